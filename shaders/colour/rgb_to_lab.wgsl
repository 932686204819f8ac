// Working colour to CIELAB; alpha passes.
// Cost: one load and six powers.
#import gpu/grid
#import shared/colour

struct Params {
    /// Factor on the colour axes: 0 is grey, 1 leaves the saturation alone.
    chroma: f32,
}

#params
#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f) -> vec4f {
    let lab = linear_to_lab(srgb_decode(v.rgb));
    return vec4f(lab * vec3f(1.0, params.chroma, params.chroma), v.a);
}
