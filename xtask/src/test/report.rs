//! Reports of programs of tests, as they are printed.

use super::programs::Program;
use std::process::Output;

/// Number of the slowest programs that are named at the end.
const SLOWEST: usize = 20;

/// Most lines of a failing program that are printed once more at the end.
const LAST_WORDS: usize = 40;

/// A program that was run.
pub struct Ran {
    pub program: Program,
    pub seconds: f64,
    /// Why it failed, as far as it says so.
    pub failure: Option<String>,
    /// True where it failed beside others, and this is what came of it by itself.
    pub is_second: bool,
}

/// Prints what a program printed.
pub fn show(program: Program, output: &std::io::Result<Output>, seconds: f64) -> Ran {
    println!("\n-- {} ({seconds:.1} s)", program.name);
    let failure = match output {
        Ok(output) => {
            let [printed, errors] = [&output.stdout, &output.stderr].map(|b| String::from_utf8_lossy(b));
            print!("{printed}");
            eprint!("{errors}");
            (!output.status.success())
                .then(|| format!("{}\n{}", output.status, last_words(&printed, &errors)))
        }
        Err(error) => Some(format!("{} cannot be started: {error}", program.path.display())),
    };
    Ran { program, seconds, failure, is_second: false }
}

/// The part of what a failing program printed that says why: what its harness lists, or else the end of what it complained
/// of, without backtraces.
fn last_words(printed: &str, errors: &str) -> String {
    let listed = printed.split_once("\nfailures:\n").map(|(_, listed)| listed);
    let lines = listed.unwrap_or(errors).lines().filter(|line| !is_frame(line) && !line.trim().is_empty());
    let mut lines: Vec<&str> = lines.collect();
    if listed.is_some() {
        lines.truncate(LAST_WORDS);
    } else {
        lines.drain(..lines.len().saturating_sub(LAST_WORDS));
    }
    lines.join("\n")
}

/// True for a line of a backtrace: `  12: function`, or `    at file:line`.
fn is_frame(line: &str) -> bool {
    let Some(frame) = line.strip_prefix("  ").map(str::trim_start) else { return false };
    frame.starts_with("at ") || frame.split_once(": ").is_some_and(|(n, _)| n.parse::<u32>().is_ok())
}

/// Prints the programs that took longest, and once more why others failed: whoever reads a log from its end, or has but the
/// end, finds it there. Programs of generated trials name their slowest trials themselves. Returns the programs that failed.
pub fn sum_up(mut ran: Vec<Ran>) -> Vec<String> {
    ran.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    println!("\n-- the slowest programs");
    for Ran { seconds, program, .. } in ran.iter().take(SLOWEST) {
        println!("{seconds:7.1} s  {}", program.name);
    }
    let mut failed = Vec::new();
    for Ran { program, failure, is_second, .. } in ran {
        if let Some(why) = failure {
            println!("\n-- {} failed: {why}", program.name);
            failed.push(program.name);
        } else if is_second {
            println!(
                "\n-- {} failed beside others and holds by itself: see above, and mend what is not steady",
                program.name
            );
        }
    }
    failed
}

#[cfg(test)]
mod tests {
    use super::last_words;

    #[test]
    fn failures_are_told_without_what_held_and_without_frames() {
        let printed = "test a ... ok\ntest b ... FAILED\n\nfailures:\n\n---- b stdout ----\n\
            thread 'b' panicked at b.rs:1:2:\nit is wrong\n   0: std::panicking\n             at /std.rs:3\n\
            \nfailures:\n    b\n";
        let words = "---- b stdout ----\nthread 'b' panicked at b.rs:1:2:\nit is wrong\nfailures:\n    b";
        assert_eq!(last_words(printed, "noise"), words);
        assert_eq!(last_words("test a ... ok", "Segmentation fault\n"), "Segmentation fault");
    }
}
