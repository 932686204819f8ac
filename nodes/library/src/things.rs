//! Rules for things in a picture, which are told by the numbers of objects: what a control map has where they are, and the
//! colour of their lines.

/// Rule for things.
#[derive(Clone, Debug, PartialEq)]
pub struct ThingRule {
    /// Numbers of the objects that it is for.
    pub numbers: Vec<u32>,
    /// Values of a control map where they are: detail, width of lines, their amount and strength of the medium.
    pub control: [Option<f32>; 4],
    /// Colour of their lines, gamma-encoded RGBA, where it is another than the style's.
    pub line_color: Option<[f32; 4]>,
}

impl ThingRule {
    /// Numbers of the objects that words such as `id:3,4` name; none for other words.
    pub fn numbers_of(words: &str) -> Option<Vec<u32>> {
        let number = |text: &str| text.trim().parse().ok();
        words.strip_prefix("id:")?.split(',').map(number).collect()
    }

    /// True where a control map has nothing of it.
    pub fn is_neutral(&self) -> bool {
        self.control.iter().all(Option::is_none)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_whole_ones() {
        assert_eq!(ThingRule::numbers_of("id:3, 4"), Some(vec![3, 4]));
        for words in ["3", "id:", "id:-1", "id:1.5", "id:a", "cryptomatte:id:3"] {
            assert_eq!(ThingRule::numbers_of(words), None, "{words}");
        }
    }
}
