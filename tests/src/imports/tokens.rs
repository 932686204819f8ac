//! Rust source as words and signs, without comments.

/// A word, a sign or a string, and the line that it is on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// Kind of the token.
    pub kind: Kind,
    /// Counted from 1.
    pub line: usize,
}

/// Kinds of tokens; numbers count as words, `::` is one sign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An identifier, a keyword or a number.
    Word(String),
    /// Text between the quotes.
    Text(String),
    /// `::`.
    Path,
    /// Any other character.
    Sign(char),
}

/// The tokens of a file.
pub fn tokens(source: &str) -> Vec<Token> {
    let chars: Vec<char> = source.chars().collect();
    let mut reader = Reader { chars: &chars, at: 0, line: 1, tokens: Vec::new() };
    while reader.at < chars.len() {
        reader.next();
    }
    reader.tokens
}

struct Reader<'s> {
    chars: &'s [char],
    at: usize,
    line: usize,
    tokens: Vec<Token>,
}

impl Reader<'_> {
    fn peek(&self, ahead: usize) -> char {
        self.chars.get(self.at + ahead).copied().unwrap_or('\0')
    }

    fn step(&mut self) -> char {
        let c = self.peek(0);
        self.at += 1;
        self.line += usize::from(c == '\n');
        c
    }

    fn push(&mut self, kind: Kind, line: usize) {
        self.tokens.push(Token { kind, line });
    }

    fn next(&mut self) {
        let line = self.line;
        match (self.peek(0), self.peek(1)) {
            ('/', '/') => while self.at < self.chars.len() && self.step() != '\n' {},
            ('/', '*') => self.block_comment(),
            ('"', _) => self.text(line),
            ('\'', _) => self.quote(),
            (':', ':') => {
                self.at += 2;
                self.push(Kind::Path, line);
            }
            (c, _) if is_word(c) => self.word(line),
            (c, _) => {
                self.step();
                if !c.is_whitespace() {
                    self.push(Kind::Sign(c), line);
                }
            }
        }
    }

    fn block_comment(&mut self) {
        let mut depth = 0;
        while self.at < self.chars.len() {
            match (self.peek(0), self.peek(1)) {
                ('/', '*') => depth += 1,
                ('*', '/') => depth -= 1,
                _ => {
                    self.step();
                    continue;
                }
            }
            self.at += 2;
            if depth == 0 {
                return;
            }
        }
    }

    fn text(&mut self, line: usize) {
        self.step();
        let mut text = String::new();
        while self.at < self.chars.len() {
            match self.step() {
                '"' => break,
                '\\' => text.push(self.step()),
                c => text.push(c),
            }
        }
        self.push(Kind::Text(text), line);
    }

    /// A character or a lifetime.
    fn quote(&mut self) {
        self.step();
        if self.peek(0) == '\\' {
            self.step();
            self.step();
            while self.at < self.chars.len() && self.step() != '\'' {}
        } else if self.peek(1) == '\'' {
            self.step();
            self.step();
        } else {
            while is_word(self.peek(0)) {
                self.step();
            }
        }
    }

    fn word(&mut self, line: usize) {
        let mut word = String::new();
        while is_word(self.peek(0)) {
            word.push(self.step());
        }
        let starts_raw = matches!(word.as_str(), "r" | "br" | "cr") && matches!(self.peek(0), '#' | '"');
        if starts_raw {
            return self.raw_text(line);
        }
        // The letter of b"", c"" or b'' says nothing here.
        let is_prefix = matches!((word.as_str(), self.peek(0)), ("b" | "c", '"') | ("b", '\''));
        if !is_prefix {
            self.push(Kind::Word(word), line);
        }
    }

    /// The rest of r"..." or r#"..."#. Of an identifier such as r#type the name is read next.
    fn raw_text(&mut self, line: usize) {
        let hashes = (0..).take_while(|n| self.peek(*n) == '#').count();
        if self.peek(hashes) != '"' {
            self.at += hashes;
            return;
        }
        self.at += hashes + 1;
        let mut text = String::new();
        while self.at < self.chars.len() {
            let c = self.step();
            if c == '"' && (0..hashes).all(|n| self.peek(n) == '#') {
                self.at += hashes;
                break;
            }
            text.push(c);
        }
        self.push(Kind::Text(text), line);
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_strings_and_characters_hide_what_is_in_them() {
        let source = "use a::b; // use c\n/* use /* d */ e */ '\"' '\\'' 'x: \"use \\\" f\" r#\"use \" g\"# r#type b'h'";
        let words: Vec<_> = tokens(source)
            .into_iter()
            .filter_map(|t| match t.kind {
                Kind::Word(word) => Some((word, t.line)),
                _ => None,
            })
            .collect();
        let expected = [("use", 1), ("a", 1), ("b", 1), ("type", 2)];
        assert_eq!(words, expected.map(|(w, l)| (w.to_owned(), l)), "{words:?}");
    }
}
