// Breaks of geometry between neighbouring pixels. Twin of kernels/shared/breaks.rs.
//
// normal: 1 - cos of the angle. depth: 1/z is linear in x and y over any plane, so |z0/z+ + z0/z- - 2|
// is 0 on planes however slanted, and has no scale. object id: different or not.

// False for NaN and infinities, by bits: shader compilers may assume that they do not exist.
fn is_finite(v: f32) -> bool {
    return (bitcast<u32>(v) & 0x7f800000u) != 0x7f800000u;
}

// A normal, all zero where there is none.
fn known_normal(v: vec4f) -> vec3f {
    let valid = is_finite(v.x) && is_finite(v.y) && is_finite(v.z) && v.w > 0.5;
    return select(vec3f(0.0), v.xyz, valid);
}

// Depth, 0 where there is nothing.
fn known_depth(z: f32) -> f32 {
    return select(0.0, z, is_finite(z) && z > 0.0);
}

fn known_id(v: f32) -> f32 {
    return select(0.0, v, is_finite(v));
}

// How far two directions differ, 0 for equal and 1 for perpendicular ones, and 1 where one is missing and the other not.
fn normal_break(a: vec3f, b: vec3f) -> vec2f {
    let aa = dot(a, a);
    let bb = dot(b, b);
    if aa <= 0.0 || bb <= 0.0 {
        return vec2f(0.0, select(0.0, 1.0, aa > 0.0 || bb > 0.0));
    }
    let turn = 1.0 - dot(a, b) / sqrt(aa * bb);
    // Below 10 degrees a pixel it is relief of the surface, from 31 degrees on an edge.
    let t = clamp((turn - 0.015) * 8.0, 0.0, 1.0);
    return vec2f(t * t * (3.0 - 2.0 * t), 0.0);
}

// Nearness relative to the pixel itself, 0..2; two empty places are equally near.
fn relative_nearness(z0: f32, z: f32) -> f32 {
    if z0 <= 0.0 {
        return select(1.0, 2.0, z > 0.0);
    }
    return select(0.0, min(z0 / z, 2.0), z > 0.0);
}

// How far depth at the middle one of three pixels is from a plane through its neighbours.
fn depth_bend(before: f32, z0: f32, after: f32) -> f32 {
    return abs(relative_nearness(z0, before) + relative_nearness(z0, after) - 2.0);
}

// 1/z, 0 where there is nothing.
fn nearness(z: f32) -> f32 {
    return select(0.0, 1.0 / max(z, 1e-30), z > 0.0);
}

// How far two surfaces are apart in depth half-way between two pixels that are three apart: relative jump of 1/z from the plane
// through the first of them and one two pixels before it to that through the others. Depth may be smoothed between them.
fn depth_apart(nearnesses: vec4f) -> f32 {
    let before = nearnesses.y + 0.75 * (nearnesses.y - nearnesses.x);
    let after = nearnesses.z + 0.75 * (nearnesses.z - nearnesses.w);
    return abs(after - before) / max(max(abs(before), abs(after)), 1e-30);
}

// Relative jump of nearness from which on two surfaces do not touch.
const APART: f32 = 0.06;

// Both pixels at a jump lie off the plane of their neighbours.
fn depth_break(bend: f32, next_bend: f32) -> f32 {
    // A step of 2 % is relief, one of 12 % an edge.
    let t = clamp((min(bend, next_bend) - 0.02) * 10.0, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}
