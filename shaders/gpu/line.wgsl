#import gpu/grid

// Straight lines through a pixel in steps of one pixel along the axis nearer to them, so that every tap lies between
// two pixels of a row or of a column (3.6, 3.7).
//
// To clamp the taps of a line to the picture is half of the work to find them, and most lines need none. A kernel
// therefore goes along its line in a function that is called with `inside` once as true and once as false:
//
//   if line_inside(line, slot, steps) { sum = gather(line, true); } else { sum = gather(line, false); }

struct Line {
    // The pixel, absolute.
    pixel: vec2i,
    // The same as a texel of the texture that taps are read from.
    texel: vec2i,
    // True where a step is one pixel along x, false where it is one along y.
    along_x: bool,
    // Pixels along the other axis per step, -1..1.
    slope: f32,
}

// Where a tap lies, from the pixel of the line: `f` of the way from one pixel to the `next`.
struct LinePlace {
    offset: vec2i,
    next: vec2i,
    f: f32,
}

// A tap between the pixels `a` and `b`: `f` of the way from the first to the second.
struct LineTap {
    a: vec4f,
    b: vec4f,
    f: f32,
}

// A line through the pixel at absolute position p, for taps from input `slot`.
fn line_through(p: vec2i, slot: u32, along_x: bool, slope: f32) -> Line {
    return Line(p, p - grid.inputs[slot].xy, along_x, slope);
}

// True when the picture of input `slot` holds all pixels that the taps of up to `steps` steps lie between.
fn line_inside(line: Line, slot: u32, steps: i32) -> bool {
    let room = vec2i(steps + 1);
    return all(line.pixel >= room) && all(line.pixel + room < grid.inputs[slot].zw);
}

// Where the tap `k` steps from the pixel lies.
fn line_place(line: Line, k: i32) -> LinePlace {
    let across = f32(k) * line.slope;
    let whole = floor(across);
    let i = i32(whole);
    let offset = select(vec2i(i, k), vec2i(k, i), line.along_x);
    return LinePlace(offset, select(vec2i(1, 0), vec2i(0, 1), line.along_x), across - whole);
}

// The tap `k` steps from the pixel; of lines that are not `inside`, clamped to the picture.
fn line_tap(image: texture_2d<f32>, slot: u32, line: Line, k: i32, inside: bool) -> LineTap {
    let place = line_place(line, k);
    if inside {
        let texel = line.texel + place.offset;
        return LineTap(textureLoad(image, texel, 0), textureLoad(image, texel + place.next, 0), place.f);
    }
    let p = line.pixel + place.offset;
    return LineTap(fetch(image, slot, p), fetch(image, slot, p + place.next), place.f);
}
