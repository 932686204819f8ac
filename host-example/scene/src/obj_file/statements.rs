//! Statements of OBJ and MTL files: a keyword and what follows it, on one line or on several of which all but
//! the last end in a backslash.

use std::borrow::Cow;

/// The text of a file: UTF-8, UTF-16, or bytes of an older encoding, of which the first 256 characters are taken; ends
/// of lines of all systems are the same.
pub fn text_of(bytes: &[u8]) -> String {
    let wide = |to: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(|unit| to(*unit)).collect();
        String::from_utf16_lossy(&units)
    };
    let text = match bytes {
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        [a, 0, b, 0, ..] if *a > 0 && *b > 0 => wide(u16::from_le_bytes),
        [0, a, 0, b, ..] if *a > 0 && *b > 0 => wide(u16::from_be_bytes),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
        },
    };
    if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n") } else { text }
}

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
    fn encodings_and_ends_of_lines_are_one() {
        let text = "v 1 2 3\nusemtl Mädchen\n";
        let wide = |to: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(to).collect::<Vec<u8>>();
        let (little, big) = (wide(u16::to_le_bytes), wide(u16::to_be_bytes));
        for bytes in [
            text.as_bytes().to_vec(),
            text.replace('\n', "\r").into_bytes(),
            text.replace('\n', "\r\n").into_bytes(),
            text.chars().map(|c| c as u8).collect(),
            [b"\xff\xfe".as_slice(), &little].concat(),
            [b"\xfe\xff".as_slice(), &big].concat(),
            little,
            big,
        ] {
            assert_eq!(text_of(&bytes).trim_start_matches('\u{feff}'), text, "{bytes:?}");
        }
    }

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
