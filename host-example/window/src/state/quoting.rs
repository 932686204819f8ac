//! Words of a command line as shells take them.

use std::path::Path;

/// A path as the system's shell takes it, and the program not for an option.
pub fn quoted_path(path: &Path) -> String {
    let path = path.to_string_lossy();
    quoted(&if path.starts_with('-') { format!("./{path}") } else { path.into_owned() })
}

/// A word as the system's shell takes it. A terminal would obey control characters when the line is pasted.
pub fn quoted(word: &str) -> String {
    if cfg!(windows) { for_windows(word) } else { for_posix(word) }
}

/// True for a word of letters, digits and some signs alone.
fn is_plain(word: &str, signs: &str) -> bool {
    !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || signs.contains(c))
}

fn for_posix(word: &str) -> String {
    if is_plain(word, "-_./=,:@%+") {
        return word.to_owned();
    }
    if !word.chars().any(char::is_control) {
        return format!("'{}'", word.replace('\'', r"'\''"));
    }
    let escaped = word.chars().map(|c| match c {
        '\'' | '\\' => format!("\\{c}"),
        c if c.is_control() => {
            c.encode_utf8(&mut [0; 4]).bytes().map(|byte| format!("\\{byte:03o}")).collect()
        }
        c => c.into(),
    });
    format!("$'{}'", escaped.collect::<String>())
}

/// A word as both `cmd` and PowerShell take it, or else, where it has what PowerShell replaces between double quotes, as
/// that does alone. No file of Windows has double quotes or the usual control characters in its name.
fn for_windows(word: &str) -> String {
    if is_plain(word, r"-_./\=:+") {
        return word.to_owned();
    }
    let word: String = word.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
    if word.contains(['$', '`']) {
        return format!("'{}'", word.replace('\'', "''"));
    }
    // Programs take a backslash before a quote for one that belongs to the word.
    let slashes = word.len() - word.trim_end_matches('\\').len();
    format!("\"{word}{}\"", "\\".repeat(slashes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        assert_eq!(for_posix("line_color=#102030"), "'line_color=#102030'");
        assert_eq!(for_posix("a/b-c.json"), "a/b-c.json");
        assert_eq!(for_posix("it's"), r"'it'\''s'");
        assert_eq!(for_posix(""), "''");
        assert_eq!(for_posix("a\u{1b}[2J\n'\\\u{9b}"), r"$'a\033[2J\012\'\\\302\233'");
        assert_eq!(quoted_path(Path::new("-o.png")), "./-o.png");
    }

    #[test]
    fn words_are_quoted_for_both_shells_of_windows() {
        for (word, taken) in [
            (r"C:\a\b-c.png", r"C:\a\b-c.png"),
            (r"C:\my pictures\a.png", r#""C:\my pictures\a.png""#),
            ("line_color=#102030", "\"line_color=#102030\""),
            ("1,2", "\"1,2\""),
            ("it's & more.png", "\"it's & more.png\""),
            ("shot.%04d.exr", "\"shot.%04d.exr\""),
            (r"C:\my pictures\", r#""C:\my pictures\\""#),
            ("shot.$F4.exr", "'shot.$F4.exr'"),
            ("it's $5.png", "'it''s $5.png'"),
            ("a\u{9b}2J", "\"a?2J\""),
            ("", "\"\""),
        ] {
            assert_eq!(for_windows(word), taken, "{word}");
        }
    }
}
