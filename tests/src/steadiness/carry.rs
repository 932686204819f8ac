//! The frame before, carried to the frame at hand along the motion, and where that means anything.

use super::shot::{Frame, Shot};
use isophote_engine::Image;

/// Greatest difference of two depths of one surface, as a part of the depth: a camera that comes closer changes
/// depths by a few hundredths from frame to frame, another surface behind an edge is mostly farther away.
pub const DEPTH_AGREES: f32 = 0.1;

/// Weight below which a pixel has no part in a sample: motion that is whole but for rounding needs one pixel only.
const NO_PART: f32 = 1e-3;

/// Result of [`carried`] for a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Red, green and blue of the frame before.
    pub color: [f32; 3],
    /// True where they belong to the same point of the same surface.
    pub counts: bool,
}

/// The four pixels around a place, with their weights. Pixel (x, y) has its centre at (x, y) here.
struct Taps {
    at: [(i32, i32); 4],
    weights: [f32; 4],
}

impl Taps {
    fn new(x: f32, y: f32) -> Self {
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let (i, j) = (x.floor() as i32, y.floor() as i32);
        Self {
            at: [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)],
            weights: [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy],
        }
    }

    /// The pixels that have a part in the sample.
    fn parts(&self) -> impl Iterator<Item = (i32, i32)> {
        let both = self.at.iter().zip(&self.weights);
        both.filter(|(_, weight)| **weight >= NO_PART).map(|(at, _)| *at)
    }

    /// The sample, clamped to the picture's edge; one channel is grey.
    fn sample(&self, image: &Image) -> [f32; 3] {
        let (w, h) = (image.width() as i32, image.height() as i32);
        let mut sum = [0.0; 3];
        for ((x, y), weight) in self.at.iter().zip(self.weights) {
            let pixel = rgb(image, (*x).clamp(0, w - 1), (*y).clamp(0, h - 1));
            sum.iter_mut().zip(pixel).for_each(|(s, v)| *s += weight * v);
        }
        sum
    }
}

/// Red, green and blue of a pixel; one channel is grey.
pub fn rgb(image: &Image, x: i32, y: i32) -> [f32; 3] {
    match image.pixel(x, y) {
        [r, g, b, ..] => [*r, *g, *b],
        other => [other.first().copied().unwrap_or_default(); 3],
    }
}

/// `before`, which a filter made of the frame before `frame`, carried to `frame`: row by row. The first frame has
/// none before it.
///
/// # Panics
/// When `frame` is 0 or beyond the shot, or sizes differ.
pub fn carried(shot: &Shot, frame: usize, before: &Image) -> Vec<Carried> {
    let (now, then) = (&shot.frames[frame], &shot.frames[frame - 1]);
    let (w, h) = (now.color.width(), now.color.height());
    assert_eq!((before.width(), before.height()), (w, h), "frames of one size");
    let mut out = Vec::with_capacity(w as usize * h as usize);
    for y in 0..h as i32 {
        for x in 0..w as i32 {
            let motion = now.motion.pixel(x, y);
            let taps = Taps::new(x as f32 + motion[0], y as f32 + motion[1]);
            let counts =
                (shot.is_static || now.object_id.pixel(x, y)[0] != 0.0) && is_same(&taps, now, then, x, y);
            out.push(Carried { color: taps.sample(before), counts });
        }
    }
    out
}

/// True where all pixels of a sample of the frame before show the surface that is at (x, y) now.
fn is_same(taps: &Taps, now: &Frame, then: &Frame, x: i32, y: i32) -> bool {
    let (w, h) = (now.color.width() as i32, now.color.height() as i32);
    let (id, depth) = (now.object_id.pixel(x, y)[0], now.depth.pixel(x, y)[0]);
    taps.parts().all(|(x, y)| {
        let is_inside = x >= 0 && y >= 0 && x < w && y < h;
        is_inside
            && then.object_id.pixel(x, y)[0] == id
            && (then.depth.pixel(x, y)[0] - depth).abs() <= DEPTH_AGREES * depth.abs()
    })
}
