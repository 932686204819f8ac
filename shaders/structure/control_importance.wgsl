// A control map of how much places matter: less detail and fewer lines where it is little. What an artist painted adds to it.
// Cost: two loads.
#import gpu/grid
#import shared/control

struct Params {
    /// Factor on the map, 0..1.
    strength: f32,
    /// Nonzero: the second image is a map that an artist painted.
    painted: u32,
}

#params
#input importance, control
#output target_image rgba32float

// Importance that changes nothing.
const NEUTRAL_IMPORTANCE: f32 = 0.5;
// Growth of detail where importance is greatest, of what it falls by where there is none.
const MORE: f32 = 0.5;
// Share by which lines become fewer for what detail is lost.
const FEWER: f32 = 0.6;

fn of_pixel(id: vec3u, importance: vec4f, control: vec4f) -> vec4f {
    let detail = params.strength * clamp(importance.x / NEUTRAL_IMPORTANCE - 1.0, -1.0, MORE);
    let painted = select(vec4f(0.5), control, params.painted != 0u);
    return vec4f(
        control_sum(painted.x, detail),
        control_sum(painted.y, 0.0),
        control_sum(painted.z, FEWER * min(detail, 0.0)),
        control_sum(painted.w, 0.0),
    );
}
