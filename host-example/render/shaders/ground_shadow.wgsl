// The shadow of a scene on the ground below it, also where the scene hides it.
// Cost: 40 loads, and where there is shadow 112 comparisons.

@group(1) @binding(0) var shadow_maps: texture_depth_2d_array;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;

// Radius of the light over its distance: shadows grow softer by this as they leave what casts them.
const SOFTNESS = 0.14;
const SEARCHES = 40u;
const SAMPLES = 112u;

// Soft shadows by the mean distance of what is between (Fernando, "Percentage-closer soft shadows", 2005): x is the
// share of the light that is taken, y the radius of its softness, as a share of how far shadows reach. The last map
// holds the whole scene; the ground may lie beyond its far end.
@fragment
fn ground_fragment(in: Ground) -> @location(0) vec2f {
    let map = u32(frame.settings.z) - 1u;
    let matrix = frame.sun_matrices[map];
    let projected = matrix * vec4f(in.position, 1.0);
    let middle = projected.xy * vec2f(0.5, -0.5) + 0.5;
    // Lengths of the map and of its depth per unit of the world.
    let rows = transpose(matrix);
    let scale = 0.5 * vec2f(length(rows[0].xyz), length(rows[1].xyz));
    let depth_scale = length(rows[2].xyz);
    let size = vec2f(textureDimensions(shadow_maps));

    // Samples weigh the less the farther out they are, so that none shows where it enters the shadow.
    let search = SOFTNESS * projected.z / depth_scale * scale;
    var depth = 0.0;
    var found = 0.0;
    for (var i = 0u; i < SEARCHES; i++) {
        let offset = spiral(i, SEARCHES);
        let uv = middle + search * offset;
        if all(uv >= vec2f(0.0)) && all(uv < vec2f(1.0)) {
            let nearest = textureLoad(shadow_maps, vec2u(uv * size), map, 0);
            if nearest < min(projected.z, 1.0) {
                let weight = 1.0 - dot(offset, offset);
                depth += weight * nearest;
                found += weight;
            }
        }
    }
    if found == 0.0 {
        return vec2f(0.0);
    }
    let distance = (projected.z - depth / found) / depth_scale;
    let radius = max(SOFTNESS * distance * scale, 1.5 / size);
    var shadow = 0.0;
    for (var i = 0u; i < SAMPLES; i++) {
        let offset = spiral(i, SAMPLES);
        let uv = middle + 1.2 * radius * offset;
        if all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0)) {
            let share = textureSampleCompareLevel(shadow_maps, shadow_sampler, uv, map, min(projected.z, 1.0));
            shadow += (1.0 - dot(offset, offset)) * (1.0 - share);
        }
    }
    // Long shadows of a low sun fade before the ground ends.
    let away = (in.position.xz - 0.5 * (frame.ground_low.xz + frame.ground_high.xz)) / frame.ground_high.w;
    let fade = 1.0 - smoothstep(0.5, 1.0, length(away));
    let share = frame.ground_low.w * fade * shadow * 2.0 / f32(SAMPLES);
    return vec2f(share, radius.x / scale.x / frame.ground_high.w);
}
