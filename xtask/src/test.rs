//! `cargo xtask test`: everything that must hold before a change lands, or the tests of one thing.

use crate::error::{Context, Failure, Result};
use crate::setup::{
    self, BINUTILS, BLENDER, BROWSER, C_COMPILER, CLANG, CPP_COMPILER, FFMPEG, NODE, PACKAGING, PYTHON,
    VALGRIND, VULKAN, VULKAN_HEADERS, WASM, XVFB,
};
use crate::tools::{cargo, cargo_command, heading, library_file, root, target_dir};
use crate::{cases, python, web};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::time::Instant;

/// Options of `cargo xtask test`.
#[derive(clap::Args)]
pub struct Options {
    /// Only tests whose name, or whose file's name, contains this: a kernel, a node, a test
    filter: Option<String>,

    /// Only say what tests there are
    #[arg(long)]
    list: bool,

    /// Only the tests; no formatting, lints, documents or generated files
    #[arg(long)]
    tests_only: bool,

    /// Only the job of this name, of those that a whole run starts beside the programs; all is built
    #[arg(long, hide = true)]
    job: Option<String>,
}

/// Sets up what the tests need, then runs those that are asked for, or all of them and every other check.
///
/// # Errors
/// The checks that fail.
pub fn run(options: &Options) -> Result<()> {
    if let Some(name) = &options.job {
        let job = OUTSIDE_TESTS.iter().find(|test| test.name == name);
        return job.map_or_else(|| Err(Failure(format!("there is no job {name}"))), |job| (job.run)());
    }
    setup::ensure(&[
        &C_COMPILER,
        &CPP_COMPILER,
        &BINUTILS,
        &VULKAN,
        &VULKAN_HEADERS,
        &VALGRIND,
        &XVFB,
        &FFMPEG,
        &BROWSER,
        &CLANG,
        &PACKAGING,
        &PYTHON,
        &BLENDER,
        &NODE,
        &WASM,
    ])?;
    let is_everything = options.filter.is_none() && !options.list;
    if is_everything && !options.tests_only {
        check_sources()?;
    }
    if is_everything || options.filter.as_deref() == Some(cases::FILTER) {
        cases::check()?;
    }
    heading("build");
    cargo(&["build", "--workspace", "--quiet"])?;
    let programs = programs()?;
    if options.list {
        return list(&programs, options.filter.as_deref());
    }
    heading("tests");
    let failed = match &options.filter {
        Some(filter) => run_named(&programs, filter)?,
        None => run_all(programs)?,
    };
    heading("end");
    if failed.is_empty() { Ok(()) } else { Err(Failure(format!("these tests fail: {}", failed.join(", ")))) }
}

/// Formatting, lints, generated files and documents.
fn check_sources() -> Result<()> {
    heading("formatting");
    check_formatting()?;
    heading("lints");
    cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])?;
    heading("generated files");
    crate::guides::run(&crate::guides::Options { check: true })?;
    crate::header::run(&crate::header::Options { check: true })?;
    crate::readme::run(&crate::readme::Options { check: true })?;
    crate::crates::run(&crate::crates::Options { check: true })?;
    crate::gpu_cost::run(&crate::gpu_cost::Options { check: true, kernel: None })?;
    heading("documents");
    cargo(&["doc", "--workspace", "--no-deps", "--quiet"])
}

/// Checks every Rust file of the repository. `cargo fmt` does not see those that macros and build scripts
/// declare.
fn check_formatting() -> Result<()> {
    let mut git = Command::new("git");
    let listed = git.args(["ls-files", "*.rs"]).current_dir(root()).output();
    let listed = listed.context(|| "git, which lists the files, cannot be started".into())?;
    let files = String::from_utf8_lossy(&listed.stdout).into_owned();
    let files: Vec<&str> = files.lines().filter(|file| root().join(file).exists()).collect();
    if !listed.status.success() || files.is_empty() {
        return Err(Failure("git does not list the repository's files".into()));
    }
    let mut rustfmt = Command::new("rustfmt");
    crate::tools::run(rustfmt.args(["--edition", "2024", "--check"]).args(files).current_dir(root()))
        .map_err(|_| Failure("some files are not formatted: run rustfmt on them".into()))
}

fn documents() -> Result<()> {
    cargo(&["test", "--workspace", "--doc", "--quiet"])
}

/// The declared OpenFX interface has a workspace of its own; its manifest says why.
fn interface() -> Result<()> {
    let mut interface = cargo_command(&["test", "--locked", "--quiet", "--manifest-path"]);
    let manifest = root().join("tests/interface/Cargo.toml");
    crate::tools::run(interface.arg(manifest).arg("--target-dir").arg(target_dir("interface")))
}

/// Tests that are no program of the workspace, each run by another process of this chore, so that what they print
/// stays together.
struct OutsideTest {
    name: &'static str,
    run: fn() -> Result<()>,
}

const OUTSIDE_TESTS: [OutsideTest; 4] = [
    OutsideTest { name: "web", run: || web::test(None) },
    OutsideTest { name: "python", run: || python::test(None) },
    OutsideTest { name: "documents", run: documents },
    OutsideTest { name: "interface", run: interface },
];

impl OutsideTest {
    /// The test as a program: the chores as the workspace is built with them, for that build may have replaced this one.
    fn program(&self) -> Program {
        let path = target_dir("debug").join(format!("xtask{}", std::env::consts::EXE_SUFFIX));
        let arguments = vec!["test", "--job", self.name];
        Program { name: self.name.into(), path, folder: root(), arguments }
    }
}

/// A program of tests.
struct Program {
    /// Stem of its file.
    name: String,
    path: PathBuf,
    /// Folder of its package, where it runs.
    folder: PathBuf,
    arguments: Vec<&'static str>,
}

impl Program {
    fn command(&self) -> Command {
        let mut command = Command::new(&self.path);
        self.set_up(&mut command);
        command
    }

    /// The same, behind all other processes.
    fn patient(&self) -> Command {
        let mut command = Command::new("nice");
        command.args(["-n", "19"]).arg(&self.path);
        self.set_up(&mut command);
        command
    }

    fn set_up(&self, command: &mut Command) {
        command
            .args(&self.arguments)
            .current_dir(&self.folder)
            .env("CARGO_MANIFEST_DIR", &self.folder)
            .env("ISOPHOTE_LIBRARY", library_file("debug"))
            .env("ISOPHOTE_REQUIRE_GPU", "1")
            .env("NODEVICE_SELECT", "1");
    }

    /// Its tests whose name contains the filter, or all of them when its own name does.
    fn tests(&self, filter: &str) -> Result<Vec<String>> {
        let output = self.command().arg("--list").output();
        let output = output.context(|| format!("{} cannot be started", self.path.display()))?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let names = text.lines().filter_map(|line| line.strip_suffix(": test"));
        let is_meant = self.name.contains(filter);
        Ok(names.filter(|name| is_meant || name.contains(filter)).map(str::to_owned).collect())
    }
}

/// Builds all programs of tests.
fn programs() -> Result<Vec<Program>> {
    let mut build = cargo_command(&["test", "--workspace", "--no-run", "--quiet"]);
    build.arg("--message-format=json-render-diagnostics").stderr(Stdio::inherit());
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

fn list(programs: &[Program], filter: Option<&str>) -> Result<()> {
    for program in programs {
        for test in program.tests(filter.unwrap_or_default())? {
            println!("{}: {test}", program.name);
        }
    }
    for suite in &SUITES {
        for test in suite.named(filter.unwrap_or_default())? {
            println!("{}: {test}", suite.name);
        }
    }
    Ok(())
}

/// Tests in another language.
struct Suite {
    /// Name that they have together.
    name: &'static str,
    tests: fn() -> Result<Vec<String>>,
    /// Runs those whose names contain the filter; without one all.
    run: fn(Option<&str>) -> Result<()>,
}

const SUITES: [Suite; 2] = [
    Suite { name: "python", tests: python::tests, run: python::test },
    Suite { name: "web", tests: web::tests, run: web::test },
];

impl Suite {
    /// The tests whose name contains the filter, or all of them when their common name does.
    fn named(&self, filter: &str) -> Result<Vec<String>> {
        let tests = (self.tests)()?.into_iter();
        Ok(tests.filter(|test| self.name.contains(filter) || test.contains(filter)).collect())
    }
}

/// Runs the tests that the filter means, one program after the other. Returns the programs that fail.
fn run_named(programs: &[Program], filter: &str) -> Result<Vec<String>> {
    let (mut failed, mut found) = (Vec::new(), 0);
    for program in programs {
        let tests = program.tests(filter)?;
        if tests.is_empty() {
            continue;
        }
        found += tests.len();
        let mut command = program.command();
        if !program.name.contains(filter) {
            command.arg(filter);
        }
        println!("\n-- {}", program.name);
        if crate::tools::run(&mut command).is_err() {
            failed.push(program.name.clone());
        }
    }
    for suite in &SUITES {
        if !suite.named(filter)?.is_empty() {
            found += 1;
            let named = (!suite.name.contains(filter)).then_some(filter);
            failed.extend((suite.run)(named).err().map(|_| suite.name.to_owned()));
        }
    }
    if found == 0 {
        return Err(Failure(format!("no test's name contains '{filter}'; --list shows them all")));
    }
    Ok(failed)
}

/// Programs that take long, the longest first.
const LONG: [&str; 15] = [
    "experiments_steadiness",
    "documents",
    "docs",
    "dist",
    "experiments_marks",
    "experiments_flow",
    "view_life",
    "video_faults",
    "python",
    "view_device",
    "view_end",
    "sliders",
    "precision",
    "twins",
    "colour",
];

/// Programs that measure time, and run when nothing else does.
const ALONE: [&str; 1] = ["openfx_faults"];

/// Programs that leave a core idle, as they wait for browsers, and begin at once. The others leave them the processor when they
/// want it.
const FIRST: [&str; 1] = ["web"];

/// Other programs that run at a time. Each has as many threads as there are cores; while one waits for a
/// device, or for its last test, the other computes.
const LANES: usize = 2;

/// Number of the slowest programs that are named at the end.
const SLOWEST: usize = 20;

/// Runs all programs. Returns those that fail.
fn run_all(mut programs: Vec<Program>) -> Result<Vec<String>> {
    programs.extend(OUTSIDE_TESTS.iter().map(OutsideTest::program));
    programs.sort_by_key(|p| LONG.iter().position(|long| *long == p.name).unwrap_or(LONG.len()));
    let (alone, together): (Vec<Program>, Vec<Program>) =
        programs.into_iter().partition(|p| ALONE.contains(&p.name.as_str()));
    let (first, together): (Vec<Program>, Vec<Program>) =
        together.into_iter().partition(|p| FIRST.contains(&p.name.as_str()));
    let (failed, times) = (Mutex::new(Vec::new()), Mutex::new(Vec::new()));
    let run = |program: Program, is_patient: bool| {
        let started = Instant::now();
        let output = if is_patient { program.patient().output() } else { program.command().output() };
        let seconds = started.elapsed().as_secs_f64();
        lock(&times).push((seconds, program.name.clone()));
        // Locked, so that what two programs print stays apart.
        let mut failed = lock(&failed);
        if !show(&program, &output, seconds) {
            failed.push(program.name);
        }
    };
    let waiting = Mutex::new(together.into_iter());
    std::thread::scope(|scope| {
        scope.spawn(|| first.into_iter().for_each(|program| run(program, false)));
        for _ in 0..LANES {
            scope.spawn(|| {
                loop {
                    // Not in the head of a `while let`: its guard would be held while the program runs.
                    let Some(program) = lock(&waiting).next() else { break };
                    run(program, true);
                }
            });
        }
    });
    alone.into_iter().for_each(|program| run(program, false));
    show_slowest(times.into_inner().unwrap_or_default());
    Ok(failed.into_inner().unwrap_or_default())
}

/// Prints the programs that took longest. Those of generated trials name their slowest trials themselves.
fn show_slowest(mut times: Vec<(f64, String)>) {
    times.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    println!("\n-- the slowest programs");
    for (seconds, name) in times.iter().take(SLOWEST) {
        println!("{seconds:7.1} s  {name}");
    }
}

/// Prints what a program printed; whether its tests hold.
fn show(program: &Program, output: &std::io::Result<Output>, seconds: f64) -> bool {
    println!("\n-- {} ({seconds:.1} s)", program.name);
    match output {
        Ok(output) => {
            print!("{}", String::from_utf8_lossy(&output.stdout));
            eprint!("{}", String::from_utf8_lossy(&output.stderr));
            output.status.success()
        }
        Err(error) => {
            eprintln!("{} cannot be started: {error}", program.path.display());
            false
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Makes the golden images anew. Look at them before they are committed.
///
/// # Errors
/// When they cannot be made.
pub fn bless() -> Result<()> {
    let mut command = cargo_command(&["test", "--workspace", "--test", "goldens", "--test", "bits"]);
    crate::tools::run(command.env("ISOPHOTE_BLESS", "1"))
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
