//! Programs of tests of another machine, run by an emulator.

use crate::error::{Failure, Result};
use crate::test::programs::Program;
use crate::test::report;
use crate::tools::heading;
use std::process::Command;
use std::time::Instant;

/// Runs the tests of programs whose names contain the filter, each by a command with its arguments, and tells which fail. Of
/// programs of several files of tests only those files are meant.
///
/// # Errors
/// The programs that fail, or that cannot be started.
pub fn run_programs(
    programs: Vec<Program>,
    files: &[&str],
    filter: Option<&str>,
    runner: &[&str],
    prepare: impl Fn(&mut Command),
) -> Result<()> {
    heading("tests");
    let command = |program: &Program| {
        let mut command = program.command(runner);
        prepare(&mut command);
        command
    };
    let programs = programs.into_iter().map(|program| program.files(command)).collect::<Result<Vec<_>>>()?;
    let is_meant = |program: &Program| program.arguments.is_empty() || files.contains(&&*program.name);
    let programs = programs.into_iter().flatten().filter(is_meant);
    let ran = programs.filter_map(|program| run_program(program, filter, command).transpose());
    let ran: Vec<report::Ran> = ran.collect::<Result<_>>()?;
    if ran.is_empty() {
        return Err(Failure(format!("no test's name contains '{}'", filter.unwrap_or_default())));
    }
    let failed = report::sum_up(ran);
    heading("end");
    if failed.is_empty() { Ok(()) } else { Err(Failure(format!("these tests fail: {}", failed.join(", ")))) }
}

/// Runs a program's tests whose names contain the filter; `None` where there are none. `run` makes a command that runs it.
fn run_program(
    program: Program,
    filter: Option<&str>,
    run: impl Fn(&Program) -> Command,
) -> Result<Option<report::Ran>> {
    let Some(program) = program.narrowed(filter.unwrap_or_default(), &run)? else { return Ok(None) };
    let started = Instant::now();
    let output = run(&program).output();
    Ok(Some(report::show(program, &output, started.elapsed().as_secs_f64())))
}

/// Name of a variable that tells cargo something of a target.
pub fn variable(target: &str, what: &str) -> String {
    format!("CARGO_TARGET_{}_{what}", target.to_uppercase().replace('-', "_"))
}

#[cfg(test)]
mod tests {
    #[test]
    fn variables_are_named_as_cargo_names_them() {
        let name = super::variable("aarch64-unknown-linux-gnu", "LINKER");
        assert_eq!(name, "CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER");
    }
}
