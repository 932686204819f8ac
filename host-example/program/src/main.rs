//! The program `isophote`: renders scenes, stylizes what it renders, and stylizes pictures.

#![forbid(unsafe_code)]

mod bench;
mod cli;
mod info;
mod verbs;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;
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
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
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
fn usage(error: &clap::Error) -> ExitCode {
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
    let text = error.render().to_string();
    let wrong = text.lines().take_while(|line| !line.trim().is_empty());
    let tips = text.lines().filter(|line| line.trim_start().starts_with("tip:"));
    let words: Vec<&str> = wrong.chain(tips).flat_map(str::split_whitespace).collect();
    // Words of the command line may be names of files. Where nobody can be told the exit code tells.
    let _ = writeln!(std::io::stderr(), "{}; see --help", printable(&words.join(" ")));
    ExitCode::from(2)
}
