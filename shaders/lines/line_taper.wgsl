// Lines that run out into a point: narrower towards their ends, where less of them lies along the flow than around their middle.
// Cost: four loads and two divisions.
#import gpu/grid

// 1 = paper, 0 = line.
#input edges
// In the first channel: the same smoothed in all directions, and of that the mean along the flow and the least around.
#input soft, along, darkest
#output target_image r32float

// Share of a line below which nothing is known of it.
const LEAST_SHARE: f32 = 0.05;

fn of_pixel(id: vec3u, edges: vec4f, soft: vec4f, along: vec4f, darkest: vec4f) -> vec4f {
    let line = 1.0 - clamp(edges.x, 0.0, 1.0);
    // A half of the line lies along the flow at its end, and nearly all of it within.
    let left = (1.0 - along.x) / max(1.0 - soft.x, LEAST_SHARE);
    let inside = clamp((left - 0.5) * 2.857, 0.0, 1.0);
    // 1 on the middle of the line, and about two thirds at its borders.
    let height = (1.0 - soft.x) / max(1.0 - darkest.x, LEAST_SHARE);
    let narrow = clamp((height - mix(1.02, 0.6, inside)) * 12.0, 0.0, 1.0);
    let kept = mix(narrow, 1.0, clamp((inside - 0.8) * 5.0, 0.0, 1.0));
    return vec4f(1.0 - line * kept, 0.0, 0.0, 0.0);
}
