// Colour encodings, extended to values below 0 and above 1 so that they stay monotonic and
// invertible: scene-linear highlights survive a round trip. Twin of kernels/shared/colour.rs.

const EPSILON_LAB: f32 = 0.008856452; // (6/29)^3
const SLOPE_LAB: f32 = 7.787037; // (29/6)^2 / 3
const WHITE_D65: vec3f = vec3f(0.95047, 1.0, 1.08883);

// Linear light to the sRGB curve, odd about 0.
fn srgb_encode(v: vec3f) -> vec3f {
    let a = abs(v);
    let curve = 1.055 * pow(max(a, vec3f(1e-30)), vec3f(1.0 / 2.4)) - 0.055;
    return sign(v) * select(curve, 12.92 * a, a <= vec3f(0.0031308));
}

// The sRGB curve to linear light, odd about 0.
fn srgb_decode(v: vec3f) -> vec3f {
    let a = abs(v);
    let curve = pow((a + 0.055) / 1.055, vec3f(2.4));
    return sign(v) * select(curve, a / 12.92, a <= vec3f(0.04045));
}

fn lab_curve(t: vec3f) -> vec3f {
    let root = pow(max(t, vec3f(1e-30)), vec3f(1.0 / 3.0));
    return select(root, SLOPE_LAB * t + 16.0 / 116.0, t <= vec3f(EPSILON_LAB));
}

fn lab_curve_inverse(f: vec3f) -> vec3f {
    return select(f * f * f, (f - 16.0 / 116.0) / SLOPE_LAB, f <= vec3f(6.0 / 29.0));
}

// Linear Rec. 709 to CIELAB (D65), L in 0..100.
fn linear_to_lab(c: vec3f) -> vec3f {
    let xyz = vec3f(
        dot(c, vec3f(0.4124564, 0.3575761, 0.1804375)),
        dot(c, vec3f(0.2126729, 0.7151522, 0.0721750)),
        dot(c, vec3f(0.0193339, 0.1191920, 0.9503041)),
    );
    let f = lab_curve(xyz / WHITE_D65);
    return vec3f(116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z));
}

fn lab_to_linear(lab: vec3f) -> vec3f {
    let y = (lab.x + 16.0) / 116.0;
    let xyz = WHITE_D65 * lab_curve_inverse(vec3f(y + lab.y / 500.0, y, y - lab.z / 200.0));
    return vec3f(
        dot(xyz, vec3f(3.2404542, -1.5371385, -0.4985314)),
        dot(xyz, vec3f(-0.9692660, 1.8760108, 0.0415560)),
        dot(xyz, vec3f(0.0556434, -0.2040259, 1.0572252)),
    );
}

// ACEScg (AP1, D60) to linear Rec. 709 (D65), Bradford adaptation.
fn acescg_to_linear(c: vec3f) -> vec3f {
    return vec3f(
        dot(c, vec3f(1.7050510, -0.6217921, -0.0832589)),
        dot(c, vec3f(-0.1302564, 1.1408047, -0.0105483)),
        dot(c, vec3f(-0.0240034, -0.1289690, 1.1529724)),
    );
}

fn linear_to_acescg(c: vec3f) -> vec3f {
    return vec3f(
        dot(c, vec3f(0.6130974, 0.3395231, 0.0473795)),
        dot(c, vec3f(0.0701937, 0.9163539, 0.0134524)),
        dot(c, vec3f(0.0206156, 0.1095698, 0.8698146)),
    );
}
