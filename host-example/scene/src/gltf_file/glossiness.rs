//! Surfaces of KHR_materials_pbrSpecularGlossiness as metallic-roughness surfaces, by the conversion that Khronos
//! publishes with the extension: the metalness is that at which the diffuse colour and the specular colour are both
//! met. Where textures say what is metal, they are converted texel by texel.

use glam::{Vec3, Vec4};

use super::uses;
use crate::budget::Budget;
use crate::material::{Image, Material, Texture, TextureUse};
use crate::model::Scene;
use crate::texels::combined;

/// Reflectance of what is no metal.
const DIELECTRIC: f32 = 0.04;

/// Numbers of a surface and its two textures.
#[derive(Clone, Copy, PartialEq)]
struct Surface {
    diffuse: Vec4,
    specular: Vec3,
    glossiness: f32,
    diffuse_texture: Option<TextureUse>,
    specular_texture: Option<TextureUse>,
}

/// Converter of such surfaces, which makes textures once for all materials that share them.
pub struct Glossiness<'a> {
    budget: &'a Budget,
    made: Vec<(Surface, [TextureUse; 2])>,
}

impl<'a> Glossiness<'a> {
    /// A converter within a budget.
    pub fn new(budget: &'a Budget) -> Self {
        Self { budget, made: Vec::new() }
    }

    /// Replaces base colour, metalness and roughness of a material.
    pub fn apply(
        &mut self,
        name: &str,
        source: &gltf::material::PbrSpecularGlossiness,
        material: &mut Material,
        scene: &mut Scene,
    ) {
        let surface = Surface {
            diffuse: Vec4::from(source.diffuse_factor()),
            specular: Vec3::from(source.specular_factor()),
            glossiness: source.glossiness_factor(),
            diffuse_texture: uses::of_info(name, source.diffuse_texture(), scene),
            specular_texture: uses::of_info(name, source.specular_glossiness_texture(), scene),
        };
        let lost = source.specular_glossiness_texture().is_some() && surface.specular_texture.is_none();
        // The factors are those of the texture alone.
        let specular = if lost { Vec3::splat(DIELECTRIC) } else { surface.specular };
        let (base, metallic) = metallic(surface.diffuse.truncate(), specular);
        material.base_color = base.extend(surface.diffuse.w);
        material.metallic = metallic;
        material.roughness = if lost { 0.6 } else { 1.0 - surface.glossiness.clamp(0.0, 1.0) };
        material.base_color_texture = surface.diffuse_texture;
        material.metallic_roughness_texture = None;
        let plain = surface.specular_texture.is_none()
            && (surface.diffuse_texture.is_none() || specular.max_element() <= DIELECTRIC + 0.01);
        if plain {
            return;
        }
        match self.textures(&Surface { specular, ..surface }, scene) {
            Ok([base, rough]) => {
                material.base_color = Vec3::ONE.extend(surface.diffuse.w);
                (material.metallic, material.roughness) = (1.0, 1.0);
                material.base_color_texture = Some(base);
                material.metallic_roughness_texture = Some(rough);
            }
            Err(problem) => {
                (material.base_color, material.metallic) = (surface.diffuse, 0.0);
                let text =
                    format!("material {name}: its specular-glossiness texture {problem}; it is left out");
                scene.warnings.push(text);
            }
        }
    }

    /// Textures of base colour, and of roughness and metalness.
    fn textures(&mut self, surface: &Surface, scene: &mut Scene) -> Result<[TextureUse; 2], String> {
        if let Some((_, made)) = self.made.iter().find(|(known, _)| known == surface) {
            return Ok(*made);
        }
        let place = |use_: TextureUse| (use_.uv_set, use_.transform);
        let (diffuse, specular) = (surface.diffuse_texture, surface.specular_texture);
        if let (Some(diffuse), Some(specular)) = (diffuse, specular)
            && place(diffuse) != place(specular)
        {
            return Err("lies otherwise on the surface than its diffuse texture".into());
        }
        let main = diffuse.or(specular).ok_or("is missing")?;
        let white = Image::solid("white", [255; 4]);
        let image = |use_: Option<TextureUse>| {
            use_.and_then(|use_| scene.textures.get(use_.texture)?.image)
                .map_or(&white, |image| &scene.images[image])
        };
        let (diffuse, specular) = (image(diffuse), image(specular));
        let name = if surface.diffuse_texture.is_some() { &diffuse.name } else { &specular.name };
        let linear: [f32; 256] = std::array::from_fn(|value| decoded(value as u8));
        let texel = |d: [u8; 4], s: [u8; 4]| {
            let color = |t: [u8; 4]| Vec3::from([0, 1, 2].map(|i| linear[usize::from(t[i])]));
            metallic(surface.diffuse.truncate() * color(d), surface.specular * color(s))
        };
        let base = combined(name.clone(), diffuse, specular, self.budget, |d, s| {
            let [r, g, b] = texel(d, s).0.to_array().map(encoded);
            [r, g, b, d[3]]
        })?;
        let rough = combined(name.clone(), diffuse, specular, self.budget, |d, s| {
            let gloss = surface.glossiness.clamp(0.0, 1.0) * f32::from(s[3]) / 255.0;
            [255, ((1.0 - gloss) * 255.0).round() as u8, (texel(d, s).1 * 255.0).round() as u8, 255]
        })?;
        let sampler = scene.textures[main.texture].sampler;
        let made = [base, rough].map(|image| {
            scene.images.push(image);
            scene.textures.push(Texture { image: Some(scene.images.len() - 1), sampler });
            TextureUse { texture: scene.textures.len() - 1, ..main }
        });
        self.made.push((*surface, made));
        Ok(made)
    }
}

/// Base colour and metalness of linear diffuse and specular colours.
fn metallic(diffuse: Vec3, specular: Vec3) -> (Vec3, f32) {
    let rest = 1.0 - specular.max_element().clamp(0.0, 1.0);
    let (bright, shine) = (brightness(diffuse), brightness(specular));
    let metallic = if shine <= DIELECTRIC {
        0.0
    } else {
        let b = bright * rest / (1.0 - DIELECTRIC) + shine - 2.0 * DIELECTRIC;
        let c = DIELECTRIC - shine;
        ((-b + (b * b - 4.0 * DIELECTRIC * c).max(0.0).sqrt()) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
    };
    let from_diffuse = diffuse * (rest / (1.0 - DIELECTRIC) / (1.0 - metallic).max(1e-6)).min(1.0);
    let from_specular = (specular - Vec3::splat(DIELECTRIC * (1.0 - metallic))) / metallic.max(1e-6);
    let base = from_diffuse.lerp(from_specular, metallic * metallic);
    (base.clamp(Vec3::ZERO, Vec3::ONE), metallic)
}

fn brightness(color: Vec3) -> f32 {
    (color * color).dot(Vec3::new(0.299, 0.587, 0.114)).sqrt()
}

/// Linear light of an sRGB value.
fn decoded(value: u8) -> f32 {
    let value = f32::from(value) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB value of linear light.
fn encoded(value: f32) -> u8 {
    let value = if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paint_keeps_its_colour_and_metal_its_reflection() {
        let red = Vec3::new(0.8, 0.1, 0.05);
        let (base, share) = metallic(red, Vec3::splat(0.04));
        assert!(base.abs_diff_eq(red, 1e-3) && share < 1e-3, "{base} {share}");
        let gold = Vec3::new(1.0, 0.77, 0.34);
        let (base, share) = metallic(Vec3::ZERO, gold);
        assert!(base.abs_diff_eq(gold, 1e-3) && share > 0.999, "{base} {share}");
    }

    #[test]
    fn every_value_comes_back() {
        for value in 0..=255 {
            assert_eq!(encoded(decoded(value)), value);
        }
    }
}
