//! Colours multiplied by their coverage, for kernels that mix pixels at arbitrary positions; the twin
//! of `shaders/shared/coverage.wgsl`.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Image, Rect, View};

/// A colour image whose colours are multiplied by their alpha, around one band.
///
/// Opaque pictures, the usual case, are used as they are: the product with 1 is exact, so which of
/// the two happens never shows.
#[derive(Debug)]
pub struct Covered(Option<Image>);

impl Covered {
    /// Prepares the rows that `band` reads of `view` when it reaches `support` pixels far.
    pub fn new(view: &View<'_>, band: &Band<'_>, support: i32) -> Self {
        let window = view.window();
        let rows = Rect { y0: band.window.y0 - support, y1: band.window.y1 + support, ..window };
        let rows = rows.intersection(&window);
        let at = view.offset(rows.x0, rows.y0);
        let source = &view.data()[at..at + view.stride() * rows.height() as usize];
        if is_opaque(source) {
            return Self(None);
        }
        let image = Image::with_window(rows, 4).ok().map(|mut image| {
            let (source, target) = (source.as_chunks::<4>().0, image.data_mut().as_chunks_mut::<4>().0);
            for i in 0..source.len().min(target.len()) {
                let [r, g, b, a] = source[i];
                target[i] = [r * a, g * a, b * a, a];
            }
            image
        });
        Self(image)
    }

    /// True when all alphas are 1, so that dividing by them can be left out.
    pub fn is_opaque(&self) -> bool {
        self.0.is_none()
    }

    /// The multiplied colours, where `view` is the image that this was made from.
    pub fn view<'a>(&'a self, view: &View<'a>) -> View<'a> {
        self.0.as_ref().map_or(*view, |image| View::new(image, view.full()))
    }
}

/// Coverage up to which a pixel counts as empty.
pub const LEAST_COVERAGE: f32 = 1e-6;

/// Colours times their alpha.
#[inline(always)]
pub fn premultiply<S: Simd>([r, g, b, a]: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    [r * a, g * a, b * a, a]
}

/// Colours without the alpha that they are multiplied by; black where nothing is covered.
#[inline(always)]
pub fn unpremultiply<S: Simd>([r, g, b, a]: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let (zero, seen) = (f32x8::splat(a.simd, 0.0), a.simd_gt(f32x8::splat(a.simd, LEAST_COVERAGE)));
    [seen.select(r / a, zero), seen.select(g / a, zero), seen.select(b / a, zero), a]
}

/// Greater mean coverages are rounding away from 1.
pub const FULL: f32 = 0.999_998;

/// Mean coverages, exactly 1 where only rounding can have kept them from it: what is opaque stays opaque, for
/// whoever looks at the result and for kernels that have less to do there.
#[inline(always)]
pub fn full_or<S: Simd>(coverage: f32x8<S>) -> f32x8<S> {
    coverage.simd_gt(FULL).select(f32x8::splat(coverage.simd, 1.0), coverage)
}

/// True when the alpha of all pixels is 1.
pub fn is_opaque(rgba: &[f32]) -> bool {
    // Eight at a time without a way out between them, so that the comparisons do not wait for branches.
    let (blocks, rest) = rgba.as_chunks::<32>();
    blocks.iter().all(|b| (0..8).fold(true, |all, i| all & (b[4 * i + 3] == 1.0)))
        && rest.chunks_exact(4).all(|p| p[3] == 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::{Level, dispatch};

    #[test]
    fn what_is_not_covered_is_black() {
        dispatch!(Level::new(), simd => {
            let pixel = [0.5, -2.0, 8.0].map(|v| f32x8::splat(simd, v));
            let with = |alpha: f32| [pixel[0], pixel[1], pixel[2], f32x8::splat(simd, alpha)];
            let back = unpremultiply(premultiply(with(0.25)));
            assert_eq!(back.map(|v| v[3]), [0.5, -2.0, 8.0, 0.25]);
            assert_eq!(unpremultiply(with(0.0)).map(|v| v[0]), [0.0; 4]);
        });
    }
}
