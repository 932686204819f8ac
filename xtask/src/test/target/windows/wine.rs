//! Wine with a disk of its own and a display without a screen.

use crate::error::{Context, Failure, Result};
use crate::tools::run as run_command;
use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Compiler and linker of C for Windows.
pub const LINKER: &str = "x86_64-w64-mingw32-gcc";

/// Libraries of Windows that Wine does without: it would ask for the first two at its first start, and has no card that
/// knows the last.
const WITHOUT: &str = "mscoree=;mshtml=;d3d12=";

/// A display and the disk of Wine, until it is dropped.
pub struct Wine {
    folder: PathBuf,
    display: Child,
    name: String,
}

impl Wine {
    /// Starts a display, and Wine with the disk in a folder, which is made at the first start.
    ///
    /// # Errors
    /// Programs that cannot be started.
    pub fn start(folder: &Path) -> Result<Self> {
        let mut display = Command::new("Xvfb");
        display.args(["-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp"]);
        let display = display.stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut display = display.context(|| "Xvfb cannot be started".into())?;
        let mut number = String::new();
        if let Some(told) = display.stdout.take() {
            BufReader::new(told).read_line(&mut number).context(|| "Xvfb tells no display".into())?;
        }
        let wine = Self { folder: folder.to_owned(), display, name: format!(":{}", number.trim()) };
        let system = folder.join("drive_c/windows/system32");
        if !system.join("bcryptprimitives.dll").is_file() {
            wine.run("wineboot", &["--init"])?;
            if !system.is_dir() {
                return Err(Failure(format!("Wine has not made {}", system.display())));
            }
            // The library that Rust's standard library takes random numbers from.
            compile("bcryptprimitives.c", &system.join("bcryptprimitives.dll"), &["-shared", "-ladvapi32"])?;
        }
        wine.clean();
        wine.share_the_disk()?;
        wine.add_programs()?;
        Ok(wine)
    }

    /// Tells a program of Wine where disk and display are, and which graphics device to take.
    pub fn prepare(&self, command: &mut Command) {
        command.env("WINEPREFIX", &self.folder).env("DISPLAY", &self.name);
        command.env("WINEDEBUG", "-all").env("WINEDLLOVERRIDES", WITHOUT).env("LC_ALL", "C.UTF-8");
        command.env("WGPU_BACKEND", "vulkan").env("ISOPHOTE_ADAPTER", "llvmpipe");
        command.env("WINEPATH", path(&self.programs()));
    }

    fn run(&self, program: &str, arguments: &[&str]) -> Result<()> {
        let mut command = Command::new(program);
        self.prepare(&mut command);
        run_command(command.args(arguments))
    }

    /// Folder of programs that those of Windows find by their names.
    pub fn programs(&self) -> PathBuf {
        self.folder.join("programs")
    }

    /// Lets programs name the disk as that of another machine, as every Windows does for those who look after it.
    fn share_the_disk(&self) -> Result<()> {
        let machine = self.folder.join("dosdevices/unc/localhost");
        let cannot = || format!("cannot make {}", machine.display());
        let _ = fs::remove_dir_all(&machine);
        fs::create_dir_all(&machine).context(cannot)?;
        symlink(self.folder.join("drive_c"), machine.join("C$")).context(cannot)
    }

    /// Empties the folders of temporary files. Libraries that are loaded cannot be removed by those who made them.
    fn clean(&self) {
        let users = fs::read_dir(self.folder.join("drive_c/users")).into_iter().flatten().flatten();
        for left in users.filter_map(|user| fs::read_dir(user.path().join("Temp")).ok()).flatten().flatten() {
            // What lies there is no result, and others may be as fast.
            let _ = fs::remove_dir_all(left.path()).or_else(|_| fs::remove_file(left.path()));
        }
    }

    /// Programs of this system under the names that they have on Windows. Paths are told to them as this system has them.
    fn add_programs(&self) -> Result<()> {
        let folder = self.programs();
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).context(|| format!("cannot create {}", folder.display()))?;
        for (name, program) in PROGRAMS {
            compile("native.c", &folder.join(format!("{name}.exe")), &[])?;
            let file = folder.join(format!("{name}.sh"));
            let script = SCRIPT.replace("PROGRAM", program).replace("FOLDER", &self.folder.to_string_lossy());
            let put = fs::write(&file, script)
                .and_then(|()| fs::set_permissions(&file, fs::Permissions::from_mode(0o755)));
            put.context(|| format!("cannot write {}", file.display()))?;
        }
        Ok(())
    }
}

impl Drop for Wine {
    fn drop(&mut self) {
        let mut end = Command::new("wineserver");
        self.prepare(&mut end);
        let _ = end.arg("--kill").status();
        self.clean();
        let _ = self.display.kill();
        let _ = self.display.wait();
    }
}

/// Programs that tests start, by their names in Wine and in this system. Wine hands them no pipes.
const PROGRAMS: [(&str, &str); 1] = [("cc", LINKER)];

/// A script that `native.c` starts: it runs a program with paths as this system has them, and tells how it ended.
const SCRIPT: &str = r#"#!/bin/bash
arguments=()
for argument in "$@"; do
    if [[ $argument =~ ^(file:)?([CcZz]:)?[\\/] ]]; then
        argument=${argument//\\//}
        argument=${argument/[Zz]:/}
        argument=${argument/[Cc]:/FOLDER/drive_c}
    fi
    arguments+=("$argument")
done
told=${arguments[0]}
PROGRAM "${arguments[@]:1}"
echo $? >"$told.part"
mv "$told.part" "$told"
"#;

/// Name of a file of this system for programs of Wine.
pub fn path(file: &Path) -> String {
    format!("Z:{}", file.display()).replace('/', "\\")
}

/// Builds a file of C, which lies beside this one, for Windows.
fn compile(source: &str, out: &Path, options: &[&str]) -> Result<()> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/test/target/windows").join(source);
    let mut compile = Command::new(LINKER);
    compile.args(["-O1", "-Wall", "-o"]).arg(out).arg(source);
    run_command(compile.args(options))
}
