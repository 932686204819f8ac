// What is seen and known of the shadow on the ground. Of the ground itself nothing is seen: it makes what is behind it
// darker, and more opaque where that is transparent.

// As `ground_shadow.wgsl` leaves it.
@group(1) @binding(0) var ground_shadow: texture_2d<f32>;
@group(1) @binding(1) var ground_sampler: sampler;

const TAPS = 24u;

// Radius, in that of the softness, of the disc over which the shadow is smoothed: the distance of its samples, whose
// borders show as ripples otherwise.
const SPREAD = 0.3;

// Shadow below this is none to the guides.
const FAINTEST = 0.002;

// Share of the light that is taken at a point of the ground.
fn shadow_at(position: vec3f) -> f32 {
    let clip = frame.view_projection * vec4f(position, 1.0);
    let own = textureSampleLevel(ground_shadow, ground_sampler, place(clip), 0.0);
    let radius = SPREAD * own.y * frame.ground_high.w;
    // The disc faces the sun, and its points are where the sun throws them.
    let rows = transpose(frame.sun_matrices[u32(frame.settings.z) - 1u]);
    let u = rows[0].xz / length(rows[0].xyz);
    let v = rows[1].xz / length(rows[1].xyz);
    let area = u.x * v.y - u.y * v.x;
    let x = frame.view_projection * vec4f(v.y, 0.0, -v.x, 0.0) / area;
    let y = frame.view_projection * vec4f(-u.y, 0.0, u.x, 0.0) / area;
    var sum = 0.0;
    for (var i = 0u; i < TAPS; i++) {
        let offset = spiral(i, TAPS);
        let there = clip + radius * (x * offset.x + y * offset.y);
        sum += (1.0 - dot(offset, offset)) * textureSampleLevel(ground_shadow, ground_sampler, place(there), 0.0).x;
    }
    return sum * 2.0 / f32(TAPS);
}

// Place of a point in the texture.
fn place(clip: vec4f) -> vec2f {
    return clip.xy / max(clip.w, 1e-6) * vec2f(0.5, -0.5) + 0.5;
}

@fragment
fn ground_surface_fragment(in: Ground) -> @location(0) vec4f {
    return vec4f(0.0, 0.0, 0.0, shadow_at(in.position));
}

// The ground lies still: its motion is that of the camera, as in `geometry_buffer.wgsl`.
@fragment
fn ground_motion_fragment(in: Ground) -> @location(3) vec2f {
    if shadow_at(in.position) < FAINTEST {
        discard;
    }
    let now = frame.view_projection * vec4f(in.position, 1.0);
    let before = frame.previous_view_projection * vec4f(in.position, 1.0);
    let earlier = select(now.xy / now.w, before.xy / before.w, before.w > 0.0);
    return (earlier - now.xy / now.w) * vec2f(0.5, -0.5) * frame.size.xy;
}

@fragment
fn ground_rest_fragment(in: Ground) -> @location(0) vec4f {
    if shadow_at(in.position) < FAINTEST {
        discard;
    }
    return vec4f(in.position, 1.0);
}
