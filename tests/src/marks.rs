//! Motion and size of marks: noise that a style draws, against the motion of what it is drawn on.

use crate::run;
use crate::steadiness::{Shot, carried};
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote::{Graph, Request};
use isophote_engine::Image;

/// Grey pictures, on which a style draws its marks alone.
///
/// # Panics
/// For a size that no image can have.
pub fn grey(width: u32, height: u32, value: f32) -> Image {
    let pixels = (0..width * height).flat_map(|_| [value, value, value, 1.0]);
    match Image::from_vec(width, height, 4, pixels.collect()) {
        Ok(image) => image,
        Err(e) => panic!("{e}"),
    }
}

/// A style on a picture, with the rest positions of what is seen or without.
pub fn drawn(graph: &Graph, picture: &Image, rest: Option<&Image>) -> Image {
    let guides = Guides::of(|input| input == GraphInput::RestPosition && rest.is_some());
    let request = Request { guides, ..Request::new(picture.width(), picture.height()) };
    let mut inputs = vec![("color", picture.clone())];
    inputs.extend(rest.map(|rest| ("rest_position", rest.clone())));
    run::whole(run::planned(graph, request).plan(), &inputs)
}

/// Side of the squares whose marks are followed, pixels.
const SQUARE: i32 = 32;

/// Farthest that marks are looked for, pixels on each axis.
pub const FARTHEST: i32 = 4;

/// Distance that the marks of a frame slide against the surface that they lie on, pixels to the right and down: for
/// every square of the picture that shows one surface, the place of the greatest correlation of the marks with those of
/// the frame before, carried along the motion. [`FARTHEST`] or more where they do not move with it at all.
///
/// # Panics
/// As [`carried`].
pub fn slides(shot: &Shot, frame: usize, [before, now]: [&Image; 2]) -> Vec<[f64; 2]> {
    let (w, h) = (now.width() as i32, now.height() as i32);
    let carried = carried(shot, frame, before);
    let then = |x: i32, y: i32| f64::from(carried[(y * w + x) as usize].color[1]);
    let value = |x: i32, y: i32| f64::from(now.pixel(x, y)[1]);
    let counts = |x: i32, y: i32| carried[(y * w + x) as usize].counts;
    let mut slides = Vec::new();
    let places = |full: i32| (FARTHEST..full - SQUARE - FARTHEST).step_by(SQUARE as usize / 2);
    for (x0, y0) in places(h).flat_map(|y| places(w).map(move |x| (x, y))) {
        let around = (y0 - FARTHEST..y0 + SQUARE + FARTHEST)
            .all(|y| (x0 - FARTHEST..x0 + SQUARE + FARTHEST).all(|x| counts(x, y)));
        if !around {
            continue;
        }
        let correlation = |dx: i32, dy: i32| {
            let (mut n, mut a, mut b, mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
            for y in y0..y0 + SQUARE {
                for x in x0..x0 + SQUARE {
                    let (u, v) = (value(x, y), then(x + dx, y + dy));
                    (n, a, b, aa, bb, ab) = (n + 1.0, a + u, b + v, aa + u * u, bb + v * v, ab + u * v);
                }
            }
            let spread = (aa / n - (a / n).powi(2)) * (bb / n - (b / n).powi(2));
            if spread < 1e-12 { 0.0 } else { (ab / n - a / n * b / n) / spread.sqrt() }
        };
        slides.push(peak(correlation));
    }
    slides
}

/// Place where a function is greatest, between whole places by parabolas.
fn peak(of: impl Fn(i32, i32) -> f64) -> [f64; 2] {
    let side = 2 * FARTHEST + 1;
    let at = |dx: i32, dy: i32| ((dy + FARTHEST) * side + dx + FARTHEST) as usize;
    let places = (-FARTHEST..=FARTHEST).flat_map(|dy| (-FARTHEST..=FARTHEST).map(move |dx| (dx, dy)));
    let values: Vec<f64> = places.clone().map(|(dx, dy)| of(dx, dy)).collect();
    let best = places.max_by(|a, b| values[at(a.0, a.1)].total_cmp(&values[at(b.0, b.1)]));
    let Some((dx, dy)) = best else { return [0.0; 2] };
    if dx.abs() == FARTHEST || dy.abs() == FARTHEST {
        return [f64::from(dx), f64::from(dy)];
    }
    let vertex = |low: f64, middle: f64, high: f64| {
        let bend = low - 2.0 * middle + high;
        if bend < 0.0 { 0.5 * (low - high) / bend } else { 0.0 }
    };
    let middle = values[at(dx, dy)];
    let x = f64::from(dx) + vertex(values[at(dx - 1, dy)], middle, values[at(dx + 1, dy)]);
    let y = f64::from(dy) + vertex(values[at(dx, dy - 1)], middle, values[at(dx, dy + 1)]);
    [x, y]
}

/// Appearance of marks.
#[derive(Clone, Copy, Debug)]
pub struct Looks {
    /// Standard deviation of their values.
    pub contrast: f64,
    /// Distance to the right, and down, at which their autocorrelation is a half, pixels.
    pub width: [f64; 2],
}

/// Appearance of the marks of a picture, its border left out.
pub fn looks(image: &Image) -> Looks {
    const BORDER: i32 = 40;
    let (w, h) = (image.width() as i32, image.height() as i32);
    let value = |x: i32, y: i32| f64::from(image.pixel(x, y)[1]);
    let mean = |f: &dyn Fn(i32, i32) -> f64| {
        let rows = (BORDER..h - BORDER).map(|y| (BORDER..w - BORDER).map(|x| f(x, y)).sum::<f64>());
        rows.sum::<f64>() / f64::from((w - 2 * BORDER) * (h - 2 * BORDER))
    };
    let middle = mean(&value);
    let product = |dx: i32, dy: i32| mean(&|x, y| (value(x, y) - middle) * (value(x + dx, y + dy) - middle));
    let variance = product(0, 0);
    let width = [(1, 0), (0, 1)].map(|(dx, dy)| {
        let mut last = 1.0;
        for n in 1..=BORDER {
            let now = product(n * dx, n * dy) / variance;
            if now < 0.5 {
                return f64::from(n) - (0.5 - now) / (last - now);
            }
            last = now;
        }
        f64::from(BORDER)
    });
    Looks { contrast: variance.sqrt(), width }
}
