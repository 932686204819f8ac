// The diffusion tensor of edge-enhancing or coherence-enhancing diffusion (§ 3.1) from a smoothed
// structure tensor, as the weights of the step that follows.
// Cost: one load, one eigenanalysis, one exponential.
#import shared/tensor
#import gpu/grid

struct Params {
    /// 1 / lambda^2 (edge-enhancing) or 1 / contrast^2 (coherence-enhancing).
    falloff: f32,
    /// 0: edge-enhancing; 1: coherence-enhancing.
    scheme: u32,
}

#params
#input tensors
#output target_image rgba32float

const COHERENCE_ENHANCING = 1u;

fn of_pixel(id: vec3u, tensors: vec4f) -> vec4f {
    let eigen = tensor_eigen(tensors);
    var across = 1.0;
    var along = 1.0;
    if params.scheme == COHERENCE_ENHANCING {
        // 0.001 + 0.999 exp(-C / (lambda1 - lambda2)^2); 1e18 is far beyond any exponent.
        let q = min(params.falloff * (eigen.lambda1 - eigen.lambda2), 1e9);
        across = 0.001;
        along = 0.001 + 0.999 * exp(-min(1.0 / max(q * q, 1e-18), 87.0));
    } else {
        let s = min(params.falloff * eigen.lambda1, 1e8);
        let s4 = (s * s) * (s * s);
        across = 1.0 - exp(-min(3.31488 / max(s4, 1e-30), 87.0));
    }
    let n = eigen.major;
    let a = across * n.x * n.x + along * n.y * n.y;
    let b = (across - along) * n.x * n.y;
    let c = across * n.y * n.y + along * n.x * n.x;
    let size = abs(b);
    let weights = vec4f(max(a - size, 0.0), max(c - size, 0.0), 0.5 * (size + b), 0.5 * (size - b));
    return weights;
}
