//! Textures of a glTF document as its materials use them.

use glam::Affine2;
use gltf::json::Value;

use crate::material::TextureUse;
use crate::model::Scene;

/// Use of a texture by a material; `None` where there is none, or it has no image.
pub fn of_info(material: &str, info: Option<gltf::texture::Info>, scene: &mut Scene) -> Option<TextureUse> {
    // The crate decodes the transform of these itself, but not that of the two special kinds of texture.
    let info = info?;
    let transform = info.texture_transform();
    let set = transform.as_ref().and_then(|t| t.tex_coord()).unwrap_or(info.tex_coord());
    let mut use_ = of_texture(material, info.texture().index(), set, None, scene)?;
    if let Some(t) = transform {
        use_.transform = TextureUse::uv_transform(t.offset(), t.rotation(), t.scale());
    }
    Some(use_)
}

/// Use of a texture by a material, with KHR_texture_transform as plain JSON; `None` where the texture has no image.
pub fn of_texture(
    material: &str,
    texture: usize,
    set: u32,
    transform: Option<&Value>,
    scene: &mut Scene,
) -> Option<TextureUse> {
    let (transform, set) = texture_transform(transform, set);
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
