//! Text from outside as terminals can take it.

use std::borrow::Cow;
use std::fmt::Write as _;

/// Text in which control characters, but for lines and tabs, and marks that turn the direction of writing stand as `\u001b`:
/// a terminal would obey the former, and the latter make one name look like another. JSON stays the same JSON.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for character in text.chars() {
        if is_hidden(character) {
            let _ = write!(shown, "\\u{:04x}", u32::from(character));
        } else {
            shown.push(character);
        }
    }
    Cow::Owned(shown)
}

fn is_hidden(character: char) -> bool {
    match character {
        '\n' | '\t' => false,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        other => other.is_control(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_to_terminals_are_shown_and_all_else_stays() {
        let title = "\u{1b}]0;title\u{7} \u{9b}2J \u{202e}gnp.exe\r";
        assert_eq!(printable(title), "\\u001b]0;title\\u0007 \\u009b2J \\u202egnp.exe\\u000d");
        for plain in ["größe 日本 ✓.png", "a\tb\nc", "\\u001b", ""] {
            assert!(matches!(printable(plain), Cow::Borrowed(same) if same == plain));
        }
    }
}
