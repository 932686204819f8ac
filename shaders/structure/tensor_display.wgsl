// A tensor field as a colour: orientation on the circle of double angles, or a measure as grey.
// Cost: one load and about 30 operations.
#import gpu/grid
#import shared/tensor

struct Params {
    /// 0 orientation; 1, 2, 3 anisotropy, of roots, squared; 4 magnitude; 5 Harris, 6 Foerstner,
    /// 7 Tomasi and Kanade, 8 Rohr; 9 significance; 10 condition number.
    show: u32,
    /// k of the Harris measure.
    k: f32,
    /// Anisotropy above which a place is no noise.
    threshold: f32,
}

#params
#input source
#output target_image rgba32float

// Values that are shown as middle grey: a gradient and, for corners, a squared one.
const HALF_GRADIENT: f32 = 0.1;
const HALF_SQUARE: f32 = 0.0025;

fn anisotropy(t: vec4f) -> f32 {
    let a = tensor_anisotropy(t);
    switch params.show {
        case 2u: {
            return a / (1.0 + sqrt(max(1.0 - a * a, 0.0)));
        }
        case 3u: {
            return a * a;
        }
        case 9u: {
            return select(0.0, a, a > params.threshold);
        }
        case 10u: {
            // cond / (1 + cond) by (2.142), which does not overflow.
            return 0.5 + 0.5 * a;
        }
        default: {
            return a;
        }
    }
}

fn strength(unbounded: vec4f) -> f32 {
    // Products of four gradients must not overflow.
    let t = clamp(unbounded, vec4f(-1e9), vec4f(1e9));
    let trace = t.x + t.z;
    let lambda1 = trace * 0.5 + tensor_axis((t.x - t.z) * 0.5, t.y).radius;
    // What rounding leaves of the determinant of a tensor of rank one is no corner.
    let determinant = max(t.x * t.z - t.y * t.y - 1e-6 * trace * trace, 0.0);
    switch params.show {
        case 4u: {
            let gradient = sqrt(max(lambda1, 0.0));
            return gradient / (gradient + HALF_GRADIENT);
        }
        case 5u: {
            let harris = determinant - params.k * trace * trace;
            let square = sqrt(abs(harris));
            return 0.5 + 0.5 * sign(harris) * square / (square + HALF_SQUARE);
        }
        case 6u: {
            let square = determinant / max(trace, TENSOR_SMALLEST);
            return square / (square + HALF_SQUARE);
        }
        case 7u: {
            let square = determinant / max(lambda1, TENSOR_SMALLEST);
            return square / (square + HALF_SQUARE);
        }
        default: {
            let square = sqrt(determinant);
            return square / (square + HALF_SQUARE);
        }
    }
}

fn of_pixel(id: vec3u, t: vec4f) -> vec4f {
    var color = vec3f(0.0);
    if params.show == 0u {
        // Anisotropy times (cos 2 phi, sin 2 phi), phi the angle of the tangent.
        let trace = max(t.x + t.z, TENSOR_SMALLEST);
        let axis = vec2f(t.z - t.x, -2.0 * t.y) / trace;
        color = vec3f(
            0.5 + 0.5 * axis.x,
            0.5 - 0.25 * axis.x + 0.4330127 * axis.y,
            0.5 - 0.25 * axis.x - 0.4330127 * axis.y,
        );
    } else if params.show < 4u || params.show >= 9u {
        color = vec3f(anisotropy(t));
    } else {
        color = vec3f(strength(t));
    }
    return vec4f(color, 1.0);
}
