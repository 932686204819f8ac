//! Shows a file that was made in the file manager of the system. Paths are handed over as arguments and never as text of a shell.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::worker::Wake;
use isophote_files::error::{Error, Result};

/// File managers that were asked to show something, each on a thread of its own: some stay until they are closed, for which the
/// window does not wait.
pub struct Reveal {
    problems: Receiver<Error>,
    tell: Sender<Error>,
    wake: Wake,
}

impl Reveal {
    /// None that was asked yet.
    pub fn new(wake: &Wake) -> Self {
        let (tell, problems) = channel();
        Self { problems, tell, wake: Arc::clone(wake) }
    }

    /// Shows a file, the files of a pattern or a folder.
    pub fn show(&self, file: &Path) {
        let (tell, wake, file) = (self.tell.clone(), Arc::clone(&self.wake), file.to_owned());
        let spawned = std::thread::Builder::new().name("folder".into()).spawn(move || {
            if let Err(problem) = run(command(&file), &file) {
                // The window may be closed by now.
                let _ = tell.send(problem);
                wake();
            }
        });
        if let Err(e) = spawned {
            // Nobody else listens there.
            let _ = self.tell.send(Error::failure(format!("the folder cannot be shown: {e}"), "try again"));
        }
    }

    /// Problem since the last call.
    pub fn problem(&self) -> Option<Error> {
        self.problems.try_recv().ok()
    }
}

/// Folder of a file, or itself.
fn folder(file: &Path) -> PathBuf {
    let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    if file.is_dir() { file } else { file.parent().map(Path::to_owned).unwrap_or(file) }
}

/// The command that shows a file in its folder, or a folder.
fn command(file: &Path) -> Command {
    let mut command;
    if cfg!(target_os = "macos") {
        command = Command::new("open");
        if file.is_file() {
            command.arg("-R").arg(file);
        } else {
            command.arg(folder(file));
        }
    } else if cfg!(windows) {
        command = Command::new("explorer");
        if file.is_file() {
            command.arg("/select,").arg(file);
        } else {
            command.arg(folder(file));
        }
    } else {
        command = Command::new("xdg-open");
        command.arg(folder(file));
    }
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Runs it to its end.
fn run(mut command: Command, file: &Path) -> Result<()> {
    let failed = |problem: String| {
        let fix = format!("open {} yourself", folder(file).display());
        Error::failure(format!("the folder cannot be shown: {problem}"), fix)
    };
    let name = command.get_program().to_string_lossy().into_owned();
    let status = command.status().map_err(|e| failed(format!("{name}: {e}")))?;
    // Explorer says nothing true by how it ends.
    if status.success() || cfg!(windows) {
        Ok(())
    } else {
        Err(failed(format!("{name} ended with {status}")))
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    #[test]
    fn the_folder_is_one_argument_and_failures_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("a $(touch gone); 'b' größer");
        fs::create_dir(&place).unwrap();
        let file = place.join("photo-look.png");
        fs::write(&file, "x").unwrap();
        let program = |script: &str| {
            let new = folder.path().join("new");
            fs::write(&new, script).unwrap();
            fs::set_permissions(&new, fs::Permissions::from_mode(0o755)).unwrap();
            fs::rename(&new, folder.path().join("xdg-open")).unwrap();
        };
        let told = folder.path().join("told");
        program(&format!("#!/bin/sh\nprintf '%s\\n' \"$#\" \"$@\" > '{}'\n", told.display()));
        let show = |file: &Path| {
            let mut command = command(file);
            command.env("PATH", folder.path());
            run(command, file)
        };
        for shown in [&file, &place.join("shot.####.png"), &place] {
            show(shown).unwrap();
            assert_eq!(fs::read_to_string(&told).unwrap(), format!("1\n{}\n", place.display()));
        }
        program("#!/bin/sh\nexit 3\n");
        let error = show(&file).unwrap_err().to_string();
        assert!(error.contains("xdg-open ended with") && error.contains("yourself"), "{error}");
        fs::remove_file(folder.path().join("xdg-open")).unwrap();
        assert!(show(&file).unwrap_err().to_string().contains("xdg-open"));
    }
}
