// Second pass of the separable flow-based difference of Gaussians along stream lines after Cabral and
// Leedom: response and field are constant on pixels, and the Gaussian is integrated exactly (2.193).
// Cost: per segment one load of the response and one of the field with its tangent, two divisions and
// the error function; up to 1.5 segments a pixel of length.
#import shared/pixel_line
#import shared/edge_threshold

struct Params {
    /// Standard deviation along the line, pixels.
    sigma: f32,
    /// How the response becomes an edge image: 0 not at all, 1 binary (4.6), 2 tanh (4.8), 3 smoothstep.
    threshold: u32,
    /// Response from which on there is no line, units of L.
    epsilon: f32,
    /// Steepness of the ramp, per unit of L.
    phi: f32,
    /// Share of the paper that shows through lines, which are narrower than a pixel; 0 where they are not.
    faintness: f32,
}

#params
#input response
// (E - G, F), see orientation_field.
#input field
#output target_image r32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let limit = floor(2.0 * params.sigma + 1e-3);
    // 1 / (sigma sqrt 2).
    let inverse = 0.70710678 / max(params.sigma, 1e-3);
    let tangent = tensor_tangent(fetch(field, 1u, p));
    // A line of no length is the pixel itself.
    var sum = select(0.0, 1.0, limit <= 0.0) * fetch(response, 0u, p).xy;
    for (var side = -1.0; side <= 1.0; side += 2.0) {
        var line = pixel_line_begin(p, side * tangent);
        var u = 0.0;
        for (var i = 0; i < pixel_line_steps(limit) && u < limit; i++) {
            let h = pixel_line_aim(&line, field, 1u);
            let end = min(u + h, limit);
            let weight = error_function(end * inverse) - error_function(u * inverse);
            sum += weight * fetch(response, 0u, line.pixel).xy;
            u = end;
            if !pixel_line_cross(&line, 1u, h) {
                break;
            }
        }
    }
    let edge = edge_of_sum(sum, params.threshold, params.epsilon, params.phi, params.faintness);
    textureStore(target_image, vec2i(id.xy), vec4f(edge));
}
