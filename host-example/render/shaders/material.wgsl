// The material of a draw and the sampling of its textures.

struct Material {
    base_color: vec4f,
    emissive: vec4f,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    alpha_cutoff: f32,
    flags: u32,
    // Bit i: texture i uses the second set of coordinates.
    uv_sets: u32,
    // Share of light that what is no metal reflects straight back.
    reflectance: f32,
    // Two rows of the affine transform of each texture's coordinates.
    transforms: array<vec4f, 10>,
}

const HAS_BASE_COLOR = 1u;
const HAS_METALLIC_ROUGHNESS = 2u;
const HAS_NORMAL = 4u;
const HAS_OCCLUSION = 8u;
const HAS_EMISSIVE = 16u;
const UNLIT = 32u;

@group(2) @binding(0) var<uniform> material: Material;
@group(2) @binding(1) var base_color_texture: texture_2d<f32>;
@group(2) @binding(2) var metallic_roughness_texture: texture_2d<f32>;
@group(2) @binding(3) var normal_texture: texture_2d<f32>;
@group(2) @binding(4) var occlusion_texture: texture_2d<f32>;
@group(2) @binding(5) var emissive_texture: texture_2d<f32>;
@group(2) @binding(6) var base_color_sampler: sampler;
@group(2) @binding(7) var metallic_roughness_sampler: sampler;
@group(2) @binding(8) var normal_sampler: sampler;
@group(2) @binding(9) var occlusion_sampler: sampler;
@group(2) @binding(10) var emissive_sampler: sampler;

fn has(flag: u32) -> bool {
    return (material.flags & flag) != 0u;
}

fn coordinates(index: u32, uv0: vec2f, uv1: vec2f) -> vec2f {
    let uv = vec3f(select(uv0, uv1, (material.uv_sets & (1u << index)) != 0u), 1.0);
    return vec2f(dot(material.transforms[2u * index].xyz, uv), dot(material.transforms[2u * index + 1u].xyz, uv));
}

fn base_color(uv0: vec2f, uv1: vec2f, vertex_color: vec4f) -> vec4f {
    var color = material.base_color * vertex_color;
    if has(HAS_BASE_COLOR) {
        color *= textureSample(base_color_texture, base_color_sampler, coordinates(0u, uv0, uv1));
    }
    return color;
}
