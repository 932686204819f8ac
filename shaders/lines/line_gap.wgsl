// Share of lines that stays, in alpha: none where a nearer thing's outline is within a distance, but for that outline itself.
// Cost: three loads and a division.
#import gpu/grid
#import shared/breaks

#input depth
// Nearness of what stands in front, within the width of its outline, and within that and the gap.
#input beside, around
#output target_image rgba32float

// Nearness of what is not in front of a pixel, against its own.
const SAME: f32 = 1.04;

fn of_pixel(id: vec3u, depth: vec4f, beside: vec4f, around: vec4f) -> vec4f {
    let z = known_depth(depth.x);
    let own = SAME * nearness(z);
    // The outline of the nearest thing, not that of another one behind it.
    let is_line = beside.x > own && beside.x * SAME >= around.x;
    let is_behind = around.x > own;
    return vec4f(0.0, 0.0, 0.0, select(1.0, 0.0, is_behind && !is_line));
}
