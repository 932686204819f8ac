//! Generated cases as trials of their own: each has a name that can be asked for, and one that fails
//! hides no other.
//!
//! A program with `harness = false` collects them in its `main`. The name of a trial is the file, the test and the kernel or
//! node that it concerns, with two colons between them: `goldens::cpu::cartoon`. A test of the same name as its file has no
//! name of its own: `twins::gaussian_blur`.

use libtest_mimic::{Arguments, Completion, Failed, Trial};
use std::ffi::OsString;
use std::fmt::Display;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Number of the slowest trials that are named at the end.
const SLOWEST: usize = 5;

/// Report of a trial that did not panic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Report {
    /// Everything holds.
    Passed,
    /// Nothing was tried, and why.
    Skipped(String),
    /// Message about what does not hold.
    Failed(String),
}

impl From<()> for Report {
    fn from((): ()) -> Self {
        Self::Passed
    }
}

/// Everything that is wrong, line by line.
impl From<Vec<String>> for Report {
    fn from(wrong: Vec<String>) -> Self {
        if wrong.is_empty() { Self::Passed } else { Self::Failed(format!("\n{}", wrong.join("\n"))) }
    }
}

/// Nothing where a graphics device is missing and may be.
impl<R: Into<Self>> From<Option<R>> for Report {
    fn from(report: Option<R>) -> Self {
        report.map_or_else(|| Self::Skipped("no graphics device".into()), Into::into)
    }
}

type Times = Arc<Mutex<Vec<(Duration, String)>>>;

/// The trials of a program.
#[derive(Debug, Default)]
pub struct Trials {
    /// Name of the file whose trials are added now; empty where a program has but one.
    file: &'static str,
    trials: Vec<Trial>,
    times: Times,
}

impl Trials {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Trials that are added from now on are those of this file, and their names begin with it.
    pub fn begin_file(&mut self, name: &'static str) {
        self.file = name;
    }

    /// Adds the trial `test::subject`. It fails by a panic or by its report.
    pub fn add<R: Into<Report>>(
        &mut self,
        test: &str,
        subject: impl Display,
        body: impl FnOnce() -> R + Send + 'static,
    ) {
        self.add_plain(&format!("{test}::{subject}"), body);
    }

    /// Adds a trial that concerns no kernel or node in particular.
    pub fn add_plain<R: Into<Report>>(&mut self, name: &str, body: impl FnOnce() -> R + Send + 'static) {
        let is_named = self.file.is_empty() || name.split("::").next() == Some(self.file);
        let name = if is_named { name.to_owned() } else { format!("{}::{name}", self.file) };
        let (times, known_as) = (Arc::clone(&self.times), name.clone());
        self.trials.push(Trial::ignorable_test(name, move || {
            let started = Instant::now();
            let report = body().into();
            times.lock().unwrap_or_else(PoisonError::into_inner).push((started.elapsed(), known_as));
            match report {
                Report::Passed => Ok(Completion::Completed),
                Report::Skipped(reason) => Ok(Completion::ignored_with(reason)),
                Report::Failed(what) => Err(Failed::from(what)),
            }
        }));
    }

    /// The last trial added runs only when asked for by `--ignored`.
    pub fn ignore_last(&mut self) {
        if let Some(last) = self.trials.pop() {
            self.trials.push(last.with_ignored_flag(true));
        }
    }

    /// Runs those that the command line asks for, as the built-in harness would; after `--file` those of one file.
    pub fn run(mut self) -> ExitCode {
        let mut words: Vec<OsString> = std::env::args_os().collect();
        if let Some(at) = words.iter().position(|word| word == "--file") {
            let file = words.drain(at..words.len().min(at + 2)).nth(1).unwrap_or_default();
            let begin = format!("{}::", file.display());
            self.trials.retain(|trial| trial.name().starts_with(&begin));
        }
        let conclusion = libtest_mimic::run(&Arguments::from_iter(words), self.trials);
        let mut times = self.times.lock().unwrap_or_else(PoisonError::into_inner);
        times.sort_by_key(|(time, _)| std::cmp::Reverse(*time));
        if times.len() > 1 {
            let slowest: Vec<String> = times
                .iter()
                .take(SLOWEST)
                .map(|(time, name)| format!("{name} {:.1} s", time.as_secs_f64()))
                .collect();
            println!("slowest: {}", slowest.join(", "));
        }
        conclusion.exit_code()
    }
}
