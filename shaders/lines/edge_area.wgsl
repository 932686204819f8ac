// The edge image of a response, averaged over an area around each pixel, so that lines keep their coverage while they
// move by parts of a pixel. The more of neighbouring frames counts at a pixel the wider the area is; where the
// frame stands alone or nothing moves it is a point.
// Cost: eleven loads and 16 thresholds.
#import gpu/grid
#import shared/edge_threshold

struct Params {
    /// Side of the area where all frames count, pixels, 0..=2.
    width: f32,
    /// How much the response is sharpened there.
    sharpening: f32,
    /// One over the sum of the weights of all other frames where they count in full.
    inverse_most: f32,
    /// One over the motion from which on lines count as moving, in pixels.
    inverse_moving: f32,
    /// How the response becomes an edge image: 1 binary (4.6), 2 tanh (4.8), 3 smoothstep.
    threshold: u32,
    /// Response from which on there is no line, units of L.
    epsilon: f32,
    /// Steepness of the ramp, per unit of L.
    phi: f32,
    /// Share of the paper that shows through lines, which are narrower than a pixel; 0 where they are not.
    faintness: f32,
}

#params
#input response
// Share of the last frame, sum of weights.
#input shares
// To the nearest other frame, pixels.
#input motion
#output target_image r32float

// The response beside one; that one itself where nothing is covered.
fn beside(p: vec2i, own: f32) -> f32 {
    let value = fetch(response, 0u, p).x;
    return select(value, own, value >= NOT_COVERED);
}

// Four samples across a pixel, from the values before, at and behind it; `reach` is the outermost.
fn samples(before: f32, own: f32, behind: f32, reach: f32) -> vec4f {
    let far = reach * vec2f(before - own, behind - own);
    return own + vec4f(far.x, far.x / 3.0, far.y / 3.0, far.y);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let own = fetch(response, 0u, p).x;
    let speed = min(length(fetch(motion, 2u, p).xy) * params.inverse_moving, 1.0);
    let share = clamp((fetch(shares, 1u, p).y - 1.0) * params.inverse_most, 0.0, 1.0) * speed;
    var rows: array<vec3f, 3>;
    for (var y = 0; y < 3; y++) {
        for (var x = 0; x < 3; x++) {
            rows[y][x] = beside(p + vec2i(x - 1, y - 1), own);
        }
    }
    let around = 0.25 * ((rows[0].y + rows[2].y) + (rows[1].x + rows[1].z));
    let sharper = params.sharpening * share * (own - around);
    // The outermost of four samples that divide the area evenly.
    let reach = 0.375 * params.width * share;
    let top = samples(rows[0].x, rows[0].y, rows[0].z, reach);
    let middle = samples(rows[1].x, rows[1].y, rows[1].z, reach);
    let bottom = samples(rows[2].x, rows[2].y, rows[2].z, reach);
    var sum = 0.0;
    for (var i = 0; i < 4; i++) {
        let column = samples(top[i], middle[i], bottom[i], reach);
        for (var j = 0; j < 4; j++) {
            sum += edge_threshold(column[j] + sharper, params.threshold, params.epsilon, params.phi);
        }
    }
    var result = sum / 16.0;
    if share <= 0.0 {
        result = edge_threshold(own, params.threshold, params.epsilon, params.phi);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(fainter(result, params.faintness)));
}
