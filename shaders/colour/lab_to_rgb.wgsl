// CIELAB to working colour; alpha passes.
// Cost: one load and three powers.
#import gpu/grid
#import shared/colour

struct Params {
    /// Factor on the colour axes: 0 is grey, 1 leaves the saturation alone.
    chroma: f32,
}

#params
#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, lab: vec4f) -> vec4f {
    let linear = lab_to_linear(lab.rgb * vec3f(1.0, params.chroma, params.chroma));
    return vec4f(srgb_encode(linear), lab.a);
}
