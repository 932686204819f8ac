//! Tables of the thesis experiments, as markdown on the standard output, between marks by which
//! `cargo xtask experiments` finds them.

use std::fmt::Write as _;

/// One table of an experiment.
#[derive(Debug)]
pub struct Table {
    text: String,
}

impl Table {
    /// A table of experiment `number` of the list of experiments; `source` is a figure, section or
    /// equation of the thesis, `title` says what is measured, in which unit.
    pub fn new(number: u32, source: &str, title: &str, columns: &[&str]) -> Self {
        let mut text = format!("<!-- experiment {number} -->\n### {title} ({source})\n\n");
        let _ = writeln!(text, "| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
        Self { text }
    }

    /// A row, its cells as they are to be shown. Show no more digits than are the same on every
    /// machine.
    pub fn row<T: AsRef<str>>(&mut self, cells: &[T]) {
        let cells: Vec<&str> = cells.iter().map(AsRef::as_ref).collect();
        let _ = writeln!(self.text, "| {} |", cells.join(" | "));
    }

    /// Prints the table.
    pub fn print(self) {
        println!("{}<!-- end -->", self.text);
    }
}
