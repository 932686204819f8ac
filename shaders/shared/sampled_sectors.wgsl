#import shared/sectors
#import gpu/sector_weights

// Sectors whose weighting functions are sampled (thesis § 5.3, 5.4.2), for shaders whose parameters hold
// `weights`: h_0 and its quarter turns at 43 x 22 nodes over the half y >= 0 of the disc's bounding square. They call
// `sector_weights_load` first.
// Twin of kernels/shared/sampled_sectors.rs.
//
// The four weights a quarter turn apart are one texel; those between them lie at positions turned by 45
// degrees. Two pixels opposite each other share one evaluation of the weights, whose order is turned by
// half for the second. All sums are vectors of four sectors, so that eight sectors take one pass.

// Texel `at` and its right neighbour, interpolated.
fn sector_texels(at: u32, f: f32) -> vec4f {
    return mix(sector_weights_at(at), sector_weights_at(at + 1u), f);
}

// The four weights at a point of the unit disc, interpolated. The lower half mirrors the upper one, with
// the second and the fourth sector exchanged.
fn sector_table(v: vec2f) -> vec4f {
    let p = vec2f(max((v.x + 1.0) * 21.0, 0.0), abs(v.y) * 21.0);
    let corner = min(floor(p), vec2f(41.0, 20.0));
    let f = min(p - corner, vec2f(1.0));
    let at = u32(corner.y) * 43u + u32(corner.x);
    let w = mix(sector_texels(at, f.x), sector_texels(at + 43u, f.x), f.y);
    return select(w, w.xwzy, v.y < 0.0);
}

// Adds the pixel at v of the unit disc, of colour c0 relative to the centre's and coverage a0, and the one
// opposite it; `full`: the sums of the weights without regard to coverage.
fn sampled_add(
    sums: ptr<function, SectorSums>,
    full: ptr<function, vec4f>,
    v: vec2f,
    c0: vec3f,
    a0: f32,
    c1: vec3f,
    a1: f32,
) {
    let w = sector_table(v);
    sector_add(sums, w, c0, a0);
    sector_add(sums, w.zwxy, c1, a1);
    *full += w + w.zwxy;
}

// v turned by 45 degrees, to the weights of the sectors between the others.
fn sector_between(v: vec2f) -> vec2f {
    return vec2f(v.x + v.y, v.y - v.x) * 0.70710678;
}
