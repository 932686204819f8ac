// The start of the edge tangent flow: the tensor of a pixel's gradient as one of length 1, and the
// gradient's magnitude (2.5). Cost: one load and about 20 operations.
#import gpu/grid
#import shared/tensor

// A magnitude below this is no gradient.
const LEAST: f32 = 1e-6;

#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, t: vec4f) -> vec4f {
    let axis = tensor_axis((t.x - t.z) * 0.5, t.y);
    let magnitude = sqrt(max((t.x + t.z) * 0.5 + axis.radius, 0.0));
    let n = axis.major;
    var start = vec4f(n.x * n.x, n.x * n.y, n.y * n.y, magnitude);
    if magnitude < LEAST {
        start = vec4f(0.0);
    }
    return start;
}
