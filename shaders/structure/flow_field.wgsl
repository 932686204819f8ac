// A painted flow map as tensors of trace 1 at most: the tangent is the painted direction, the trace its strength.
// Cost: one load and about 15 operations.
#import gpu/grid
#import shared/host_colour

struct Params {
    /// Factor on the strength.
    strength: f32,
    /// Nonzero where green grows upwards.
    invert_y: u32,
}

#params
#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, source: vec4f) -> vec4f {
    let v = clamp(finite(source), vec4f(0.0), vec4f(1.0));
    var d = 2.0 * v.rg - 1.0;
    if params.invert_y != 0u {
        d.y = -d.y;
    }
    let square = dot(d, d);
    let length = sqrt(square);
    // Eight bits have no exact half: less than one and a half of their steps is no direction.
    let weight = select(0.0, clamp(params.strength * v.a * min(length, 1.0), 0.0, 1.0), length > FLOW_LEAST);
    let scale = weight / max(square, 1e-12);
    return vec4f(scale * d.y * d.y, -scale * d.x * d.y, scale * d.x * d.x, weight);
}

// Length up to which a painted vector stands for none.
const FLOW_LEAST: f32 = 0.012;
