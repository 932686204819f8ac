// A colour axis of CIELAB and coverage, (a alpha, alpha) or (b alpha, alpha), for line filters. Cost: one load.
#import gpu/grid

struct Params {
    /// 0: a, from green to red; 1: b, from blue to yellow.
    axis: u32,
}

#params
#input lab
#output target_image rg32float

// Colours of surfaces are no farther from grey; light beyond white would drown them.
const MOST: f32 = 128.0;

fn of_pixel(id: vec3u, lab: vec4f) -> vec4f {
    let v = clamp(select(lab.y, lab.z, params.axis == 1u), -MOST, MOST);
    return vec4f(v * lab.a, lab.a, 0.0, 0.0);
}
