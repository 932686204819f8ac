// Surround inhibition (Grigorescu, Petkov and Westenberg 2003): lines yield where many lines are around, weak ones first.
// Those of the pixel's own orientation count less, since a contour must not inhibit itself; and lines that
// stand together more closely than those around, as in an eye or a letter, excuse each other.
// Cost: five loads and 40 operations.
#import gpu/grid
#import shared/tensor

struct Params {
    /// Weight of the lightness in the response.
    base: f32,
    /// Lightness that counts at least, units of L.
    least: f32,
    /// Response that is taken off lines per unit of energy around.
    inhibition: f32,
    /// Weight of lines of the own orientation.
    own: f32,
    /// Energy around that a unit of it close by excuses.
    excused: f32,
}

#params
// (u alpha, alpha), (L alpha, alpha), (E - G, F), the energy of lines around and close by.
#input response, lightness, field, surround, near
#output target_image rg32float

fn of_pixel(
    id: vec3u,
    response: vec4f,
    lightness: vec4f,
    field: vec4f,
    surround: vec4f,
    near: vec4f,
) -> vec4f {
    let ground = params.base * max(lightness.x, params.least * lightness.y);
    let across = tensor_axis(0.5 * field.x, field.y).major;
    let own = across.x * (surround.x * across.x + 2.0 * surround.y * across.y) + surround.z * across.y * across.y;
    let around = surround.x + surround.z + (params.own - 1.0) * own;
    let excess = max(around - params.excused * (near.x + near.z), 0.0);
    let raised = response.x + params.inhibition * excess;
    return vec4f(select(response.x, min(raised, ground), response.x < ground), response.y, 0.0, 0.0);
}
