// A layer of brush strokes: each pixel gathers those that may cover it and keeps the topmost, whose bristles leave marks of
// different height and ragged ends.
// Cost: (2 cells + 1)^2 loads; for each stroke at hand about 40 operations, and 200 more where it covers the pixel.
#import gpu/grid
#import shared/value_noise

struct Params {
    /// Pixels by which cells begin before the picture.
    offset: vec2f,
    /// Pixels of the finest level on a cell's side.
    cell: f32,
    /// Cells on each side in which strokes are that may cover a pixel.
    cells: i32,
    /// Farthest that a stroke reaches from its seed, on each axis, pixels.
    reach: f32,
    /// Longest half of a stroke's length, pixels.
    longest: f32,
    /// Longest half of a stroke's width, pixels.
    widest: f32,
    /// 1 / width of the marks of bristles, 1 / pixels.
    across: f32,
    /// 1 / length of the marks of bristles, 1 / pixels.
    along: f32,
    /// Share of a stroke's end that is ragged, 0..1.
    ragged: f32,
    /// Share of a stroke that the paint does not cover, 0..=1.
    dryness: f32,
    /// Height of the middle of a stroke.
    body: f32,
    /// Height of the marks of its bristles.
    relief: f32,
    /// 1 / pixels over which borders are soft.
    inverse_soft: f32,
    /// Nonzero where nothing is painted below.
    begin: u32,
    /// Nonzero where there are object ids.
    by_id: u32,
}

#params
#input places, shapes, colours, below, heights_below, ids
#output target_image rgba32float
#output heights rgba32float

// Strokes that are kept of those that cover a pixel.
const KEPT: u32 = 4u;
// Coverage from which on a stroke counts, and what is left of a pixel that counts as covered.
const LEAST: f32 = 0.02;
// Height where nothing is painted.
const GROUND: f32 = 0.3;

struct Mark {
    alpha: f32,
    height: f32,
}

// What the stroke of a cell leaves `d` from its seed.
fn mark(cell: vec2i, place: vec4f, d: vec2f) -> Mark {
    let shape = fetch(shapes, 1u, cell);
    let back = sqrt(dot(shape.xy, shape.xy));
    let t = shape.xy / max(back, 1e-6);
    let u = dot(d, t);
    let v = d.y * t.x - d.x * t.y - 0.5 * shape.z * u * u;
    let len = clamp(select(back, shape.w, u > 0.0), 1e-3, params.longest);
    let w = min(place.w, params.widest);
    let q = abs(v) / w;
    let e = abs(u) / len;
    if q > 1.1 || e > 1.1 {
        return Mark(0.0, 0.0);
    }
    let phase = place.z * 16.0;
    let x = u * params.along + phase;
    let y = v * params.across;
    let fine = value_noise(vec2f(x, y + 31.0), 11u);
    let coarse = value_noise(vec2f(0.45 * x, 0.37 * y + 77.0), 23u);
    let bristle = 0.5 * fine + 0.5 * coarse;
    let side = 1.0 - 0.22 * value_noise(vec2f(1.3 * x, select(9.0, 3.0, v > 0.0)), 5u);
    let end = 1.0 - params.ragged * bristle - 0.25 * q * q;
    var alpha = clamp((end - e) * len * params.inverse_soft + 0.5, 0.0, 1.0)
        * clamp((side - q) * w * params.inverse_soft + 0.5, 0.0, 1.0);
    // A brush that runs dry covers less and less.
    let dry = params.dryness * (0.26 + 0.49 * (0.5 + 0.5 * u / len));
    alpha *= select(1.0, clamp((bristle - dry) * 8.0 + 0.5, 0.0, 1.0), params.dryness > 0.0);
    // Paint is thick in the middle, heaped up at the sides and thin at the ends.
    let edge = min(q / side, 1.0);
    let square = edge * edge;
    let profile = 1.4 * (1.0 - square * square) + 3.0 * square * (1.0 - edge);
    let ahead = min(e / max(end, 0.1), 1.0);
    let cube = ahead * ahead * ahead;
    let height = GROUND + params.body * profile * (1.0 - cube * cube) + params.relief * (bristle - 0.5);
    return Mark(alpha, height);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = centre(id);
    let own = fetch(below, 3u, pixel(id));
    let v = fetch(ids, 5u, pixel(id)).x;
    // Neither NaN nor infinity.
    let good = (bitcast<u32>(v) & 0x7f800000u) != 0x7f800000u;
    let thing = select(0.0, v, params.by_id != 0u && good);
    let middle = vec2i(floor((p + params.offset) / params.cell));
    let size = grid.inputs[0].zw;
    // The topmost first.
    var ranks = array<f32, 4>(-1e30, -1e30, -1e30, -1e30);
    var marks: array<Mark, 4>;
    var cells: array<vec2i, 4>;
    let first = max(middle - params.cells, vec2i(0));
    let last = min(middle + params.cells, size - 1);
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            let cell = vec2i(x, y);
            let place = fetch(places, 0u, cell);
            let d = p - (vec2f(cell) * params.cell - params.offset) - place.xy;
            if place.w <= 0.0 || place.z <= ranks[3] || any(abs(d) > vec2f(params.reach)) {
                continue;
            }
            let found = mark(cell, place, d);
            if found.alpha < LEAST {
                continue;
            }
            if params.by_id != 0u && abs(fetch(colours, 2u, cell).w - thing) > 0.5 {
                continue;
            }
            var at = 3;
            while at > 0 && place.z > ranks[at - 1] {
                ranks[at] = ranks[at - 1];
                marks[at] = marks[at - 1];
                cells[at] = cells[at - 1];
                at--;
            }
            ranks[at] = place.z;
            marks[at] = found;
            cells[at] = cell;
        }
    }
    var rest = 1.0;
    var sum = vec3f(0.0);
    var height = 0.0;
    for (var i = 0u; i < KEPT; i++) {
        if ranks[i] <= -1e30 || rest < LEAST {
            break;
        }
        let share = rest * marks[i].alpha;
        sum += share * fetch(colours, 2u, cells[i]).rgb;
        height += share * marks[i].height;
        rest -= share;
    }
    let ground = select(fetch(heights_below, 4u, pixel(id)).x, GROUND, params.begin != 0u);
    textureStore(target_image, vec2i(id.xy), vec4f(sum + rest * own.rgb, own.a));
    textureStore(heights, vec2i(id.xy), vec4f(vec3f(height + rest * ground), 1.0));
}
