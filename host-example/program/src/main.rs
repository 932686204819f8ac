//! The program `isophote`: renders scenes, stylizes what it renders, and stylizes pictures.

#![forbid(unsafe_code)]

mod bench;
mod cli;
mod info;
mod meant;
mod verbs;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use isophote_files::error::Error;
use isophote_files::{limits, output};
use isophote_loader::printable;

use cli::Cli;
use isophote_render::drivers;

/// The program starts where the C library is older.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[used]
static OWN: isophote_glibc::Kept = isophote_glibc::KEPT;

fn main() -> ExitCode {
    drivers::keep_quiet();
    limits::end_where_memory_ends();
    let words = meant::with_verb(std::env::args_os().collect(), &Cli::command());
    let cli = match Cli::try_parse_from(&words) {
        Ok(cli) => cli,
        Err(error) => return usage(&error, &words),
    };
    match cli.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failed(&error),
    }
}

fn failed(error: &Error) -> ExitCode {
    output::complain(error);
    ExitCode::from(error.exit_code())
}

/// Help and version as the parser prints them; what is wrong with the command line on one line, like every
/// other error.
fn usage(error: &clap::Error, words: &[OsString]) -> ExitCode {
    if matches!(
        error.kind(),
        ErrorKind::DisplayHelp
            | ErrorKind::DisplayVersion
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    ) {
        return match output::printed(error.print()) {
            Ok(()) => ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)),
            Err(error) => failed(&error),
        };
    }
    if let Some(error) = meant::explained(error, words) {
        return failed(&error);
    }
    let text = error.render().to_string();
    let wrong = text.lines().take_while(|line| !line.trim().is_empty());
    let mut said = wrong.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ");
    let tips = text.lines().filter_map(|line| line.trim_start().strip_prefix("tip:"));
    // Nobody means an option as a value.
    for tip in tips.map(str::trim).filter(|tip| !tip.starts_with("to pass")) {
        said += &format!("; {tip}");
    }
    // Words of the command line may be names of files. Where nobody can be told the exit code tells.
    let _ = writeln!(std::io::stderr(), "{}; see --help", printable(&said));
    ExitCode::from(2)
}
