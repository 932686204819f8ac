//! Numbers and colours as they are typed: with decimal points or commas, as small calculations, with units.

/// Most characters that are read.
const MOST: usize = 120;

/// A number or a sentence why there is none.
type Answer = Result<f64, String>;

/// Marks that may follow numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Marks<'u> {
    /// The unit that the field shows, which says nothing new.
    pub unit: &'u str,
    /// True where a number is a share of one, so that 50 % is a half.
    pub is_share: bool,
}

/// The value of a number or a calculation with `+`, `-`, `*`, `/` and brackets.
///
/// # Errors
/// A short sentence for who typed it.
pub fn number(text: &str, marks: Marks<'_>) -> Answer {
    if text.trim().is_empty() {
        return Err("Nothing was typed".into());
    }
    if text.chars().count() > MOST {
        return Err("That is too long".into());
    }
    let mut reader = Reader { rest: text, marks };
    let value = reader.sum()?;
    match reader.next() {
        Some(')') => Err("A bracket is closed that was not opened".into()),
        Some(next) if next.is_ascii_digit() => {
            Err(format!("Before '{}' a +, -, * or / is missing", reader.word()))
        }
        Some(_) => Err(format!("'{}' is not understood", reader.word())),
        None if value.is_finite() => Ok(value),
        None => Err("There is no such number".into()),
    }
}

/// A colour as the web writes it, with three, four, six or eight digits, with or without `#`; its opacity where it has one.
///
/// # Errors
/// A short sentence for who typed it.
pub fn color(text: &str) -> Result<([u8; 3], Option<u8>), String> {
    let failed = || format!("'{}' is no colour such as #a0522d", text.trim());
    let digits = text.trim().trim_start_matches('#');
    let digits: Option<Vec<u8>> = digits.chars().map(|c| c.to_digit(16).map(|digit| digit as u8)).collect();
    let digits = digits.ok_or_else(failed)?;
    let parts: Vec<u8> = match digits.len() {
        3 | 4 => digits.iter().map(|digit| digit * 17).collect(),
        6 | 8 => digits.as_chunks::<2>().0.iter().map(|[high, low]| high * 16 + low).collect(),
        _ => return Err(failed()),
    };
    let [r, g, b, ref opacity @ ..] = parts[..] else { return Err(failed()) };
    Ok(([r, g, b], opacity.first().copied()))
}

/// Text from which numbers and signs are taken.
struct Reader<'t> {
    rest: &'t str,
    marks: Marks<'t>,
}

impl Reader<'_> {
    fn next(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    /// Takes one of these signs, if it is the next.
    fn takes(&mut self, signs: &[char]) -> bool {
        let sign = self.next().filter(|sign| signs.contains(sign));
        self.rest = &self.rest[sign.map_or(0, char::len_utf8)..];
        sign.is_some()
    }

    /// The next few letters and digits, for messages.
    fn word(&self) -> &str {
        let is_end = |c: char| c.is_whitespace() || "+-*/()".contains(c);
        let end = self.rest.char_indices().skip(1).find(|(_, c)| is_end(*c));
        &self.rest[..end.map_or(self.rest.len(), |(at, _)| at)]
    }

    fn sum(&mut self) -> Answer {
        let mut value = self.product()?;
        loop {
            if self.takes(&['+']) {
                value += self.product()?;
            } else if self.takes(&['-', '−', '–']) {
                value -= self.product()?;
            } else {
                return Ok(value);
            }
        }
    }

    fn product(&mut self) -> Answer {
        let mut value = self.factor()?;
        loop {
            if self.takes(&['*', '×', '·']) {
                value *= self.factor()?;
            } else if self.takes(&['/', '÷', ':']) {
                match self.factor()? {
                    0.0 => return Err("It is divided by 0".into()),
                    divisor => value /= divisor,
                }
            } else {
                return Ok(value);
            }
        }
    }

    fn factor(&mut self) -> Answer {
        if self.takes(&['-', '−', '–']) {
            return self.factor().map(|value| -value);
        }
        if self.takes(&['+']) {
            return self.factor();
        }
        if !self.takes(&['(']) {
            return self.number();
        }
        let value = self.sum()?;
        match self.takes(&[')']) {
            true => Ok(value),
            false => Err("A bracket is not closed".into()),
        }
    }

    fn number(&mut self) -> Answer {
        let Some(first) = self.next() else { return Err("The calculation has no end".into()) };
        let is_part = |c: &char| c.is_ascii_digit() || ['.', ','].contains(c);
        if !is_part(&first) {
            return Err(format!("'{}' is no number", self.word()));
        }
        let mut length = self.rest.chars().take_while(is_part).count();
        length += exponent(&self.rest[length..]);
        let (text, rest) = self.rest.split_at(length);
        let value: f64 = text.replace(',', ".").parse().map_err(|_| format!("'{text}' is no number"))?;
        self.rest = rest;
        Ok(value * self.mark())
    }

    /// Takes the mark that may follow a number; returns what it is multiplied by.
    fn mark(&mut self) -> f64 {
        let names: &[&str] = match self.marks.unit.trim() {
            "" => &[],
            "px" => &["pixels", "pixel", "px"],
            "°" => &["°", "degrees", "degree", "deg"],
            own => &[own],
        };
        self.rest = self.rest.trim_start();
        if let Some(rest) = names.iter().find_map(|name| self.rest.strip_prefix(name)) {
            self.rest = rest;
        } else if self.marks.is_share && self.takes(&['%']) {
            return 0.01;
        }
        1.0
    }
}

/// Bytes of an exponent at the start of a text.
fn exponent(text: &str) -> usize {
    let Some(after) = text.strip_prefix(['e', 'E']) else { return 0 };
    let digits = after.trim_start_matches(['+', '-']);
    let signs = after.len() - digits.len();
    let count = digits.bytes().take_while(u8::is_ascii_digit).count();
    if count > 0 && signs < 2 { 1 + signs + count } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> Answer {
        number(text, Marks::default())
    }

    #[test]
    fn numbers_and_calculations_are_understood() {
        for (text, value) in [
            ("1.5", 1.5),
            (" 1,5 ", 1.5),
            (".5", 0.5),
            ("-2", -2.0),
            ("−2", -2.0),
            ("+3", 3.0),
            ("2*1.5", 3.0),
            ("2 × 1,5", 3.0),
            ("1/4", 0.25),
            ("1 - 2 - 3", -4.0),
            ("8/2/2", 2.0),
            ("1+2*3", 7.0),
            ("(2+1)*0.5", 1.5),
            ("-(1+-2)", 1.0),
            ("1e3", 1000.0),
            ("2.5e-1*2", 0.5),
        ] {
            assert_eq!(plain(text), Ok(value), "{text}");
        }
    }

    #[test]
    fn units_that_a_field_shows_say_nothing_new_and_others_are_refused() {
        let of = |unit| Marks { unit, is_share: false };
        assert_eq!(number("3 px", of(" px")), Ok(3.0));
        assert_eq!(number("2*3px + 1 pixel", of(" px")), Ok(7.0));
        assert_eq!(number("45°", of("°")), Ok(45.0));
        assert_eq!(number("45 deg/2", of("°")), Ok(22.5));
        assert_eq!(number("50%", of(" %")), Ok(50.0));
        assert_eq!(number("1.5 stops", of(" stops")), Ok(1.5));
        let share = Marks { unit: "", is_share: true };
        assert_eq!(number("50 %", share), Ok(0.5));
        assert_eq!(number("3 px", of("°")), Err("'px' is not understood".into()));
        assert_eq!(plain("50%"), Err("'%' is not understood".into()));
    }

    #[test]
    fn what_is_no_number_is_said_in_a_few_words() {
        for (text, problem) in [
            ("", "Nothing was typed"),
            ("abc", "'abc' is no number"),
            ("2*x", "'x' is no number"),
            ("1.2.3", "'1.2.3' is no number"),
            ("1.000,5", "'1.000,5' is no number"),
            (".", "'.' is no number"),
            ("1/0", "It is divided by 0"),
            ("2*", "The calculation has no end"),
            ("(1+2", "A bracket is not closed"),
            ("1+2)", "A bracket is closed that was not opened"),
            ("2 3", "Before '3' a +, -, * or / is missing"),
            ("2 apples", "'apples' is not understood"),
            ("1e999", "There is no such number"),
            ("ä", "'ä' is no number"),
        ] {
            assert_eq!(plain(text), Err(problem.into()), "{text}");
        }
        assert_eq!(plain(&"(".repeat(100_000)), Err("That is too long".into()));
        assert!(plain(&"(".repeat(MOST)).is_err());
    }

    #[test]
    fn colours_are_read_as_the_web_writes_them() {
        assert_eq!(color("#a52"), Ok(([0xaa, 0x55, 0x22], None)));
        assert_eq!(color(" a0522d "), Ok(([0xa0, 0x52, 0x2d], None)));
        assert_eq!(color("#A0522D80"), Ok(([0xa0, 0x52, 0x2d], Some(0x80))));
        assert_eq!(color("a52f"), Ok(([0xaa, 0x55, 0x22], Some(0xff))));
        for wrong in ["", "#", "#a5", "#a0522", "sienna", "#gggggg", "#ä0522d"] {
            assert!(color(wrong).is_err(), "{wrong}");
        }
    }
}
