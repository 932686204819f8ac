//! A real window of the program on a display without a screen, and what people do to it.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// Software rendering on a busy machine takes its time; this only ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(240);
const TICK: Duration = Duration::from_millis(50);
/// A corner of the window's menu, which is darker while it is asked whether the window may be closed.
const CORNER: Part = [0, 0, 60, 24];

/// A child that does not outlive its test.
pub struct Running(pub Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A part of a screen: its left, upper, right and lower border.
pub type Part = [usize; 4];

/// Xvfb on a display that it chooses itself, whose screen is a file.
pub struct Display {
    _server: Running,
    /// As `DISPLAY` has it.
    pub name: String,
    folder: TempDir,
}

impl Display {
    /// A screen of a size; nothing where the test cannot be made, which is not so on machines that test.
    ///
    /// It does not reset: it would whenever its only client leaves, as each call of xdotool does, and turn down whoever
    /// connects in that moment.
    pub fn open(size: &str) -> Option<Self> {
        let opened = Self::try_open(size);
        if opened.is_none() {
            assert!(
                std::env::var_os("CI").is_none(),
                "Xvfb and xdotool are needed: apt install xvfb xdotool"
            );
            eprintln!("SKIPPED: no Xvfb or xdotool");
        }
        opened
    }

    fn try_open(size: &str) -> Option<Self> {
        let folder = super::folder();
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &format!("{size}x24")])
            .args(["-nolisten", "tcp", "-noreset", "-fbdir"])
            .arg(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        let mut number = String::new();
        BufReader::new(server.stdout.take()?).read_line(&mut number).ok()?;
        let display = Self { _server: Running(server), name: format!(":{}", number.trim()), folder };
        display.xdotool(&["version"])?;
        Some(display)
    }

    /// The folder of the screen's file.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Output of xdotool, if it succeeds.
    pub fn xdotool(&self, arguments: &[&str]) -> Option<String> {
        let output = Command::new("xdotool").env("DISPLAY", &self.name).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    }
}

/// A part of the screen whose file is in a folder: four bytes a pixel, from the format XWD.
pub fn screen(folder: &Path, [left, top, right, bottom]: Part) -> Vec<u8> {
    let file = fs::read(folder.join("Xvfb_screen0")).expect("the screen's file");
    let number = |at: usize| u32::from_be_bytes(file[4 * at..][..4].try_into().expect("four bytes")) as usize;
    let (header, row, colors) = (number(0), number(12), number(19));
    let pixels = &file[header + 12 * colors..];
    (top..bottom).flat_map(|y| pixels[y * row + 4 * left..y * row + 4 * right].iter().copied()).collect()
}

/// The program's window.
pub struct Window<'d> {
    display: &'d Display,
    viewer: Running,
    /// Its number, as xdotool has it.
    pub id: String,
    said: Arc<Mutex<String>>,
}

impl<'d> Window<'d> {
    /// Opens it on a display by a command, which is `isophote view` with what else is asked for.
    pub fn open(display: &'d Display, command: &mut Command) -> Self {
        Self::open_beside(display, command.env_remove("DBUS_SESSION_BUS_ADDRESS"))
    }

    /// The same, on the session bus that the command names.
    pub fn open_beside(display: &'d Display, command: &mut Command) -> Self {
        let child = command
            .env("DISPLAY", &display.name)
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        let mut viewer = Running(child.expect("the program can be started"));
        let said = Arc::new(Mutex::new(String::new()));
        let (own, errors) = (Arc::clone(&said), viewer.0.stderr.take().expect("standard error"));
        std::thread::spawn(move || {
            for line in BufReader::new(errors).lines().map_while(Result::ok) {
                *own.lock().expect("the test goes on") += &format!("{line}\n");
            }
        });
        let mut window = Self { display, viewer, id: String::new(), said };
        window.wait_for("a window", |window| {
            let found = window.display.xdotool(&["search", "--onlyvisible", "--name", ".+"]);
            window.id = found.and_then(|ids| ids.lines().next().map(str::to_owned)).unwrap_or_default();
            !window.id.is_empty()
        });
        window
    }

    /// Waits until something is so, while the program goes on.
    pub fn wait_for(&mut self, what: &str, mut is_so: impl FnMut(&mut Self) -> bool) {
        let started = Instant::now();
        while !is_so(self) {
            assert!(started.elapsed() < PATIENCE, "waited too long for {what}: {}", self.state());
            let ended = self.viewer.0.try_wait().expect("the program's state");
            assert!(ended.is_none(), "the program ended before {what}: {}", self.state());
            std::thread::sleep(TICK);
        }
    }

    fn state(&self) -> String {
        format!("'{}' {}", self.title(), self.said())
    }

    /// Text that it has written to standard error.
    pub fn said(&self) -> String {
        self.said.lock().expect("the test goes on").clone()
    }

    /// Its title.
    pub fn title(&self) -> String {
        self.display.xdotool(&["getwindowname", &self.id]).unwrap_or_default()
    }

    /// Waits until the title names what is open and the look, by its name or its id, since a picture of both has been shown.
    pub fn shows(&mut self, file: &str, look: &str) {
        let wanted = titled(file, look);
        self.wait_for(&wanted, |window| window.title().to_lowercase().starts_with(&wanted));
    }

    /// Presses keys.
    pub fn key(&mut self, keys: &str) {
        let id = self.id.clone();
        self.wait_for("a key", |window| {
            window.display.xdotool(&["windowfocus", "--sync", &id, "key", keys]).is_some()
        });
    }

    /// Presses a key and holds it for so many seconds.
    pub fn hold(&mut self, key: &str, seconds: &str) {
        let id = self.id.clone();
        self.wait_for("a key", |window| {
            let held = ["windowfocus", "--sync", &id, "keydown", key, "sleep", seconds, "keyup", key];
            window.display.xdotool(&held).is_some()
        });
    }

    /// Does something with the pointer at a place of the window.
    pub fn point(&mut self, [x, y]: [i32; 2], then: &[&str]) {
        let (id, [x, y]) = (self.id.clone(), [x, y].map(|v| v.to_string()));
        self.wait_for("the pointer", |window| {
            window.display.xdotool(&[&["mousemove", "--window", &id, &x, &y], then].concat()).is_some()
        });
    }

    /// Clicks on a place, and takes the pointer away.
    pub fn click(&mut self, at: [i32; 2]) {
        self.point(at, &["sleep", "0.1", "click", "1"]);
        self.point([2, 200], &[]);
    }

    /// Drags from one place to another, in steps.
    pub fn drag(&mut self, from: [i32; 2], to: [i32; 2]) {
        const STEPS: i32 = 6;
        self.point(from, &["sleep", "0.1", "mousedown", "1"]);
        for step in 1..=STEPS {
            let at = [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * step / STEPS);
            self.point(at, &["sleep", "0.05"]);
        }
        self.point(to, &["mouseup", "1"]);
        self.point([2, 200], &[]);
    }

    /// Changes its size, and waits until it has it.
    pub fn resize(&mut self, width: u32, height: u32) {
        let (id, size) = (self.id.clone(), [width, height].map(|v| v.to_string()));
        self.wait_for("another size", |window| {
            window.display.xdotool(&["windowsize", "--sync", &id, &size[0], &size[1]]).is_some()
        });
    }

    /// A part of the screen, once it has stayed the same for a while.
    pub fn settled(&mut self, part: Part) -> Vec<u8> {
        let folder = self.display.folder().to_owned();
        let (mut seen, mut since) = (Vec::new(), Instant::now());
        self.wait_for("a picture that stays", |_| {
            let now = screen(&folder, part);
            if now != seen {
                (seen, since) = (now, Instant::now());
            }
            since.elapsed() > Duration::from_secs(2)
        });
        seen
    }

    /// Waits until a part of the screen is another than it was.
    pub fn changes(&mut self, what: &str, part: Part, before: &[u8]) {
        let folder = self.display.folder().to_owned();
        self.wait_for(what, |_| screen(&folder, part) != before);
    }

    /// Waits until a part of the screen is as it was.
    pub fn becomes(&mut self, what: &str, part: Part, before: &[u8]) {
        let folder = self.display.folder().to_owned();
        self.wait_for(what, |_| screen(&folder, part) == before);
    }

    /// Number of the program's process.
    pub fn process(&self) -> u32 {
        self.viewer.0.id()
    }

    /// Waits until it ends; returns how, and what it printed.
    pub fn ended(&mut self) -> (ExitStatus, String) {
        let started = Instant::now();
        let status = loop {
            if let Some(status) = self.viewer.0.try_wait().expect("the program's state") {
                break status;
            }
            assert!(started.elapsed() < PATIENCE, "the window does not close: {}", self.state());
            std::thread::sleep(TICK);
        };
        let mut report = String::new();
        let out = self.viewer.0.stdout.as_mut().expect("standard output");
        out.read_to_string(&mut report).expect("what was printed");
        (status, report)
    }

    /// Closes it, which must succeed without a question, as nothing is lost; returns what it printed.
    pub fn close(&mut self) -> String {
        self.key("ctrl+q");
        self.closed()
    }

    /// Closes it although something is lost, which is asked; returns what it printed.
    pub fn discard(&mut self) -> String {
        self.asks(|window| window.key("ctrl+q"));
        self.key("Tab");
        self.key("Return");
        self.closed()
    }

    /// Waits until it has closed, which must succeed; returns what it printed.
    pub fn closed(&mut self) -> String {
        let (status, report) = self.ended();
        assert!(status.success(), "{status}: {}", self.said());
        report
    }

    /// Does something that lets it ask whether it may be closed; returns what a corner of it was like before.
    pub fn asks(&mut self, act: impl FnOnce(&mut Self)) -> Vec<u8> {
        let before = screen(self.display.folder(), CORNER);
        act(self);
        self.changes("a question", CORNER, &before);
        self.settled(CORNER);
        before
    }

    /// Waits until the corner is as it was, since nothing is asked any more.
    pub fn goes_on(&mut self, before: &[u8]) {
        self.becomes("the window of before", CORNER, before);
    }
}

/// Beginning of the title of a window that shows a look on a file, in small letters.
pub fn titled(file: &str, look: &str) -> String {
    let look = if look == "none" { "original" } else { look };
    format!("{file} – {look}").to_lowercase()
}

/// `isophote view` of a size, with settings of its own in a folder.
pub fn view(folder: &Path, size: &str) -> Command {
    let mut command = super::isophote();
    command.env("ISOPHOTE_SETTINGS", folder.join("view.json")).args(["view", "--size", size]);
    command
}

/// Writes a program in a folder of its own, and returns the folder for `PATH`.
pub fn program(folder: &Path, name: &str, script: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;

    let programs = folder.join("programs");
    fs::create_dir_all(&programs).expect("the folder is writable");
    let file = programs.join(name);
    // One that runs cannot be written, but replaced.
    let new = folder.join("program");
    fs::write(&new, script).expect("the folder is writable");
    fs::set_permissions(&new, fs::Permissions::from_mode(0o755)).expect("it is ours");
    fs::rename(&new, &file).expect("the folder is writable");
    programs
}
