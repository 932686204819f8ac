//! Materials of a glTF document.

use glam::{Vec3, Vec4};
use gltf::json::Value;
use gltf::material::AlphaMode as GltfAlphaMode;

use super::accessors::Accessors;
use super::glossiness::Glossiness;
use super::uses;
use crate::material::{AlphaMode, Material};
use crate::model::Scene;

/// Coverage that is left of a surface which lets all light through: what it reflects is still seen.
const LEAST_COVERAGE: f32 = 0.15;

/// Reads materials into the scene, whose textures must be there already. The last material is the default one.
pub fn read(document: &gltf::Document, accessors: &Accessors, scene: &mut Scene) {
    let mut glossiness = Glossiness::new(accessors.budget);
    for material in document.materials() {
        let name = label(material.name(), material.index().unwrap_or_default());
        let mut converted = read_material(&name, &material, scene);
        reflect(&material, &mut converted);
        if let Some(surface) = material.pbr_specular_glossiness() {
            glossiness.apply(&name, &surface, &mut converted, scene);
        }
        if let Some(transmission) = material.transmission() {
            transmit(&name, &transmission, &mut converted, scene);
        }
        scene.materials.push(converted);
    }
    scene.materials.push(Material::default());
}

/// A name for messages.
pub fn label(name: Option<&str>, index: usize) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("'{name}'"),
        _ => format!("number {index}"),
    }
}

fn read_material(name: &str, material: &gltf::Material, scene: &mut Scene) -> Material {
    let surface = material.pbr_metallic_roughness();
    let base_color_texture = uses::of_info(name, surface.base_color_texture(), scene);
    let metallic_roughness_texture = uses::of_info(name, surface.metallic_roughness_texture(), scene);
    let emissive_texture = uses::of_info(name, material.emissive_texture(), scene);
    let normal = material.normal_texture();
    let occlusion = material.occlusion_texture();
    const TRANSFORM: &str = "KHR_texture_transform";
    let mut take = |texture: usize, set: u32, transform: Option<&Value>| {
        uses::of_texture(name, texture, set, transform, scene)
    };
    // Without its texture a factor of 1 would turn everything into mirrors.
    let lost = surface.metallic_roughness_texture().is_some() && metallic_roughness_texture.is_none();
    Material {
        name: material.name().unwrap_or_default().to_owned(),
        base_color: Vec4::from(surface.base_color_factor()),
        base_color_texture,
        metallic: if lost { 0.0 } else { surface.metallic_factor() },
        roughness: if lost { 0.6 * surface.roughness_factor() } else { surface.roughness_factor() },
        metallic_roughness_texture,
        reflectance: Material::default().reflectance,
        normal_scale: normal.as_ref().map_or(1.0, |n| n.scale()),
        normal_texture: normal
            .and_then(|n| take(n.texture().index(), n.tex_coord(), n.extension_value(TRANSFORM))),
        occlusion_strength: occlusion.as_ref().map_or(1.0, |o| o.strength()),
        occlusion_texture: occlusion
            .and_then(|o| take(o.texture().index(), o.tex_coord(), o.extension_value(TRANSFORM))),
        emissive: Vec3::from(material.emissive_factor()) * material.emissive_strength().unwrap_or(1.0),
        emissive_texture,
        alpha_mode: match material.alpha_mode() {
            GltfAlphaMode::Opaque => AlphaMode::Opaque,
            GltfAlphaMode::Mask => AlphaMode::Mask { cutoff: material.alpha_cutoff().unwrap_or(0.5) },
            GltfAlphaMode::Blend => AlphaMode::Blend,
        },
        double_sided: material.double_sided(),
        unlit: material.unlit(),
    }
}

/// Reflectance of KHR_materials_ior and KHR_materials_specular, whose colour is taken as its mean.
fn reflect(source: &gltf::Material, material: &mut Material) {
    if let Some(ior) = source.ior().filter(|ior| *ior >= 0.0) {
        material.reflectance = ((ior - 1.0) / (ior + 1.0)).powi(2).min(1.0);
    }
    if let Some(specular) = source.specular() {
        let color = Vec3::from(specular.specular_color_factor()).element_sum() / 3.0;
        let share = specular.specular_factor().clamp(0.0, 1.0);
        material.reflectance = (material.reflectance * color.max(0.0)).min(1.0) * share;
    }
}

/// Lets light through by blending over what lies behind, which is not bent and not blurred. Where a texture says how
/// much, its mean counts.
fn transmit(name: &str, source: &gltf::material::Transmission, material: &mut Material, scene: &mut Scene) {
    let image = uses::of_info(name, source.transmission_texture(), scene)
        .and_then(|use_| scene.textures[use_.texture].image)
        .map(|image| scene.images[image].rgba.as_chunks::<4>().0);
    let mean = image.map_or(1.0, |texels| {
        let sum: f64 = texels.iter().map(|texel| f64::from(texel[0])).sum();
        (sum / (255.0 * texels.len().max(1) as f64)) as f32
    });
    let share = (source.transmission_factor() * mean).clamp(0.0, 1.0);
    // Metals let nothing through.
    let share = share
        * (1.0
            - material.metallic.clamp(0.0, 1.0) * f32::from(material.metallic_roughness_texture.is_none()));
    if share > 0.0 {
        material.base_color.w *= 1.0 - share * (1.0 - LEAST_COVERAGE);
        material.alpha_mode = AlphaMode::Blend;
    }
}
