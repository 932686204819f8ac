// The structure tensor of each pixel's gradient (2.34), by a separable derivative operator.
// Columns are summed once and held in workgroup memory for all pixels whose windows they are in.
// Cost: 1 + radius / 4 columns of 2 radius + 1 loads, and 4 radius multiply-adds on vec4 each; as many again
// along the row.
#import gpu/group
#import shared/outer_product

struct Params {
    /// Pixels on each side of the centre.
    radius: i32,
    /// Bit 0: the gradient of the luma alone. Bit 1: divide each channel's tensor by its
    /// gradient's magnitude (2.133).
    flags: u32,
    /// Factor on the colours.
    scale: f32,
    /// A tensor is valid (w = 1) above this lambda1 (2.164).
    threshold: f32,
    /// Weights at distance 0, 1, ... across the derivative.
    smoothing: array<vec4f, 5>,
    /// Weights at distance 0, 1, ... along the derivative.
    derivative: array<vec4f, 5>,
}

#params
#input source
#output target_image rgba32float

struct Column {
    smoothed: vec4f,
    derived: vec4f,
}

// Colour times coverage, and coverage.
fn tap(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    return vec4f(v.rgb * v.a, v.a);
}

fn column(p: vec2i) -> Column {
    var c = Column(params.smoothing[0].x * tap(p), vec4f(0.0));
    for (var j = 1; j <= params.radius; j++) {
        let above = tap(p - vec2i(0, j));
        let below = tap(p + vec2i(0, j));
        c.smoothed += params.smoothing[j >> 2u][j & 3] * (above + below);
        c.derived += params.derivative[j >> 2u][j & 3] * (below - above);
    }
    return c;
}

// Both derivatives, of colour times coverage and of coverage.
struct Gradient {
    x: vec4f,
    y: vec4f,
}

// Adds the columns i pixels to the left and to the right.
fn with_columns(g: Gradient, i: i32, left: Column, right: Column) -> Gradient {
    return Gradient(
        g.x + params.derivative[i >> 2u][i & 3] * (right.smoothed - left.smoothed),
        g.y + params.smoothing[i >> 2u][i & 3] * (left.derived + right.derived),
    );
}

fn tensor_of(centre: vec4f, g: Gradient) -> vec4f {
    return outer_product(centre, g.x, g.y, params.scale, params.flags, params.threshold);
}

fn at_place(p: vec2i) -> vec4f {
    var g = Gradient(vec4f(0.0), params.smoothing[0].x * column(p).derived);
    for (var i = 1; i <= params.radius; i++) {
        g = with_columns(g, i, column(p - vec2i(i, 0)), column(p + vec2i(i, 0)));
    }
    return tensor_of(tap(p), g);
}

// Columns around the workgroup's pixels, radius at most 19.
var<workgroup> smoothed: array<vec4f, 368>;
var<workgroup> derived: array<vec4f, 368>;

// Sums the columns that the workgroup needs.
fn share_columns(id: vec3u) {
    let local = group_local(id);
    let size = group_size(id);
    let stride = 8 + 2 * params.radius;
    if local.y < size.y {
        for (var x = local.x; x < size.x + 2 * params.radius; x += 8) {
            let c = column(group_corner(id) + vec2i(x - params.radius, local.y));
            smoothed[local.y * stride + x] = c.smoothed;
            derived[local.y * stride + x] = c.derived;
        }
    }
    workgroupBarrier();
}

// The column i pixels to the right.
fn column_beside(id: vec3u, i: i32) -> Column {
    let seat = group_seat(id);
    let at = seat.y * (8 + 2 * params.radius) + seat.x + params.radius + i;
    return Column(smoothed[at], derived[at]);
}

// The same as `at_place`, from columns that the workgroup has summed together.
fn shared_tensor(id: vec3u) -> vec4f {
    share_columns(id);
    var g = Gradient(vec4f(0.0), params.smoothing[0].x * column_beside(id, 0).derived);
    for (var i = 1; i <= params.radius; i++) {
        g = with_columns(g, i, column_beside(id, -i), column_beside(id, i));
    }
    return tensor_of(tap(group_pixel(id)), g);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    var t: vec4f;
    if shared_windows {
        t = shared_tensor(id);
    } else {
        t = at_place(group_pixel(id));
    }
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), t);
    }
}
