//! The notes of a release: what CHANGELOG says of its version.

use crate::error::{Error, Result};
use crate::share::VERSION;
use std::path::Path;

/// Name of their file beside the archives.
pub const FILE: &str = "NOTES.md";

/// Heading of what no version holds yet.
const UNRELEASED: &str = "Unreleased";

/// The section of this version, or else of what is not released yet.
///
/// # Errors
/// When CHANGELOG cannot be read, and where it has neither.
pub fn of_version(root: &Path) -> Result<String> {
    let path = root.join("CHANGELOG.md");
    let text = std::fs::read_to_string(&path).map_err(Error::at(&path))?;
    let section = section(&text, VERSION).or_else(|| section(&text, UNRELEASED));
    let missing = || Error::malformed(&path, format!("has no section {VERSION} and none {UNRELEASED}"));
    section.map(|section| format!("# Isophote {VERSION}\n\n{section}\n")).ok_or_else(missing)
}

/// Text below a heading of the second level that begins with this word.
fn section(text: &str, word: &str) -> Option<String> {
    let heading =
        |line: &str| line.strip_prefix("## ").map(|title| title.split_whitespace().next() == Some(word));
    let lines = text.lines().skip_while(|line| heading(line) != Some(true)).skip(1);
    let below: Vec<&str> = lines.take_while(|line| heading(line).is_none()).collect();
    Some(below.join("\n").trim().to_owned()).filter(|below| !below.is_empty())
}

#[cfg(test)]
mod tests {
    use super::section;

    #[test]
    fn sections_end_where_the_next_begins() {
        let text =
            "# Changelog\n\n## Unreleased\n\n- new\n  more\n\n## 0.1.0 (2026-01-01)\n\n- old\n\n## 0.0.9\n";
        assert_eq!(section(text, "Unreleased").unwrap(), "- new\n  more");
        assert_eq!(section(text, "0.1.0").unwrap(), "- old");
        assert_eq!(section(text, "0.0.9"), None);
        assert_eq!(section(text, "0.1"), None);
    }
}
