// The mean of the sectors of a disc, weighted by their variance (5.14, 5.15), for the generalized and
// the anisotropic Kuwahara filters. Twin of kernels/shared/sectors.rs.
//
// Sectors are handled four to a vector. Colours count by their coverage and are taken relative to the
// centre's, so that the variance of nearly equal values does not cancel.

// Squared distance in units of the radius up to which a pixel belongs to the disc. Pixels on the very
// border, as a whole radius has them, must not hang on the last bit.
const SECTOR_INSIDE: f32 = 1.0005;

// A sector of which less than this share is covered says nothing.
const SECTOR_SEEN: f32 = 1e-3;

// Sums over four sectors: weights times a r, a g, a b, a (r^2 + g^2 + b^2) and a.
struct SectorSums {
    r: vec4f,
    g: vec4f,
    b: vec4f,
    q: vec4f,
    w: vec4f,
}

// What four sectors hold; cover is 0 where too little is covered.
struct SectorMeans {
    r: vec4f,
    g: vec4f,
    b: vec4f,
    variance: vec4f,
    cover: vec4f,
}

// Adds one pixel of colour c, relative to the centre's, and coverage a.
fn sector_add(sums: ptr<function, SectorSums>, weights: vec4f, c: vec3f, a: f32) {
    let w = weights * a;
    (*sums).r += w * c.r;
    (*sums).g += w * c.g;
    (*sums).b += w * c.b;
    (*sums).q += w * dot(c, c);
    (*sums).w += w;
}

// `full`: the sum of the weights without regard to coverage.
fn sector_means(sums: SectorSums, full: vec4f) -> SectorMeans {
    let cover = sums.w / max(full, vec4f(1e-20));
    let seen = cover > vec4f(SECTOR_SEEN);
    let n = select(vec4f(0.0), 1.0 / sums.w, seen);
    let r = sums.r * n;
    let g = sums.g * n;
    let b = sums.b * n;
    let variance = max(sums.q * n - (r * r + g * g + b * b), vec4f(0.0));
    return SectorMeans(r, g, b, variance, select(vec4f(0.0), cover, seen));
}

// The least bounded variance of the sectors that are covered.
fn sector_least(s: SectorMeans, threshold: f32) -> f32 {
    let v = select(vec4f(3.4e38), max(s.variance, vec4f(threshold * threshold)), s.cover > vec4f(0.0));
    return min(min(v.x, v.y), min(v.z, v.w));
}

// x^(q/2) for x in 0..1; by repeated squaring for whole q.
fn sector_power(x: vec4f, q: f32) -> vec4f {
    if q != floor(q) {
        return pow(max(x, vec4f(1e-38)), vec4f(0.5 * q));
    }
    let whole = u32(q);
    var result = select(vec4f(1.0), sqrt(x), (whole & 1u) != 0u);
    var square = x;
    for (var rest = whole >> 1u; rest != 0u; rest >>= 1u) {
        if (rest & 1u) != 0u {
            result *= square;
        }
        square *= square;
    }
    return result;
}

// Weighted sum of the sectors' means, and the sum of the weights (5.14).
fn sector_response(s: SectorMeans, least: f32, threshold: f32, q: f32) -> vec4f {
    let bounded = max(s.variance, vec4f(threshold * threshold));
    let alpha = sector_power(min(least / bounded, vec4f(1.0)), q) * s.cover;
    return vec4f(dot(alpha, s.r), dot(alpha, s.g), dot(alpha, s.b), dot(alpha, vec4f(1.0)));
}

// Standard deviations, each at least `least`.
fn sector_deviations(s: SectorMeans, least: f32) -> vec4f {
    return max(sqrt(s.variance), vec4f(least));
}

// The ellipse |v|^2 = a i^2 + 2 b i j + c j^2 <= 1 of the pixels (i, j) around a pixel, for v the point of the
// unit disc that (i, j) is mapped to (5.32); a c - b^2 = `area`.
struct SectorEllipse {
    // Rows of S R_-phi for a disc of radius 1.
    along: vec2f,
    across: vec2f,
    a: f32,
    b: f32,
    area: f32,
    // Rows below the centre.
    rows: i32,
}

// The ellipse along the unit tangent `t` of a disc of `radius` pixels, `stretch` times as long (5.22).
fn sector_ellipse(t: vec2f, radius: f32, stretch: f32) -> SectorEllipse {
    let along = t / (radius * stretch);
    let across = vec2f(-t.y, t.x) * (stretch / radius);
    let a = along.x * along.x + across.x * across.x;
    let b = along.x * along.y + across.x * across.y;
    let area = 1.0 / (radius * radius * radius * radius);
    return SectorEllipse(along, across, a, b, area, i32(sqrt(SECTOR_INSIDE * a / area)));
}

// Elongations up to which a workgroup's pixels share what they read: longer ellipses leave most of it out.
const SECTOR_SHARED: f32 = 2.0;

// The most pixels that an ellipse reaches along either axis.
fn sector_reach(radius: f32, elongation: f32) -> i32 {
    return i32(radius * (1.0 + elongation) * sqrt(SECTOR_INSIDE) + 0.01);
}

// The first and the last column of row j >= 0; in row 0 those to the right of the centre, since every pixel
// stands for the one opposite it too.
fn sector_columns(ellipse: SectorEllipse, j: i32) -> vec2i {
    let y = f32(j);
    let half = sqrt(max(SECTOR_INSIDE * ellipse.a - ellipse.area * y * y, 0.0)) / ellipse.a;
    let middle = -ellipse.b * y / ellipse.a;
    let columns = vec2i(i32(ceil(middle - half - 1e-3)), i32(floor(middle + half + 1e-3)));
    return select(columns, vec2i(1, columns.y), j == 0);
}

// The point of the unit disc that pixel (i, j) is mapped to.
fn sector_point(ellipse: SectorEllipse, offset: vec2i) -> vec2f {
    let d = vec2f(offset);
    return vec2f(dot(ellipse.along, d), dot(ellipse.across, d));
}
