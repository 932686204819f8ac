// Noise that belongs to the surfaces of objects: smooth solid noise at the points of the undeformed objects, of two
// octaves whose marks on screen are just smaller and just larger than is asked for. Where there is no object, the
// noise of the screen stays.
// Cost: three loads, 54 hashes and about 350 multiply-adds.
#import shared/rest_position
#import gpu/grid

struct Params {
    /// Logarithm, to base 2, of the spacing of the noise's values on screen, pixels.
    spacing: f32,
    /// Standard deviation of the noise.
    deviation: f32,
    /// Another number gives another noise.
    seed: u32,
}

#params
#input points, scales, screen
#output target_image rgba32float

// A number in -0.5..0.5 that belongs to a cell, of a sum of its coordinates' products.
fn solid_hash(cell: u32) -> f32 {
    var h = cell;
    h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12u)) * 0x297a2d39u;
    h = h ^ (h >> 15u);
    return f32(h >> 8u) * 5.9604645e-8 - 0.5;
}

// Weights of the three cells around a place in the middle one: the quadratic B-spline.
fn spline(f: f32) -> vec3f {
    let g = 1.0 - f;
    return vec3f(0.5 * g * g, 0.75 - (f - 0.5) * (f - 0.5), 0.5 * f * f);
}

// Solid noise of variance 1 whose values are 2^octave apart.
fn noise(p: vec3f, octave: i32) -> f32 {
    // Products with a power of two are exact, and so are the whole part and the rest.
    let q = p * bitcast<f32>(u32(127 - octave) << 23u);
    let cell = floor(q);
    let f = q - cell;
    let seed = params.seed + u32(octave) * 0x9e3779b9u;
    let i = vec3i(cell);
    let wx = spline(f.x);
    let wy = spline(f.y);
    let wz = spline(f.z);
    var sum = 0.0;
    for (var z = 0; z < 3; z++) {
        let hz = (u32(i.z + z - 1) * 0xc2b2ae3du) ^ seed;
        for (var y = 0; y < 3; y++) {
            let hy = (u32(i.y + y - 1) * 0x85ebca77u) ^ hz;
            var row = 0.0;
            for (var x = 0; x < 3; x++) {
                row += wx[x] * solid_hash((u32(i.x + x - 1) * 0x9e3779b1u) ^ hy);
            }
            sum += wz[z] * wy[y] * row;
        }
    }
    // Sums of independent values vary as the squares of their weights: as much everywhere.
    return sum * inverseSqrt(dot(wx, wx) * dot(wy, wy) * dot(wz, wz) / 12.0);
}

// What the coarse octave's variance counts against the fine one's, the root of 1/2: lines along which marks are smoothed
// keep more of it.
const COARSE: f32 = 0.7071;

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let point = fetch(points, 0u, pixel(id));
    let scale = fetch(scales, 1u, pixel(id)).x;
    if !is_at_rest(point) || !has_footprint(scale) {
        textureStore(target_image, vec2i(id.xy), fetch(screen, 2u, pixel(id)));
        return;
    }
    // So far from 0 that floats do not tell finer cells apart, marks are larger.
    let farthest = max(max(abs(point.x), abs(point.y)), max(abs(point.z), 1e-20));
    let level = clamp(max(scale + params.spacing, log2(farthest) - 22.0), -60.0, 60.0);
    let octave = floor(level);
    // Where the shares of the variance go evenly from one octave to the next, the width of marks stays.
    let coarse = sqrt(COARSE * (level - octave));
    let fine = sqrt(1.0 - (level - octave));
    let sum = fine * noise(point.xyz, i32(octave)) + coarse * noise(point.xyz, i32(octave) + 1);
    let even = sum * inverseSqrt(fine * fine + coarse * coarse);
    let value = clamp(0.5 + params.deviation * even, 0.0, 1.0);
    textureStore(target_image, vec2i(id.xy), vec4f(vec3f(value), 1.0));
}
