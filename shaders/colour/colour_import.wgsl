// The host's colour to the working colour: finite, not premultiplied, gamma-encoded Rec. 709.
// Cost: one load and three powers.
#import gpu/grid
#import shared/colour
#import shared/host_colour

struct Params {
    /// 0 sRGB, 1 linear Rec. 709, 2 ACEScg.
    space: u32,
    /// 1 when colour comes multiplied by alpha; 2 when light beyond coverage is left out as well.
    premultiplied: u32,
}

#params
#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, source: vec4f) -> vec4f {
    var v = plain(source, params.premultiplied);
    if params.space == 2u {
        v = vec4f(acescg_to_linear(v.rgb), v.a);
    }
    if params.space != 0u {
        v = vec4f(srgb_encode(v.rgb), v.a);
    }
    return v;
}
