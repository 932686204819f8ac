//! The statements of MTL files. What cannot be read there costs a warning with its line, and nothing else; what is not
//! understood is named in one warning of each file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::options::Map;
use super::statements::{number, statements, text_of, words};
use crate::budget::Budget;
use crate::phrases::list;
use crate::references::Folders;

/// Content of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Colour (`map_Kd`).
    Diffuse,
    /// Coverage (`map_d`).
    Coverage,
    /// Emission (`map_Ke`).
    Emission,
    /// Normals (`norm`).
    Normals,
    /// Heights, or normals in their place (`map_Bump`).
    Bumps,
    /// Roughness (`map_Pr`).
    Roughness,
    /// Metalness (`map_Pm`).
    Metalness,
}

/// A material as a file describes it.
#[derive(Clone, Debug, Default)]
pub struct Definition {
    /// Its name, which may be empty.
    pub name: String,
    /// Path of the file.
    pub file: PathBuf,
    /// `Kd`.
    pub diffuse: Option<[f32; 3]>,
    /// `Ke`.
    pub emissive: Option<[f32; 3]>,
    /// `d`.
    pub dissolve: Option<f32>,
    /// `Tr`, which is 1 where nothing is seen.
    pub transparency: Option<f32>,
    /// `Ns`.
    pub shininess: Option<f32>,
    /// `Pm`.
    pub metallic: Option<f32>,
    /// `Pr`.
    pub roughness: Option<f32>,
    /// Its textures.
    pub maps: HashMap<Kind, Map>,
}

/// Reads what an OBJ file at `path` names as its material library: one file, whose name may hold spaces, or
/// several with spaces between them.
pub fn read(path: &Path, names: &str, budget: &Budget, warnings: &mut Vec<String>) -> Vec<Definition> {
    let folders = Folders::of(path);
    let several: Vec<&str> = match folders.open(names) {
        Err(_) if names.contains(char::is_whitespace) && !names.starts_with(['"', '\'']) => {
            names.split_whitespace().collect()
        }
        _ => vec![names],
    };
    let mut all = Vec::new();
    for name in several {
        let read =
            folders.open(name).map_err(|problem| format!("the file {problem}")).and_then(|(file, found)| {
                let bytes = budget.read(file).map_err(|e| format!("{name} cannot be read: {e}"))?;
                budget.take(bytes.len(), 1).map_err(|e| format!("{name} {e}"))?;
                Ok((text_of(&bytes), found))
            });
        match read {
            Ok((text, found)) => all.extend(definitions(&text, name, &found, warnings)),
            Err(problem) => warnings.push(format!("{problem}; plain materials are used")),
        }
    }
    all
}

/// The materials of one file.
fn definitions(text: &str, name: &str, file: &Path, warnings: &mut Vec<String>) -> Vec<Definition> {
    let mut all: Vec<Definition> = Vec::new();
    let mut unknown: Vec<String> = Vec::new();
    let mut note = |word: &str| {
        if !unknown.iter().any(|known| known == word) {
            unknown.push(word.to_owned());
        }
    };
    for statement in statements(text) {
        let Some((keyword, rest)) = statement.split() else { continue };
        if keyword.eq_ignore_ascii_case("newmtl") {
            all.push(Definition { name: rest.to_owned(), file: file.to_owned(), ..Definition::default() });
            continue;
        }
        let mut before = Definition::default();
        let read = all.last_mut().unwrap_or(&mut before).statement(keyword, rest, &mut note);
        if let Err(problem) = read {
            warnings.push(format!("{name}, line {}: {keyword} {problem}; it is left out", statement.line));
        }
    }
    if !unknown.is_empty() {
        let verb = if unknown.len() == 1 { "is" } else { "are" };
        warnings.push(format!("{name}: {} {verb} not understood and left out", list(&unknown)));
    }
    all
}

impl Definition {
    /// Takes one statement; words that are not understood are handed to `note`.
    fn statement(&mut self, keyword: &str, rest: &str, note: &mut impl FnMut(&str)) -> Result<(), String> {
        match keyword.to_ascii_lowercase().as_str() {
            "kd" => self.diffuse = Some(color(rest)?),
            "ke" => self.emissive = Some(color(rest)?),
            // Not used, but no reason for a warning either.
            "ka" | "ks" => drop(color(rest)?),
            "ni" => drop(one_number(rest)?),
            "illum" => {}
            "ns" => self.shininess = Some(one_number(rest)?),
            "d" => self.dissolve = Some(one_number(rest.strip_prefix("-halo").unwrap_or(rest))?),
            "tr" => self.transparency = Some(one_number(rest)?),
            "pm" => self.metallic = Some(one_number(rest)?),
            "pr" => self.roughness = Some(one_number(rest)?),
            // Exporters write these whatever they are; only these values change nothing.
            "tf" if words(rest).all(|word| number(word) == Ok(1.0)) => {}
            "ps" | "pc" | "pcr" | "aniso" | "anisor" if words(rest).all(|word| number(word) == Ok(0.0)) => {}
            "map_kd" => self.map(Kind::Diffuse, rest, note)?,
            "map_d" => self.map(Kind::Coverage, rest, note)?,
            "map_ke" | "map_emissive" => self.map(Kind::Emission, rest, note)?,
            "map_pr" => self.map(Kind::Roughness, rest, note)?,
            "map_pm" => self.map(Kind::Metalness, rest, note)?,
            "norm" | "map_kn" => self.map(Kind::Normals, rest, note)?,
            "bump" | "map_bump" => self.map(Kind::Bumps, rest, note)?,
            "map_ka" if self.maps.get(&Kind::Diffuse).is_some_and(|map| rest.ends_with(&map.name)) => {}
            _ if rest.is_empty() && keyword.starts_with("map_") => {}
            _ => note(keyword),
        }
        Ok(())
    }

    fn map(&mut self, kind: Kind, rest: &str, note: &mut impl FnMut(&str)) -> Result<(), String> {
        if !rest.is_empty() {
            self.maps.insert(kind, Map::of(rest, note)?);
        }
        Ok(())
    }
}

/// A colour of three numbers, or of one that stands for all three.
fn color(rest: &str) -> Result<[f32; 3], String> {
    let mut given = words(rest).peekable();
    if let Some(kind @ ("spectral" | "xyz")) = given.peek().copied() {
        return Err(format!("is given as {kind}, which is not read here"));
    }
    let values: Vec<f32> = given.map(number).collect::<Result<_, _>>()?;
    match values[..] {
        [value] => Ok([value; 3]),
        [r, g, b, ..] => Ok([r, g, b]),
        _ => Err(format!("takes 1 or 3 numbers, not {}", values.len())),
    }
}

fn one_number(rest: &str) -> Result<f32, String> {
    number(words(rest).next().ok_or("takes a number")?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_understood_is_named_once() {
        let text = "newmtl a\nKd 1 0 0\nTf 1 1 1\nrefl sky.png\nmap_Ks shine.png\nPc 0\nnewmtl b\nrefl sky.png\n\
                    map_Kd -foo 1 wood.png\nmap_Ka wood.png\nTf 0.5 1 1\nPs 1\n";
        let mut warnings = Vec::new();
        let read = definitions(text, "a.mtl", Path::new("a.mtl"), &mut warnings);
        assert_eq!(read.len(), 2);
        assert_eq!(warnings, ["a.mtl: refl, map_Ks, -foo, Tf and Ps are not understood and left out"]);
        assert_eq!(read[1].maps[&Kind::Diffuse].name, "wood.png");
    }

    #[test]
    fn keywords_may_have_any_letters() {
        let mut warnings = Vec::new();
        let text = "NEWMTL a\nKD 1 0 0\nmap_bump b.png\nMap_Kd c.png\n";
        let read = definitions(text, "a.mtl", Path::new("a.mtl"), &mut warnings);
        assert_eq!((read[0].diffuse, read[0].maps.len(), warnings.len()), (Some([1.0, 0.0, 0.0]), 2, 0));
    }
}
