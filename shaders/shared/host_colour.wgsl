#import shared/coverage

// The host's pixels in its own space, finite and not premultiplied. Twin of
// kernels/shared/host_colour.rs.

// Pixels cut to what the largest half can hold, 0 for what is not a number; alpha is cut to 0..=1.
fn finite(pixel: vec4f) -> vec4f {
    var v = pixel;
    // Compared by bits: shader compilers may assume that NaN does not exist.
    let bits = bitcast<vec4u>(v);
    let special = (bits & vec4u(0x7f800000u)) == vec4u(0x7f800000u);
    let nan = special & ((bits & vec4u(0x007fffffu)) != vec4u(0u));
    let largest = select(vec4f(65504.0), vec4f(-65504.0), (bits >> vec4u(31u)) == vec4u(1u));
    v = select(select(v, largest, special), vec4f(0.0), nan);
    return clamp(v, vec4f(vec3f(-65504.0), 0.0), vec4f(vec3f(65504.0), 1.0));
}

// What a premultiplied colour has beyond alpha / (1 - alpha)^4: straight colours of 1 where coverage is 0, of 16 where
// it is a half, and any where it is full are within it.
fn beyond_coverage(v: vec4f) -> vec3f {
    let share = (1.0 - v.a) * (1.0 - v.a);
    let most = v.a / max(share * share, 1e-30);
    return sign(v.rgb) * max(abs(v.rgb) - most, vec3f(0.0));
}

// `premultiplied`: 0 not, 1 it is, 2 it is and light beyond coverage is left out.
fn plain(pixel: vec4f, premultiplied: u32) -> vec4f {
    var v = finite(pixel);
    if premultiplied == 2u {
        v = vec4f(v.rgb - beyond_coverage(v), v.a);
    }
    if premultiplied != 0u {
        v = unpremultiply(v);
    }
    return v;
}
