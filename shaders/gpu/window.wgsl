#import gpu/group

// Windows of neighbours in workgroup memory: what the windows of many pixels share is fetched from the
// texture once.
//
// The shader defines `window_tap(p: vec2i) -> vec4f`, what a window holds of the pixel at absolute position p, and
// `WINDOW_PIXELS`, one of the sizes of gpu/tap. A window is gone through in parts that fit the memory:
//
//   let step = window_step(end - begin + 1);
//   for (var y = begin.y; y <= end.y; y += step.y) {
//       for (var x = begin.x; x <= end.x; x += step.x) {
//           let first = vec2i(x, y);
//           let last = min(first + step - 1, end);
//           let part = window_load(id, first, last);
//           ... window_read(part, offset) for the offsets first to last
//       }
//   }
//
// Offsets are those of taps from their own pixel. What `first` and `last` are made of must be uniform.

var<workgroup> window: array<WindowTap, WINDOW_PIXELS>;

// The taps opposite those of `window`, for kernels that take both at once.
var<workgroup> window_opposite: array<WindowTap, WINDOW_PIXELS>;

struct WindowPart {
    // The invocation's own pixel: absolute, and its index in the two arrays if that were in them.
    pixel: vec2i,
    index: i32,
    opposite: i32,
    // Pixels per row of the arrays.
    stride: i32,
    // False where taps are fetched one by one.
    loaded: bool,
}

// How many of `taps` columns and rows to take at once. Parts of wide windows are about as high as wide, which
// shares the most.
fn window_step(taps: vec2i) -> vec2i {
    let side = i32(GROUP_SIDE);
    let most = WINDOW_PIXELS / side - (side - 1);
    var columns = min(taps.x, most);
    if taps.y > 1 {
        let widest = min(most, 32);
        let parts = (taps.x + widest - 1) / widest;
        columns = (taps.x + parts - 1) / parts;
    }
    return vec2i(columns, min(taps.y, WINDOW_PIXELS / (columns + side - 1) - (side - 1)));
}

// How far a disc reaches to either side in row `dy`: the largest whole number whose square and that of dy are `limit`
// together, or less.
fn window_chord(limit: i32, dy: i32) -> i32 {
    // Half a unit more keeps the root of a square from coming out too small, and reaches no other.
    return i32(sqrt(f32(limit - dy * dy) + 0.5));
}

// A part whose taps are fetched one by one.
fn window_unshared(id: vec3u) -> WindowPart {
    return WindowPart(group_pixel(id), 0, 0, 0, false);
}

// Loads the taps at the offsets `first` to `last` of all pixels of the workgroup.
fn window_load(id: vec3u, first: vec2i, last: vec2i) -> WindowPart {
    if !shared_windows {
        return window_unshared(id);
    }
    let part = window_part(id, first, last);
    let size = group_size(id) + last - first;
    let corner = group_corner(id) + first;
    let local = group_local(id);
    // All have read the part before.
    workgroupBarrier();
    for (var y = local.y; y < size.y; y += i32(GROUP_SIDE)) {
        for (var x = local.x; x < size.x; x += i32(GROUP_SIDE)) {
            window[y * part.stride + x] = window_pack(window_tap(corner + vec2i(x, y)));
        }
    }
    workgroupBarrier();
    return part;
}

// The same, and the taps at the offsets -`last` to -`first`. Both are fetched at once, so that the time of one load
// passes for two.
fn window_load_both(id: vec3u, first: vec2i, last: vec2i) -> WindowPart {
    if !shared_windows {
        return window_unshared(id);
    }
    let part = window_part(id, first, last);
    let size = group_size(id) + last - first;
    let corner = group_corner(id);
    let local = group_local(id);
    workgroupBarrier();
    for (var y = local.y; y < size.y; y += i32(GROUP_SIDE)) {
        for (var x = local.x; x < size.x; x += i32(GROUP_SIDE)) {
            let place = corner + vec2i(x, y);
            let tap = window_pack(window_tap(place + first));
            let opposite = window_pack(window_tap(place - last));
            window[y * part.stride + x] = tap;
            window_opposite[y * part.stride + x] = opposite;
        }
    }
    workgroupBarrier();
    return part;
}

// Where the invocation's taps of a part are.
fn window_part(id: vec3u, first: vec2i, last: vec2i) -> WindowPart {
    let stride = last.x - first.x + i32(GROUP_SIDE);
    let seat = group_seat(id);
    let index = (seat.y - first.y) * stride + seat.x - first.x;
    let opposite = (seat.y + last.y) * stride + seat.x + last.x;
    return WindowPart(group_pixel(id), index, opposite, stride, true);
}

// The tap at `offset`.
fn window_read(part: WindowPart, offset: vec2i) -> vec4f {
    if part.loaded {
        return window_unpack(window[part.index + offset.y * part.stride + offset.x]);
    }
    return window_tap(part.pixel + offset);
}

// The tap at -`offset`.
fn window_read_opposite(part: WindowPart, offset: vec2i) -> vec4f {
    if part.loaded {
        return window_unpack(window_opposite[part.opposite - offset.y * part.stride - offset.x]);
    }
    return window_tap(part.pixel - offset);
}
