#import shared/tensor

// The structure tensor of one pixel's gradient and its validity (2.34, 2.133, 2.164).
// Twin of kernels/shared/outer_product.rs.
//
// c is the centre's colour times coverage and its coverage; gx and gy are derivatives of such values.
// `flags`: bit 0, the gradient of the luma alone; bit 1, divide each channel's tensor by its
// gradient's magnitude. A tensor is valid above lambda1 = `threshold`.
fn outer_product(c: vec4f, gx: vec4f, gy: vec4f, scale: f32, flags: u32, threshold: f32) -> vec4f {
    // The quotient rule without its division: coverage squared times the gradient of the colour.
    var x = (c.a * gx.rgb - c.rgb * gx.a) * scale;
    var y = (c.a * gy.rgb - c.rgb * gy.a) * scale;
    if (flags & 1u) != 0u {
        x = vec3f(0.2126 * x.r + 0.7152 * x.g + 0.0722 * x.b, 0.0, 0.0);
        y = vec3f(0.2126 * y.r + 0.7152 * y.g + 0.0722 * y.b, 0.0, 0.0);
    }
    var e = x * x;
    var f = x * y;
    var g = y * y;
    if (flags & 2u) != 0u {
        let inverse = 1.0 / sqrt(max(e + g, vec3f(1e-30)));
        e *= inverse;
        f *= inverse;
        g *= inverse;
    }
    let t = vec3f(e.x + e.y + e.z, f.x + f.y + f.z, g.x + g.y + g.z);
    let lambda1 = (t.x + t.z) * 0.5 + tensor_axis((t.x - t.z) * 0.5, t.y).radius;
    return vec4f(t, select(0.0, 1.0, lambda1 > threshold));
}
