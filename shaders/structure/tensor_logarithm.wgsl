// The logarithm of a tensor, or back: its eigenvalues' at the same eigenvectors.
// Cost: one eigenanalysis and two logarithms or powers.
#import gpu/grid
#import shared/tensor

struct Params {
    /// 0: the logarithm; 1: back.
    inverse: u32,
    /// Eigenvalues below this count as this.
    least: f32,
    /// The smaller eigenvalue is no smaller share of the larger than this.
    share: f32,
}

#params
#input source
#output target_image rgba32float

// The tensor with the eigenvalue a along v and b across.
fn composed(a: f32, b: f32, v: vec2f) -> vec3f {
    let square = v * v;
    return vec3f(a * square.x + b * square.y, (a - b) * v.x * v.y, a * square.y + b * square.x);
}

fn of_pixel(id: vec3u, t: vec4f) -> vec4f {
    var result: vec3f;
    if params.inverse != 0u {
        let mean = (t.x + t.z) * 0.5;
        let axis = tensor_axis((t.x - t.z) * 0.5, t.y);
        result = composed(exp(mean + axis.radius), exp(mean - axis.radius), axis.major);
    } else {
        let eigen = tensor_eigen(t);
        let larger = max(eigen.lambda1, params.least);
        let smaller = max(max(eigen.lambda2, params.least), larger * params.share);
        result = composed(log(larger), log(smaller), eigen.major);
    }
    return vec4f(result, t.w);
}
