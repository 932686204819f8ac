//! Names of things as people write them: `cryptomatte:hero,props/*`, or `cryptomatte[crypto_material]:skin`, which is
//! `material:skin`, too.
//!
//! `*` stands for any characters, `/` included, and `?` for one. A backslash before any of `*?,\` and before blanks makes it
//! an ordinary letter; all other letters are ordinary ones, brackets too. Blanks around names do not count.

use std::str::FromStr;

/// Beginning of the choice.
const WORD: &str = "cryptomatte";
/// Beginning of the choice of materials, without the colon.
const MATERIAL: &str = "material";
/// The usual name of the Cryptomatte of materials.
pub const MATERIALS: &str = "crypto_material";
/// The usual name of the Cryptomatte of objects.
pub const OBJECTS: &str = "crypto_object";
/// Form in which it is written.
const FIX: &str =
    "write cryptomatte:NAME,NAME or cryptomatte[LAYER]:NAME,NAME, where * stands for any letters";

/// Choice of things in a Cryptomatte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MatteChoice {
    /// The Cryptomatte; the one of objects without.
    pub layer: Option<String>,
    /// At least one.
    pub names: Vec<Pattern>,
}

/// A name, or what names have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    /// As it was written.
    pub text: String,
    parts: Vec<Part>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Letter(char),
    One,
    Any,
}

impl MatteChoice {
    /// The choice that a text is; nothing where it is of another kind.
    pub fn of(text: &str) -> Option<Result<Self, String>> {
        if let Some(names) = text.strip_prefix(MATERIAL).filter(|names| names.starts_with(':')) {
            return Some(format!("[{MATERIALS}]{names}").parse());
        }
        let rest = text.strip_prefix(WORD)?;
        rest.starts_with([':', '[']).then(|| rest.parse())
    }

    /// The Cryptomatte that a text names, which is `cryptomatte` or `cryptomatte[LAYER]`: some layer, or the one of objects.
    /// Nothing where the text is of another kind.
    pub fn layer_of(text: &str) -> Option<Option<&str>> {
        match text.strip_prefix(WORD)? {
            "" => Some(None),
            rest => rest.strip_prefix('[')?.strip_suffix(']').map(Some),
        }
    }
}

impl MatteChoice {
    /// The words that choose things of these names in the same Cryptomatte.
    pub fn words<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> String {
        let names: Vec<String> = names.into_iter().map(escaped).collect();
        let names = names.join(",");
        match self.layer.as_deref() {
            None => format!("{WORD}:{names}"),
            Some(MATERIALS) => format!("{MATERIAL}:{names}"),
            Some(layer) => format!("{WORD}[{layer}]:{names}"),
        }
    }
}

/// A whole name as it is written in a list.
fn escaped(name: &str) -> String {
    let inner = name.trim().len();
    let first = name.len() - name.trim_start().len();
    let mut text = String::new();
    for (at, letter) in name.char_indices() {
        // Blanks count within names alone.
        let is_outer = letter == ' ' && !(first..first + inner).contains(&at);
        if "*?,\\".contains(letter) || is_outer {
            text.push('\\');
        }
        text.push(letter);
    }
    text
}

impl FromStr for MatteChoice {
    type Err = String;

    /// Of what follows after the word.
    fn from_str(rest: &str) -> Result<Self, String> {
        let (layer, names) = match rest.strip_prefix('[') {
            Some(rest) => {
                let (layer, names) = rest.split_once("]:").ok_or(FIX)?;
                (Some(layer.to_owned()), names)
            }
            None => (None, rest.strip_prefix(':').ok_or(FIX)?),
        };
        let names = patterns(names);
        if names.is_empty() || layer.as_deref() == Some("") {
            return Err(FIX.into());
        }
        Ok(Self { layer, names })
    }
}

/// The names of a list.
fn patterns(list: &str) -> Vec<Pattern> {
    let mut patterns = Vec::new();
    let mut name = Pattern { text: String::new(), parts: Vec::new() };
    // Length without blanks at the end.
    let mut length = 0;
    let mut letters = list.chars();
    loop {
        let letter = letters.next();
        let part = match letter {
            Some(',') | None => {
                name.parts.truncate(length);
                name.text = name.text.trim().to_owned();
                if length > 0 {
                    patterns.push(name);
                }
                if letter.is_none() {
                    return patterns;
                }
                (name, length) = (Pattern { text: String::new(), parts: Vec::new() }, 0);
                continue;
            }
            Some('*') => Part::Any,
            Some('?') => Part::One,
            Some('\\') => {
                let escaped = letters.clone().next().filter(|c| "*?,\\ ".contains(*c));
                letters.by_ref().take(usize::from(escaped.is_some())).for_each(drop);
                name.text.push('\\');
                if let Some(escaped) = escaped {
                    name.text.push(escaped);
                }
                name.parts.push(Part::Letter(escaped.unwrap_or('\\')));
                length = name.parts.len();
                continue;
            }
            Some(blank) if blank.is_whitespace() => {
                if !name.parts.is_empty() {
                    name.parts.push(Part::Letter(blank));
                    name.text.push(blank);
                }
                continue;
            }
            Some(other) => Part::Letter(other),
        };
        name.text.extend(letter);
        name.parts.push(part);
        length = name.parts.len();
    }
}

impl Pattern {
    /// The one name that it stands for, if it is not for many.
    pub fn exact(&self) -> Option<String> {
        let letter = |part: &Part| match part {
            Part::Letter(letter) => Some(*letter),
            Part::One | Part::Any => None,
        };
        self.parts.iter().map(letter).collect()
    }

    /// True where it stands for a name.
    pub fn matches(&self, name: &str) -> bool {
        let mut parts = self.parts.as_slice();
        let mut rest = name.chars();
        // Where to go on when what follows the last star does not fit: with one letter more under the star.
        let mut star = None;
        loop {
            let mut next = rest.clone();
            let letter = next.next();
            match (parts.split_first(), letter) {
                (Some((Part::Any, after)), _) => {
                    star = Some((after, rest.clone()));
                    parts = after;
                    continue;
                }
                (Some((Part::One, after)), Some(_)) => (parts, rest) = (after, next),
                (Some((Part::Letter(wanted), after)), Some(letter)) if *wanted == letter => {
                    (parts, rest) = (after, next);
                }
                (None, None) => return true,
                _ => {
                    let Some((after, under)) = &mut star else { return false };
                    if under.next().is_none() {
                        return false;
                    }
                    (parts, rest) = (after, under.clone());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(text: &str) -> MatteChoice {
        MatteChoice::of(text).unwrap().unwrap()
    }

    fn names(text: &str) -> Vec<Option<String>> {
        choice(text).names.iter().map(Pattern::exact).collect()
    }

    #[test]
    fn lists_are_read() {
        let some = |name: &str| Some(name.to_owned());
        assert_eq!(names("cryptomatte:hero"), [some("hero")]);
        assert_eq!(names("cryptomatte: hero , the prop,,"), [some("hero"), some("the prop")]);
        assert_eq!(
            names(r"cryptomatte:a\,b,c\\d,e\*,f\g"),
            [some("a,b"), some(r"c\d"), some("e*"), some(r"f\g")]
        );
        assert_eq!(names(r"cryptomatte:end\ ,\ start"), [some("end "), some(" start")]);
        assert_eq!(names("cryptomatte:a*,b?,[x]"), [None, None, some("[x]")]);
        let layered = choice("cryptomatte[crypto_material]:skin");
        assert_eq!(layered.layer.as_deref(), Some("crypto_material"));
        assert_eq!(choice("cryptomatte: a* ,b").names[0].text, "a*");
        for bad in ["cryptomatte:", "cryptomatte: ,", "cryptomatte[]:a", "cryptomatte[a]", "cryptomatte[a:b"]
        {
            assert!(MatteChoice::of(bad).unwrap().is_err(), "{bad}");
        }
        assert_eq!(MatteChoice::of("cryptomattes"), None);
        assert_eq!(MatteChoice::of("crypto:a"), None);
        assert_eq!(MatteChoice::layer_of("cryptomatte"), Some(None));
        assert_eq!(MatteChoice::layer_of("cryptomatte[a]"), Some(Some("a")));
        assert_eq!(MatteChoice::layer_of("cryptomatte00"), None);
    }

    #[test]
    fn words_choose_the_names_that_they_were_made_of() {
        let known = ["hero", "a,b", r"c\d", "e*?", " blanks ", "[x] y"];
        for choice in ["cryptomatte:a", "material:a", "cryptomatte[own]:a"].map(choice) {
            let words = choice.words(known);
            let MatteChoice { layer, names } = self::choice(&words);
            let names: Vec<String> = names.iter().filter_map(Pattern::exact).collect();
            assert_eq!(layer, choice.layer, "{words}");
            assert_eq!(names, known, "{words}");
        }
    }

    #[test]
    fn patterns_match_names() {
        let matches =
            |pattern: &str, name: &str| choice(&format!("cryptomatte:{pattern}")).names[0].matches(name);
        for (pattern, name) in [
            ("props/*", "props/a/b"),
            ("*", "anything"),
            ("*arm", "left arm"),
            ("a*b*c", "aXbYbZc"),
            ("a**", "a"),
            ("?rd", "ård"),
            (r"has_\*_x", "has_*_x"),
            ("rect_[]", "rect_[]"),
        ] {
            assert!(matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [
            ("props/*", "prop"),
            ("a?", "a"),
            ("a*b", "abc"),
            (r"has_\*_x", "has_n_x"),
            ("Hero", "hero"),
            ("a", "ab"),
        ] {
            assert!(!matches(pattern, name), "{pattern} {name}");
        }
        // Many stars take no more than the product of both lengths.
        assert!(!matches(&format!("{}c", "a*".repeat(50)), &"a".repeat(5000)));
    }
}
