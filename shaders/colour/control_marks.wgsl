// Marks of a medium where a control map says how much of it there is: what they leave bare is raised to the factor of the
// map's fourth channel, as if they were drawn that many times.
// Cost: two loads, a logarithm and two exponentials.
#import gpu/grid
#import shared/control

// The share of the paper that marks cover, and the map.
#input marks, control
#output target_image r32float

fn of_pixel(id: vec3u, marks: vec4f, control: vec4f) -> vec4f {
    let factor = control_factor(control.w);
    let bare = clamp(1.0 - marks.x, 1e-6, 1.0);
    let covered = 1.0 - exp(factor * log(bare));
    return vec4f(select(marks.x, covered, factor != 1.0 && marks.x > 0.0), 0.0, 0.0, 0.0);
}
