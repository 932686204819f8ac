//! Textures as MTL files name them: options, and a file name that may hold spaces.

use glam::{Affine2, Mat2, Vec2};

/// A texture as a statement names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Name of the file.
    pub name: String,
    /// Factors of the texture coordinates (`-s`).
    pub scale: Vec2,
    /// Added to the scaled coordinates (`-o`).
    pub offset: Vec2,
    /// Repeats its edge and not itself (`-clamp on`).
    pub clamp: bool,
    /// Added to the values of the texture, once they are multiplied (`-mm`).
    pub base: f32,
    /// Multiplies the values of the texture (`-mm`).
    pub gain: f32,
    /// Multiplies the bumps of the texture (`-bm`).
    pub bumps: f32,
    /// Channel that a single number is taken from (`-imfchan`).
    pub channel: Option<char>,
}

impl Map {
    /// Reads what follows the keyword; options that are not known are handed to `warn`.
    ///
    /// # Errors
    /// A clause saying what is wrong.
    pub fn of(statement: &str, mut warn: impl FnMut(&str)) -> Result<Self, String> {
        let mut map = Self {
            name: String::new(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            clamp: false,
            base: 0.0,
            gain: 1.0,
            bumps: 1.0,
            channel: None,
        };
        let mut rest = statement.trim();
        while let Some((option, after)) = option(rest) {
            rest = match option {
                "-s" => pair(after, &mut map.scale),
                "-o" => pair(after, &mut map.offset),
                "-t" => numbers(after, 3, |_, _| {}),
                "-mm" => {
                    let mut values = Vec2::new(map.base, map.gain);
                    let rest = numbers(after, 2, |place, value| values[place] = value);
                    (map.base, map.gain) = (values.x, values.y);
                    rest
                }
                "-bm" => numbers(after, 1, |_, value| map.bumps = value),
                "-boost" | "-texres" => numbers(after, 1, |_, _| {}),
                "-clamp" => {
                    let (word, rest) = word(after);
                    map.clamp = word.eq_ignore_ascii_case("on");
                    rest
                }
                "-imfchan" => {
                    let (word, rest) = word(after);
                    map.channel = word.chars().next();
                    rest
                }
                "-blendu" | "-blendv" | "-cc" | "-type" | "-colorspace" => word(after).1,
                other => {
                    warn(other);
                    let (first, rest) = word(after);
                    let value = first.parse::<f32>().is_ok() || matches!(first, "on" | "off");
                    if value { numbers(rest, 2, |_, _| {}) } else { after }
                }
            };
        }
        map.name = rest.to_owned();
        if map.name.is_empty() { Err("names no file".into()) } else { Ok(map) }
    }

    /// Matrix of the texture coordinates. V of MTL points up the image, ours down.
    pub fn transform(&self) -> Affine2 {
        let offset = Vec2::new(self.offset.x, 1.0 - self.scale.y - self.offset.y);
        Affine2::from_mat2_translation(Mat2::from_diagonal(self.scale), offset)
    }
}

/// The option at the start of a text, and what follows it. File names may begin with a hyphen as well.
fn option(text: &str) -> Option<(&str, &str)> {
    let letter = text.strip_prefix('-')?.starts_with(|c: char| c.is_ascii_alphabetic());
    let (option, rest) = text.split_once(char::is_whitespace)?;
    letter.then(|| (option, rest.trim_start()))
}

/// Hands up to `most` numbers to `put` with their places, of which a file name must be left; yields the rest.
fn numbers(mut text: &str, most: usize, mut put: impl FnMut(usize, f32)) -> &str {
    for place in 0..most {
        let (first, rest) = word(text);
        match first.parse::<f32>() {
            Ok(value) if !rest.is_empty() => put(place, value),
            _ => break,
        }
        text = rest;
    }
    text
}

/// Up to three numbers, of which two are kept.
fn pair<'a>(text: &'a str, values: &mut Vec2) -> &'a str {
    numbers(text, 3, |place, value| {
        if place < 2 {
            values[place] = value;
        }
    })
}

/// The first word, and what follows it.
fn word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_told_from_names() {
        let map = |text: &str| Map::of(text, |option| panic!("{option} is known")).unwrap();
        for (text, name) in [
            ("wall.png", "wall.png"),
            ("-s 2 2 1 -clamp on old wall.png", "old wall.png"),
            ("-bm 0.5 stone.jpg", "stone.jpg"),
            ("-colorspace sRGB wood.png", "wood.png"),
            ("-type sphere -blendu off -cc on wood.png", "wood.png"),
            ("-imfchan m -texres 256 -boost 2 1 2.png", "1 2.png"),
            ("-s 2 7", "7"),
            ("-o 1 \t 5.png", "5.png"),
            ("-1.png", "-1.png"),
        ] {
            assert_eq!(map(text).name, name, "{text}");
        }
        let all = map("-s 4 3 1 -o 0.5 0.25 0 -mm 0.1 0.9 -clamp on -imfchan r a.png");
        assert_eq!((all.scale, all.offset), (Vec2::new(4.0, 3.0), Vec2::new(0.5, 0.25)));
        assert_eq!((all.base, all.gain, all.clamp, all.channel), (0.1, 0.9, true, Some('r')));
        assert_eq!(map("-s 4 a.png").scale, Vec2::new(4.0, 1.0));
        let mut unknown = Vec::new();
        let map = Map::of("-foo 1 2 -bar wood.png", |option| unknown.push(option.to_owned())).unwrap();
        assert_eq!((map.name.as_str(), unknown), ("wood.png", vec!["-foo".to_owned(), "-bar".to_owned()]));
        assert!(Map::of("  ", |_| {}).is_err());
    }

    #[test]
    fn textures_are_scaled_and_moved_from_their_lower_left_corner() {
        let map = Map::of("-s 4 2 1 -o 0.5 0.25 a.png", |_| {}).unwrap();
        // Ours are (u, 1 - v) of the file's.
        for (u, v) in [(0.0, 0.0), (1.0, 0.5), (0.25, 1.0)] {
            let moved = map.transform().transform_point2(Vec2::new(u, 1.0 - v));
            assert_eq!(moved, Vec2::new(4.0 * u + 0.5, 1.0 - (2.0 * v + 0.25)));
        }
    }
}
