// From scene-linear radiance to linear display light in [0, 1]: exposure, then the Khronos PBR Neutral tone
// mapper, which keeps the colours of materials and compresses only highlights. A colour of the user's choice is
// put behind afterwards, so that it stays what it is.

struct Settings {
    // x is the exposure, y 1 where the radiance has transparent parts.
    exposure: vec4f,
    // What is behind those, premultiplied display light.
    behind: vec4f,
}

@group(0) @binding(0) var<uniform> settings: Settings;
@group(0) @binding(1) var radiance: texture_2d<f32>;
@group(0) @binding(2) var diffuse: texture_2d<f32>;
@group(0) @binding(3) var specular: texture_2d<f32>;

fn corner(index: u32) -> vec4f {
    return vec4f(vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@vertex
fn tone_map_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner(index);
}

const COMPRESSION_START = 0.76;
const DESATURATION = 0.15;

fn neutral(input: vec3f) -> vec3f {
    let darkest = min(input.r, min(input.g, input.b));
    let offset = select(0.04, darkest - 6.25 * darkest * darkest, darkest < 0.08);
    let color = input - offset;
    let peak = max(color.r, max(color.g, color.b));
    if peak < COMPRESSION_START {
        return color;
    }
    let room = 1.0 - COMPRESSION_START;
    let compressed = 1.0 - room * room / (peak + room - COMPRESSION_START);
    let share = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    return mix(color * compressed / peak, vec3f(compressed), share);
}

@fragment
fn tone_map_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = textureLoad(radiance, vec2u(position.xy), 0);
    if settings.exposure.y < 0.5 {
        return vec4f(neutral(max(texel.rgb, vec3f(0.0)) * settings.exposure.x), 1.0);
    }
    let alpha = saturate(texel.a);
    let color = max(texel.rgb, vec3f(0.0)) / max(alpha, 1e-4);
    return vec4f(neutral(color * settings.exposure.x) * alpha, alpha) + (1.0 - alpha) * settings.behind;
}

@vertex
fn tone_map_light_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner(index);
}

struct Light {
    @location(0) diffuse: vec4f,
    @location(1) specular: vec4f,
}

// Light of surfaces in the share that tone mapping leaves of all light: layers that add up to the radiance add up
// to its colour.
@fragment
fn tone_map_light_fragment(@builtin(position) position: vec4f) -> Light {
    let place = vec2u(position.xy);
    let texel = textureLoad(radiance, place, 0);
    let alpha = select(1.0, max(saturate(texel.a), 1e-4), settings.exposure.y >= 0.5);
    let whole = max(texel.rgb, vec3f(0.0)) / alpha * settings.exposure.x;
    let share = select(vec3f(0.0), neutral(whole) / whole, whole > vec3f(0.0)) * settings.exposure.x;
    let spread = textureLoad(diffuse, place, 0);
    let mirrored = textureLoad(specular, place, 0);
    return Light(vec4f(spread.rgb * share, spread.a), vec4f(mirrored.rgb * share, mirrored.a));
}
