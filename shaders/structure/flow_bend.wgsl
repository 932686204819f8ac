// Tensors bent towards a smoothed flow field.
// Cost: two loads and about 15 operations.
#import gpu/grid

#input source, flow
#output target_image rgba32float

// Trace that painted orientation has where the picture has none: (1/255)^2, one step of eight bits a pixel.
const LEAST_TRACE: f32 = 1.5378701e-5;

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let own = fetch(source, 0u, pixel(id));
    let painted = fetch(flow, 1u, pixel(id));
    let share = clamp(painted.w, 0.0, 1.0);
    let trace = max(own.x + own.z, LEAST_TRACE);
    let bent = (1.0 - share) * own.xyz + trace * painted.xyz;
    textureStore(target_image, vec2i(id.xy), vec4f(bent, own.w + (1.0 - own.w) * share));
}
