// The anisotropic Kuwahara filter with sampled weighting functions (thesis § 5.4.2, Listings 5.2, 5.3).
//
// Cost: pi radius^2 pixels, each one read of workgroup memory and half of eight table lookups and 80
// multiply-adds; about a quarter of (1 + elongation)^2 radius^2 loads up to an elongation of 2, beyond it one
// per pixel.
#import gpu/window
#import shared/sampled_sectors
#import shared/tensor

struct Params {
    /// Radius of the disc that the ellipse is made of, pixels.
    radius: f32,
    /// 1 / alpha of (5.22).
    elongation: f32,
    /// tau_s of (5.15).
    threshold: f32,
    /// Exponent q.
    q: f32,
    /// tau_w: least standard deviation of a sector in the second output.
    deviation_floor: f32,
    /// 4 or 8.
    sectors: u32,
    /// h_0 and its quarter turns at 43 x 22 nodes over the half y >= 0 of the disc's bounding square.
    weights: array<vec4f, 960>,
}

#params
#input source, tensors
#output target_image rgba32float
#output deviations r32float

const WINDOW_PIXELS: i32 = WINDOW_AREA_BESIDE_WEIGHTS;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    sector_weights_load(id);
    let p = group_pixel(id);
    let tensor = fetch(tensors, 1u, p);
    let t = tensor_tangent(tensor);
    let stretch = 1.0 + params.elongation * tensor_anisotropy(tensor);
    let ellipse = sector_ellipse(t, params.radius, stretch);
    let eight = params.sectors == 8u;
    let origin = fetch(source, 0u, p);
    // Four sectors a quarter turn apart, and the four between them.
    var even = SectorSums();
    var even_full = sector_table(vec2f(0.0));
    sector_add(&even, even_full, vec3f(0.0), origin.a);
    var odd = even;
    var odd_full = even_full;

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
                    if dot(v, v) > SECTOR_INSIDE {
                        continue;
                    }
                    let p0 = window_read(part, vec2i(i, j));
                    let p1 = window_read_opposite(part, vec2i(i, j));
                    let c0 = p0.rgb - origin.rgb;
                    let c1 = p1.rgb - origin.rgb;
                    sampled_add(&even, &even_full, v, c0, p0.a, c1, p1.a);
                    if eight {
                        sampled_add(&odd, &odd_full, sector_between(v), c0, p0.a, c1, p1.a);
                    }
                }
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
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
        textureStore(deviations, vec2i(id.xy), vec4f(deviation));
    }
}
