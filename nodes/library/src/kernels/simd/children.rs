//! Pixels with the four of the next finer level that they stand for.

use isophote_engine::{Band, View};

/// Runs `f` on every pixel of a band with those of `view`, of four channels, that lie in its place at the next finer level: in
/// the upper row and in the lower one. At odd sizes the missing ones are left out.
#[inline(always)]
pub fn for_children(view: &View<'_>, band: &mut Band<'_>, mut f: impl FnMut(&[f32], &[f32], &mut [f32])) {
    let window = band.window;
    let [width, height] = view.full();
    let len = 4 * ((2 * window.x1).min(width) - 2 * window.x0) as usize;
    for y in window.y0..window.y1 {
        let row = |y: i32| {
            let at = view.offset(2 * window.x0, y);
            &view.data()[at..at + len]
        };
        let upper = row(2 * y).chunks(8);
        // The row below the last of an odd picture is no row.
        let lower = if 2 * y + 1 < height { row(2 * y + 1) } else { &[] };
        let lower = lower.chunks(8).chain(std::iter::repeat(&[][..]));
        for ((upper, lower), target) in upper.zip(lower).zip(band.row_mut(0, y).chunks_exact_mut(4)) {
            f(upper, lower, target);
        }
    }
}
