//! Palettes as text: those of GIMP, lists of hexadecimal numbers, those of Paint Shop Pro, and JSON.
//!
//! Sources: "GIMP Palette" of GIMP's documentation for developers (`.gpl`); the formats that lospec.com offers (`.hex`,
//! `.txt` of Paint.NET, `.pal` with the head `JASC-PAL`, JSON). Every reader gives the problem as a sentence without a subject.

use serde_json::{Value, json};

use super::spaces::{Colour, hex};

/// First line of a palette of GIMP, which Inkscape, Krita and Aseprite write as well.
pub const GIMP: &str = "GIMP Palette";
/// First line of a palette of Paint Shop Pro.
pub const JASC: &str = "JASC-PAL";

/// Reads the lines of a palette of GIMP: three numbers from 0 to 255 each, after a head and among comments.
pub fn gimp(text: &str) -> Result<Vec<Colour>, String> {
    let mut colours = Vec::new();
    for (number, line) in (1..).zip(text.lines()).skip(1) {
        let line = line.trim();
        let is_head = colours.is_empty() && line.contains(':');
        if line.is_empty() || line.starts_with('#') || is_head {
            continue;
        }
        let colour = three(line).ok_or_else(|| {
            format!("has no red, green and blue from 0 to 255 in line {number}, '{}'", start(line))
        })?;
        colours.push(colour);
    }
    Ok(colours)
}

/// Reads a palette of Paint Shop Pro: its head, a version, how many colours there are, and as many lines.
pub fn jasc(text: &str) -> Result<Vec<Colour>, String> {
    let mut lines = (1..).zip(text.lines()).skip(2);
    let count: usize = lines
        .next()
        .and_then(|(_, line)| line.trim().parse().ok())
        .ok_or("does not say in its third line how many colours it has")?;
    let mut colours = Vec::new();
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()).take(count) {
        let colour = three(line).ok_or_else(|| {
            format!("has no red, green and blue from 0 to 255 in line {number}, '{}'", start(line))
        })?;
        colours.push(colour);
    }
    if colours.len() < count {
        return Err(format!("says that it has {count} colours, and has {}", colours.len()));
    }
    Ok(colours)
}

/// Reads hexadecimal numbers of three or six digits, in lines or between commas. Lines that begin with `;` are comments of
/// Paint.NET, which writes two digits of opacity before the six.
pub fn numbers(text: &str) -> Result<Vec<Colour>, String> {
    let has_opacity = text.lines().any(|line| line.trim_start().starts_with(';'));
    let mut colours = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        if line.trim_start().starts_with(';') {
            continue;
        }
        for word in line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty()) {
            let is_long = has_opacity && word.len() == 8 && word.is_ascii();
            let colour = of_hex(if is_long { &word[2..] } else { word })
                .ok_or_else(|| format!("has no colour such as 1a2b3c in line {number}, '{}'", start(word)))?;
            colours.push(colour);
        }
    }
    Ok(colours)
}

/// Reads JSON: a list of colours as text, or an object with such a list as its `colors` or `colours`. Objects in a list have
/// their colour as `hex`.
pub fn of_json(text: &str) -> Result<Vec<Colour>, String> {
    let json: Value = serde_json::from_str(text).map_err(|e| format!("is no JSON: {e}"))?;
    let list = match &json {
        Value::Object(object) => object.get("colors").or_else(|| object.get("colours")),
        other => Some(other),
    };
    let list = list.and_then(Value::as_array).ok_or("has no list of colours as its \"colors\"")?;
    let colour = |(number, entry): (usize, &Value)| {
        let text = entry.as_str().or_else(|| entry.get("hex")?.as_str());
        let colour = text.and_then(of_hex);
        colour.ok_or_else(|| format!("has no colour such as \"#1a2b3c\" in place {number} of its list"))
    };
    (1..).zip(list).map(colour).collect()
}

/// A palette of GIMP.
pub fn to_gimp(name: &str, colours: &[Colour]) -> String {
    let line = |colour: &Colour| {
        let [r, g, b] = colour;
        format!("{r:3} {g:3} {b:3}\t{}\n", hex(*colour))
    };
    let name = name.replace(char::is_control, " ");
    format!("{GIMP}\nName: {name}\nColumns: 0\n#\n{}", colours.iter().map(line).collect::<String>())
}

/// Hexadecimal numbers, one in a line.
pub fn to_numbers(colours: &[Colour]) -> String {
    colours.iter().map(|colour| format!("{}\n", hex(*colour).trim_start_matches('#'))).collect()
}

/// JSON, as of an object with a name and a list.
pub fn to_json(name: &str, colours: &[Colour]) -> String {
    let colours: Vec<String> = colours.iter().copied().map(hex).collect();
    format!("{:#}\n", json!({ "name": name, "colors": colours }))
}

/// The first three numbers of a line; a name or an opacity may follow.
fn three(line: &str) -> Option<Colour> {
    let mut words = line.split_whitespace().map(|word| word.parse::<u8>().ok());
    Some([words.next()??, words.next()??, words.next()??])
}

/// A colour of three or six hexadecimal digits, after `#` or without.
fn of_hex(text: &str) -> Option<Colour> {
    let digits = text.trim().trim_start_matches('#');
    let is_hex = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    let number = u32::from_str_radix(digits, 16).ok().filter(|_| is_hex)?;
    match digits.len() {
        6 => Some([number >> 16, number >> 8, number].map(|v| (v & 0xff) as u8)),
        3 => Some([number >> 8, number >> 4, number].map(|v| (v & 0xf) as u8 * 17)),
        _ => None,
    }
}

/// The beginning of a text, for messages.
fn start(text: &str) -> String {
    text.chars().take(24).collect::<String>().escape_default().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    const THREE: [Colour; 3] = [[16, 32, 48], [240, 232, 216], [176, 64, 40]];

    #[test]
    fn palettes_of_gimp_have_heads_comments_and_names() {
        // As GIMP 2.10 writes it, and as Aseprite does, with opacity.
        let text = "GIMP Palette\nName: Three\nColumns: 3\n#\n 16  32  48\tNight\n240 232 216\tPaper: warm\n\n176 64 40";
        assert_eq!(gimp(text).unwrap(), THREE);
        let text = "GIMP Palette\r\nChannels: RGBA\r\n#\r\n16 32 48 255 Untitled\r\n240 232 216 255\r\n176 64 40 0\r\n";
        assert_eq!(gimp(text).unwrap(), THREE);
        for (bad, line) in [
            ("GIMP Palette\n1 2", "line 2, '1 2'"),
            ("GIMP Palette\n#\n1 2 300", "line 3"),
            ("GIMP Palette\n-1 2 3", "line 2"),
            ("GIMP Palette\n1 2 nan", "line 2"),
            ("GIMP Palette\n1 2 3\nName: late", "line 3"),
        ] {
            assert!(gimp(bad).unwrap_err().contains(line), "{bad}");
        }
        assert_eq!(gimp("GIMP Palette"), Ok(vec![]));
    }

    #[test]
    fn numbers_stand_in_lines_or_between_commas() {
        for text in [
            "102030\nf0e8d8\nb04028\n",
            "#102030\r\n#F0E8D8\r\n\r\n#B04028",
            "102030, f0e8d8;b04028",
            "; paint.net Palette File\n;Colors: 3\nFF102030\nFFf0e8d8\nFFb04028\n",
        ] {
            assert_eq!(numbers(text).unwrap(), THREE, "{text}");
        }
        assert_eq!(numbers("fff\n#08c").unwrap(), [[255; 3], [0, 136, 204]]);
        for bad in ["102030\nyellow", "+12345\n", "1020304", "FF102030", "ééé", "#"] {
            assert!(numbers(bad).unwrap_err().contains("has no colour"), "{bad}");
        }
    }

    #[test]
    fn palettes_of_paint_shop_pro_say_how_many_they_are() {
        let text = "JASC-PAL\r\n0100\r\n3\r\n16 32 48\r\n240 232 216\r\n176 64 40\r\n";
        assert_eq!(jasc(text).unwrap(), THREE);
        let short = text.replace("\r\n3\r\n", "\r\n4000000000\r\n");
        assert!(jasc(&short).unwrap_err().contains("4000000000 colours, and has 3"));
        assert!(jasc("JASC-PAL\n0100\n").unwrap_err().contains("third line"));
        assert!(jasc("JASC-PAL\n0100\n1\n1 2").unwrap_err().contains("line 4"));
    }

    #[test]
    fn json_has_a_list_or_an_object_with_one() {
        for text in [
            r##"["#102030", "f0e8d8", "#B04028"]"##,
            r##"{"name": "Three", "author": "", "colors": ["102030", "f0e8d8", "b04028"]}"##,
            r##"{"colours": ["#102030", "#f0e8d8", "#b04028"]}"##,
            r##"[{"name": "Night", "hex": "102030"}, {"hex": "#f0e8d8"}, "b04028"]"##,
        ] {
            assert_eq!(of_json(text).unwrap(), THREE, "{text}");
        }
        for (bad, problem) in [
            ("[", "is no JSON"),
            ("7", "no list"),
            (r#"{"style": "ink"}"#, "no list"),
            (r##"["#102030", 7]"##, "place 2"),
            (r#"[[1, 2, 3]]"#, "place 1"),
            (&"[".repeat(100_000), "is no JSON"),
        ] {
            assert!(of_json(bad).unwrap_err().contains(problem));
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let name = "A\n\"b\"";
        assert_eq!(gimp(&to_gimp(name, &THREE)).unwrap(), THREE);
        assert_eq!(numbers(&to_numbers(&THREE)).unwrap(), THREE);
        assert_eq!(of_json(&to_json(name, &THREE)).unwrap(), THREE);
    }
}
