// Gradient of the L of a Lab image by the Sobel operator (2.23), at half the size, in the first two channels: the mean of
// those of four pixels, where one that is longer than `longest` is shortened to the inverse of its length.
// Cost: 16 loads.
#import gpu/grid

struct Params {
    /// Longest gradient that counts in full, units of L per pixel.
    longest: f32,
}

#params
#input source
#output target_image rgba32float

// Four pixels of a row.
struct Row {
    lightness: vec4f,
    coverage: vec4f,
}

fn row(p: vec2i) -> Row {
    let a = fetch(source, 0u, p);
    let b = fetch(source, 0u, p + vec2i(1, 0));
    let c = fetch(source, 0u, p + vec2i(2, 0));
    let d = fetch(source, 0u, p + vec2i(3, 0));
    return Row(vec4f(a.x, b.x, c.x, d.x), vec4f(a.w, b.w, c.w, d.w));
}

// The gradient in the middle of three pixels of three rows; a neighbour that is transparent stands for the middle.
fn gradient(lightness: mat3x3f, coverage: mat3x3f) -> vec2f {
    let centre = lightness[1].y;
    let above = (lightness[0] - centre) * coverage[0];
    let beside = (lightness[1] - centre) * coverage[1];
    let below = (lightness[2] - centre) * coverage[2];
    let x = 0.25 * (beside.z - beside.x) + 0.125 * ((above.z - above.x) + (below.z - below.x));
    let y = 0.25 * (below.y - above.y) + 0.125 * ((below.x - above.x) + (below.z - above.z));
    let share = min(params.longest / max(sqrt(x * x + y * y), 1e-6), 1.0);
    return coverage[1].y * share * share * vec2f(x, y);
}

// The sum of the gradients of two pixels of a row, or of the one that there is.
fn of_row(above: Row, beside: Row, below: Row, both: bool) -> vec2f {
    let left = gradient(
        mat3x3f(above.lightness.xyz, beside.lightness.xyz, below.lightness.xyz),
        mat3x3f(above.coverage.xyz, beside.coverage.xyz, below.coverage.xyz),
    );
    let right = gradient(
        mat3x3f(above.lightness.yzw, beside.lightness.yzw, below.lightness.yzw),
        mat3x3f(above.coverage.yzw, beside.coverage.yzw, below.coverage.yzw),
    );
    return left + select(vec2f(0.0), right, both);
}

fn at_place(p: vec2i) -> vec4f {
    let first = row(2 * p + vec2i(-1, -1));
    let second = row(2 * p + vec2i(-1, 0));
    let third = row(2 * p + vec2i(-1, 1));
    let fourth = row(2 * p + vec2i(-1, 2));
    // At odd sizes the last pixels have no neighbour to be paired with.
    let both = 2 * p + 1 < grid.inputs[0].zw;
    let upper = of_row(first, second, third, both.x);
    let lower = of_row(second, third, fourth, both.x);
    let count = select(1.0, 2.0, both.x) * select(1.0, 2.0, both.y);
    return vec4f((upper + select(vec2f(0.0), lower, both.y)) / count, 0.0, 1.0);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), at_place(pixel(id)));
    }
}
