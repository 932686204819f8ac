//! Materials of an OBJ file: its MTL files and the textures they name. What cannot be read there costs a
//! warning with its line, and nothing else.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt::Write;
use std::fs::File;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::statements::{UNNAMED, number, statements, words};
use crate::budget::Budget;
use crate::gltf_file::open;
use crate::material::{AlphaMode, DecodeProblem, Image, Material, Sampler, Texture, TextureUse};
use crate::model::Scene;
use isophote_files::error::{Error, Result};

/// Colour of surfaces that say nothing about it.
const PLAIN: Vec3 = Vec3::new(0.45, 0.44, 0.42);

/// Roughness of surfaces that say nothing about it.
const DEFAULT_ROUGHNESS: f32 = 0.55;

/// OBJ says nothing reliable about the side a face is seen from, so both are shown.
pub fn plain_material() -> Material {
    Material {
        base_color: PLAIN.extend(1.0),
        metallic: 0.0,
        roughness: DEFAULT_ROUGHNESS,
        double_sided: true,
        ..Material::default()
    }
}

/// Reads what an OBJ file at `path` names as its material library: one file, whose name may hold spaces, or
/// several with spaces between them.
pub fn load_mtl(
    path: &Path,
    names: &Path,
    budget: &Budget,
    warnings: &RefCell<Vec<String>>,
) -> tobj::MTLLoadResult {
    let names = names.to_string_lossy();
    let several: Vec<&str> = match open(path, &reference(&names)) {
        Err(_) if names.contains(char::is_whitespace) => names.split_whitespace().collect(),
        _ => vec![&names],
    };
    let mut text = String::new();
    for name in several {
        match read_mtl(path, name, budget, warnings) {
            Ok(more) => text.push_str(&more),
            Err(problem) => warnings.borrow_mut().push(format!("{problem}; plain materials are used")),
        }
    }
    tobj::load_mtl_buf(&mut Cursor::new(text.as_bytes()))
}

/// The normal form of one file.
fn read_mtl(
    path: &Path,
    name: &str,
    budget: &Budget,
    warnings: &RefCell<Vec<String>>,
) -> std::result::Result<String, String> {
    let (file, _) = open(path, &reference(name)).map_err(|problem| format!("the file {problem}"))?;
    let bytes = budget.read(file).map_err(|e| format!("{name} cannot be read: {e}"))?;
    Ok(normal_form(&String::from_utf8_lossy(&bytes), |line, problem| {
        warnings.borrow_mut().push(format!("{name}, line {line}: {problem}; it is left out"));
    }))
}

/// A file name of an OBJ or MTL file as the reference of a glTF, which has escapes and one kind of slash.
fn reference(name: &str) -> String {
    name.replace('%', "%25").replace('\\', "/")
}

/// The normal form of an MTL file: one statement per line, colours of three numbers, and nothing that `tobj`
/// refuses. What is wrong is handed to `warn` with its line and dropped.
fn normal_form(text: &str, mut warn: impl FnMut(usize, String)) -> String {
    let mut out = String::with_capacity(text.len());
    for statement in statements(text) {
        let Some((keyword, rest)) = statement.split() else { continue };
        let value = match keyword {
            "newmtl" if rest.is_empty() => Ok(UNNAMED.to_owned()),
            "Ka" | "Kd" | "Ks" | "Ke" => color(rest).map(|[r, g, b]| format!("{r} {g} {b}")),
            "Ns" | "Ni" => one_number(rest),
            "d" => one_number(rest.strip_prefix("-halo").unwrap_or(rest)),
            // Not used, and refused by the parser where it is no whole number.
            "illum" => continue,
            "bump" | "norm" if rest.is_empty() => continue,
            _ if rest.is_empty() && keyword.starts_with("map_") => continue,
            _ => Ok(rest.to_owned()),
        };
        match value {
            Ok(value) => writeln!(out, "{keyword} {value}").expect("strings can be written to"),
            Err(problem) => warn(statement.line, format!("{keyword} {problem}")),
        }
    }
    out
}

/// A colour of three numbers, or of one that stands for all three.
fn color(rest: &str) -> std::result::Result<[f32; 3], String> {
    let mut given = words(rest).peekable();
    if let Some(kind @ ("spectral" | "xyz")) = given.peek().copied() {
        return Err(format!("is given as {kind}, which is not read here"));
    }
    let values: Vec<f32> = given.map(number).collect::<std::result::Result<_, _>>()?;
    match values[..] {
        [value] => Ok([value; 3]),
        [r, g, b, ..] => Ok([r, g, b]),
        _ => Err(format!("takes 1 or 3 numbers, not {}", values.len())),
    }
}

fn one_number(rest: &str) -> std::result::Result<String, String> {
    let word = words(rest).next().ok_or("takes a number")?;
    number(word).map(|value| value.to_string())
}

/// An image named by the caller.
pub fn named_texture(scene: &mut Scene, path: &Path, budget: &Budget) -> Result<usize> {
    let unreadable = |problem: String| {
        Error::file(path, problem, budget.fix("give the path of a readable PNG or JPEG file"))
    };
    let file = File::open(path).map_err(|e| unreadable(e.to_string()))?;
    let bytes = budget.read(file).map_err(unreadable)?;
    let image = Image::decode(&path.display().to_string(), &bytes, budget).map_err(|problem| {
        let problem = match problem {
            DecodeProblem::Unsupported(_) => "is neither a PNG nor a JPEG image".into(),
            DecodeProblem::Damaged(problem) => problem,
        };
        Error::file(path, problem, budget.fix("give a whole PNG or JPEG file"))
    })?;
    Ok(add_texture(scene, image))
}

fn add_texture(scene: &mut Scene, image: Image) -> usize {
    scene.images.push(image);
    scene.textures.push(Texture { image: Some(scene.images.len() - 1), sampler: Sampler::default() });
    scene.textures.len() - 1
}

/// Turns materials of an MTL file into those of a scene.
pub struct Loader<'a> {
    /// The OBJ file.
    pub path: &'a Path,
    /// Counts what is read.
    pub budget: &'a Budget,
    /// The texture of each file read so far, where it could be read.
    pub images: HashMap<PathBuf, Option<usize>>,
    /// Receives images, textures and warnings.
    pub scene: Scene,
}

impl Loader<'_> {
    /// Converts one material.
    pub fn material(&mut self, source: &tobj::Material) -> Material {
        let base_color_texture = source.diffuse_texture.as_deref().and_then(|name| self.texture(name));
        // Exporters write black Kd beside a texture; the texture is what was meant.
        let diffuse = match source.diffuse {
            Some(kd) if base_color_texture.is_none() || kd != [0.0; 3] => Vec3::from(kd),
            _ if base_color_texture.is_some() => Vec3::ONE,
            _ => PLAIN,
        };
        let opacity = source.dissolve.unwrap_or(1.0).clamp(0.0, 1.0);
        let emissive = source.emissive.map_or(Vec3::ZERO, |ke| Vec3::from(ke).max(Vec3::ZERO));
        Material {
            name: if source.name == UNNAMED { String::new() } else { source.name.clone() },
            base_color: diffuse.max(Vec3::ZERO).extend(opacity),
            base_color_texture,
            // The Blinn-Phong exponent Ns of a lobe as wide as that of GGX.
            roughness: source
                .shininess
                .filter(|ns| *ns > 0.0)
                .map_or(DEFAULT_ROUGHNESS, |ns| (2.0 / (ns + 2.0)).powf(0.25).clamp(0.05, 1.0)),
            normal_texture: source.unknown_param.get("norm").and_then(|name| self.texture(name)),
            emissive,
            alpha_mode: if opacity < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque },
            ..plain_material()
        }
    }

    /// A texture of the MTL file; options before its name are ignored.
    fn texture(&mut self, statement: &str) -> Option<TextureUse> {
        let name = without_options(statement);
        let (file, path) = match open(self.path, &reference(name)) {
            Ok(opened) => opened,
            Err(problem) => {
                self.scene.warnings.push(format!("a material {problem}; it is left out"));
                return None;
            }
        };
        if let Some(known) = self.images.get(&path) {
            return known.map(TextureUse::plain);
        }
        let decoded = self.budget.read(file).and_then(|bytes| {
            Image::decode(name, &bytes, self.budget).map_err(|problem| match problem {
                DecodeProblem::Unsupported(_) => "is neither PNG nor JPEG".to_owned(),
                DecodeProblem::Damaged(problem) => problem,
            })
        });
        let texture = match decoded {
            Ok(image) => Some(add_texture(&mut self.scene, image)),
            Err(problem) => {
                self.scene.warnings.push(format!("texture '{name}': {problem}; it is left out"));
                None
            }
        };
        self.images.insert(path, texture);
        texture.map(TextureUse::plain)
    }
}

/// Drops options such as `-s 1 1 1` and `-clamp on` that may precede a file name, which itself may hold spaces.
fn without_options(statement: &str) -> &str {
    let mut rest = statement.trim();
    while let Some(option) = rest.strip_prefix('-') {
        let Some((_, mut after)) = option.split_once(char::is_whitespace) else { break };
        loop {
            after = after.trim_start();
            match after.split_once(char::is_whitespace) {
                Some((word, tail)) if word.parse::<f32>().is_ok() || matches!(word, "on" | "off") => {
                    after = tail
                }
                _ => break,
            }
        }
        rest = after.trim_start();
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_textures_are_skipped() {
        assert_eq!(without_options("wall.png"), "wall.png");
        assert_eq!(without_options("-s 2 2 1 -clamp on old wall.png"), "old wall.png");
        assert_eq!(without_options("-bm 0.5 stone.jpg"), "stone.jpg");
    }
}
