// Round dots of a halftone screen. Twin of kernels/shared/halftone_dots.rs.

// Width of the borders of dots, pixels; the least size of a dot's blur, square pixels; the steepest rise of the spot
// function, per cell; and one of four places in a pixel, which the others turn to.
const EDGE: f32 = 0.9;
const LEAST_DOT: f32 = 4.65;
const STEEPEST: f32 = 2.2;
const PLACE: vec2f = vec2f(0.335, 0.236);

// How far x lies from the nearest whole number, 0..=1/2.
fn fold(x: vec2f) -> vec2f {
    return abs(x - floor(x + 0.5));
}

// cos(2 pi a) for a in 0..=1/2.
fn wave(a: vec2f) -> vec2f {
    let t = 1.0 - 4.0 * a;
    let q = t * t;
    return t * (1.5706268 + q * (-0.6432292 + q * 0.0727102));
}

// The share of a cell where the sum of two cosines is greater than at (u, v).
fn threshold(q: vec2f) -> f32 {
    let w = wave(fold(q));
    let s = 0.5 * (w.x + w.y);
    let x = abs(s);
    let r = sqrt(x);
    let g = r * (0.04388541 + r * (1.13211294 + r * (-1.24463274 + r * (0.78631934 - r * 0.2178912))));
    return 0.5 - select(g, -g, s < 0.0);
}

// Share of the paper within a dot or hole whose border begins at a threshold.
struct Border {
    /// The threshold at the border's middle.
    middle: f32,
    /// 1 / width of the border, in thresholds.
    inverse: f32,
}

// The border of dots of area m on a screen of `frequency`, 1 / size of a cell; `blur` is its least width in shares of the
// paper. Thresholds are even in 0..1, so that a ramp of them has a mean that is known, which is what moves it where it would
// leave the range.
fn border_of(m: f32, frequency: f32, blur: f32) -> Border {
    let rise = min(3.5449077 * sqrt(m), STEEPEST) * EDGE * frequency;
    let size = LEAST_DOT * frequency * frequency;
    let w = max(max(rise, blur), 0.5 * size * size / max(m, 1e-5));
    let extent = sqrt(2.0 * w * m);
    let low = select(0.5 + w * (m - 0.5), extent - 0.5 * w, extent <= 1.0);
    return Border(select(m, low, m < 0.5 * w), 1.0 / w);
}

fn within(border: Border, t: f32) -> f32 {
    return clamp((border.middle - t) * border.inverse + 0.5, 0.0, 1.0);
}

// One of four places in a pixel, in cells; `screen` is cosine and sine of the screen's angle over the size of a cell.
fn place_of(i: u32, screen: vec2f) -> vec2f {
    let turned = vec2f(PLACE.x * screen.x - PLACE.y * screen.y, PLACE.x * screen.y + PLACE.y * screen.x);
    return select(turned, vec2f(-turned.y, turned.x), (i & 1u) != 0u) * select(1.0, -1.0, i >= 2u);
}

// Dots that cover `share` of every cell at q, in cells, and meet as squares at a half; above it round holes.
fn dots_at(q: vec2f, share: f32, screen: vec2f, frequency: f32, blur: f32) -> f32 {
    let dark = share > 0.5;
    let border = border_of(select(share, 1.0 - share, dark), frequency, blur);
    var sum = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let t = threshold(q + place_of(i, screen));
        sum += within(border, select(t, 1.0 - t, dark));
    }
    return select(0.25 * sum, 1.0 - 0.25 * sum, dark);
}

// Dots that are discs up to a share of about 0.4: farther out discs of neighbours meet.
fn discs_at(q: vec2f, share: f32, screen: vec2f, frequency: f32) -> f32 {
    let border = border_of(share, frequency, 0.0);
    var sum = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let arm = fold(q + place_of(i, screen));
        sum += within(border, 3.1415927 * dot(arm, arm));
    }
    return 0.25 * sum;
}
