// A picture between one and another, whose difference counts by the factor of a channel of a control map.
// Cost: three loads and an exponential.
#import gpu/grid
#import shared/control

struct Params {
    /// Channel of the map, 0 to 3.
    channel: u32,
    /// 1: the factor grows with the channel; -1: it falls.
    sense: f32,
    /// The factor at most.
    most: f32,
}

#params
#input first, second, control
#output target_image rgba32float

fn of_pixel(id: vec3u, first: vec4f, second: vec4f, control: vec4f) -> vec4f {
    let value = 0.5 + params.sense * (control[params.channel] - 0.5);
    let factor = min(control_factor(value), params.most);
    // Where nothing changes, not the last bit does.
    return second + (second - first) * (factor - 1.0);
}
