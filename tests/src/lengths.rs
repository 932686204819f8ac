//! Lengths of functions in Rust source.

use crate::imports::tokens::{Kind, Token, tokens};

/// Function of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Its name.
    pub name: String,
    /// Line of the word `fn`, counted from 1.
    pub line: usize,
    /// Lines from there to its closing brace, both included.
    pub lines: usize,
}

/// All functions with a body, those within others included.
pub fn functions(source: &str) -> Vec<Function> {
    let tokens = tokens(source);
    let is_word = |token: &Token, word: &str| matches!(&token.kind, Kind::Word(text) if text == word);
    let found = tokens.windows(2).enumerate().filter_map(|(at, pair)| {
        let Kind::Word(name) = &pair[1].kind else { return None };
        let end = is_word(&pair[0], "fn").then(|| end(&tokens[at..]))??;
        Some(Function { name: name.clone(), line: pair[0].line, lines: end - pair[0].line + 1 })
    });
    found.collect()
}

/// The line of the brace that closes what the tokens begin with; none for what has no body.
fn end(tokens: &[Token]) -> Option<usize> {
    // Parentheses and brackets of arguments and array types may hold semicolons; braces begin the body.
    let (mut braces, mut others) = (0, 0);
    for token in tokens {
        match token.kind {
            Kind::Sign('(' | '[') => others += 1,
            Kind::Sign(')' | ']') => others -= 1,
            Kind::Sign('{') => braces += 1,
            Kind::Sign('}') => {
                braces -= 1;
                if braces == 0 && others == 0 {
                    return Some(token.line);
                }
            }
            Kind::Sign(';') if braces == 0 && others == 0 => return None,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_are_counted_and_what_only_looks_like_one_is_not() {
        let source = "trait T {\n    fn none(&self) -> [u8; 2];\n}\nfn one() {}\n/// fn no() {\nfn three<const N: usize>(a: [u8; N])\nwhere\n{\n    \
                      let text = \"fn no() {\n}\";\n    fn inner() {\n    }\n}\nconst P: fn(u8) = |_| {};\n";
        let found: Vec<(String, usize, usize)> =
            functions(source).into_iter().map(|f| (f.name, f.line, f.lines)).collect();
        let expected = [("one", 4, 1), ("three", 6, 8), ("inner", 11, 2)];
        assert_eq!(found, expected.map(|(name, line, lines)| (name.to_owned(), line, lines)));
    }
}
