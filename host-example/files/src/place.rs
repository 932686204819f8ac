//! The place for the number of the frame in a file name, as programs write it: `####`, `@@@@`, `%04d`, `$F4`, `<UDIM>`.

/// Digits of the number of a UDIM tile.
const TILE_DIGITS: usize = 4;
/// Words for the number of a UDIM tile, in lower case.
const TILES: [&[u8]; 2] = [b"<udim>", b"%(udim)d"];

/// A place for a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Where it begins in the name.
    pub start: usize,
    /// Its length in bytes.
    pub length: usize,
    /// Least digits of the number.
    pub digits: usize,
    /// True where a minus is one of the digits, as C's `printf` counts.
    pub counts_sign: bool,
    /// True where the number is that of a UDIM tile.
    pub is_tile: bool,
}

impl Place {
    /// Likelihood that it is meant as a place: a sign by itself may be any letter of the name.
    pub fn rank(&self, name: &[u8]) -> u8 {
        match (self.digits, name[self.start]) {
            (1, b'#' | b'@') => 0,
            (1, _) => 1,
            _ => 2,
        }
    }
}

/// All places of a name, in their order.
pub fn places(name: &[u8]) -> Vec<Place> {
    let mut places = Vec::new();
    let mut start = 0;
    while start < name.len() {
        match place(name, start) {
            Some(place) => {
                start += place.length;
                places.push(place);
            }
            None => start += 1,
        }
    }
    places
}

/// The place that begins here.
fn place(name: &[u8], start: usize) -> Option<Place> {
    let rest = &name[start..];
    let found = |length, digits: usize, counts_sign| {
        let digits = digits.max(1);
        Some(Place { start, length, digits, counts_sign, is_tile: false })
    };
    if let Some(word) = TILES.iter().find(|word| starts(rest, word)) {
        let (length, digits) = (word.len(), TILE_DIGITS);
        return Some(Place { start, length, digits, counts_sign: false, is_tile: true });
    }
    match rest[0] {
        sign @ (b'#' | b'@') => {
            let length = rest.iter().take_while(|other| **other == sign).count();
            found(length, length, false)
        }
        b'%' => {
            // %4d would pad with blanks, which no sequence means.
            let (length, digits) = number(&rest[1..])?;
            (rest.get(1 + length) == Some(&b'd')).then(|| found(length + 2, digits, true))?
        }
        b'$' if starts(rest, b"${f") => closed(rest, 3, b'}').and_then(|(length, n)| found(length, n, true)),
        b'<' if starts(rest, b"<f") => closed(rest, 2, b'>').and_then(|(length, n)| found(length, n, true)),
        b'$' if rest.get(1) == Some(&b'F') => {
            let (length, digits) = number(&rest[2..])?;
            // The name of another variable goes on.
            let is_over =
                rest.get(2 + length).is_none_or(|next| !next.is_ascii_alphanumeric() && *next != b'_');
            is_over.then(|| found(2 + length, digits, true))?
        }
        _ => None,
    }
}

/// True where a name starts with this word, in lower case, whatever its own case.
fn starts(name: &[u8], word: &[u8]) -> bool {
    name.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
}

/// The whole length of a place with a number from `at` to `end`, and the number.
fn closed(name: &[u8], at: usize, end: u8) -> Option<(usize, usize)> {
    let (length, digits) = number(&name[at..])?;
    (name.get(at + length) == Some(&end)).then_some((at + length + 1, digits))
}

/// Length and value of the number of at most three digits that begins here; 0 without any.
fn number(text: &[u8]) -> Option<(usize, usize)> {
    let length = text.iter().take_while(|c| c.is_ascii_digit()).count();
    let value = || text[..length].iter().fold(0, |sum, c| sum * 10 + usize::from(c - b'0'));
    (length <= 3).then(|| (length, value()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_as_programs_write_them() {
        let digits = |name: &str| -> Vec<(usize, usize)> {
            places(name.as_bytes()).iter().map(|place| (place.length, place.digits)).collect()
        };
        for (name, found) in [
            ("a.####.exr", &[(4, 4)][..]),
            ("a.@.exr", &[(1, 1)]),
            ("a.%04d.exr", &[(4, 4)]),
            ("a.%d.exr", &[(2, 1)]),
            ("a.$F4.exr", &[(3, 4)]),
            ("a.${F4}.exr", &[(5, 4)]),
            ("a.$F.exr", &[(2, 1)]),
            ("a.<F4>.exr", &[(4, 4)]),
            ("a.<UDIM>.exr", &[(6, 4)]),
            ("a.%(UDIM)d.exr", &[(8, 4)]),
            ("photo #1.##.exr", &[(1, 1), (2, 2)]),
            ("$FOLDER 100%.exr", &[]),
            ("a.<UDIM", &[]),
            ("a.${F4", &[]),
            ("a.%", &[]),
            ("$", &[]),
        ] {
            assert_eq!(digits(name), found, "{name}");
        }
    }
}
