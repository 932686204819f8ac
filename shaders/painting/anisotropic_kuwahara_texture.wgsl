// The anisotropic Kuwahara filter with sampled weighting functions (thesis § 5.4.2, Listings 5.2, 5.3).
//
// The four weights a quarter turn apart are one texel; those between them lie at positions turned by 45
// degrees. Two pixels opposite each other share one evaluation of the weights, whose order is turned by
// half for the second. All sums are vectors of four sectors, so that eight sectors take one pass.
//
// Cost: pi radius^2 pixels, each one load and half of eight table lookups and 80 multiply-adds.
#import grid
#import sectors
#import tensor

struct Params {
    // Radius of the disc that the ellipse is made of, pixels.
    radius: f32,
    // 1 / alpha of (5.22).
    elongation: f32,
    // tau_s of (5.15).
    threshold: f32,
    // Exponent q.
    q: f32,
    // tau_w: least standard deviation of a sector in the second output.
    deviation_floor: f32,
    // 4 or 8.
    sectors: u32,
    reserved: vec2u,
    // h_0 and its quarter turns at 43 x 22 nodes over the half y >= 0 of the disc's bounding square.
    weights: array<vec4f, 960>,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var tensors: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;
@group(0) @binding(5) var deviations: texture_storage_2d<r32float, write>;

// Texel `at` and its right neighbour, interpolated.
fn texels(at: u32, f: f32) -> vec4f {
    return mix(params.weights[at], params.weights[at + 1u], f);
}

// The four weights at a point of the unit disc, interpolated. The lower half mirrors the upper one, with
// the second and the fourth sector exchanged.
fn table(v: vec2f) -> vec4f {
    let p = vec2f(max((v.x + 1.0) * 21.0, 0.0), abs(v.y) * 21.0);
    let corner = min(floor(p), vec2f(41.0, 20.0));
    let f = min(p - corner, vec2f(1.0));
    let at = u32(corner.y) * 43u + u32(corner.x);
    let w = mix(texels(at, f.x), texels(at + 43u, f.x), f.y);
    return select(w, w.xwzy, v.y < 0.0);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let tensor = fetch(tensors, 1u, p);
    let t = tensor_tangent(tensor);
    let stretch = 1.0 + params.elongation * tensor_anisotropy(tensor);
    // Rows of S R_-phi (5.32) for a disc of radius 1.
    let along = t / (params.radius * stretch);
    let across = vec2f(-t.y, t.x) * (stretch / params.radius);
    let eight = params.sectors == 8u;
    let origin = fetch(source, 0u, p);
    var even = SectorSums();
    var odd = SectorSums();
    var even_full = table(vec2f(0.0));
    var odd_full = even_full;
    sector_add(&even, even_full, vec3f(0.0), origin.a);
    sector_add(&odd, odd_full, vec3f(0.0), origin.a);

    // The ellipse |v|^2 = a i^2 + 2 b i j + c j^2 <= 1, a c - b^2 = `area`, row by row.
    let a = along.x * along.x + across.x * across.x;
    let b = along.x * along.y + across.x * across.y;
    let area = 1.0 / (params.radius * params.radius * params.radius * params.radius);
    let rows = i32(sqrt(SECTOR_INSIDE * a / area));
    for (var j = 0; j <= rows; j++) {
        let y = f32(j);
        let half = sqrt(max(SECTOR_INSIDE * a - area * y * y, 0.0)) / a;
        var first = i32(ceil(-b * y / a - half - 1e-3));
        let last = i32(floor(-b * y / a + half + 1e-3));
        if j == 0 {
            first = 1;
        }
        for (var i = first; i <= last; i++) {
            let d = vec2f(f32(i), y);
            let v = vec2f(dot(along, d), dot(across, d));
            if dot(v, v) > SECTOR_INSIDE {
                continue;
            }
            let p0 = fetch(source, 0u, p + vec2i(i, j));
            let p1 = fetch(source, 0u, p - vec2i(i, j));
            let c0 = p0.rgb - origin.rgb;
            let c1 = p1.rgb - origin.rgb;
            let w = table(v);
            sector_add(&even, w, c0, p0.a);
            sector_add(&even, w.zwxy, c1, p1.a);
            even_full += w + w.zwxy;
            if eight {
                let u = table(vec2f(v.x + v.y, v.y - v.x) * 0.70710678);
                sector_add(&odd, u, c0, p0.a);
                sector_add(&odd, u.zwxy, c1, p1.a);
                odd_full += u + u.zwxy;
            }
        }
    }
    let near = sector_means(even, even_full);
    var least = sector_least(near, params.threshold);
    var far = sector_means(odd, odd_full);
    var deviation = dot(sector_deviations(near, params.deviation_floor), vec4f(1.0));
    if eight {
        least = min(least, sector_least(far, params.threshold));
        deviation += dot(sector_deviations(far, params.deviation_floor), vec4f(1.0));
    } else {
        far.cover = vec4f(0.0);
        // As of eight sectors.
        deviation *= 2.0;
    }
    let found = sector_response(near, least, params.threshold, params.q)
        + sector_response(far, least, params.threshold, params.q);
    let color = origin.rgb + select(vec3f(0.0), found.rgb / found.a, found.a > 0.0);
    textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
    textureStore(deviations, vec2i(id.xy), vec4f(deviation));
}
