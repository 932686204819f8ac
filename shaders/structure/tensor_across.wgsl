// Tensors turned by a right angle: stream lines lead across the form.
// Cost: one load.
#import gpu/grid

#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f) -> vec4f {
    return vec4f(v.z, -1.0 * v.y, v.x, v.w);
}
