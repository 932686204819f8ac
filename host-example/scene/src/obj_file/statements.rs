//! Statements of OBJ and MTL files: a keyword and what follows it, on one line or on several of which all but
//! the last end in a backslash.

use std::borrow::Cow;

/// Name given to a material, or chosen by faces, that has an empty name in the file. No name in a text can be
/// the same.
pub const UNNAMED: &str = "\0";

/// One statement.
pub struct Statement<'a> {
    /// Number of its first line, counted from 1.
    pub line: usize,
    text: Cow<'a, str>,
}

impl Statement<'_> {
    /// The keyword and what follows it, without the space around them; `None` for comments and empty lines.
    pub fn split(&self) -> Option<(&str, &str)> {
        let text = self.text.trim();
        if text.is_empty() || text.starts_with('#') {
            return None;
        }
        let (keyword, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        Some((keyword, rest.trim_start()))
    }
}

/// All statements of a file, comments and empty lines included.
pub fn statements(text: &str) -> impl Iterator<Item = Statement<'_>> {
    // Some editors begin a file with a byte order mark.
    let mut lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines().enumerate();
    std::iter::from_fn(move || {
        let (index, first) = lines.next()?;
        let line = index + 1;
        let Some(head) = continued(first) else { return Some(Statement { line, text: first.into() }) };
        let mut whole = head.to_owned();
        for (_, next) in lines.by_ref() {
            whole.push(' ');
            match continued(next) {
                Some(part) => whole.push_str(part),
                None => {
                    whole.push_str(next);
                    break;
                }
            }
        }
        Some(Statement { line, text: whole.into() })
    })
}

/// The line without its backslash, if it ends in one. Comments are not continued: drawings in them may end so.
fn continued(line: &str) -> Option<&str> {
    let line = line.trim_end();
    if line.trim_start().starts_with('#') { None } else { line.strip_suffix('\\') }
}

/// The words of a statement of numbers, which a comment may follow.
pub fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}

/// A number.
///
/// # Errors
/// A clause that names the word.
pub fn number(word: &str) -> Result<f32, String> {
    word.parse().map_err(|_| format!("'{word}' is not a number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_joined_and_counted() {
        let text = "\u{feff}v 1 \\\r\n 2 \\\n3\n# not \\\n\tusemtl\ta b \n\ns\nf 1 \\";
        let all: Vec<(usize, Option<(String, String)>)> = statements(text)
            .map(|s| (s.line, s.split().map(|(keyword, rest)| (keyword.to_owned(), rest.to_owned()))))
            .collect();
        let statement = |keyword: &str, rest: &str| Some((keyword.to_owned(), rest.to_owned()));
        assert_eq!(
            all,
            [
                (1, statement("v", "1   2  3")),
                (4, None),
                (5, statement("usemtl", "a b")),
                (6, None),
                (7, statement("s", "")),
                (8, statement("f", "1")),
            ]
        );
        assert_eq!(words("1 2 # three").collect::<Vec<_>>(), ["1", "2"]);
    }
}
