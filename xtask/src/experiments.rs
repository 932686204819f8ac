//! `cargo xtask experiments`: runs the experiments of the thesis and writes their tables as markdown.

use crate::error::{Context, Failure, Result};
use crate::tools::{cargo_command, root};
use std::process::Stdio;

/// Options of `cargo xtask experiments`.
#[derive(clap::Args)]
pub struct Options {
    /// Only print the tables; do not write tests/EXPERIMENTS.md
    #[arg(long)]
    print: bool,
}

/// Text above the tables.
const OPENING: &str = "# Experiments

The experiments of J. E. Kyprianidis' thesis *Structure Adaptive Stylization of Images and Video*, done
again with the nodes of this library. Each is a test in `tests/tests/experiments_*.rs` that asserts what the
text beside the figure says; these are the numbers that it prints. `cargo xtask experiments` makes this page.
";

/// Runs the experiments and writes, or prints, their tables.
///
/// # Errors
/// When an experiment does not come out, or the page cannot be written.
pub fn run(options: &Options) -> Result<()> {
    let mut command = cargo_command(&["test", "--quiet", "--workspace", "--test", "tests"]);
    command.args(["--", "experiments_", "--nocapture", "--test-threads=1"]).stderr(Stdio::inherit());
    // What is measured for the tables alone.
    command.env("ISOPHOTE_TABLES", "1");
    let output = command.output().context(|| "cannot run cargo".into())?;
    let printed = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(Failure(format!("{printed}\nan experiment does not come out")));
    }
    let page = page(&printed)?;
    if options.print {
        print!("{page}");
        return Ok(());
    }
    let path = root().join("tests/EXPERIMENTS.md");
    std::fs::write(&path, page).context(|| format!("cannot write {}", path.display()))?;
    println!("the tables are in {}", path.display());
    Ok(())
}

/// The tables in the order of their numbers.
fn page(printed: &str) -> Result<String> {
    let mut tables = Vec::new();
    for part in printed.split("<!-- experiment ").skip(1) {
        let (Some((number, rest)), Some(end)) = (part.split_once(" -->\n"), part.find("<!-- end -->")) else {
            return Err(Failure("an experiment printed a table without an end".into()));
        };
        let number: u32 = number.parse().context(|| format!("'{number}' is no number of an experiment"))?;
        tables.push((number, rest[..end - (part.len() - rest.len())].trim_end().to_owned()));
    }
    if tables.is_empty() {
        return Err(Failure("no experiment printed a table".into()));
    }
    // Stable: tables of one experiment stay in the order in which they were printed.
    tables.sort_by_key(|(number, _)| *number);
    let mut text = OPENING.to_owned();
    let mut last = 0;
    for (number, table) in tables {
        if number != last {
            text += &format!("\n## Experiment {number}\n");
            last = number;
        }
        text += &format!("\n{table}\n");
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::page;

    #[test]
    fn tables_come_in_the_order_of_their_numbers() {
        let printed = "noise\n<!-- experiment 7 -->\n### b\n| 2 |\n<!-- end -->\n.\n<!-- experiment 2 -->\n### a\n<!-- end -->\nok";
        let page = page(printed).unwrap();
        let tail = page.split("makes this page.\n").nth(1).unwrap();
        assert_eq!(tail, "\n## Experiment 2\n\n### a\n\n## Experiment 7\n\n### b\n| 2 |\n");
    }

    #[test]
    fn output_without_tables_is_an_error() {
        assert!(page("ok").is_err());
        assert!(page("<!-- experiment 1 -->\n| cut").is_err());
    }
}
