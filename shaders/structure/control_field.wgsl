// The orientation of a picture with a factor for each pixel, of a channel of a control map, in the fourth channel: what
// lines and smoothing read along with the direction that they follow.
// Cost: two loads and an exponential.
#import gpu/grid
#import shared/control

struct Params {
    /// Channel of the map, 0 to 3.
    channel: u32,
    /// 1: the factor grows with the channel; -1: it falls.
    sense: f32,
    /// The factor at least.
    least: f32,
}

#params
// (E - G, F), see orientation_field, and the map.
#input field, control
#output target_image rgba32float

fn of_pixel(id: vec3u, field: vec4f, control: vec4f) -> vec4f {
    let value = 0.5 + params.sense * (control[params.channel] - 0.5);
    return vec4f(field.xy, 0.0, max(control_factor(value), params.least));
}
