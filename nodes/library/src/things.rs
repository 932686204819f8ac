//! Rules for things in a picture, which are told by the numbers of objects or by the names of a Cryptomatte: what a control map has
//! where they are, and the colour of their lines.

use crate::guides::GraphInput;
use isophote_cryptomatte::{MatteChoice, id};

/// Things in a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Things {
    /// Objects of these numbers.
    Numbers(Vec<u32>),
    /// Things whose names have these ids in a Cryptomatte, as bits of the floats there.
    Names(Vec<u32>),
}

impl Things {
    /// Things that words such as `id:3,4`, `cryptomatte:hero,props/box` or `material:skin` name; none for other words, and for names
    /// with `*` or `?`, which stand for names that only a host knows.
    pub fn of(words: &str) -> Option<Self> {
        if let Some(numbers) = words.strip_prefix("id:") {
            let numbers: Result<_, _> = numbers.split(',').map(|number| number.trim().parse()).collect();
            return numbers.ok().map(Self::Numbers);
        }
        let choice = MatteChoice::of(words)?.ok()?;
        let ids = choice.names.iter().map(|name| name.exact().map(|name| id(&name)));
        ids.collect::<Option<_>>().map(Self::Names)
    }

    /// The guide that tells them.
    pub fn guide(&self) -> GraphInput {
        match self {
            Self::Numbers(_) => GraphInput::ObjectId,
            Self::Names(_) => GraphInput::Cryptomatte,
        }
    }
}

/// Rule for things.
#[derive(Clone, Debug, PartialEq)]
pub struct ThingRule {
    /// The things that it is for.
    pub things: Things,
    /// Values of a control map where they are: detail, width of lines, their amount and strength of the medium.
    pub control: [Option<f32>; 4],
    /// Colour of their lines, gamma-encoded RGBA, where it is another than the style's.
    pub line_color: Option<[f32; 4]>,
}

impl ThingRule {
    /// True where a control map has nothing of it.
    pub fn is_neutral(&self) -> bool {
        self.control.iter().all(Option::is_none)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_name_things_by_number_and_by_whole_names() {
        assert_eq!(Things::of("id:3, 4"), Some(Things::Numbers(vec![3, 4])));
        let names = Some(Things::Names(vec![0x1385_1a76, 0x62fa_4db8]));
        assert_eq!(Things::of(r"cryptomatte:bunny,name\, with\, comma"), names);
        assert_eq!(Things::of("material:bunny"), Some(Things::Names(vec![0x1385_1a76])));
        for words in ["3", "id:", "id:-1", "id:1.5", "id:a", "cryptomatte:", "cryptomatte:a,b*", "bunny"] {
            assert_eq!(Things::of(words), None, "{words}");
        }
    }
}
