// Merges a level of the multi-scale Kuwahara filter with the result of the coarser one (thesis § 5.5.2):
// what varied much there stays as it is, the rest takes the coarser result, interpolated.
// What lies on an edge may stay as well, since nothing may be painted across it.
// Cost: 10 loads and 65 operations.
#import shared/sampling
#import shared/coverage

struct Params {
    /// p_s p_d^k at this level.
    gain: f32,
    /// tau_v: deviations up to this, times the gain, count for nothing.
    threshold: f32,
    /// Gradient from which on a place lies on an edge; below 0: none does.
    edge: f32,
    /// 1 / how much steeper edges are kept as they are.
    inverse_ramp: f32,
}

#params
#input source, coarse, deviations, structure
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(coarse);
    let original = fetch(source, 0u, pixel(id));
    let at = centre(id) * 0.5;
    let filtered = sample_covered(coarse, 1u, at);
    let deviation = sample_linear(deviations, 2u, at).x;
    var beta = clamp(deviation * params.gain - params.threshold, 0.0, 1.0);
    if params.edge >= 0.0 {
        let t = fetch(structure, 3u, pixel(id));
        beta = max(beta, clamp((sqrt(max(t.x + t.z, 0.0)) - params.edge) * params.inverse_ramp, 0.0, 1.0));
    }
    if filtered.a < 1e-3 {
        beta = 1.0;
    }
    let below = filtered.rgb / max(filtered.a, 1e-3);
    textureStore(target_image, vec2i(id.xy), vec4f(below + (original.rgb - below) * beta, original.a));
}
