// Hysteresis (section 4.1): weak candidates become strong when a chain of candidates, at most `steps` pixels
// long, joins them to a strong one. Several passes reach farther.
//
// A workgroup holds 32 x 32 pixels as one word a row: a step of all its chains is a few operations on words.
// Cost: 16 loads and 3 operations per step and invocation.
#import gpu/grid

struct Params {
    /// Length of the chains, pixels; at most 12.
    steps: u32,
    /// What is written where there is no candidate.
    none: f32,
    /// What is written for a weak candidate.
    weak: f32,
    /// What is written for a strong candidate.
    strong: f32,
}

#params
#input candidates
#output target_image r32float

// Half rows while they are read; bit 0 is the leftmost pixel.
var<workgroup> candidate_halves: array<u32, 64>;
var<workgroup> strong_halves: array<u32, 64>;
var<workgroup> strong_rows: array<u32, 32>;

fn main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) index: u32,
) {
    let corner = grid.origin + vec2i(group.xy * 8u) - 12;
    let half = vec2i(i32(index & 1u) * 16, i32(index >> 1u));
    var any_candidates = 0u;
    var any_strong = 0u;
    for (var i = 0; i < 16; i++) {
        let v = fetch(candidates, 0u, corner + half + vec2i(i, 0)).x;
        any_candidates |= select(0u, 1u << u32(i), v >= 1.0);
        any_strong |= select(0u, 1u << u32(i), v >= 2.0);
    }
    candidate_halves[index] = any_candidates;
    strong_halves[index] = any_strong;
    workgroupBarrier();
    // The first 32 invocations have a row each; the others go along.
    let row = index & 31u;
    let allowed = candidate_halves[2u * row] | (candidate_halves[2u * row + 1u] << 16u);
    var reached = strong_halves[2u * row] | (strong_halves[2u * row + 1u] << 16u);
    if index < 32u {
        strong_rows[row] = reached;
    }
    workgroupBarrier();
    for (var i = 0u; i < params.steps; i++) {
        let near = reached | strong_rows[max(row, 1u) - 1u] | strong_rows[min(row + 1u, 31u)];
        reached = (near | (near << 1u) | (near >> 1u)) & allowed;
        workgroupBarrier();
        if index < 32u {
            strong_rows[row] = reached;
        }
        workgroupBarrier();
    }
    if outside(id) {
        return;
    }
    let own_row = 12u + (index >> 3u);
    let own_bit = 12u + (index & 7u);
    let own = candidate_halves[2u * own_row] | (candidate_halves[2u * own_row + 1u] << 16u);
    var result = params.none;
    if ((own >> own_bit) & 1u) != 0u {
        result = select(params.weak, params.strong, ((strong_rows[own_row] >> own_bit) & 1u) != 0u);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(result));
}
