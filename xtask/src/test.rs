//! `cargo xtask test`: everything that must hold before a change lands, or the tests of one thing.

use crate::error::{Context, Failure, Result};
use crate::setup::{
    self, BINUTILS, BLENDER, BROWSER, C_COMPILER, CLANG, CPP_COMPILER, FFMPEG, PACKAGING, PYTHON, SLURM,
    VALGRIND, VULKAN, VULKAN_HEADERS, XVFB,
};
use crate::tools::{WRAPPER, cargo, cargo_command, heading, library_file, root, target_dir};
use crate::{cases, python, web};
pub use compiler::stand_in;
use programs::Program;
use report::Ran;
use std::process::{Command, Output};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

mod compiler;
mod programs;
mod report;
mod target;

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

    /// Only what a whole run leaves out: tests of the browser, of packages, or of another machine
    #[arg(long, conflicts_with_all = ["list", "tests_only"])]
    target: Option<target::Target>,

    /// Besides, the tests of each target
    #[arg(long, conflicts_with_all = ["filter", "list", "tests_only", "target"])]
    everywhere: bool,

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
    if let Some(target) = options.target {
        return target::run(target, options.filter.as_deref());
    }
    if options.everywhere {
        let here = run_here(options);
        return target::run_all().and(here);
    }
    run_here(options)
}

/// Runs what can be said of this machine.
fn run_here(options: &Options) -> Result<()> {
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
        &SLURM,
    ])?;
    let is_everything = options.filter.is_none() && !options.list;
    let has_checks = is_everything && !options.tests_only;
    if has_checks && !compiler::lints() {
        heading("formatting");
        check_formatting()?;
        return compiler::run_linting(&["test"]);
    }
    if is_everything || options.filter.as_deref() == Some(cases::FILTER) {
        cases::check()?;
    }
    heading(if has_checks { "build, lints and documents of code" } else { "build" });
    cargo(&["build", "--workspace", "--quiet"])?;
    let programs = programs::build(cargo_command(&["test", "--workspace"]))?.into_iter();
    let programs = programs.map(|program| program.files(|program| program.command(&[])));
    let programs: Vec<Program> = programs.collect::<Result<Vec<_>>>()?.concat();
    if options.list {
        return list(&programs, options.filter.as_deref());
    }
    if has_checks {
        check_generated()?;
    }
    heading("tests");
    let failed = match &options.filter {
        Some(filter) => run_named(programs, filter)?,
        None => run_all(programs.into_iter().filter(|p| !target::PACKED.contains(&&*p.name)).collect()),
    };
    heading("end");
    if failed.is_empty() { Ok(()) } else { Err(Failure(format!("these tests fail: {}", failed.join(", ")))) }
}

/// Generated files and the pages of the documentation.
fn check_generated() -> Result<()> {
    heading("generated files");
    crate::guides::run(&crate::guides::Options { check: true })?;
    crate::header::run(&crate::header::Options { check: true })?;
    crate::readme::run(&crate::readme::Options { check: true })?;
    crate::crates::run(&crate::crates::Options { check: true })?;
    crate::gpu_cost::run(&crate::gpu_cost::Options { check: true, kernel: None })?;
    heading("documents");
    crate::docs::check()
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
    // What the crate's macros make of the standard's headers is no code of ours to lint.
    interface.env_remove(WRAPPER);
    let manifest = root().join("tests/interface/Cargo.toml");
    crate::tools::run(interface.arg(manifest).arg("--target-dir").arg(target_dir("interface")))
}

/// Tests that are no program of the workspace, each run by another process of this chore, so that what they print
/// stays together.
struct OutsideTest {
    name: &'static str,
    run: fn() -> Result<()>,
}

const OUTSIDE_TESTS: [OutsideTest; 3] = [
    OutsideTest { name: "python", run: || python::test(None) },
    OutsideTest { name: "documents", run: documents },
    OutsideTest { name: "interface", run: interface },
];

impl OutsideTest {
    /// The test as a program: the chores as the workspace is built with them, for that build may have replaced this one.
    fn program(&self) -> Program {
        let path = target_dir("debug").join(format!("xtask{}", std::env::consts::EXE_SUFFIX));
        let arguments = ["test", "--job", self.name].map(str::to_owned).to_vec();
        Program { name: self.name.into(), path, folder: root(), arguments }
    }
}

fn list(programs: &[Program], filter: Option<&str>) -> Result<()> {
    for program in programs {
        for test in program.tests(filter.unwrap_or_default(), program.command(&[]))? {
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
fn run_named(programs: Vec<Program>, filter: &str) -> Result<Vec<String>> {
    let (mut failed, mut found) = (Vec::new(), 0);
    for program in programs {
        let Some(program) = program.narrowed(filter, |program| program.command(&[]))? else { continue };
        found += 1;
        println!("\n-- {}", program.name);
        if crate::tools::run(&mut prepared(program.command(&[]))).is_err() {
            failed.push(program.name);
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
const LONG: [&str; 13] = [
    "experiments_steadiness",
    "documents",
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

/// Programs that run at a time. Each has as many threads as there are cores; while one waits for a
/// device, or for its last test, the other computes.
const LANES: usize = 2;

/// A program of tests with the library that it loads, which must find a graphics adapter.
fn prepared(mut command: Command) -> Command {
    command.env("ISOPHOTE_LIBRARY", library_file("debug")).env("ISOPHOTE_REQUIRE_GPU", "1");
    command
}

/// Runs all programs. Returns those that fail.
fn run_all(mut programs: Vec<Program>) -> Vec<String> {
    programs.extend(OUTSIDE_TESTS.iter().map(OutsideTest::program));
    programs.sort_by_key(|p| LONG.iter().position(|long| *long == p.name).unwrap_or(LONG.len()));
    let (alone, together): (Vec<Program>, Vec<Program>) =
        programs.into_iter().partition(|p| ALONE.contains(&p.name.as_str()));
    let ran = Mutex::new(Vec::new());
    let run = |program: Program| {
        let (output, seconds) = timed(&program);
        // Locked, so that what two programs print stays apart.
        let mut ran = lock(&ran);
        ran.push(report::show(program, &output, seconds));
    };
    let waiting = Mutex::new(together.into_iter());
    std::thread::scope(|scope| {
        for _ in 0..LANES {
            scope.spawn(|| {
                loop {
                    // Not in the head of a `while let`: its guard would be held while the program runs.
                    let Some(program) = lock(&waiting).next() else { break };
                    run(program);
                }
            });
        }
    });
    alone.into_iter().for_each(run);
    let ran = ran.into_inner().unwrap_or_else(PoisonError::into_inner);
    report::sum_up(ran.into_iter().map(tried_again).collect())
}

/// A program that failed beside others, run once more by itself. What fails on a busy machine alone is told at the end as well,
/// and is no failure of the change.
fn tried_again(ran: Ran) -> Ran {
    let Some(why) = ran.failure else { return ran };
    println!("\n-- {} failed beside others, and runs again: {why}", ran.program.name);
    let (output, seconds) = timed(&ran.program);
    Ran { is_second: true, ..report::show(ran.program, &output, ran.seconds + seconds) }
}

/// Output of a program, and the seconds that it takes.
fn timed(program: &Program) -> (std::io::Result<Output>, f64) {
    let started = Instant::now();
    let output = prepared(program.command(&[])).output();
    (output, started.elapsed().as_secs_f64())
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes the golden images anew. Look at them before they are committed.
///
/// # Errors
/// When they cannot be made.
pub fn bless() -> Result<()> {
    for file in ["goldens", "bits"] {
        let mut command = cargo_command(&["test", "--workspace", "--test", "trials", "--", "--file", file]);
        crate::tools::run(command.env("ISOPHOTE_BLESS", "1"))?;
    }
    Ok(())
}
