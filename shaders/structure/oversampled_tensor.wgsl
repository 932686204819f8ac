// The structure tensor of Gaussian derivatives at twice the resolution, by resampling convolution
// (2.4.6). Columns are summed once and held in workgroup memory for all pixels whose windows they are in.
// Cost: 2/3 + radius / 4 columns of 2 radius + 1 loads and as many multiply-adds on two vec4; as many again
// along the row.
#import gpu/group
#import shared/outer_product

struct Params {
    /// Pixels of the picture on each side of the centre.
    radius: i32,
    /// Bit 0: the gradient of the luma alone. Bit 1: divide each channel's tensor by its
    /// gradient's magnitude (2.133).
    flags: u32,
    /// Factor on the colours.
    scale: f32,
    /// A tensor is valid (w = 1) above this lambda1 (2.164).
    threshold: f32,
    /// Weights of the pixels from -radius on for a position 1/4 pixel beyond the centre's.
    smoothing: array<vec4f, 10>,
    /// The same of the derivative.
    derivative: array<vec4f, 10>,
}

#params
#input source
#output target_image rgba32float

// Colour times coverage, and coverage.
fn tap(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    return vec4f(v.rgb * v.a, v.a);
}

// Smoothing and derivative weight of the pixel at distance j. Positions before the centre's, at even
// pixels, see the mirror image.
fn weights(j: i32, phase: i32) -> vec2f {
    let side = 2 * phase - 1;
    let i = side * j + params.radius;
    return vec2f(params.smoothing[i >> 2u][i & 3], f32(side) * params.derivative[i >> 2u][i & 3]);
}

struct Column {
    smoothed: vec4f,
    derived: vec4f,
}

// Derivatives are sums of differences from the middle: where all is flat they are exactly 0.
fn column(p: vec2i, phase: i32) -> Column {
    let middle = tap(p);
    var c = Column(vec4f(0.0), vec4f(0.0));
    for (var j = -params.radius; j <= params.radius; j++) {
        let value = tap(p + vec2i(0, j));
        let w = weights(j, phase);
        c.smoothed += w.x * value;
        c.derived += w.y * (value - middle);
    }
    return c;
}

// Columns around the workgroup's pixels, radius at most 19: one for every output row, 5 pixels of the picture
// and those on both sides.
var<workgroup> smoothed: array<vec4f, 344>;
var<workgroup> derived: array<vec4f, 344>;

// Sums the columns that the workgroup needs.
fn share_columns(id: vec3u) {
    let local = group_local(id);
    let size = group_size(id);
    let corner = group_corner(id);
    let first = (corner.x >> 1u) - params.radius;
    let last = ((corner.x + size.x - 1) >> 1u) + params.radius;
    let stride = 5 + 2 * params.radius;
    let y = corner.y + local.y;
    if local.y < size.y {
        for (var x = first + local.x; x <= last; x += 8) {
            let c = column(vec2i(x, y >> 1u), y & 1);
            smoothed[local.y * stride + x - first] = c.smoothed;
            derived[local.y * stride + x - first] = c.derived;
        }
    }
    workgroupBarrier();
}

// The column i pixels of the picture to the right.
fn column_beside(id: vec3u, i: i32) -> Column {
    let p = group_pixel(id);
    if shared_windows {
        let place = (p.x >> 1u) - (group_corner(id).x >> 1u) + params.radius + i;
        let at = group_seat(id).y * (5 + 2 * params.radius) + place;
        return Column(smoothed[at], derived[at]);
    }
    return column((p >> vec2u(1u)) + vec2i(i, 0), p.y & 1);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if shared_windows {
        share_columns(id);
    }
    let p = group_pixel(id) >> vec2u(1u);
    let phase = group_pixel(id).x & 1;
    let middle = column_beside(id, 0).smoothed;
    var gx = vec4f(0.0);
    var gy = vec4f(0.0);
    for (var i = -params.radius; i <= params.radius; i++) {
        let c = column_beside(id, i);
        let w = weights(i, phase);
        gx += w.y * (c.smoothed - middle);
        gy += w.x * c.derived;
    }
    let t = outer_product(tap(p), gx, gy, params.scale, params.flags, params.threshold);
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), t);
    }
}
