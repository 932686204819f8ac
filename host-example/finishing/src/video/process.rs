//! Processes of ffmpeg: started, ended, and what they complain of.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};

use isophote_files::error::{Error, Result};

/// Most characters of a complaint.
const MOST: usize = 4000;
/// Beginnings of complaints that follow from others and say no reason.
const FOLLOWING: [&str; 5] = [
    "Error initializing output stream",
    "Error while opening encoder",
    "Could not write header",
    "Error opening output file",
    "Conversion failed",
];
/// Most complaints that are kept.
const MOST_LINES: usize = 1000;
/// Protocols by which ffmpeg may open what it reads: no network, and no other programs.
pub const PROTOCOLS: [&str; 2] = ["-protocol_whitelist", "file,pipe"];
/// Kinds of files that are read, which hold their pictures themselves: no playlists.
const KINDS: [&str; 2] = [
    "-format_whitelist",
    "mov,matroska,avi,mxf,mpegts,mpeg,mpegvideo,m4v,h264,hevc,yuv4mpegpipe,flv,asf,ogg,nut,ivf,dv,gif,apng",
];

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

/// Lets a command read a video file, and no other that this may name.
pub fn read(command: &mut Command, path: &Path) {
    command.args(PROTOCOLS).args(KINDS).arg("-i").arg(file(path));
}

/// Reason why a process did not do its work.
#[derive(Debug)]
pub enum Problem {
    /// It cannot be started.
    Missing(Error),
    /// Message that it wrote.
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

/// Lines in which a process complains, while it does.
#[derive(Clone, Debug, Default)]
pub struct Complaints(Arc<Mutex<Vec<String>>>);

impl Complaints {
    /// The first one that says a reason, from which the others follow.
    pub fn first(&self) -> Option<String> {
        let is_reason = |line: &str| !FOLLOWING.iter().any(|start| line.starts_with(start));
        self.find(is_reason).or_else(|| self.find(|_| true))
    }

    /// The first one that names this.
    pub fn naming(&self, name: &str) -> Option<String> {
        self.find(|line| line.contains(name))
    }

    fn find(&self, is_it: impl Fn(&str) -> bool) -> Option<String> {
        let lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let line = lines.iter().find(|line| is_it(line))?;
        Some(line.chars().take(MOST).collect())
    }

    /// Keeps every line of a process's standard error.
    fn keep(&self, from: impl Read) {
        for line in BufReader::new(from).split(b'\n').map_while(std::result::Result::ok) {
            let line: String = String::from_utf8_lossy(&line)
                .chars()
                .map(|c| if c.is_control() { ' ' } else { c })
                .collect::<String>();
            // Some encoders say there what they do, whatever they are asked for.
            if line.trim().is_empty() || line.contains("[info]") {
                continue;
            }
            let mut lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            if lines.len() < MOST_LINES {
                lines.push(without_address(line.trim()));
            }
        }
    }
}

/// A line that begins with the part of ffmpeg that says it, without that part's address: `[mp4 @ 0x55e8] ` is `mp4: `.
fn without_address(line: &str) -> String {
    let split = || line.strip_prefix('[')?.split_once("] ");
    match split().and_then(|(who, said)| Some((who.split_once(" @ 0x")?.0, said))) {
        Some((who, said)) => format!("{who}: {said}"),
        None => line.to_owned(),
    }
}

/// End of a process.
#[derive(Debug)]
pub struct End {
    /// True where it ended well.
    pub is_good: bool,
    /// Complaints of the process.
    pub complaints: Complaints,
    has_code: bool,
    status: String,
}

impl End {
    /// Message that it gives.
    pub fn said(&self) -> String {
        let silent = || format!("it says nothing ({})", self.status);
        format!("ffmpeg cannot do it: {}", self.complaints.first().unwrap_or_else(silent))
    }

    /// True where it ended by itself without doing its work.
    pub fn is_refusal(&self) -> bool {
        !self.is_good && self.has_code
    }

    /// Of what kind its trouble is with what it writes.
    pub fn trouble(&self) -> Option<ErrorKind> {
        // In the words of the C library, which ffmpeg does not translate.
        const WORDS: [(&str, ErrorKind); 5] = [
            ("No space left on device", ErrorKind::StorageFull),
            ("Disk quota exceeded", ErrorKind::QuotaExceeded),
            ("File too large", ErrorKind::FileTooLarge),
            ("Broken pipe", ErrorKind::BrokenPipe),
            ("Input/output error", ErrorKind::Other),
        ];
        WORDS.iter().find(|(words, _)| self.complaints.naming(words).is_some()).map(|(_, kind)| *kind)
    }
}

/// A process that is ended with its owner.
#[derive(Debug)]
pub struct Process {
    child: Child,
    complaints: Complaints,
    listener: Option<JoinHandle<()>>,
}

impl Process {
    /// Starts a command, whose standard error is kept.
    ///
    /// # Errors
    /// [`Problem::Missing`].
    pub fn start(command: &mut Command) -> std::result::Result<Self, Problem> {
        let child = command.stderr(Stdio::piped()).spawn().map_err(|problem| {
            let name = command.get_program().to_string_lossy().into_owned();
            Problem::Missing(match problem.kind() {
                ErrorKind::NotFound => Error::failure(
                    format!("the program {name} is not found, which reads and writes videos"),
                    "install ffmpeg (on Debian: apt install ffmpeg), or work on a sequence of pictures",
                ),
                _ => Error::failure(format!("{name} cannot be started: {problem}"), "start again"),
            })
        })?;
        let mut process = Self { child, complaints: Complaints::default(), listener: None };
        let (complaints, from) = (process.complaints.clone(), process.child.stderr.take());
        let listen = move || from.into_iter().for_each(|from| complaints.keep(from));
        let listener = Builder::new().name("complaints".into()).spawn(listen).map_err(|e| {
            Problem::Missing(Error::failure(format!("a thread cannot be started: {e}"), "try again"))
        })?;
        process.listener = Some(listener);
        Ok(process)
    }

    /// Text that a command prints.
    ///
    /// # Errors
    /// The problem with it.
    pub fn output(command: &mut Command) -> std::result::Result<String, Problem> {
        Self::heard(command).map(|(text, _)| text)
    }

    /// Text that a command prints, and its complaints though it ends well.
    ///
    /// # Errors
    /// As [`Process::output`].
    pub fn heard(command: &mut Command) -> std::result::Result<(String, Complaints), Problem> {
        let mut process = Self::start(command.stdin(Stdio::null()).stdout(Stdio::piped()))?;
        let mut bytes = Vec::new();
        if let Some(mut out) = process.child.stdout.take() {
            // What is cut short is no JSON, which is found out later.
            let _ = out.read_to_end(&mut bytes);
        }
        let complaints = process.complaints();
        process.end().map(|()| (String::from_utf8_lossy(&bytes).into_owned(), complaints))
    }

    /// The process.
    pub fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Its complaints, also while it works.
    pub fn complaints(&self) -> Complaints {
        self.complaints.clone()
    }

    /// Waits for its end.
    pub fn finish(mut self) -> End {
        let status = self.child.wait();
        if let Some(listener) = self.listener.take() {
            // It only keeps lines.
            let _ = listener.join();
        }
        End {
            is_good: status.as_ref().is_ok_and(std::process::ExitStatus::success),
            complaints: self.complaints(),
            has_code: status.as_ref().is_ok_and(|status| status.code().is_some()),
            status: status.map_or_else(|e| e.to_string(), |status| status.to_string()),
        }
    }

    /// Waits for its end.
    ///
    /// # Errors
    /// [`Problem::Said`] unless it ended well.
    pub fn end(self) -> std::result::Result<(), Problem> {
        let end = self.finish();
        if end.is_good { Ok(()) } else { Err(Problem::Said(end.said())) }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_is_told_whole() {
        let complaints = Complaints::default();
        let long = "x".repeat(1000);
        let said = format!(
            "Error initializing output stream 0:0 -- \n[mp4 @ 0x55e8883269c0] {long}\nConversion failed!\n"
        );
        complaints.keep(said.as_bytes());
        assert_eq!(complaints.first(), Some(format!("mp4: {long}")));
        let complaints = Complaints::default();
        complaints.keep(&b"Conversion failed!\n"[..]);
        assert_eq!(complaints.first().as_deref(), Some("Conversion failed!"));
        assert_eq!(without_address("[in] file.mp4: bad"), "[in] file.mp4: bad");
    }
}
