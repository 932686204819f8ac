// Response of a line filter with more or fewer lines, as a control map says: differences from the lightness beneath count by
// its factor, and not at all where it is 0.
// Cost: three loads and an exponential.
#import gpu/grid
#import shared/control

struct Params {
    /// Weight of the lightness in the response.
    base: f32,
    /// Inverse of the share of the way from 0 to neutral over which lines fade to none.
    fade: f32,
}

#params
// (u alpha, alpha), (L alpha, alpha) and the map.
#input response, lightness, control
#output target_image rg32float

fn of_pixel(id: vec3u, response: vec4f, lightness: vec4f, control: vec4f) -> vec4f {
    // What is not a number is neutral, and so does not fade.
    let step = control_step(control.z);
    let factor = control_factor(control.z) * min((step + 1.0) * params.fade, 1.0);
    let difference = response.x - params.base * lightness.x;
    return vec4f(response.x + difference * (factor - 1.0), response.y, 0.0, 0.0);
}
