#import shared/coverage

// The host's pixels in its own space, finite and not premultiplied. Twin of
// kernels/shared/host_colour.rs.
fn plain(pixel: vec4f, premultiplied: bool) -> vec4f {
    var v = pixel;
    // Compared by bits: shader compilers may assume that NaN does not exist.
    let bits = bitcast<vec4u>(v);
    let special = (bits & vec4u(0x7f800000u)) == vec4u(0x7f800000u);
    let nan = special & ((bits & vec4u(0x007fffffu)) != vec4u(0u));
    let largest = select(vec4f(65504.0), vec4f(-65504.0), (bits >> vec4u(31u)) == vec4u(1u));
    v = select(select(v, largest, special), vec4f(0.0), nan);
    v = clamp(v, vec4f(vec3f(-65504.0), 0.0), vec4f(vec3f(65504.0), 1.0));
    if premultiplied {
        v = unpremultiply(v);
    }
    return v;
}
