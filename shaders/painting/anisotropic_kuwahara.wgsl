// The anisotropic Kuwahara filter with polynomial weighting functions (thesis § 5.4, Listing 5.4).
//
// Two pixels opposite each other share one evaluation of the weights. Sums over opposite sectors k and
// k + N/2 are kept as their sum and their difference, which need the sum and the difference of the two
// colours only: half the multiply-adds, and ten vectors for all eight sectors in one pass over the
// neighbourhood, where two passes over four sectors each would evaluate all weights twice.
//
// Cost: pi radius^2 pixels, each one read of workgroup memory and half of about 110 operations; about a
// quarter of (1 + elongation)^2 radius^2 loads up to an elongation of 2, beyond it one per pixel.
#import gpu/window
#import shared/sectors
#import shared/tensor

struct Params {
    /// Radius of the disc that the ellipse is made of, pixels.
    radius: f32,
    /// 1 / alpha of (5.22).
    elongation: f32,
    /// Overlap of the sectors at the centre (5.40).
    zeta: f32,
    /// Overlap of the sectors at their sides (5.42).
    eta: f32,
    /// tau_s of (5.15).
    threshold: f32,
    /// Exponent q.
    q: f32,
    /// tau_w: least standard deviation of a sector in the second output.
    deviation_floor: f32,
    /// 4 or 8.
    sectors: u32,
}

#params
#input source, tensors
#output target_image rgba32float
#output deviations r32float

const WINDOW_PIXELS: i32 = WINDOW_AREA;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    let p = group_pixel(id);
    let tensor = fetch(tensors, 1u, p);
    let t = tensor_tangent(tensor);
    let stretch = 1.0 + params.elongation * tensor_anisotropy(tensor);
    let ellipse = sector_ellipse(t, params.radius, stretch);
    let eight = params.sectors == 8u;
    // Of four sectors those between them get no weight anywhere on the disc.
    let zeta = select(vec4f(params.zeta, -4.0, params.zeta, -4.0), vec4f(params.zeta), eight);
    let eta = params.eta;

    let origin = fetch(source, 0u, p);
    // Sums of sectors 0, 1, 2, 3 with their opposites, and differences from them.
    var sum = SectorSums();
    var difference = SectorSums();
    let centre = select(vec4f(0.25, 0.0, 0.25, 0.0), vec4f(0.125), eight);
    var full = centre;
    sector_add(&sum, 2.0 * centre, vec3f(0.0), origin.a);

    // The longest ellipse bounds what the workgroup reads. Of very long ones that is so much more than they
    // cover that each pixel fetches its own.
    let reach = sector_reach(params.radius, params.elongation);
    let shares = params.elongation <= SECTOR_SHARED;
    let size = vec2i(2 * reach, reach) + 1;
    let step = select(size, window_step(size), shares);
    for (var y = 0; y <= reach; y += step.y) {
        for (var x = -reach; x <= reach; x += step.x) {
            let end = min(vec2i(x, y) + step - 1, vec2i(reach));
            var part = window_unshared(id);
            if shares {
                part = window_load_both(id, vec2i(x, y), end);
            }
            for (var j = y; j <= min(ellipse.rows, end.y); j++) {
                let columns = sector_columns(ellipse, j);
                for (var i = max(columns.x, x); i <= min(columns.y, end.x); i++) {
                    let v = sector_point(ellipse, vec2i(i, j));
                    let distance2 = dot(v, v);
                    if distance2 > SECTOR_INSIDE {
                        continue;
                    }
                    let u = vec2f(v.x + v.y, v.y - v.x) * 0.70710678;
                    // Components along sectors 0 to 3, and the squares of those across them.
                    let forward = vec4f(v.x, u.x, v.y, u.y);
                    let side = vec4f(v.y * v.y, u.y * u.y, v.x * v.x, u.x * u.x);
                    let k = zeta - eta * side;
                    let z0 = max(k + forward, vec4f(0.0));
                    let z1 = max(k - forward, vec4f(0.0));
                    let near = z0 * z0;
                    let far = z1 * z1;
                    let g = exp(-3.125 * distance2) / dot(near + far, vec4f(1.0));
                    let both = (near + far) * g;
                    let apart = (near - far) * g;

                    let offset = vec2i(i, j);
                    let p0 = window_read(part, offset);
                    let p1 = window_read_opposite(part, offset);
                    let c0 = p0.rgb - origin.rgb;
                    let c1 = p1.rgb - origin.rgb;
                    let e = p0.a * vec4f(c0, dot(c0, c0)) + p1.a * vec4f(c1, dot(c1, c1));
                    let o = p0.a * vec4f(c0, dot(c0, c0)) - p1.a * vec4f(c1, dot(c1, c1));
                    sum.r += both * e.r;
                    sum.g += both * e.g;
                    sum.b += both * e.b;
                    sum.q += both * e.a;
                    sum.w += both * (p0.a + p1.a);
                    difference.r += apart * o.r;
                    difference.g += apart * o.g;
                    difference.b += apart * o.b;
                    difference.q += apart * o.a;
                    difference.w += apart * (p0.a - p1.a);
                    full += both;
                }
            }
        }
    }
    let near = sector_means(half_of(sum, difference, 0.5), full);
    let far = sector_means(half_of(sum, difference, -0.5), full);
    let least = min(sector_least(near, params.threshold), sector_least(far, params.threshold));
    let found = sector_response(near, least, params.threshold, params.q)
        + sector_response(far, least, params.threshold, params.q);
    let color = origin.rgb + select(vec3f(0.0), found.rgb / found.a, found.a > 0.0);
    let all = sector_deviations(near, params.deviation_floor) + sector_deviations(far, params.deviation_floor);
    // As of eight sectors.
    let deviation = select(2.0 * (all.x + all.z), dot(all, vec4f(1.0)), eight);
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
        textureStore(deviations, vec2i(id.xy), vec4f(deviation));
    }
}

// Half the sum of the first plus `share` times the second.
fn half_of(sum: SectorSums, difference: SectorSums, share: f32) -> SectorSums {
    return SectorSums(
        0.5 * sum.r + share * difference.r,
        0.5 * sum.g + share * difference.g,
        0.5 * sum.b + share * difference.b,
        0.5 * sum.q + share * difference.q,
        0.5 * sum.w + share * difference.w,
    );
}
