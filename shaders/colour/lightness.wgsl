// Lightness L (0..100) and coverage of a colour, as (L alpha, alpha): what the line filters work on.
// Both are linear, so that smoothing and interpolation weight by coverage of themselves.
// Cost: one load and four powers; one for a host's linear light, none when the source is Lab already.
#import gpu/grid
#import shared/colour
#import shared/host_colour

struct Params {
    /// 0 working colour, 1 Lab, 2 the host's colour.
    source_space: u32,
    /// The host's colour space: 0 sRGB, 1 linear Rec. 709, 2 ACEScg.
    space: u32,
    /// Nonzero when the host's colour comes multiplied by alpha.
    premultiplied: u32,
}

#params
#input source
#output target_image rg32float

fn of_pixel(id: vec3u, source: vec4f) -> vec4f {
    var v = source;
    if params.source_space != 1u {
        let host = params.source_space == 2u;
        if host {
            v = plain(v, params.premultiplied);
        }
        var linear = v.rgb;
        if !host || params.space == 0u {
            linear = srgb_decode(v.rgb);
        } else if params.space == 2u {
            linear = acescg_to_linear(v.rgb);
        }
        let y = dot(linear, vec3f(0.2126729, 0.7151522, 0.0721750));
        v.x = 116.0 * lab_curve(vec3f(y)).x - 16.0;
    }
    return vec4f(v.x * v.a, v.a, 0.0, 0.0);
}
