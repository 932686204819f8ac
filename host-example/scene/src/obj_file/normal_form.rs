//! The normal form of an OBJ file: what its surfaces are made of, said in the one way that `tobj` reads as it is
//! meant. Every number and index is checked on the way, so that an error can name its line.
//!
//! Statements end up on one line each, libraries of materials first, then vertices; either all vertices have a colour
//! or none; texture coordinates have two numbers; indices count from the start of the file, and every corner has all
//! three where the file has such values. Names of objects begin with their number. Smoothing groups, which `tobj`
//! does not know, stand beside the text. Lines, points, curves and what else is not drawn are left out.

use std::fmt::{Arguments, Write};

use super::statements::{number, statements, words};
use crate::phrases::list;

/// Name of the material that faces choose by an empty name. No name in a text can be the same.
pub const UNNAMED: &str = "\0";

/// Texture coordinates of corners that have none in a file where others do: its V axis points up, so that this
/// is the origin of ours.
const NO_TEXTURE: &str = "vt 0 1\n";

/// Normal of corners that have none in a file where others do.
const NO_NORMAL: &str = "vn 0 0 0\n";

/// Smoothing of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// The file has not said anything yet.
    Unsaid,
    /// No group.
    Off,
    /// Group of this number.
    Number(u32),
}

/// A file in its normal form.
#[derive(Debug, Default, PartialEq)]
pub struct NormalForm {
    /// The text for `tobj`.
    pub text: String,
    /// Smoothing of every face, in the order of the file.
    pub smoothing: Vec<Group>,
    /// Number of corners of all faces.
    pub corners: usize,
    /// Sentences about what is not understood.
    pub warnings: Vec<String>,
}

/// The number and the name of an object out of its name in the normal form.
pub fn object(name: &str) -> (&str, &str) {
    let (number, name) = name.split_once(' ').unwrap_or((name, ""));
    (number, if name.is_empty() { "unnamed_object" } else { name })
}

/// Numbers of everything that a file holds, and its colours.
#[derive(Clone, Copy, Default)]
struct Totals {
    positions: usize,
    texcoords: usize,
    normals: usize,
    /// True where any vertex has a colour.
    colored: bool,
    /// True where any value of a colour is above 1.
    above_one: bool,
    /// True where any value of a colour is no byte.
    fractions: bool,
}

impl Totals {
    fn of(text: &str) -> Self {
        let mut totals = Self::default();
        for statement in statements(text) {
            match statement.split() {
                Some(("v", rest)) => {
                    totals.positions += 1;
                    if words(rest).count() >= 6 {
                        totals.colored = true;
                        totals.color(words(rest).skip(3).take(3));
                    }
                }
                Some(("vt", _)) => totals.texcoords += 1,
                Some(("vn", _)) => totals.normals += 1,
                _ => {}
            }
        }
        totals
    }

    fn color<'a>(&mut self, values: impl Iterator<Item = &'a str>) {
        for value in values.filter_map(|word| number(word).ok()).filter(|value| value.is_finite()) {
            self.above_one |= value > 1.0;
            self.fractions |= value.fract() != 0.0 || !(0.0..=255.0).contains(&value);
        }
    }

    /// Value of full light in a colour: some scanners write bytes.
    fn full_light(&self) -> f32 {
        if self.above_one && !self.fractions { 255.0 } else { 1.0 }
    }
}

/// Brings a file into its normal form.
///
/// # Errors
/// A clause that names the line and says what is wrong with it.
pub fn normal_form(text: &str) -> Result<NormalForm, String> {
    let totals = Totals::of(text);
    let mut writer = Writer {
        totals,
        seen: Totals::default(),
        out: NormalForm::default(),
        vertices: String::new(),
        faces: "g 0\n".to_owned(),
        objects: 0,
        material: String::new(),
        written: String::new(),
        smoothing: Group::Unsaid,
        normals_missing: None,
        unknown: Vec::new(),
    };
    if totals.texcoords > 0 {
        writer.vertices.push_str(NO_TEXTURE);
    }
    if totals.normals > 0 {
        writer.vertices.push_str(NO_NORMAL);
    }
    for statement in statements(text) {
        let Some((keyword, rest)) = statement.split() else { continue };
        writer
            .statement(keyword, rest, statement.line)
            .map_err(|problem| format!("line {}: {keyword} {problem}", statement.line))?;
    }
    Ok(writer.finish())
}

struct Writer {
    totals: Totals,
    /// Numbers of what came before the current statement, which negative indices count back from.
    seen: Totals,
    /// The result, of whose text only the libraries are there.
    out: NormalForm,
    /// Values in the form that takes few letters whatever their size.
    vertices: String,
    faces: String,
    /// Number of objects that have begun.
    objects: usize,
    /// Name of the material of the next face, empty before any is chosen.
    material: String,
    /// Name of the material of the last face that was written.
    written: String,
    smoothing: Group,
    /// The first normal that there is not, in words.
    normals_missing: Option<String>,
    /// Statements that are left out.
    unknown: Vec<String>,
}

impl Writer {
    fn statement(&mut self, keyword: &str, rest: &str, line: usize) -> Result<(), String> {
        match keyword {
            "v" => self.vertex(rest)?,
            "vt" => {
                let (count, [u, v]) = numbers(rest, 1)?;
                self.seen.texcoords += 1;
                put(&mut self.vertices, format_args!("vt {u:?} {:?}\n", if count > 1 { v } else { 0.0 }));
            }
            "vn" => {
                let (_, [x, y, z]) = numbers(rest, 3)?;
                self.seen.normals += 1;
                put(&mut self.vertices, format_args!("vn {x:?} {y:?} {z:?}\n"));
            }
            "f" | "fo" => self.face(rest, line)?,
            "o" | "g" => {
                self.objects += 1;
                put(&mut self.faces, format_args!("g {} {rest}\n", self.objects));
            }
            "s" => self.smoothing = smoothing(rest)?,
            "mtllib" => put(&mut self.out.text, format_args!("mtllib {rest}\n")),
            "usemtl" => self.material = if rest.is_empty() { UNNAMED } else { rest }.to_owned(),
            "curv" | "curv2" | "surf" | "call" | "csh" | "usemap"
                if !self.unknown.iter().any(|known| known == keyword) =>
            {
                self.unknown.push(keyword.to_owned());
            }
            _ => {}
        }
        Ok(())
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
        put(&mut self.vertices, format_args!("v {x:?} {y:?} {z:?}"));
        if self.totals.colored {
            // Vertices without a colour are white among coloured ones.
            let full = self.totals.full_light();
            let [r, g, b] = if count >= 6 { [r, g, b].map(|value| value / full) } else { [1.0; 3] };
            put(&mut self.vertices, format_args!(" {r:?} {g:?} {b:?}"));
        }
        self.vertices.push('\n');
        self.seen.positions += 1;
        Ok(())
    }

    fn face(&mut self, rest: &str, line: usize) -> Result<(), String> {
        let count = words(rest).count();
        if count == 0 {
            return Err("has no corners".into());
        }
        if count > 2 && self.material != self.written {
            put(&mut self.faces, format_args!("usemtl {}\n", self.material));
            self.written.clone_from(&self.material);
        }
        let start = self.faces.len();
        self.faces.push('f');
        for corner in words(rest) {
            self.corner(corner, line)?;
        }
        self.faces.push('\n');
        if count > 2 {
            self.out.smoothing.push(self.smoothing);
            self.out.corners += count;
        } else {
            self.faces.truncate(start);
        }
        Ok(())
    }

    fn corner(&mut self, corner: &str, line: usize) -> Result<(), String> {
        let mut parts = corner.split('/');
        let mut index = |seen, total| {
            index(parts.next().unwrap_or_default(), seen, total)
                .map_err(|problem| format!("has the corner '{corner}', whose {problem}"))
        };
        let position = index(self.seen.positions, self.totals.positions)?;
        let texcoord = index(self.seen.texcoords, self.totals.texcoords)?;
        // A normal that is missing can be computed.
        let normal = index(self.seen.normals, self.totals.normals).unwrap_or_else(|problem| {
            self.normals_missing.get_or_insert_with(|| format!("line {line}: f {problem}"));
            0
        });
        if position == 0 {
            return Err(format!("has the corner '{corner}' without a vertex"));
        }
        if parts.next().is_some() {
            return Err(format!("has the corner '{corner}' with more than three indices"));
        }
        // The first texture coordinates and the first normal are those of corners without any.
        put(&mut self.faces, format_args!(" {position}/"));
        if self.totals.texcoords > 0 {
            put(&mut self.faces, format_args!("{}", texcoord + 1));
        }
        if self.totals.normals > 0 {
            put(&mut self.faces, format_args!("/{}", normal + 1));
        }
        Ok(())
    }

    fn finish(self) -> NormalForm {
        let mut out = self.out;
        out.text.push_str(&self.vertices);
        drop(self.vertices);
        out.text.push_str(&self.faces);
        if let Some(first) = self.normals_missing {
            out.warnings.push(format!("{first}; normals that are missing are computed"));
        }
        if !self.unknown.is_empty() {
            let verb = if self.unknown.len() == 1 { "is" } else { "are" };
            out.warnings
                .push(format!("{} of the file {verb} not understood and left out", list(&self.unknown)));
        }
        out
    }
}

fn put(text: &mut String, line: Arguments) {
    text.write_fmt(line).expect("strings can be written to");
}

/// A smoothing group: its number, or `off`.
fn smoothing(rest: &str) -> Result<Group, String> {
    let word = words(rest).next().unwrap_or("off");
    Ok(match word {
        "off" | "0" => Group::Off,
        "on" => Group::Number(1),
        word => Group::Number(
            word.parse::<f64>().map_err(|_| format!("takes a number or off, not '{word}'"))?.abs() as u32,
        ),
    })
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

/// An index from 1; negative ones count back from what was seen before. 0 where there is none.
fn index(word: &str, seen: usize, total: usize) -> Result<usize, String> {
    if word.is_empty() {
        return Ok(0);
    }
    let value: i64 = word.parse().map_err(|_| format!("index '{word}' is not a whole number"))?;
    let place = match usize::try_from(value) {
        Ok(0) => return Ok(0),
        Ok(place) => Some(place).filter(|place| *place <= total),
        Err(_) => usize::try_from(value.unsigned_abs()).ok().and_then(|back| (seen + 1).checked_sub(back)),
    };
    place.filter(|place| *place > 0).ok_or_else(|| format!("index {value} is not one of {total}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_form_has_one_way_to_say_things() {
        let text = "v 2 4 6 2 # weight\nv 1 0 0 1 0 0\nv 0 1 0 # no colour\nvt 0.5\nusemtl\n\
                    f -3/-1 2 \\\n3/1/\nl 1 2 3\nusemtl\twall\nvn 0 0 1\ns 3\nfo 1//1 2//-1 4//1\n\
                    v 9 9 9 1 1 1 0.5\ng\ns off\nusemtl b\nusemtl wall\nf 1 2 3 4\nmtllib a.mtl\n";
        let expected = "mtllib a.mtl\nvt 0 1\nvn 0 0 0\nv 1.0 2.0 3.0 1.0 1.0 1.0\nv 1.0 0.0 0.0 1.0 0.0 0.0\n\
                        v 0.0 1.0 0.0 1.0 1.0 1.0\nvt 0.5 0.0\nvn 0.0 0.0 1.0\nv 9.0 9.0 9.0 1.0 1.0 1.0\n\
                        g 0\nusemtl \0\nf 1/2/1 2/1/1 3/2/1\n\
                        usemtl wall\nf 1/1/2 2/1/2 4/1/2\ng 1 \nf 1/1/1 2/1/1 3/1/1 4/1/1\n";
        let read = normal_form(text).unwrap();
        assert_eq!(read.text, expected);
        assert_eq!(read.smoothing, [Group::Unsaid, Group::Number(3), Group::Off]);
        assert_eq!((read.corners, read.warnings.len()), (10, 0));
        assert_eq!(normal_form("v 0 0 0\nf 1 1// 1/0/0\n").unwrap().text, "v 0.0 0.0 0.0\ng 0\nf 1/ 1/ 1/\n");
    }

    #[test]
    fn objects_have_numbers_and_names() {
        assert_eq!(object("0"), ("0", "unnamed_object"));
        assert_eq!(object("12 a b"), ("12", "a b"));
    }

    #[test]
    fn colours_may_be_bytes() {
        let text = |text: &str| normal_form(text).unwrap().text;
        assert_eq!(
            text("v 0 0 0 255 51 0\nv 1 1 1\n"),
            "v 0.0 0.0 0.0 1.0 0.2 0.0\nv 1.0 1.0 1.0 1.0 1.0 1.0\ng 0\n"
        );
        assert_eq!(text("v 0 0 0 1 1 0\n"), "v 0.0 0.0 0.0 1.0 1.0 0.0\ng 0\n");
        assert_eq!(
            text("v 0 0 0 2 0.5 0\nv 1e30 1e-30 -0 0 0 0\n"),
            "v 0.0 0.0 0.0 2.0 0.5 0.0\nv 1e30 1e-30 -0.0 0.0 0.0 0.0\ng 0\n"
        );
    }

    #[test]
    fn normals_that_are_missing_cost_one_warning() {
        let read = normal_form("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//4 2//5 3//6\nf 1//4 2//5 3//6\n").unwrap();
        assert!(read.text.ends_with("\nf 1/ 2/ 3/\nf 1/ 2/ 3/\n"), "{}", read.text);
        assert_eq!(
            read.warnings,
            [
                "line 4: f has the corner '1//4', whose index 4 is not one of 0; normals that are missing are computed"
            ]
        );
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
