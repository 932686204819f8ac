//! Surfaces: materials, textures and samplers.

use glam::{Affine2, Vec2, Vec3, Vec4};

/// Color space in which the bytes of an image are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// sRGB-encoded colour: base colour and emission.
    Srgb,
    /// Plain numbers: normals, roughness, occlusion.
    Linear,
}

/// A decoded image: RGBA, 8 bit, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Name or file name, for messages.
    pub name: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width * height * 4` bytes.
    pub rgba: Vec<u8>,
}

impl Image {
    /// An image of one colour.
    pub fn solid(name: &str, rgba: [u8; 4]) -> Self {
        Self { name: name.to_owned(), width: 1, height: 1, rgba: rgba.to_vec() }
    }
}

/// Continuation of a texture outside of [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Tiles.
    #[default]
    Repeat,
    /// Tiles, every other one mirrored.
    Mirror,
    /// Repeats the edge.
    Clamp,
}

/// Sampling of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// Along U.
    pub wrap_u: Wrap,
    /// Along V.
    pub wrap_v: Wrap,
    /// Interpolate when magnified.
    pub linear_mag: bool,
    /// Interpolate when minified.
    pub linear_min: bool,
    /// Use and blend smaller copies when minified.
    pub mipmaps: bool,
}

impl Default for Sampler {
    fn default() -> Self {
        Self { wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, linear_mag: true, linear_min: true, mipmaps: true }
    }
}

/// An image with a sampler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Index into [`super::Scene::images`]; `None` when it could not be decoded.
    pub image: Option<usize>,
    /// Sampling of it.
    pub sampler: Sampler,
}

/// A texture as a material uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureUse {
    /// Index into [`super::Scene::textures`].
    pub texture: usize,
    /// Number of the set of texture coordinates, 0 or 1.
    pub uv_set: u32,
    /// Applied to the coordinates before sampling (KHR_texture_transform).
    pub transform: Affine2,
}

impl TextureUse {
    /// A texture on the first set of coordinates, untransformed.
    pub fn plain(texture: usize) -> Self {
        Self { texture, uv_set: 0, transform: Affine2::IDENTITY }
    }

    /// The matrix of KHR_texture_transform: scale, then rotate, then offset. The extension turns
    /// counter-clockwise as seen in the image, whose V axis points down, hence the sign.
    pub fn uv_transform(offset: [f32; 2], rotation: f32, scale: [f32; 2]) -> Affine2 {
        Affine2::from_scale_angle_translation(Vec2::ONE, -rotation, Vec2::from(offset))
            * Affine2::from_scale(Vec2::from(scale))
    }
}

/// Treatment of alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Ignored.
    #[default]
    Opaque,
    /// Present where alpha is at least the cutoff.
    Mask {
        /// The cutoff.
        cutoff: f32,
    },
    /// Blended over what lies behind.
    Blend,
}

/// A metallic-roughness surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from the file, or empty.
    pub name: String,
    /// Linear colour and coverage; multiplies the texture and the vertex colour.
    pub base_color: Vec4,
    /// sRGB texture of the base colour.
    pub base_color_texture: Option<TextureUse>,
    /// 0 for dielectrics, 1 for metals; multiplies the texture's blue channel.
    pub metallic: f32,
    /// Perceptual roughness; multiplies the texture's green channel.
    pub roughness: f32,
    /// Share of light that what is no metal reflects straight back.
    pub reflectance: f32,
    /// Linear texture of roughness (G) and metalness (B).
    pub metallic_roughness_texture: Option<TextureUse>,
    /// Linear tangent-space normal map.
    pub normal_texture: Option<TextureUse>,
    /// Multiplies x and y of the normal map.
    pub normal_scale: f32,
    /// Linear texture of ambient occlusion (R).
    pub occlusion_texture: Option<TextureUse>,
    /// 0 ignores the occlusion, 1 applies it fully.
    pub occlusion_strength: f32,
    /// Linear emitted radiance, strength included.
    pub emissive: Vec3,
    /// sRGB texture of the emission.
    pub emissive_texture: Option<TextureUse>,
    /// Treatment of alpha.
    pub alpha_mode: AlphaMode,
    /// True where the back is shown, with its normal turned.
    pub double_sided: bool,
    /// Shows the base colour as it is (KHR_materials_unlit).
    pub unlit: bool,
}

impl Default for Material {
    /// The material glTF gives to primitives without one.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            reflectance: 0.04,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
        }
    }
}

impl Material {
    /// All textures with the colour space each is read in.
    pub fn textures(&self) -> [(Option<TextureUse>, ColorSpace); 5] {
        [
            (self.base_color_texture, ColorSpace::Srgb),
            (self.metallic_roughness_texture, ColorSpace::Linear),
            (self.normal_texture, ColorSpace::Linear),
            (self.occlusion_texture, ColorSpace::Linear),
            (self.emissive_texture, ColorSpace::Srgb),
        ]
    }
}
