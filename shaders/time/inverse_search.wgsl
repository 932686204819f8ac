// Dense inverse search (Kroeger et al. 2016, 3.1): the motion of patches of 8 x 8 pixels, one for every four pixels
// in x and y, so that an output pixel is a patch. Each starts from the best of some motions and goes down the sum of
// squared differences, which both patches' means do not count in, by Gauss-Newton steps with the gradients of the
// patch that does not move. Cost: 23 loads, and 81 with 100 reads of workgroup memory for each start and step.
#import gpu/group
#import shared/sampling

struct Params {
    /// How much longer motions are here than in `start`, and how much farther apart its patches lie: 2 for the field
    /// of the coarser level, 1 for patches of this one.
    scale: f32,
    /// Longest motion along x and along y.
    reach: f32,
    /// Starts in `start`: that at the patch and those at its four neighbours; 0 at the coarsest level, where all
    /// start from rest and `start` is not read.
    starts: u32,
    /// Whether rest is tried too.
    rest: u32,
    /// Gauss-Newton steps.
    steps: u32,
}

#params
#input here, there, start
#output target_image rg32float

// Added to the Hessian's diagonal, brightness squared per pixel: two of 255 levels for every pixel of a patch. Where
// there is less texture a patch stays where it starts.
const TEXTURE = 0.0039;
// Share by which a motion must be better than the one before it, beyond that which is due to rounding.
const BETTER = 0.98;
const ROUNDING = 1e-6;
// Pixels that a patch may move away from its start, in x and in y (3.1: its own size).
const FARTHEST = 8.0;

// The patch and one pixel around it, where invocations share nothing.
var<private> patch_here: array<f32, 100>;

// The patches of the workgroup, 38 x 38 pixels, every fourth column together: invocations side by side, whose patches
// are four pixels apart, then read places side by side.
const ROWS: i32 = 38;
const PLACES: i32 = 10;
var<workgroup> patches_here: array<f32, 1520>;

// Place of the pixel at (x, y) from the first of the first patch.
fn shared_place(x: i32, y: i32) -> i32 {
    return ((x & 3) * ROWS + y) * PLACES + (x >> 2u);
}

// Of the invocation's first pixel.
var<private> own_place: i32;

fn load_patches(id: vec3u) {
    let corner = 4 * group_corner(id) - 3;
    let size = 4 * group_size(id) + 6;
    let local = group_local(id);
    for (var y = local.y; y < size.y; y += 8) {
        for (var x = local.x; x < size.x; x += 8) {
            patches_here[shared_place(x, y)] = fetch(here, 0u, corner + vec2i(x, y)).x;
        }
    }
    let seat = group_seat(id);
    own_place = shared_place(4 * seat.x, 4 * seat.y);
    workgroupBarrier();
}

fn load_patch(corner: vec2i) {
    for (var i = 0; i < 100; i++) {
        patch_here[i] = fetch(here, 0u, corner + vec2i(i % 10 - 1, i / 10 - 1)).x;
    }
}

// Sums over the patch of the difference, its square and its products with the gradients.
struct Fit {
    difference: f32,
    square: f32,
    slope: vec2f,
}

// The patch at (x, y), each -1..8.
fn at(x: i32, y: i32) -> f32 {
    if shared_windows {
        return patches_here[own_place + shared_place(x + 1, y + 1)];
    }
    return patch_here[10 * y + x + 11];
}

fn gradient(x: i32, y: i32) -> vec2f {
    return 0.5 * vec2f(at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1));
}

fn row(y: i32) -> array<f32, 10> {
    var values: array<f32, 10>;
    for (var x = 0; x < 10; x++) {
        values[x] = at(x - 1, y);
    }
    return values;
}

fn fit(corner: vec2i, motion: vec2f) -> Fit {
    let whole = floor(motion);
    let share = motion - whole;
    let first = corner + vec2i(whole);
    var sums = Fit(0.0, 0.0, vec2f(0.0));
    // Row y - 1 of the other picture, and rows y - 2 to y of the patch.
    var above: array<f32, 8>;
    var upper: array<f32, 10>;
    var middle: array<f32, 10>;
    var lower = row(-1);
    for (var y = 0; y < 9; y++) {
        upper = middle;
        middle = lower;
        lower = row(y);
        var left = fetch(there, 1u, first + vec2i(0, y)).x;
        for (var x = 0; x < 8; x++) {
            let right = fetch(there, 1u, first + vec2i(x + 1, y)).x;
            let value = left + (right - left) * share.x;
            left = right;
            if y > 0 {
                let difference = above[x] + (value - above[x]) * share.y - middle[x + 1];
                let slope = 0.5 * vec2f(middle[x + 2] - middle[x], lower[x + 1] - upper[x + 1]);
                sums.difference += difference;
                sums.square += difference * difference;
                sums.slope += difference * slope;
            }
            above[x] = value;
        }
    }
    return sums;
}

// Sum of the squared differences, without that of their mean.
fn error(sums: Fit) -> f32 {
    return sums.square - sums.difference * sums.difference / 64.0;
}

fn within_reach(motion: vec2f) -> vec2f {
    return clamp(motion, vec2f(-params.reach), vec2f(params.reach));
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    let p = group_pixel(id);
    let corner = 4 * p - 2;
    if shared_windows {
        load_patches(id);
    } else {
        load_patch(corner);
    }
    var mean = vec2f(0.0);
    var squares = vec3f(0.0);
    for (var i = 0; i < 64; i++) {
        let g = gradient(i % 8, i / 8);
        mean += g;
        squares += vec3f(g.x * g.x, g.x * g.y, g.y * g.y);
    }
    mean /= 64.0;
    // The Hessian of 3.1, of gradients without their mean.
    let xx = squares.x - 64.0 * mean.x * mean.x + TEXTURE;
    let xy = squares.y - 64.0 * mean.x * mean.y;
    let yy = squares.z - 64.0 * mean.y * mean.y + TEXTURE;
    let determinant = xx * yy - xy * xy;

    var first = vec2f(0.0);
    let middle = vec2f(p) + 0.5;
    if params.starts > 0u {
        first = within_reach(params.scale * sample_linear(start, 2u, params.scale * middle).xy);
    }
    var best = fit(corner, first);
    let neighbours = array(vec2f(-1.0, 0.0), vec2f(1.0, 0.0), vec2f(0.0, -1.0), vec2f(0.0, 1.0), vec2f(0.0));
    for (var i = 0u; i < 5u; i++) {
        var motion = vec2f(0.0);
        if i < 4u {
            if i + 1u >= params.starts {
                continue;
            }
            motion = params.scale * sample_linear(start, 2u, params.scale * (middle + neighbours[i])).xy;
            motion = within_reach(motion);
        } else if params.rest == 0u {
            continue;
        }
        let other = fit(corner, motion);
        if error(other) < BETTER * error(best) - ROUNDING {
            best = other;
            first = motion;
        }
    }

    var motion = first;
    var result = first;
    var sums = best;
    for (var step = 0u; step < params.steps; step++) {
        let slope = sums.slope - mean * sums.difference;
        motion -= vec2f(yy * slope.x - xy * slope.y, xx * slope.y - xy * slope.x) / determinant;
        motion = within_reach(clamp(motion, first - FARTHEST, first + FARTHEST));
        sums = fit(corner, motion);
        if error(sums) < error(best) {
            best = sums;
            result = motion;
        }
    }
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(result, 0.0, 0.0));
    }
}
