//! Processes of ffmpeg: started, ended, and what they complain of.

use std::ffi::OsString;
use std::fs::File;
use std::io::{ErrorKind, Read, Seek};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use crate::error::{Error, Result};

/// Most characters of a complaint.
const MOST: usize = 400;

/// A command of the ffmpeg that the system finds; `ISOPHOTE_FFMPEG` names another folder.
pub fn command(name: &str) -> Command {
    match std::env::var_os("ISOPHOTE_FFMPEG") {
        Some(folder) => Command::new(Path::new(&folder).join(name)),
        None => Command::new(name),
    }
}

/// A path that ffmpeg takes for a file, whatever it looks like.
pub fn file(path: &Path) -> OsString {
    let mut name = OsString::from("file:");
    name.push(path);
    name
}

/// Why a process did not do its work.
#[derive(Debug)]
pub enum Problem {
    /// It cannot be started.
    Missing(Error),
    /// What it said.
    Said(String),
}

impl Problem {
    /// As an error about a file, with how to put it right.
    pub fn of(self, path: &Path, fix: &str) -> Error {
        match self {
            Self::Missing(error) => error,
            Self::Said(text) => Error::file(path, text, fix),
        }
    }
}

/// A process that is ended with its owner.
#[derive(Debug)]
pub struct Process {
    child: Child,
    complaints: File,
}

impl Process {
    /// Starts a command, whose standard error is kept.
    ///
    /// # Errors
    /// [`Problem::Missing`].
    pub fn start(command: &mut Command) -> std::result::Result<Self, Problem> {
        let mut start = || -> std::io::Result<Self> {
            let complaints = tempfile::tempfile()?;
            let child = command.stderr(complaints.try_clone()?).spawn()?;
            Ok(Self { child, complaints })
        };
        start().map_err(|problem| {
            let name = command.get_program().to_string_lossy().into_owned();
            Problem::Missing(match problem.kind() {
                ErrorKind::NotFound => Error::failure(
                    format!("the program {name} is not found, which reads and writes videos"),
                    "install ffmpeg (on Debian: apt install ffmpeg), or work on a sequence of pictures",
                ),
                _ => Error::failure(format!("{name} cannot be started: {problem}"), "start again"),
            })
        })
    }

    /// What a command prints.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn output(command: &mut Command) -> std::result::Result<String, Problem> {
        let mut process = Self::start(command.stdin(Stdio::null()).stdout(Stdio::piped()))?;
        let mut text = String::new();
        if let Some(mut out) = process.child.stdout.take() {
            // What is cut short is no JSON, which is found out later.
            let _ = out.read_to_string(&mut text);
        }
        process.end().map(|()| text)
    }

    /// The process.
    pub fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Waits for its end.
    ///
    /// # Errors
    /// [`Problem::Said`] unless it ended well.
    pub fn end(mut self) -> std::result::Result<(), Problem> {
        let status = self.child.wait();
        if status.as_ref().is_ok_and(ExitStatus::success) {
            return Ok(());
        }
        Err(Problem::Said(self.complaint()))
    }

    /// The last line that it has complained in.
    fn complaint(&mut self) -> String {
        let mut text = String::new();
        let _ = self.complaints.rewind().and_then(|()| self.complaints.read_to_string(&mut text));
        let line = text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("it says nothing");
        format!("ffmpeg cannot do it: {}", line.chars().take(MOST).collect::<String>())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // One that has ended is none to be killed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A result as the program has it.
pub fn at<T>(result: std::result::Result<T, Problem>, path: &Path, fix: &str) -> Result<T> {
    result.map_err(|problem| problem.of(path, fix))
}
