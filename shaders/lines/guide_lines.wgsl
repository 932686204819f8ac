// Adds lines where geometry breaks to the response of the first pass of the flow-based difference of
// Gaussians: across the tangent, it measures how much of a Gaussian window lies past a break of
// normal, depth or object id, and takes that off the response. The second pass then smooths both
// kinds of lines along the same flow. Lines are centred on the break.
//
// normal: 1 - cos of the angle between neighbours. depth: 1/z is linear in x and y over any plane, so
// |z0/z+ + z0/z- - 2| is 0 on planes however slanted, and has no scale. object id: different or not.
// Cost: up to 6 loads and one exponential per step, about 3 k sigma_e steps.
#import grid
#import tensor

struct Params {
    // -1 / (2 sigma^2) of the Gaussian across the line.
    narrow: f32,
    // Cut-off, in pixels.
    halfwidth: f32,
    // Units of response that a window wholly past a break takes off.
    amount: f32,
    // Bit 0: normal, bit 1: depth, bit 2: object id are there.
    guides: u32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var response: texture_2d<f32>;
// (E - G, F), see orientation_field.
@group(0) @binding(3) var field: texture_2d<f32>;
@group(0) @binding(4) var normal: texture_2d<f32>;
@group(0) @binding(5) var depth: texture_2d<f32>;
@group(0) @binding(6) var object_id: texture_2d<f32>;
@group(0) @binding(7) var target_image: texture_storage_2d<rg32float, write>;

// False for NaN and infinities, by bits: shader compilers may assume that they do not exist.
fn is_finite(v: f32) -> bool {
    return (bitcast<u32>(v) & 0x7f800000u) != 0x7f800000u;
}

// The normal, all zero where there is none.
fn normal_at(p: vec2i) -> vec3f {
    let v = fetch(normal, 2u, p);
    let valid = is_finite(v.x) && is_finite(v.y) && is_finite(v.z) && v.w > 0.5;
    return select(vec3f(0.0), v.xyz, valid);
}

// Depth, 0 where there is nothing.
fn depth_at(p: vec2i) -> f32 {
    let z = fetch(depth, 3u, p).x;
    return select(0.0, z, is_finite(z) && z > 0.0);
}

fn id_at(p: vec2i) -> f32 {
    let v = fetch(object_id, 4u, p).x;
    return select(0.0, v, is_finite(v));
}

// 0 for equal directions or two missing normals, 1 for perpendicular ones or one that is missing.
fn normal_break(a: vec3f, b: vec3f) -> f32 {
    let aa = dot(a, a);
    let bb = dot(b, b);
    if aa <= 0.0 || bb <= 0.0 {
        return select(0.0, 1.0, aa > 0.0 || bb > 0.0);
    }
    let turn = 1.0 - dot(a, b) / sqrt(aa * bb);
    // Below 18 degrees it is relief of the surface, from 41 degrees on an edge.
    let t = clamp((turn - 0.05) * 5.0, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// Nearness relative to the pixel itself, 0..2; two empty places are equally near.
fn relative_nearness(z0: f32, z: f32) -> f32 {
    if z0 <= 0.0 {
        return select(1.0, 2.0, z > 0.0);
    }
    return select(0.0, min(z0 / z, 2.0), z > 0.0);
}

fn depth_break(z0: f32, ahead: f32, behind: f32) -> f32 {
    let bend = abs(relative_nearness(z0, ahead) + relative_nearness(z0, behind) - 2.0);
    // A step of 2 % is relief, one of 12 % an edge.
    let t = clamp((bend - 0.02) * 10.0, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// The pixel nearest to the place k steps along the main axis and k * slope across it. Ties are
// decided off the middle, so that rounding does not.
fn place(p: vec2i, upright: bool, k: i32, slope: f32) -> vec2i {
    let i = i32(floor(f32(k) * slope + 0.502));
    return p + select(vec2i(k, i), vec2i(i, k), upright);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let t = tensor_tangent(fetch(field, 1u, p));
    let upright = abs(t.x) > abs(t.y);
    let slope = select(-t.x / t.y, -t.y / t.x, upright);
    let ds = sqrt(1.0 + slope * slope);
    let n0 = normal_at(p);
    let z0 = depth_at(p);
    let id0 = id_at(p);

    // Breaks of normal, depth and object id.
    var sums = vec3f(0.0);
    var weights = 1.0;
    for (var k = 1; f32(k) * ds <= params.halfwidth; k++) {
        let d = f32(k) * ds;
        let w = exp(params.narrow * d * d);
        let ahead = place(p, upright, k, slope);
        let behind = place(p, upright, -k, slope);
        weights += 2.0 * w;
        if (params.guides & 1u) != 0u {
            sums.x += w * (normal_break(n0, normal_at(ahead)) + normal_break(n0, normal_at(behind)));
        }
        if (params.guides & 2u) != 0u {
            sums.y += w * depth_break(z0, depth_at(ahead), depth_at(behind));
        }
        if (params.guides & 4u) != 0u {
            sums.z += w * (select(0.0, 1.0, id_at(ahead) != id0) + select(0.0, 1.0, id_at(behind) != id0));
        }
    }
    let past = max(max(sums.x, sums.y), sums.z) / weights;
    let v = fetch(response, 0u, p).xy;
    textureStore(target_image, vec2i(id.xy), vec4f(v.x - params.amount * past * v.y, v.y, 0.0, 0.0));
}
