// Light of a picture that is no light on surfaces: the sky, and what glows by itself.
// Cost: four loads, seven powers and about 40 multiply-adds.
#import gpu/grid
#import shared/colour

struct Params {
    /// 1 where diffuse and mirrored light are both there, and the rest of the picture is what they leave; 0 where the rest is
    /// what has no surface colour.
    complete: u32,
}

#params
#input source, albedo, diffuse, specular
#output target_image rgba32float

// Colours of surfaces from which on they count as such: 1 / this.
const PRESENT: f32 = 50.0;

// Rounding of three layers to halves.
const ROUNDING: f32 = 1.004;

// Linear light of a layer, as far as it covers the picture's pixel.
fn covered(layer: vec4f, alpha: f32) -> vec3f {
    return srgb_decode(layer.rgb) * saturate(layer.a / max(alpha, 1e-4));
}

fn of_pixel(id: vec3u, source: vec4f, albedo: vec4f, diffuse: vec4f, specular: vec4f) -> vec4f {
    let all = srgb_decode(source.rgb);
    let surface = covered(albedo, source.a);
    let absent = saturate(1.0 - PRESENT * max(max(surface.r, surface.g), surface.b));
    var rest = all * absent;
    if params.complete != 0u {
        let mirrored = covered(specular, source.a);
        let explained = (covered(diffuse, source.a) + mirrored) * ROUNDING;
        // Surfaces of no colour, such as metals in some renderers, show what they mirror.
        rest = max(all - explained, vec3f(0.0)) + max(mirrored, vec3f(0.0)) * absent;
    }
    return vec4f(srgb_encode(rest), source.a);
}
