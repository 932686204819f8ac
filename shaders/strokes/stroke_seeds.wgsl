// What is painted from the point of a cell: a stroke along the tensor field, as long and as wide as the picture keeps its
// colour (Hertzmann 1998, 2.2), where no higher point is near and the picture has detail of its size.
// Cost: 25 loads of points; where there is a stroke about 45 loads and 500 operations.
#import gpu/grid
#import shared/tensor
#import shared/value_noise

struct Params {
    /// Pixels by which cells begin before the picture.
    offset: vec2f,
    /// Pixels of the finest level on a cell's side.
    cell: f32,
    /// Distance within which the highest point alone is a seed, pixels.
    apart: f32,
    /// Half the width of strokes, pixels.
    half_width: f32,
    /// Half their length, pixels.
    half_length: f32,
    /// Share of the field's bend that strokes follow, 0..=1.
    curve: f32,
    /// Difference of colour from which on a stroke ends, Lab.
    tolerance: f32,
    /// Difference between the picture and the coarse one from which on there are strokes, Lab; below 0: everywhere.
    threshold: f32,
    /// 1 / distance along a stroke at which colours count half, pixels.
    inverse_smoothing: f32,
    /// Largest change of lightness from stroke to stroke, L.
    variation: f32,
    /// Largest change of hue, radians.
    hue_variation: f32,
    /// Nonzero where there are object ids.
    by_id: u32,
}

#params
#input points, tensors, flat_image, coarse, ids, smooth_image
#output places rgba32float
#output shapes rgba32float
#output colours rgba32float

// Size below which a stroke is none.
const LEAST: f32 = 0.1;
// Steps to each side of a stroke.
const STEPS: i32 = 6;
// Where a picture is flat within so many widths, strokes lie as the hand has it: slope against the field at most, and the
// difference in Lab that counts as flat no more.
const FLAT_WITHIN: f32 = 1.5;
const MOST_SLOPE: f32 = 0.5;
const NOT_FLAT: f32 = 4.0;
// Turn of a stroke along half its length at most.
const MOST_TURN: f32 = 0.7;

fn object_id(p: vec2i) -> f32 {
    let v = fetch(ids, 4u, p).x;
    // Neither NaN nor infinity.
    let good = (bitcast<u32>(v) & 0x7f800000u) != 0x7f800000u;
    return select(0.0, v, params.by_id != 0u && good);
}

// Difference of two colours in Lab.
fn difference(a: vec3f, b: vec3f) -> f32 {
    let d = a - b;
    return sqrt(dot(d, d));
}

// A triangle wave from -1 to 1.
fn wave(v: f32) -> f32 {
    return 4.0 * abs(v - floor(v) - 0.5) - 1.0;
}

fn rise(t: f32) -> f32 {
    let c = clamp(t, 0.0, 1.0);
    return c * c * (3.0 - 2.0 * c);
}

// How far the tangent at `p` turns from `t`, about its sine.
fn turn(t: vec2f, p: vec2i) -> f32 {
    let other = tensor_tangent(fetch(tensors, 1u, p));
    let sine = t.x * other.y - t.y * other.x;
    return select(sine, -sine, dot(t, other) < 0.0);
}

// Size of the stroke of a point, as higher ones are near it.
fn prominence(cell: vec2i, own: vec4f) -> f32 {
    let size = grid.inputs[0].zw;
    var share = own.w;
    for (var dy = -2; dy <= 2; dy++) {
        for (var dx = -2; dx <= 2; dx++) {
            let c = cell + vec2i(dx, dy);
            if any(c < vec2i(0)) || any(c >= size) {
                continue;
            }
            let other = fetch(points, 0u, c);
            if other.z > own.z {
                let d = other.xy - own.xy + vec2f(f32(dx), f32(dy)) * params.cell;
                // What comes nearer counts little by little, so that strokes neither appear nor vanish at once.
                let near = clamp(6.6666665 - sqrt(dot(d, d)) / params.apart * 6.6666665, 0.0, 1.0);
                share = min(share, 1.0 - near * other.w);
            }
        }
    }
    return share;
}

// The pixel at a place beside a cell's corner.
fn at(corner: vec2f, place: vec2f) -> vec2i {
    return vec2i(corner) + vec2i(floor(place));
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let cell = pixel(id);
    let own = fetch(points, 0u, cell);
    // From the corner of the cell, so that a picture's place in a larger one rounds nothing.
    let corner = vec2f(cell) * params.cell - params.offset;
    let seed = at(corner, own.xy);
    let middle = fetch(flat_image, 2u, seed);
    var share = prominence(cell, own);
    if share <= LEAST || middle.a < 0.5 {
        textureStore(places, vec2i(id.xy), vec4f(0.0));
        textureStore(shapes, vec2i(id.xy), vec4f(0.0));
        textureStore(colours, vec2i(id.xy), vec4f(0.0));
        return;
    }
    let base = fetch(smooth_image, 5u, seed).rgb;
    let w = params.half_width;
    let l = params.half_length;
    let field = tensor_tangent(fetch(tensors, 1u, seed));
    var varied = 0.0;
    for (var i = 0; i < 4; i++) {
        let far = FLAT_WITHIN * w * select(1.0, -1.0, (i & 1) == 1);
        let d = select(field, vec2f(-field.y, field.x), i < 2) * far;
        varied = max(varied, difference(fetch(smooth_image, 5u, at(corner, own.xy + d)).rgb, base));
    }
    let slope = MOST_SLOPE * (1.0 - rise(varied / NOT_FLAT)) * wave(own.z * 3.0 + 0.7);
    let t = (field + vec2f(-field.y, field.x) * slope) / sqrt(1.0 + slope * slope);
    let n = vec2f(-t.y, t.x);
    let bend = turn(field, at(corner, own.xy + field * (0.5 * l))) - turn(field, at(corner, own.xy - field * (0.5 * l)));
    let curvature = clamp(bend * params.curve, -MOST_TURN, MOST_TURN) / l;

    let thing = object_id(seed);
    var sum = middle.rgb;
    var weight = 1.0;
    var ends = vec2f(l);
    let step_length = l / f32(STEPS);
    for (var side = 0; side < 2; side++) {
        let along = select(1.0, -1.0, side == 1);
        var before = 0.0;
        for (var i = 1; i <= STEPS; i++) {
            let u = f32(i) * step_length;
            let q = own.xy + t * (along * u) + n * (0.5 * curvature * u * u);
            let place = at(corner, q);
            let c = fetch(flat_image, 2u, place);
            if c.a < 0.5 || abs(object_id(place) - thing) > 0.5 {
                ends[side] = u - 0.5 * step_length;
                break;
            }
            let now = difference(fetch(smooth_image, 5u, place).rgb, base);
            if now > params.tolerance {
                // Between two steps, so that ends do not jump.
                let rest = 1.0 - (params.tolerance - before) / max(now - before, 1e-3);
                ends[side] = u - step_length * clamp(rest, 0.0, 1.0);
                break;
            }
            before = now;
            let far = u * params.inverse_smoothing;
            let counts = 1.0 / (1.0 + far * far);
            sum += c.rgb * counts;
            weight += counts;
        }
    }
    let vary = 0.85 + 0.3 * value_noise(vec2f(own.z * 75.0, 7.0), 3u);

    var room = 0.6;
    var missing = 0.0;
    for (var side = 0; side < 2; side++) {
        let along = select(1.0, -1.0, side == 1);
        let c = fetch(smooth_image, 5u, at(corner, own.xy + n * (along * 0.8 * w))).rgb;
        room += 0.2 - 0.2 * rise(2.0 * difference(c, base) / params.tolerance - 1.5);
        let across = at(corner, own.xy + n * (along * 0.7 * w));
        missing += difference(fetch(flat_image, 2u, across).rgb, fetch(coarse, 3u, across).rgb);
        let ahead = at(corner, own.xy + t * (along * 0.35 * l));
        missing += difference(fetch(flat_image, 2u, ahead).rgb, fetch(coarse, 3u, ahead).rgb);
    }
    missing = 0.2 * (missing + difference(middle.rgb, fetch(coarse, 3u, seed).rgb));
    if params.threshold >= 0.0 {
        share *= rise(missing / params.threshold - 1.0);
    }
    share = (share - LEAST) * (1.0 / (1.0 - LEAST));
    let width = w * room * max(share, 0.0);
    // A stroke that comes or goes is small, not thin.
    ends = max(ends * (vary * (0.4 + 0.6 * clamp(share, 0.0, 1.0))), vec2f(width));

    var c = sum / weight;
    let grey = 1.0 + 0.04 * params.variation * wave(own.z * 5.0);
    let hue = params.hue_variation * wave(own.z * 11.0 + 0.3);
    let ab = vec2f(c.g - c.b * hue, c.b + c.g * hue) * grey;
    c = vec3f(c.r + params.variation * wave(own.z * 7.0), ab);
    textureStore(places, vec2i(id.xy), vec4f(own.xy, own.z, width));
    textureStore(shapes, vec2i(id.xy), vec4f(t * ends.y, curvature, ends.x));
    textureStore(colours, vec2i(id.xy), vec4f(c, thing));
}
