// Line integral convolution of a colour with a Gaussian along stream lines after Cabral and Leedom
// (§ 2.9.4): image and field are constant on pixels, and the Gaussian is integrated exactly (2.193).
// Cost: per segment one colour and one tensor load with its tangent, two divisions and the error
// function; up to 1.5 segments a pixel of length.
#import shared/coverage
#import shared/pixel_line

struct Params {
    /// Standard deviation along the line, pixels.
    sigma: f32,
    /// A side ends at a pixel boundary where it turns by more than the angle of this cosine.
    least_turn: f32,
    /// 0: none; 1: anisotropy; 2: angle.
    adapt: u32,
}

#params
#input source, tensors
#output target_image rgba32float

const INPUT_TENSORS = 1u;

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let tensor = fetch(tensors, INPUT_TENSORS, p);
    var sigma = params.sigma;
    if params.adapt == 1u {
        let a = 1.0 + tensor_anisotropy(tensor);
        sigma *= 0.25 * a * a;
    }
    // A last bit must not decide whether a whole number of pixels is reached.
    let limit = floor(2.0 * sigma + 1e-3);
    let steps = pixel_line_steps(2.0 * params.sigma);
    // 1 / (sigma sqrt 2).
    let inverse = 0.70710678 / max(sigma, 1e-3);
    let tangent = tensor_tangent(tensor);

    let middle = fetch(source, 0u, p);
    // A line of no length is the pixel itself.
    var norm = select(0.0, 1.0, limit <= 0.0);
    var sum = norm * premultiply(middle);
    for (var side = -1.0; side <= 1.0; side += 2.0) {
        var line = pixel_line_begin(p, side * tangent);
        var u = 0.0;
        for (var i = 0; i < steps && u < limit; i++) {
            let h = pixel_line_aim(&line, tensors, INPUT_TENSORS);
            if line.turn < params.least_turn {
                break;
            }
            if params.adapt == 2u {
                // What the turn adds to the arc length lies between two segments.
                u += max(acos(line.turn) * limit / 3.14159265 - h, 0.0);
            }
            let end = min(u + h, limit);
            let weight = max(error_function(end * inverse) - error_function(u * inverse), 0.0);
            sum += weight * fetch_covered(source, 0u, line.pixel);
            norm += weight;
            u = end;
            if !pixel_line_cross(&line, INPUT_TENSORS, h) {
                break;
            }
        }
    }
    textureStore(target_image, vec2i(id.xy), vec4f(unpremultiply(sum).rgb, sum.a / max(norm, 1e-6)));
}
