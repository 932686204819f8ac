// Where strokes may begin: in each cell of the screen the highest of the points of a lattice that lie there. Points of the
// lattice belong to rest positions, else to what motion carries, else to the screen, and so does all that is random of them.
// Cost: on the screen 4 hashes; else up to 64 hashes and about 1500 operations.
#import shared/rest_position
#import gpu/grid

struct Params {
    /// Pixels by which cells begin before the picture.
    offset: vec2f,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// Pixels of the finest level on a cell's side.
    cell: i32,
    /// Pixels between points of the lattice on the screen.
    spacing: f32,
    /// Its logarithm, to base 2.
    level: f32,
    /// 1 / distance in pixels of both layers' places from which on they have points of their own.
    decay: f32,
    /// Another number gives other points.
    seed: u32,
    /// Number that is added to it for points of a carried layer's life alone.
    life: u32,
    /// 0 for points of the screen, 1 and 2 of the first and the second layer that are carried, 3 of rest positions.
    way: u32,
}

#params
#input guide, scales
#output target_image rgba32float

// Change of the weight of an octave from a pixel to one beside a cell, at most.
const SOON: f32 = 0.2;

// A point of the lattice: its place in it, its height, and two more numbers of its own in 0..1.
struct Point {
    place: vec3f,
    rank: f32,
    chance: vec2f,
}

// Surface at a pixel: its point, its change per pixel, and the logarithm of the spacing that points are to have there.
struct Surface {
    point: vec3f,
    x: vec3f,
    y: vec3f,
    level: f32,
    found: bool,
}

fn mixed(v: u32) -> u32 {
    var h = v;
    h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12u)) * 0x297a2d39u;
    return h ^ (h >> 15u);
}

fn lattice_point(c: vec3i, seed: u32) -> Point {
    let a = mixed((u32(c.x) * 0x9e3779b1u) ^ (u32(c.y) * 0x85ebca77u) ^ (u32(c.z) * 0xc2b2ae3du) ^ seed);
    let b = mixed(a ^ 0x68e31da4u);
    let d = mixed(b ^ 0xb5297a4du);
    let place = vec3f(f32(a & 1023u), f32((a >> 10u) & 1023u), f32((a >> 20u) & 1023u)) * 0.0009765625;
    let chance = vec2f(f32(d >> 16u), f32(d & 0xffffu)) * 1.5258789e-5;
    return Point(vec3f(c) + place, f32(b >> 8u) * 2.3841858e-7, chance);
}

// 1 for points whose chance is below a weight, those about there little by little.
fn counted(weight: f32, chance: f32) -> f32 {
    return clamp((1.125 * weight - chance) * 8.0, 0.0, 1.0);
}

// Of the points of a cell the best one stays: high ones that are as large as they may be.
fn better(best: vec4f, place: vec2f, rank: f32, share: f32) -> vec4f {
    let inside = all(place >= vec2f(0.0)) && all(place < vec2f(f32(params.cell)));
    let wins = inside && share > 0.0 && rank * share > best.z * best.w;
    return select(best, vec4f(place, rank, share), wins);
}

// Change of the point per pixel along an axis; of both sides the one with less change lies on the same surface.
fn change(p: vec2i, here: vec3f, axis: vec2i) -> vec3f {
    let before = fetch(guide, 0u, p - axis);
    let after = fetch(guide, 0u, p + axis);
    let has_before = is_at_rest(before) && all(p - axis >= vec2i(0));
    let has_after = is_at_rest(after) && all(p + axis < grid.inputs[0].zw);
    let back = select(vec3f(0.0), here - before.xyz, has_before);
    let ahead = select(vec3f(0.0), after.xyz - here, has_after);
    return select(back, ahead, has_after && (!has_before || dot(ahead, ahead) < dot(back, back)));
}

fn surface(p: vec2i) -> Surface {
    let point = fetch(guide, 0u, p);
    let scale = fetch(scales, 1u, p).x;
    if !is_at_rest(point) || !has_footprint(scale) {
        return Surface(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, false);
    }
    // So far from 0 that floats do not tell finer cells apart, points are farther apart.
    let farthest = max(max(abs(point.x), abs(point.y)), abs(point.z));
    let exponent = f32(i32((bitcast<u32>(farthest) >> 23u) & 255u) - 127);
    let level = clamp(max(scale + params.level, exponent - 18.0), -60.0, 60.0);
    let x = change(p, point.xyz, vec2i(1, 0));
    let y = change(p, point.xyz, vec2i(0, 1));
    return Surface(point.xyz, x, y, level, true);
}

// From a pixel's centre to where the surface is nearest to a point of the lattice, pixels, and how far that is, cells.
fn nearest(s: Surface, unit: f32, place: vec3f) -> vec3f {
    let v = place - s.point * unit;
    let x = s.x * unit;
    let y = s.y * unit;
    let a = dot(x, x);
    let b = dot(x, y);
    let c = dot(y, y);
    let det = a * c - b * b;
    if det <= 1e-4 * a * c || a * c < 1e-20 {
        return vec3f(1e6);
    }
    let g = vec2f(dot(x, v), dot(y, v));
    let d = vec2f(c * g.x - b * g.y, a * g.y - b * g.x) / det;
    let off = v - x * d.x - y * d.y;
    return vec3f(d, sqrt(dot(off, off)));
}

// Weight of the points of an octave, so many octaves above the spacing that is wanted: those of the finer one come while
// those of the coarser one go, so that there are as many on the screen.
fn octave_weight(above: f32) -> f32 {
    let t = 1.0 - abs(above);
    return select(0.5 * (t + t * t), t, above > 0.0) * select(0.0, 1.0, t > 0.0);
}

fn near_cell(corner: vec2i, target_place: vec2f) -> bool {
    let d = target_place - vec2f(corner);
    return all(d > vec2f(-1.0)) && all(d < vec2f(f32(params.cell) + 1.0));
}

fn in_picture(p: vec2i) -> bool {
    return all(p >= vec2i(0)) && all(p < grid.inputs[0].zw);
}

// Blocks of eight cells of the lattice, or of four, whose points were looked at: pixels side by side mostly see the same.
struct Seen {
    blocks: array<vec4i, 8>,
    count: u32,
}

// True for a block of the lattice that was not looked at before.
fn is_new(seen: ptr<function, Seen>, block: vec4i) -> bool {
    for (var i = 0u; i < (*seen).count; i++) {
        if all((*seen).blocks[i] == block) {
            return false;
        }
    }
    if (*seen).count == 8u {
        return false;
    }
    (*seen).blocks[(*seen).count] = block;
    (*seen).count += 1u;
    return true;
}

fn solid(corner: vec2i, p: vec2i, s: Surface, so_far: vec4f, seen: ptr<function, Seen>) -> vec4f {
    var best = so_far;
    for (var n = 0; n < 2; n++) {
        let octave = i32(floor(s.level)) + n;
        let unit = bitcast<f32>(u32(127 - octave) << 23u);
        let first = vec3i(floor(s.point * unit - 0.5));
        if !is_new(seen, vec4i(first, octave)) {
            continue;
        }
        let seed = params.seed + u32(octave) * 0x9e3779b9u;
        for (var i = 0; i < 8; i++) {
            let found = lattice_point(first + vec3i(i & 1, (i >> 1u) & 1, i >> 2u), seed);
            // Nothing can come of what is lower than the best so far, or far from its turn.
            let soon = octave_weight(f32(octave) - s.level) + SOON;
            if found.rank <= best.z * best.w || counted(soon, found.chance.x) <= 0.0 {
                continue;
            }
            let way = nearest(s, unit, found.place);
            let there = vec2f(p) + 0.5 + way.xy;
            let landed = vec2i(floor(there));
            if way.z > 1.0 || !near_cell(corner, there) || !in_picture(landed) {
                continue;
            }
            let below = surface(landed);
            if !below.found {
                continue;
            }
            let rest = nearest(below, unit, found.place);
            let weight = octave_weight(f32(octave) - below.level);
            let share = counted(weight, found.chance.x) * clamp((0.525 - rest.z) * 20.0, 0.0, 1.0);
            if all(abs(rest.xy) < vec2f(1.5)) {
                best = better(best, vec2f(landed - corner) + 0.5 + rest.xy, found.rank, share);
            }
        }
    }
    return best;
}

// Where the centre of a pixel belongs to in the lattice of the layer.
fn carried_place(p: vec2i) -> vec2f {
    let ways = fetch(guide, 0u, p);
    return (vec2f(p) + 0.5 + params.origin + select(ways.xy, ways.zw, params.way == 2u)) / params.spacing;
}

fn carried(corner: vec2i, p: vec2i, so_far: vec4f, seen: ptr<function, Seen>) -> vec4f {
    var best = so_far;
    let q = carried_place(p);
    let first = vec2i(floor(q - 0.5));
    if !is_new(seen, vec4i(first, 0, 0)) {
        return best;
    }
    for (var i = 0; i < 8; i++) {
        // Points that all layers have in common, and those of this life alone.
        let is_own = i >= 4;
        let seed = params.seed + select(0u, params.life, is_own);
        let found = lattice_point(vec3i(first + vec2i(i & 1, (i >> 1u) & 1), 0), seed);
        if found.rank <= best.z * best.w {
            continue;
        }
        var landed = p;
        var d = (found.place.xy - q) * params.spacing;
        var good = near_cell(corner, vec2f(p) + 0.5 + d);
        for (var n = 0; n < 2; n++) {
            landed = vec2i(floor(vec2f(landed) + 0.5 + d));
            good = good && in_picture(landed);
            landed = clamp(landed, vec2i(0), grid.inputs[0].zw - 1);
            d = (found.place.xy - carried_place(landed)) * params.spacing;
            good = good && near_cell(corner, vec2f(landed) + 0.5 + d);
            if !good {
                break;
            }
        }
        if !good || any(abs(d) > vec2f(1.0)) {
            continue;
        }
        // Where both layers are at one place they have the same points.
        let ways = fetch(guide, 0u, landed);
        let between = ways.zw - ways.xy;
        let t = min(sqrt(dot(between, between)) * params.decay, 1.0);
        let own = t * t * (3.0 - 2.0 * t);
        let share = counted(select(1.0 - own, own, is_own), found.chance.y);
        best = better(best, vec2f(landed - corner) + 0.5 + d, found.rank, share);
    }
    return best;
}

fn flat(corner: vec2i, so_far: vec4f) -> vec4f {
    var best = so_far;
    let half = vec2f(0.5 * f32(params.cell));
    let q = (vec2f(corner) + half + params.origin) / params.spacing;
    let first = vec2i(floor(q - 0.5));
    for (var i = 0; i < 4; i++) {
        let found = lattice_point(vec3i(first + vec2i(i & 1, i >> 1u), 0), params.seed);
        best = better(best, half + (found.place.xy - q) * params.spacing, found.rank, 1.0);
    }
    return best;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let corner = pixel(id) * params.cell - vec2i(params.offset);
    var best = vec4f(0.0);
    if params.way == 0u {
        best = flat(corner, best);
    } else {
        var is_beside = false;
        var seen: Seen;
        for (var n = 0; n < 4; n++) {
            let p = corner + vec2i((1 + 2 * (n & 1)) * params.cell, (1 + 2 * (n >> 1u)) * params.cell) / 4;
            if !in_picture(p) {
                continue;
            }
            if params.way < 3u {
                best = carried(corner, p, best, &seen);
                continue;
            }
            let s = surface(p);
            if s.found {
                best = solid(corner, p, s, best, &seen);
            } else {
                is_beside = true;
            }
        }
        if is_beside {
            best = beside(corner, best);
        }
    }
    textureStore(target_image, vec2i(id.xy), best);
}

// Points of the screen where there is no object.
fn beside(corner: vec2i, so_far: vec4f) -> vec4f {
    let found = flat(corner, vec4f(0.0));
    let landed = vec2i(floor(vec2f(corner) + found.xy));
    if !in_picture(landed) || surface(landed).found {
        return so_far;
    }
    return better(so_far, found.xy, found.z, found.w);
}
