// The generalized Kuwahara filter (thesis § 5.3, Listing 5.1): the sums over sectors are convolutions
// with fixed weighting functions, here taken pixel by pixel. The CPU twin may take them by the fast
// Fourier transform, which is another way to the same sums.
//
// Cost: pi radius^2 pixels, each one read of workgroup memory and half of eight table lookups and 80
// multiply-adds; about a quarter of radius^2 loads.
#import gpu/window
#import shared/sampled_sectors

struct Params {
    /// 1 / radius, per pixel.
    scale: f32,
    /// Pixels from the centre to the border along an axis.
    reach: i32,
    /// tau_s of (5.15).
    threshold: f32,
    /// Exponent q.
    q: f32,
    /// 4 or 8.
    sectors: u32,
    /// Side of the blocks that the CPU transforms; 0 for none.
    block: u32,
    /// h_0 and its quarter turns at 43 x 22 nodes over the half y >= 0 of the disc's bounding square.
    weights: array<vec4f, 960>,
}

#params
#input source
#output target_image rgba32float

const WINDOW_PIXELS: i32 = WINDOW_AREA_BESIDE_WEIGHTS;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    sector_weights_load(id);
    let p = group_pixel(id);
    let origin = fetch(source, 0u, p);
    let eight = params.sectors == 8u;
    // Four sectors a quarter turn apart, and the four between them.
    var even = SectorSums();
    var even_full = sector_table(vec2f(0.0));
    sector_add(&even, even_full, vec3f(0.0), origin.a);
    var odd = even;
    var odd_full = even_full;
    let step = window_step(vec2i(2 * params.reach, params.reach) + 1);
    for (var y = 0; y <= params.reach; y += step.y) {
        for (var x = -params.reach; x <= params.reach; x += step.x) {
            let last = min(vec2i(x, y) + step - 1, vec2i(params.reach));
            let part = window_load_both(id, vec2i(x, y), last);
            for (var j = y; j <= last.y; j++) {
                for (var i = select(x, max(x, 1), j == 0); i <= last.x; i++) {
                    let v = vec2f(vec2i(i, j)) * params.scale;
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
    if eight {
        least = min(least, sector_least(far, params.threshold));
    } else {
        far.cover = vec4f(0.0);
    }
    let found = sector_response(near, least, params.threshold, params.q)
        + sector_response(far, least, params.threshold, params.q);
    let color = origin.rgb + select(vec3f(0.0), found.rgb / found.a, found.a > 0.0);
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
    }
}
