// Algebra of symmetric positive semidefinite 2x2 tensors (E, F, G, w); w takes no part.
// Twin of kernels/shared/tensor.rs, operation by operation.
//
// The eigenanalysis is that of Listing 2.1. Its squares would underflow for weak gradients and
// overflow for strong ones, so values are first multiplied by a power of two, which is exact.

struct Eigen {
    lambda1: f32,
    lambda2: f32,
    // Unit eigenvector of lambda1; its sign means nothing.
    major: vec2f,
}

struct Axis {
    // sqrt(d^2 + f^2).
    radius: f32,
    major: vec2f,
}

const TENSOR_SMALLEST: f32 = 1.1754944e-38;
const TENSOR_LARGEST: f32 = 3.40282346e38;

// 2^-n for 2^n <= v < 2^(n+1), v normal and below 2^127; finite for 0.
fn tensor_scale(v: f32) -> f32 {
    return bitcast<f32>(0x7f000000u - (bitcast<u32>(v) & 0x7f800000u));
}

// The reverse of `tensor_scale`: 2^n; 0 for 0.
fn tensor_unscale(v: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(v) & 0x7f800000u);
}

// Radius (2.80) and major eigenvector (2.82) from d = (E - G) / 2 and f = F.
fn tensor_axis(d: f32, f: f32) -> Axis {
    let size = max(abs(d), abs(f));
    if size < TENSOR_SMALLEST {
        return Axis(0.0, vec2f(1.0, 0.0));
    }
    let scale = tensor_scale(size);
    let ds = d * scale;
    let fs = f * scale;
    let ff = fs * fs;
    let r = sqrt(ds * ds + ff);
    // The sum of two positive numbers: nothing cancels, and it is at least 1.
    let n = abs(ds) + r;
    let inverse = 1.0 / sqrt(n * n + ff);
    let major = select(vec2f(fs, n), vec2f(n, fs), d >= 0.0) * inverse;
    return Axis(r * tensor_unscale(size), major);
}

// Eigenvalues (2.80, 2.81), lambda1 >= lambda2 >= 0, and the major eigenvector; zero tensor: (1, 0).
fn tensor_eigen(t: vec4f) -> Eigen {
    let size = max(max(t.x, t.z), abs(t.y));
    if size < TENSOR_SMALLEST {
        return Eigen(0.0, 0.0, vec2f(1.0, 0.0));
    }
    let scale = tensor_scale(size);
    let e = t.x * scale;
    let f = t.y * scale;
    let g = t.z * scale;
    let axis = tensor_axis((e - g) * 0.5, f);
    let lambda1 = (e + g) * 0.5 + axis.radius;
    // Only tensors that are not semidefinite have lambda1 < 1/2 here; the bound keeps them finite.
    let lambda2 = max(e * g - f * f, 0.0) / max(lambda1, 0.25);
    let unscale = tensor_unscale(size);
    return Eigen(lambda1 * unscale, lambda2 * unscale, axis.major);
}

// Unit minor eigenvector, along the isophotes; zero tensor: (0, 1).
fn tensor_tangent(t: vec4f) -> vec2f {
    let major = tensor_axis((t.x - t.z) * 0.5, t.y).major;
    return vec2f(-major.y, major.x);
}

struct Along {
    tangent: vec2f,
    // Of the angle between the tangent and the direction that it was asked for.
    cosine: f32,
}

// The unit minor eigenvector of tensors with E - G = `difference` and F = `f`, of the sign that turns less from
// the unit vector `p`: `p` projected on it, (I + M / r) p / 2 with M = (-d, -f; -f, d), d = (E - G) / 2 and
// r^2 = d^2 + f^2. Where there is no direction (r at most 1e-18 or above 1e18), or where it lies straight across, `p`.
fn tensor_tangent_along(difference: f32, f: f32, p: vec2f) -> Along {
    let d = 0.5 * difference;
    let rr = d * d + f * f;
    let r = sqrt(rr);
    let q = vec2f((r - d) * p.x - f * p.y, (r + d) * p.y - f * p.x);
    let size = dot(q, q);
    let t = q * inverseSqrt(max(size, TENSOR_SMALLEST));
    return Along(select(p, t, size > 1e-8 * rr && size <= TENSOR_LARGEST), select(1.0, dot(p, t), rr > 1e-36));
}

// (lambda1 - lambda2) / (lambda1 + lambda2), 0..1 (2.137); zero tensor: 0.
fn tensor_anisotropy(t: vec4f) -> f32 {
    let half_trace = (t.x + t.z) * 0.5;
    if half_trace < TENSOR_SMALLEST {
        return 0.0;
    }
    let radius = tensor_axis((t.x - t.z) * 0.5, t.y).radius;
    return min(radius / half_trace, 1.0);
}
