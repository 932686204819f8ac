//! Materials, textures and images of a glTF document.

use std::path::Path;

use glam::{Affine2, Vec3, Vec4};
use gltf::json;
use gltf::json::Value;
use gltf::material::AlphaMode as GltfAlphaMode;
use gltf::texture::{MagFilter, MinFilter, WrappingMode};

use super::accessors::Accessors;
use super::sources;
use crate::material::{AlphaMode, DecodeProblem, Image, Material, Sampler, Texture, TextureUse, Wrap};
use crate::model::Scene;
use isophote_files::error::{Error, Result};

/// Reads images, textures and materials into the scene. The last material is the default one.
pub fn read(path: &Path, document: &gltf::Document, accessors: &Accessors, scene: &mut Scene) -> Result<()> {
    let images = read_images(path, document, accessors, scene)?;
    for texture in document.textures() {
        let sampler = texture.sampler();
        let image = texture.source().and_then(|image| images.get(image.index()).copied().flatten());
        if texture.source().is_none() {
            scene.warnings.push(format!(
                "texture {} has no PNG or JPEG source and is left out",
                label(texture.name(), texture.index())
            ));
        }
        let (linear_min, mipmaps) = match sampler.min_filter() {
            Some(MinFilter::Nearest) => (false, false),
            Some(MinFilter::Linear) => (true, false),
            Some(MinFilter::NearestMipmapNearest | MinFilter::NearestMipmapLinear) => (false, true),
            _ => (true, true),
        };
        scene.textures.push(Texture {
            image,
            sampler: Sampler {
                wrap_u: wrap(sampler.wrap_s()),
                wrap_v: wrap(sampler.wrap_t()),
                linear_mag: sampler.mag_filter() != Some(MagFilter::Nearest),
                linear_min,
                mipmaps,
            },
        });
    }
    for material in document.materials() {
        let converted = read_material(&material, scene);
        scene.materials.push(converted);
    }
    scene.materials.push(Material::default());
    Ok(())
}

/// A name for messages.
pub fn label(name: Option<&str>, index: usize) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("'{name}'"),
        _ => format!("number {index}"),
    }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    }
}

/// Decodes all images; yields the scene's image for each of the document's, `None` where it is of a
/// format not read here, which costs a warning only.
fn read_images(
    path: &Path,
    document: &gltf::Document,
    accessors: &Accessors,
    scene: &mut Scene,
) -> Result<Vec<Option<usize>>> {
    let json: &json::Root = document.as_json();
    let mut places = Vec::with_capacity(json.images.len());
    for (index, image) in json.images.iter().enumerate() {
        let file = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
        let name = label(image.name.as_deref().or(file), index);
        let damaged = |problem: String| {
            Error::file(
                path,
                format!("image {name}: {problem}"),
                accessors.budget.fix("replace the image or export the scene again"),
            )
        };
        let read: std::borrow::Cow<[u8]> = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => sources::read_uri(path, uri, accessors.budget)?.into(),
            (None, Some(view)) => document
                .views()
                .nth(view.value())
                .and_then(|view| accessors.view(&view))
                .ok_or_else(|| damaged("its bytes reach beyond the end of its buffer".into()))?
                .into(),
            (None, None) => return Err(damaged("it has neither a file nor a buffer view".into())),
        };
        match Image::decode(&name, &read, accessors.budget) {
            Ok(image) => {
                places.push(Some(scene.images.len()));
                scene.images.push(image);
            }
            Err(DecodeProblem::Unsupported(format)) => {
                places.push(None);
                scene.warnings.push(format!(
                    "texture {name} is of {format} format, which is not read here (PNG and JPEG are); it is left out"
                ));
            }
            Err(DecodeProblem::Damaged(problem)) => return Err(damaged(problem)),
        }
    }
    Ok(places)
}

fn read_material(material: &gltf::Material, scene: &mut Scene) -> Material {
    let name = label(material.name(), material.index().unwrap_or_default());
    let surface = material.pbr_metallic_roughness();
    let mut take = |texture: usize, set: u32, extensions: Option<&Value>| {
        texture_use(&name, texture, set, extensions, scene)
    };
    // Info of the gltf crate decodes the transform itself; the two special kinds of texture do not.
    let mut info = |info: Option<gltf::texture::Info>| {
        info.and_then(|i| {
            let transform = i.texture_transform();
            let set = transform.as_ref().and_then(|t| t.tex_coord()).unwrap_or(i.tex_coord());
            let mut use_ = take(i.texture().index(), set, None)?;
            if let Some(t) = transform {
                use_.transform = TextureUse::uv_transform(t.offset(), t.rotation(), t.scale());
            }
            Some(use_)
        })
    };
    let base_color_texture = info(surface.base_color_texture());
    let metallic_roughness_texture = info(surface.metallic_roughness_texture());
    let emissive_texture = info(material.emissive_texture());
    let normal = material.normal_texture();
    let occlusion = material.occlusion_texture();
    const TRANSFORM: &str = "KHR_texture_transform";
    Material {
        name: material.name().unwrap_or_default().to_owned(),
        base_color: Vec4::from(surface.base_color_factor()),
        base_color_texture,
        // Without its texture a factor of 1 would turn everything into mirrors.
        metallic: match surface.metallic_roughness_texture() {
            Some(_) if metallic_roughness_texture.is_none() => 0.0,
            _ => surface.metallic_factor(),
        },
        roughness: match surface.metallic_roughness_texture() {
            Some(_) if metallic_roughness_texture.is_none() => 0.6 * surface.roughness_factor(),
            _ => surface.roughness_factor(),
        },
        metallic_roughness_texture,
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

/// Use of a texture by a material; `None` where the texture has no image.
fn texture_use(
    material: &str,
    texture: usize,
    set: u32,
    extensions: Option<&Value>,
    scene: &mut Scene,
) -> Option<TextureUse> {
    let (transform, set) = texture_transform(extensions, set);
    if set > 1 {
        scene
            .warnings
            .push(format!("material {material} uses texture coordinates {set}; the second set is used"));
    }
    let use_ = TextureUse { texture, uv_set: set.min(1), transform };
    scene.textures.get(texture).and_then(|t| t.image).map(|_| use_)
}

/// Matrix and set of texture coordinates of KHR_texture_transform as plain JSON.
fn texture_transform(extension: Option<&Value>, set: u32) -> (Affine2, u32) {
    let Some(extension) = extension else { return (Affine2::IDENTITY, set) };
    let number =
        |value: Option<&Value>, default: f32| value.and_then(Value::as_f64).map_or(default, |v| v as f32);
    let pair = |key: &str, default: f32| {
        let list = extension.get(key);
        [0, 1].map(|i| number(list.and_then(|l| l.get(i)), default))
    };
    let transform = TextureUse::uv_transform(
        pair("offset", 0.0),
        number(extension.get("rotation"), 0.0),
        pair("scale", 1.0),
    );
    let set =
        extension.get("texCoord").and_then(Value::as_u64).map_or(set, |s| s.min(u64::from(u32::MAX)) as u32);
    (transform, set)
}
