//! The statements of an OBJ file that make its surfaces. Every number and index is checked on the way, so that an
//! error can name its line. Lines, points, curves and what else is not drawn are left out.

use std::collections::HashMap;

use super::statements::{number, statements, words};
use crate::phrases::list;

/// A corner of a face: places from 1 in the lists of positions, texture coordinates and normals; 0 is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Corner {
    /// Place of its position, which there always is.
    pub position: u32,
    /// Place of its texture coordinates.
    pub texcoord: u32,
    /// Place of its normal.
    pub normal: u32,
}

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

/// A face.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Range of its corners.
    pub corners: std::ops::Range<usize>,
    /// Index of its object.
    pub object: usize,
    /// Index of the name of its material.
    pub material: Option<usize>,
    /// Smoothing group.
    pub smoothing: Group,
}

/// Content of a file.
#[derive(Debug, Default)]
pub struct Surfaces {
    /// Positions.
    pub positions: Vec<[f32; 3]>,
    /// Colours of the positions as they stand in the file, or none at all.
    pub colors: Vec<[f32; 3]>,
    /// Texture coordinates, V pointing up the image.
    pub texcoords: Vec<[f32; 2]>,
    /// Normals.
    pub normals: Vec<[f32; 3]>,
    /// Corners of all faces.
    pub corners: Vec<Corner>,
    /// Faces of three corners and more.
    pub faces: Vec<Face>,
    /// Names of objects and groups, one for each statement that begins one.
    pub objects: Vec<String>,
    /// Names of materials.
    pub materials: Vec<String>,
    /// Names of material libraries.
    pub libraries: Vec<String>,
    /// Sentences about what is not understood.
    pub warnings: Vec<String>,
}

/// Numbers of everything that a file holds, and true where any vertex has a colour.
#[derive(Clone, Copy, Default)]
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

/// Reads a file.
///
/// # Errors
/// A clause that names the line and says what is wrong with it.
pub fn surfaces(text: &str) -> Result<Surfaces, String> {
    let totals = Totals::of(text);
    let mut reader = Reader {
        totals,
        out: Surfaces { objects: vec![String::new()], ..Surfaces::default() },
        materials: HashMap::new(),
        material: None,
        smoothing: Group::Unsaid,
        normals_missing: None,
        unknown: Vec::new(),
    };
    for statement in statements(text) {
        let Some((keyword, rest)) = statement.split() else { continue };
        reader
            .statement(keyword, rest, statement.line)
            .map_err(|problem| format!("line {}: {keyword} {problem}", statement.line))?;
    }
    Ok(reader.finish())
}

struct Reader {
    totals: Totals,
    out: Surfaces,
    /// Index of each name of a material.
    materials: HashMap<String, usize>,
    material: Option<usize>,
    smoothing: Group,
    /// The first normal that there is not, in words.
    normals_missing: Option<String>,
    /// Statements that are left out.
    unknown: Vec<String>,
}

impl Reader {
    fn statement(&mut self, keyword: &str, rest: &str, line: usize) -> Result<(), String> {
        match keyword {
            "v" => self.vertex(rest)?,
            "vt" => {
                let (count, [u, v]) = numbers(rest, 1)?;
                self.out.texcoords.push([u, if count > 1 { v } else { 0.0 }]);
            }
            "vn" => self.out.normals.push(numbers(rest, 3)?.1),
            "f" | "fo" => self.face(rest, line)?,
            "o" | "g" => self.out.objects.push(rest.to_owned()),
            "s" => self.smoothing = smoothing(rest)?,
            "mtllib" => self.out.libraries.push(rest.to_owned()),
            "usemtl" => {
                let next = self.out.materials.len();
                let index = *self.materials.entry(rest.to_owned()).or_insert(next);
                if index == next {
                    self.out.materials.push(rest.to_owned());
                }
                self.material = Some(index);
            }
            "l" | "p" => {}
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
        self.out.positions.push([x, y, z]);
        if self.totals.colored {
            self.out.colors.push(if count >= 6 { [r, g, b] } else { [f32::INFINITY; 3] });
        }
        Ok(())
    }

    fn face(&mut self, rest: &str, line: usize) -> Result<(), String> {
        let start = self.out.corners.len();
        for corner in words(rest) {
            let mut parts = corner.split('/');
            let mut index = |seen, total| {
                index(parts.next().unwrap_or_default(), seen, total)
                    .map_err(|problem| format!("has the corner '{corner}', whose {problem}"))
            };
            let position = index(self.out.positions.len(), self.totals.positions)?;
            let texcoord = index(self.out.texcoords.len(), self.totals.texcoords)?;
            // A normal that is missing can be computed.
            let normal = index(self.out.normals.len(), self.totals.normals).unwrap_or_else(|problem| {
                self.normals_missing.get_or_insert_with(|| format!("line {line}: f {problem}"));
                0
            });
            if position == 0 {
                return Err(format!("has the corner '{corner}' without a vertex"));
            }
            if parts.next().is_some() {
                return Err(format!("has the corner '{corner}' with more than three indices"));
            }
            self.out.corners.push(Corner { position, texcoord, normal });
        }
        let corners = start..self.out.corners.len();
        if corners.is_empty() {
            return Err("has no corners".into());
        }
        if corners.len() > 2 {
            let object = self.out.objects.len() - 1;
            let (material, smoothing) = (self.material, self.smoothing);
            self.out.faces.push(Face { corners, object, material, smoothing });
        }
        Ok(())
    }

    fn finish(mut self) -> Surfaces {
        if let Some(first) = self.normals_missing {
            self.out.warnings.push(format!("{first}; normals that are missing are computed"));
        }
        if !self.unknown.is_empty() {
            let verb = if self.unknown.len() == 1 { "is" } else { "are" };
            self.out
                .warnings
                .push(format!("{} of the file {verb} not understood and left out", list(&self.unknown)));
        }
        let values = || self.out.colors.iter().flatten().filter(|value| value.is_finite());
        // Some scanners write bytes.
        let bytes =
            values().any(|v| *v > 1.0) && values().all(|v| v.fract() == 0.0 && (0.0..=255.0).contains(v));
        let most = if bytes { 255.0 } else { 1.0 };
        for color in &mut self.out.colors {
            // Vertices without a colour are white among coloured ones.
            *color = color.map(|value| if value == f32::INFINITY { 1.0 } else { value / most });
        }
        self.out
    }
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
fn index(word: &str, seen: usize, total: usize) -> Result<u32, String> {
    if word.is_empty() {
        return Ok(0);
    }
    let value: i64 = word.parse().map_err(|_| format!("index '{word}' is not a whole number"))?;
    let place = match usize::try_from(value) {
        Ok(0) => return Ok(0),
        Ok(place) => Some(place).filter(|place| *place <= total),
        Err(_) => usize::try_from(value.unsigned_abs()).ok().and_then(|back| (seen + 1).checked_sub(back)),
    };
    let place = place.filter(|place| *place > 0).and_then(|place| u32::try_from(place).ok());
    place.ok_or_else(|| format!("index {value} is not one of {total}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_have_one_meaning() {
        let text = "mtllib a.mtl\nv 2 4 6 2 # weight\nv 1 0 0 1 0 0\nv 0 1 0 # no colour\nvt 0.5\nusemtl\n\
                    f -3/-1 2 \\\n3/1/\nl 1 2 3\nusemtl\twall\nvn 0 0 1\ns 3\nf 1//1 2//-1 4//1\n\
                    v 9 9 9 1 1 1 0.5\ng\ns off\nf 1 2 3 4\n";
        let read = surfaces(text).unwrap();
        assert_eq!(read.positions, [[1.0, 2.0, 3.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0; 3]]);
        assert_eq!(read.colors, [[1.0; 3], [1.0, 0.0, 0.0], [1.0; 3], [1.0; 3]]);
        assert_eq!((read.texcoords, read.normals), (vec![[0.5, 0.0]], vec![[0.0, 0.0, 1.0]]));
        let corners: Vec<[u32; 3]> =
            read.corners.iter().map(|c| [c.position, c.texcoord, c.normal]).collect();
        assert_eq!(corners[..6], [[1, 1, 0], [2, 0, 0], [3, 1, 0], [1, 0, 1], [2, 0, 1], [4, 0, 1]]);
        let face = |corners, object, material, smoothing| Face {
            corners,
            object,
            material: Some(material),
            smoothing,
        };
        assert_eq!(
            read.faces,
            [
                face(0..3, 0, 0, Group::Unsaid),
                face(3..6, 0, 1, Group::Number(3)),
                face(6..10, 1, 1, Group::Off),
            ]
        );
        assert_eq!(
            (read.materials, read.libraries),
            (vec![String::new(), "wall".into()], vec!["a.mtl".to_owned()])
        );
        let corner = surfaces("v 0 0 0\nf 1 1// 1/0/0\n").unwrap().corners[1];
        assert_eq!(corner, Corner { position: 1, texcoord: 0, normal: 0 });
    }

    #[test]
    fn colours_may_be_bytes() {
        assert_eq!(surfaces("v 0 0 0 255 51 0\n").unwrap().colors, [[1.0, 0.2, 0.0]]);
        assert_eq!(surfaces("v 0 0 0 1 1 0\n").unwrap().colors, [[1.0, 1.0, 0.0]]);
    }

    #[test]
    fn normals_that_are_missing_cost_one_warning() {
        let read = surfaces("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//4 2//5 3//6\nf 1//4 2//5 3//6\n").unwrap();
        assert!(read.corners.iter().all(|corner| corner.normal == 0));
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
            assert_eq!(surfaces(text).unwrap_err(), format!("line {line}: {reason}"), "{text}");
        }
    }
}
