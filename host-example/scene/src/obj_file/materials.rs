//! Materials of an OBJ file, out of what its MTL files say and the textures that they name. A texture that is missing
//! or cannot be read costs a warning.

use std::collections::HashMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use glam::{Vec3, Vec4};

use super::library::{Definition, Kind};
use super::options::Map;
use crate::budget::Budget;
use crate::decode::{DecodeProblem, FORMATS, decode};
use crate::material::{AlphaMode, Image, Material, Sampler, Texture, TextureUse, Wrap};
use crate::model::Scene;
use crate::references::Folders;
use crate::texels::{combined, normals_of};
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

/// The material for surfaces whose vertices have colours, where it has no colour of its own.
pub fn for_colors(material: &Material) -> Option<Material> {
    let plain = material.base_color.truncate() == PLAIN && material.base_color_texture.is_none();
    plain.then(|| Material { base_color: Vec4::ONE.with_w(material.base_color.w), ..material.clone() })
}

/// An image named by the caller.
///
/// # Errors
/// [`Error::Input`] where it cannot be read.
pub fn named_texture(scene: &mut Scene, path: &Path, budget: &Budget) -> Result<usize> {
    let unreadable =
        |problem: String| Error::file(path, problem, budget.fix("give the path of a readable image"));
    let file = File::open(path).map_err(|e| unreadable(e.to_string()))?;
    let bytes = budget.read(file).map_err(unreadable)?;
    let image = decode(&path.display().to_string(), &bytes, budget).map_err(|problem| {
        let problem = match problem {
            DecodeProblem::Unsupported(_) => format!("is no image of a format that is read here ({FORMATS})"),
            DecodeProblem::Damaged(problem) => problem,
        };
        Error::file(path, problem, budget.fix("give a whole PNG or JPEG file"))
    })?;
    scene.images.push(image);
    scene.textures.push(Texture { image: Some(scene.images.len() - 1), sampler: Sampler::default() });
    Ok(scene.textures.len() - 1)
}

/// Turns definitions of MTL files into materials of a scene.
pub struct Loader<'a> {
    /// The OBJ file.
    path: &'a Path,
    /// Counts what is read.
    budget: &'a Budget,
    /// The image of each file read so far, where it could be read.
    files: HashMap<PathBuf, Option<usize>>,
    /// Images that were made of others: those, and in words how.
    made: HashMap<(Option<usize>, Option<usize>, String), usize>,
    /// The texture of each image, clamped or not.
    textures: HashMap<(usize, bool), usize>,
    /// Receives images, textures and warnings.
    pub scene: Scene,
}

impl<'a> Loader<'a> {
    /// A loader of the materials of an OBJ file.
    pub fn new(path: &'a Path, budget: &'a Budget, warnings: Vec<String>) -> Self {
        let scene = Scene::empty(warnings);
        Self { path, budget, files: HashMap::new(), made: HashMap::new(), textures: HashMap::new(), scene }
    }

    /// Converts one material.
    pub fn material(&mut self, source: &Definition) -> Material {
        let opacity =
            source.dissolve.or(source.transparency.map(|tr| 1.0 - tr)).unwrap_or(1.0).clamp(0.0, 1.0);
        let (base_color_texture, mut alpha_mode) = self.base_color(source);
        if opacity < 1.0 {
            alpha_mode = AlphaMode::Blend;
        }
        // Exporters write black Kd beside a texture; the texture is what was meant.
        let textured = base_color_texture.is_some() && source.maps.contains_key(&Kind::Diffuse);
        let diffuse = match source.diffuse {
            Some(kd) if !textured || kd != [0.0; 3] => Vec3::from(kd),
            _ if textured => Vec3::ONE,
            _ => PLAIN,
        };
        let emissive_texture = self.plain_use(source, Kind::Emission);
        let emissive = source.emissive.map_or(Vec3::ZERO, |ke| Vec3::from(ke).max(Vec3::ZERO));
        let emissive =
            if emissive_texture.is_some() && emissive == Vec3::ZERO { Vec3::ONE } else { emissive };
        let metallic_roughness_texture = self.metallic_roughness(source);
        let has = |kind: Kind| metallic_roughness_texture.is_some() && source.maps.contains_key(&kind);
        let (normal_texture, normal_scale) = self.normals(source);
        Material {
            name: source.name.clone(),
            base_color: diffuse.max(Vec3::ZERO).extend(opacity),
            base_color_texture,
            metallic: source
                .metallic
                .filter(|m| *m > 0.0)
                .unwrap_or(f32::from(has(Kind::Metalness)))
                .min(1.0),
            roughness: source
                .roughness
                .filter(|roughness| *roughness > 0.0 || !has(Kind::Roughness))
                .or(has(Kind::Roughness).then_some(1.0))
                .or(source.shininess.filter(|ns| *ns > 0.0).map(roughness_of))
                .unwrap_or(DEFAULT_ROUGHNESS)
                .clamp(0.0, 1.0),
            metallic_roughness_texture,
            normal_texture,
            normal_scale,
            emissive,
            emissive_texture,
            alpha_mode,
            ..plain_material()
        }
    }

    /// Texture of the base colour, with the coverage that a mask or the texture itself says.
    fn base_color(&mut self, source: &Definition) -> (Option<TextureUse>, AlphaMode) {
        let diffuse = self.map(source, Kind::Diffuse);
        let mask = self.map(source, Kind::Coverage);
        let image = match (&diffuse, &mask) {
            (None, None) => return (None, AlphaMode::Opaque),
            (Some((color, _)), None) => *color,
            (color, Some((cover, map))) => {
                let color = color.as_ref().map(|(image, _)| *image);
                let channel = map.channel.map(|letter| letter.to_ascii_lowercase());
                let own = color == Some(*cover);
                let clear =
                    self.scene.images[*cover].rgba.as_chunks::<4>().0.iter().any(|texel| texel[3] < 255);
                let how = match channel {
                    Some(letter @ ('r' | 'g' | 'b' | 'l')) => letter,
                    Some('m') => 'm',
                    _ if clear => 'm',
                    // The colour of a texture says nothing of its coverage.
                    _ if own => return self.used(diffuse, AlphaMode::Opaque),
                    _ => 'l',
                };
                let made = self.combine(color, Some(*cover), &format!("coverage {how}"), |color, cover| {
                    let [r, g, b, _] = color;
                    [r, g, b, single(cover, how)]
                });
                match made {
                    Some(made) => made,
                    None => return self.used(diffuse, AlphaMode::Opaque),
                }
            }
        };
        let mode = self.scene.images[image].alpha_mode();
        let map = diffuse.or(mask).map(|(_, map)| (image, map));
        self.used(map, mode)
    }

    fn used(&mut self, map: Option<(usize, Map)>, mode: AlphaMode) -> (Option<TextureUse>, AlphaMode) {
        (map.map(|(image, map)| self.texture_use(image, &map)), mode)
    }

    /// Texture of roughness and metalness, which MTL keeps apart.
    fn metallic_roughness(&mut self, source: &Definition) -> Option<TextureUse> {
        let roughness = self.map(source, Kind::Roughness);
        let metalness = self.map(source, Kind::Metalness);
        let images = [&roughness, &metalness].map(|map| map.as_ref().map(|(image, _)| *image));
        let (_, map) = roughness.or(metalness)?;
        let image = self.combine(images[0], images[1], "roughness and metalness", |rough, metal| {
            [255, single(rough, 'l'), single(metal, 'l'), 255]
        })?;
        Some(self.texture_use(image, &map))
    }

    /// Texture of normals, and what multiplies them. Many exporters name it as that of bumps, which are heights by the
    /// format.
    fn normals(&mut self, source: &Definition) -> (Option<TextureUse>, f32) {
        if let Some((image, map)) = self.map(source, Kind::Normals) {
            return (Some(self.texture_use(image, &map)), map.bumps);
        }
        let Some((image, map)) = self.map(source, Kind::Bumps) else { return (None, 1.0) };
        if holds_normals(&self.scene.images[image]) {
            return (Some(self.texture_use(image, &map)), map.bumps);
        }
        let channel = map.channel.map_or('l', |letter| letter.to_ascii_lowercase());
        let how = format!("heights {} {} {channel}", map.bumps, map.clamp);
        let made = self.make(Some(image), None, &how, |images, budget| {
            normals_of(images[0], map.bumps, map.clamp, |texel| single(texel, channel), budget)
        });
        (made.map(|image| self.texture_use(image, &map)), 1.0)
    }

    fn plain_use(&mut self, source: &Definition, kind: Kind) -> Option<TextureUse> {
        let (image, map) = self.map(source, kind)?;
        Some(self.texture_use(image, &map))
    }

    fn texture_use(&mut self, image: usize, map: &Map) -> TextureUse {
        let textures = &mut self.scene.textures;
        let texture = *self.textures.entry((image, map.clamp)).or_insert_with(|| {
            let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
            let sampler = Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() };
            textures.push(Texture { image: Some(image), sampler });
            textures.len() - 1
        });
        TextureUse { transform: map.transform(), ..TextureUse::plain(texture) }
    }

    /// An image that is made of the texels of one or two others, of which a missing one is white.
    fn combine(
        &mut self,
        first: Option<usize>,
        second: Option<usize>,
        how: &str,
        combine: impl Fn([u8; 4], [u8; 4]) -> [u8; 4],
    ) -> Option<usize> {
        self.make(first, second, how, |[first, second], budget| {
            combined(first.name.clone(), first, second, budget, combine)
        })
    }

    /// An image that is made of one or two others, of which a missing one is white. It has the name of the first.
    fn make(
        &mut self,
        first: Option<usize>,
        second: Option<usize>,
        how: &str,
        make: impl FnOnce([&Image; 2], &Budget) -> std::result::Result<Image, String>,
    ) -> Option<usize> {
        let key = (first, second, how.to_owned());
        if let Some(made) = self.made.get(&key) {
            return Some(*made);
        }
        let white = Image::solid("white", [255; 4]);
        let image = |index: Option<usize>| index.map_or(&white, |index| &self.scene.images[index]);
        let name = image(first.or(second)).name.clone();
        match make([image(first), image(second)], self.budget) {
            Ok(image) => {
                self.scene.images.push(Image { name, ..image });
                self.made.insert(key, self.scene.images.len() - 1);
                Some(self.scene.images.len() - 1)
            }
            Err(problem) => {
                self.scene.warnings.push(format!("the texture of {how} {problem}; it is left out"));
                None
            }
        }
    }

    /// The image of a texture that a material names, with the range of its values as the material wants it.
    fn map(&mut self, source: &Definition, kind: Kind) -> Option<(usize, Map)> {
        let map = source.maps.get(&kind)?.clone();
        let image = self.file(source, &map.name)?;
        if (map.base, map.gain) == (0.0, 1.0) {
            return Some((image, map));
        }
        let [base, gain] = [map.base * 255.0, map.gain];
        let image =
            self.combine(Some(image), None, &format!("base {base} gain {gain}"), |[r, g, b, a], _| {
                let [r, g, b] =
                    [r, g, b].map(|value| (base + gain * f32::from(value)).round().clamp(0.0, 255.0) as u8);
                [r, g, b, a]
            });
        image.map(|image| (image, map))
    }

    /// The image of a file, which lies beside the MTL file or the OBJ file.
    fn file(&mut self, source: &Definition, name: &str) -> Option<usize> {
        let folders = Folders::of(self.path).beside(&source.file);
        let opened = folders.open(name).or_else(|problem| {
            // A comment may follow, but the sign of one may stand in a name as well.
            let (name, _) = name.split_once(" #").ok_or(problem.clone())?;
            folders.open(name).map_err(|_| problem)
        });
        let (file, path) = match opened {
            Ok(opened) => opened,
            Err(problem) => {
                let warning = format!("a material {problem}; it is left out");
                if !self.scene.warnings.contains(&warning) {
                    self.scene.warnings.push(warning);
                }
                return None;
            }
        };
        if let Some(known) = self.files.get(&path) {
            return *known;
        }
        let decoded = self
            .budget
            .read(file)
            .and_then(|bytes| decode(name, &bytes, self.budget).map_err(|problem| problem.to_string()));
        let image = match decoded {
            Ok(mut image) => {
                if image.rgba.as_chunks::<4>().0.iter().all(|texel| texel[3] == 0) {
                    image.make_opaque();
                }
                self.scene.images.push(image);
                Some(self.scene.images.len() - 1)
            }
            Err(problem) => {
                self.scene.warnings.push(format!("texture '{name}': {problem}; it is left out"));
                None
            }
        };
        self.files.insert(path, image);
        image
    }
}

/// One number of a texel: one of its channels, its luminance (`l`) or its alpha (`m`).
fn single(texel: [u8; 4], channel: char) -> u8 {
    let [r, g, b, a] = texel;
    match channel {
        'r' => r,
        'g' => g,
        'b' => b,
        'm' => a,
        _ => (0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)).round() as u8,
    }
}

/// Roughness of a lobe of GGX as wide as that of a Blinn-Phong exponent.
fn roughness_of(exponent: f32) -> f32 {
    (2.0 / (exponent + 2.0)).powf(0.25).clamp(0.05, 1.0)
}

/// True where an image holds normals, most of which point out of the surface, and not heights.
fn holds_normals(image: &Image) -> bool {
    let texels = image.rgba.as_chunks::<4>().0;
    let mean = |channel: usize| {
        texels.iter().map(|texel| f64::from(texel[channel])).sum::<f64>() / texels.len().max(1) as f64
    };
    let [r, g, b] = [0, 1, 2].map(mean);
    b > 180.0 && b > r + 30.0 && b > g + 30.0
}
