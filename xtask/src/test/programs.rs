//! Programs of tests, as cargo builds them.

use crate::error::{Context, Failure, Result};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A program of tests, or one file of them that it runs alone.
#[derive(Clone)]
pub struct Program {
    /// Stem of the program's file, or of the file of tests.
    pub name: String,
    pub path: PathBuf,
    /// Folder of its package, where it runs.
    pub folder: PathBuf,
    pub arguments: Vec<String>,
}

/// Programs of several files of tests: of functions, and of generated trials. A test's name begins with its file's.
const OF_FILES: [&str; 2] = ["tests", "trials"];
/// Argument of the harness of functions before the names of those that are meant.
const EXACT: &str = "--exact";

impl Program {
    /// The program, to be run by `runner` where that is not empty: another program with its arguments.
    pub fn command(&self, runner: &[&str]) -> Command {
        let mut words = runner.iter().map(OsStr::new).chain([self.path.as_os_str()]);
        let mut command = Command::new(words.next().unwrap_or_default());
        command
            .args(words)
            .args(&self.arguments)
            .current_dir(&self.folder)
            .env("CARGO_MANIFEST_DIR", &self.folder)
            .env("NODEVICE_SELECT", "1");
        command
    }

    /// Its files of tests, each as a program of its own: a process for each keeps what one does to its process from the others,
    /// and each is reported by itself. A program of one file stays as it is. `run` makes a command that runs a program.
    pub fn files(self, run: impl Fn(&Self) -> Command) -> Result<Vec<Self>> {
        let [of_functions, of_trials] = OF_FILES.map(|name| name == self.name);
        if !of_functions && !of_trials {
            return Ok(vec![self]);
        }
        let mut files: Vec<Self> = Vec::new();
        for test in self.tests("", run(&self))? {
            let Some((name, _)) = test.split_once("::") else { continue };
            if files.last().is_none_or(|file| file.name != name) {
                let arguments =
                    if of_trials { vec!["--file".into(), name.into()] } else { vec![EXACT.into()] };
                files.push(Self { name: name.into(), arguments, ..self.clone() });
            }
            if of_functions && let Some(file) = files.last_mut() {
                file.arguments.push(test);
            }
        }
        Ok(files)
    }

    /// The program with those of its tests alone whose names contain the filter, if there are any; all of them where its own
    /// name does. `run` makes a command that runs a program.
    pub fn narrowed(mut self, filter: &str, run: impl Fn(&Self) -> Command) -> Result<Option<Self>> {
        if self.name.contains(filter) {
            return Ok(Some(self));
        }
        let tests = self.tests(filter, run(&self))?;
        if tests.is_empty() {
            return Ok(None);
        }
        if self.arguments.first().is_some_and(|first| first == EXACT) {
            self.arguments = [EXACT.to_owned()].into_iter().chain(tests).collect();
        } else {
            self.arguments.push(filter.into());
        }
        Ok(Some(self))
    }

    /// Names of its tests that contain the filter, or all of them when its own name does.
    /// `run` is a command that runs it.
    pub fn tests(&self, filter: &str, mut run: Command) -> Result<Vec<String>> {
        let output = run.arg("--list").output();
        let output = output.context(|| format!("{} cannot be started", self.path.display()))?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let names = text.lines().filter_map(|line| line.strip_suffix(": test"));
        let is_meant = self.name.contains(filter);
        Ok(names.filter(|name| is_meant || name.contains(filter)).map(str::to_owned).collect())
    }
}

/// Builds the programs of tests that a command of cargo names, `cargo test` with its packages.
pub fn build(mut build: Command) -> Result<Vec<Program>> {
    build.args(["--no-run", "--quiet", "--message-format=json-render-diagnostics"]).stderr(Stdio::inherit());
    let output = build.output().context(|| "cargo cannot be started".into())?;
    if !output.status.success() {
        return Err(Failure("the tests cannot be built".into()));
    }
    let messages = String::from_utf8_lossy(&output.stdout).into_owned();
    let programs = messages.lines().filter(|line| is_test(line)).filter_map(|line| {
        let path = PathBuf::from(field(line, "executable")?);
        let folder = Path::new(&field(line, "manifest_path")?).parent()?.to_owned();
        // Cargo adds a hash.
        let name = path.file_stem()?.to_str()?.rsplit_once('-')?.0.to_owned();
        Some(Program { name, path, folder, arguments: Vec::new() })
    });
    Ok(programs.collect())
}

/// True where one of cargo's messages is about something compiled as a test.
fn is_test(message: &str) -> bool {
    let profile = message.split_once(r#""profile":{"#).and_then(|(_, rest)| rest.split_once('}'));
    profile.is_some_and(|(profile, _)| profile.contains(r#""test":true"#))
}

/// A text of one of cargo's messages.
fn field(message: &str, name: &str) -> Option<String> {
    let (_, rest) = message.split_once(&format!(r#""{name}":""#))?;
    let (value, _) = rest.split_once('"')?;
    Some(value.replace(r"\\", r"\"))
}

#[cfg(test)]
mod tests {
    use super::{field, is_test};

    #[test]
    fn fields_of_messages_are_found() {
        let message =
            r#"{"reason":"compiler-artifact","manifest_path":"C:\\a b\\Cargo.toml","executable":null}"#;
        assert_eq!(field(message, "manifest_path").as_deref(), Some(r"C:\a b\Cargo.toml"));
        assert_eq!(field(message, "executable"), None);
    }

    #[test]
    fn programs_of_tests_are_told_from_programs_that_have_tests() {
        let message = |is_test: bool| {
            format!(r#"{{"target":{{"test":true}},"profile":{{"test":{is_test}}},"executable":"/a/x-0"}}"#)
        };
        assert!(is_test(&message(true)) && !is_test(&message(false)));
        assert!(!is_test(r#"{"reason":"build-finished","success":true}"#));
    }
}
