//! The normal form of an OBJ file: what its surfaces are made of, said in the one way that `tobj` reads as it is
//! meant. Every number and index is checked on the way, so that an error can name its line.
//!
//! Statements end up on one line each, vertices first; either all vertices have a colour or none; texture
//! coordinates have two numbers; indices count from the start of the file, and every corner has texture
//! coordinates or none has. Lines, points, curves and what else is not drawn are dropped.

use std::fmt::Write;

use super::statements::{UNNAMED, number, statements, words};

/// Texture coordinates of corners that have none in a file where others do: its V axis points up, so that this
/// is the origin of ours.
const NO_TEXTURE: &str = "vt 0 1\n";

/// Numbers of everything that a file holds, and true where any vertex has a colour.
#[derive(Default)]
struct Totals {
    positions: usize,
    texcoords: usize,
    normals: usize,
    colored: bool,
}

impl Totals {
    fn of(text: &str) -> Self {
        let mut totals = Self::default();
        for statement in statements(text) {
            match statement.split() {
                Some(("v", rest)) => {
                    totals.positions += 1;
                    totals.colored |= words(rest).count() >= 6;
                }
                Some(("vt", _)) => totals.texcoords += 1,
                Some(("vn", _)) => totals.normals += 1,
                _ => {}
            }
        }
        totals
    }
}

/// Brings a file into its normal form; yields the number of corners of its faces too.
///
/// # Errors
/// A clause that names the line and says what is wrong with it.
pub fn normal_form(text: &str) -> Result<(String, usize), String> {
    let totals = Totals::of(text);
    let mut writer =
        Writer { totals, seen: Totals::default(), vertices: String::new(), rest: String::new(), corners: 0 };
    if writer.totals.texcoords > 0 {
        writer.vertices.push_str(NO_TEXTURE);
    }
    for statement in statements(text) {
        let Some((keyword, rest)) = statement.split() else { continue };
        writer
            .statement(keyword, rest)
            .map_err(|problem| format!("line {}: {keyword} {problem}", statement.line))?;
    }
    let Writer { mut vertices, rest, corners, .. } = writer;
    vertices.push_str(&rest);
    Ok((vertices, corners))
}

struct Writer {
    totals: Totals,
    /// Numbers of what came before the current statement, which negative indices count back from.
    seen: Totals,
    vertices: String,
    rest: String,
    corners: usize,
}

impl Writer {
    fn statement(&mut self, keyword: &str, rest: &str) -> Result<(), String> {
        match keyword {
            "v" => self.vertex(rest),
            "vt" => {
                let (count, [u, v]) = numbers(rest, 1)?;
                let v = if count > 1 { v } else { 0.0 };
                self.seen.texcoords += 1;
                put(&mut self.vertices, format_args!("vt {u} {v}\n"));
                Ok(())
            }
            "vn" => {
                let (_, [x, y, z]) = numbers(rest, 3)?;
                self.seen.normals += 1;
                put(&mut self.vertices, format_args!("vn {x} {y} {z}\n"));
                Ok(())
            }
            "f" => self.face(rest),
            "o" | "g" | "mtllib" => {
                put(&mut self.rest, format_args!("{keyword} {rest}\n"));
                Ok(())
            }
            "usemtl" => {
                let name = if rest.is_empty() { UNNAMED } else { rest };
                put(&mut self.rest, format_args!("usemtl {name}\n"));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Three numbers; a fourth is the weight that divides them; six or seven hold a colour, of which coverage,
    /// the seventh, is not used.
    fn vertex(&mut self, rest: &str) -> Result<(), String> {
        let (count, [mut x, mut y, mut z, r, g, b, _]) = numbers(rest, 3)?;
        if count == 5 || words(rest).count() > 7 {
            return Err("takes 3 numbers, 4 with a weight, or 6 with a colour".into());
        }
        if count == 4 {
            let weight = r;
            if weight == 0.0 {
                return Err("has the weight 0".into());
            }
            [x, y, z] = [x, y, z].map(|value| value / weight);
        }
        put(&mut self.vertices, format_args!("v {x} {y} {z}"));
        if self.totals.colored {
            let [r, g, b] = if count >= 6 { [r, g, b] } else { [1.0; 3] };
            put(&mut self.vertices, format_args!(" {r} {g} {b}"));
        }
        self.vertices.push('\n');
        self.seen.positions += 1;
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), String> {
        self.rest.push('f');
        let before = self.corners;
        for corner in words(rest) {
            let mut parts = corner.split('/');
            let mut index = |seen, total| {
                index(parts.next().unwrap_or_default(), seen, total)
                    .map_err(|problem| format!("has the corner '{corner}', whose {problem}"))
            };
            let position = index(self.seen.positions, self.totals.positions)?
                .ok_or_else(|| format!("has the corner '{corner}' without a vertex"))?;
            let texcoord = index(self.seen.texcoords, self.totals.texcoords)?;
            let normal = index(self.seen.normals, self.totals.normals)?;
            if parts.next().is_some() {
                return Err(format!("has the corner '{corner}' with more than three indices"));
            }
            put(&mut self.rest, format_args!(" {position}/"));
            if self.totals.texcoords > 0 {
                // The first ones are those of corners without any.
                put(&mut self.rest, format_args!("{}", texcoord.unwrap_or(0) + 1));
            }
            if let Some(normal) = normal {
                put(&mut self.rest, format_args!("/{normal}"));
            }
            self.corners += 1;
        }
        self.rest.push('\n');
        if self.corners == before { Err("has no corners".into()) } else { Ok(()) }
    }
}

fn put(text: &mut String, line: std::fmt::Arguments) {
    text.write_fmt(line).expect("strings can be written to");
}

/// Up to `N` numbers and how many there are, at least `least`.
fn numbers<const N: usize>(rest: &str, least: usize) -> Result<(usize, [f32; N]), String> {
    let (mut count, mut values) = (0, [0.0; N]);
    for (value, word) in values.iter_mut().zip(words(rest)) {
        *value = number(word).map_err(|problem| format!("takes numbers, but {problem}"))?;
        count += 1;
    }
    if count < least {
        return Err(format!("has {count} of at least {least} numbers"));
    }
    Ok((count, values))
}

/// An index from 1; negative ones count back from what was seen before. `None` where there is none.
fn index(word: &str, seen: usize, total: usize) -> Result<Option<usize>, String> {
    if word.is_empty() {
        return Ok(None);
    }
    let value: i64 = word.parse().map_err(|_| format!("index '{word}' is not a whole number"))?;
    let place = match usize::try_from(value) {
        Ok(0) => return Ok(None),
        Ok(place) => Some(place).filter(|place| *place <= total),
        Err(_) => usize::try_from(value.unsigned_abs()).ok().and_then(|back| (seen + 1).checked_sub(back)),
    };
    match place {
        Some(place) if place > 0 => Ok(Some(place)),
        _ => Err(format!("index {value} is not one of {total}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_form_has_one_way_to_say_things() {
        let text = "mtllib a.mtl\nv 2 4 6 2 # weight\nv 1 0 0 1 0 0\nv 0 1 0 # no colour\nvt 0.5\nusemtl\n\
                    f -3/-1 2 \\\n3/1/\nl 1 2 3\nusemtl\twall\nvn 0 0 1\nf 1//1 2//-1 4//1\nv 9 9 9 1 1 1 0.5\ng\n";
        let expected = "vt 0 1\nv 1 2 3 1 1 1\nv 1 0 0 1 0 0\nv 0 1 0 1 1 1\nvt 0.5 0\nvn 0 0 1\nv 9 9 9 1 1 1\n\
                        mtllib a.mtl\nusemtl \0\nf 1/2 2/1 3/2\nusemtl wall\nf 1/1/1 2/1/1 4/1/1\ng \n";
        assert_eq!(normal_form(text).unwrap(), (expected.to_owned(), 6));
        assert_eq!(normal_form("v 0 0 0\nf 1 1// 1/0/0\n").unwrap().0, "v 0 0 0\nf 1/ 1/ 1/\n");
    }

    #[test]
    fn faults_name_their_line() {
        for (text, line, reason) in [
            ("v 0 0", 1, "v has 2 of at least 3 numbers"),
            ("\nv 0 0,5 0", 2, "v takes numbers, but '0,5' is not a number"),
            ("v 1 2 3 4 5", 1, "v takes 3 numbers, 4 with a weight, or 6 with a colour"),
            ("v 1 2 3 0", 1, "v has the weight 0"),
            ("vt", 1, "vt has 0 of at least 1 numbers"),
            ("vn 0 \\\n 1", 1, "vn has 2 of at least 3 numbers"),
            ("v 0 0 0\n\nf 1 2 1", 3, "f has the corner '2', whose index 2 is not one of 1"),
            ("v 0 0 0\nf -2 1 1", 2, "f has the corner '-2', whose index -2 is not one of 1"),
            ("v 0 0 0\nf 1 0 1", 2, "f has the corner '0' without a vertex"),
            ("v 0 0 0\nf 1 x 1", 2, "f has the corner 'x', whose index 'x' is not a whole number"),
            ("v 0 0 0\nf 1/2 1 1", 2, "f has the corner '1/2', whose index 2 is not one of 0"),
            ("v 0 0 0\nf 1/1/1/1", 2, "f has the corner '1/1/1/1', whose index 1 is not one of 0"),
            ("v 0 0 0\nf 1///1", 2, "f has the corner '1///1' with more than three indices"),
            ("f", 1, "f has no corners"),
            (
                "f 9223372036854775808 1 1",
                1,
                "f has the corner '9223372036854775808', whose index '9223372036854775808' is not a whole number",
            ),
            (
                "f -9223372036854775808 1 1",
                1,
                "f has the corner '-9223372036854775808', whose index -9223372036854775808 is not one of 0",
            ),
        ] {
            assert_eq!(normal_form(text).unwrap_err(), format!("line {line}: {reason}"), "{text}");
        }
    }
}
