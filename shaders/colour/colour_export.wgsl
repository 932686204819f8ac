// The working colour back to the host's colour.
// Cost: one load and three powers.
#import gpu/grid
#import shared/colour

struct Params {
    /// 0 sRGB, 1 linear Rec. 709, 2 ACEScg.
    space: u32,
    /// Nonzero when colour leaves multiplied by alpha.
    premultiplied: u32,
}

#params
#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, source: vec4f) -> vec4f {
    var v = source;
    if params.space != 0u {
        v = vec4f(srgb_decode(v.rgb), v.a);
    }
    if params.space == 2u {
        v = vec4f(linear_to_acescg(v.rgb), v.a);
    }
    if params.premultiplied != 0u {
        v = vec4f(v.rgb * v.a, v.a);
    }
    return v;
}
