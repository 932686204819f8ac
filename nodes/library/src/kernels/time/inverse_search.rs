//! Dense inverse search (T. Kroeger et al., *Fast Optical Flow using Dense Inverse Search*, 2016, 3.1): the motion of
//! patches of 8 x 8 pixels, one for every four pixels in x and y, so that a pixel of the result is a patch. Each starts
//! from the best of some motions and goes down the sum of squared differences, which both patches' means do not count
//! in, by Gauss-Newton steps with the gradients of the patch that does not move. Where there is no texture it stays.
//!
//! All patches are searched at once: where the paper's program hands good motions on from patch to patch while it goes
//! through them, a second pass here starts from what the first found for the neighbours.
//!
//! Cost: 700 operations for each start and step; a thousand to prepare.

pub use crate::kernels::shaders::inverse_search::Params;
use crate::kernels::simd::pixels::eight;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

/// Levels between a picture and its patches, of which there is one for every 2^2 pixels.
const STRIDE_LEVELS: i8 = 2;
/// Pixels from a patch's first to the next patch's.
const STRIDE: i32 = 1 << STRIDE_LEVELS;
/// Pixels of a patch, in x and in y.
const SIDE: usize = 8;
/// Pixels from a patch's first to the first of the stride's pixels, which lie in its middle.
const MARGIN: i32 = (SIDE as i32 - STRIDE) / 2;
/// Pixels of a patch.
const PIXELS: f32 = (SIDE * SIDE) as f32;
/// Added to the Hessian's diagonal: two of 255 levels of brightness for every pixel of a patch, squared. Where there is
/// less texture a patch stays where it starts.
const TEXTURE: f32 = 0.0039;
/// Share by which a motion must be better than the one before it, beyond that which is due to rounding.
const BETTER: f32 = 0.98;
const ROUNDING: f32 = 1e-6;
/// Pixels that a patch may move away from its start, in x and in y (3.1: its own size).
const FARTHEST: f32 = SIDE as f32;
/// Values that a copy of a patch with its neighbours takes: ten rows of ten pixels, or nine of nine, as vectors of
/// eight that start at any pixel.
const COPY: usize = 10 * 10;

crate::kernel!(inverse_search {
    cpu: |simd, pass, params, band| patches(simd, pass, &params, band),
    cost: |p| 1000.0 + 700.0 * f64::from(p.starts.max(1) + p.rest + p.steps),
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "which start is the best, and which step, is decided by comparisons; steps on little texture are \
                 large against the rounding of sums over a patch",
    },
});

/// Options of a search.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Motions that patches start from.
    pub start: Start,
    /// Gauss-Newton steps.
    pub steps: u32,
    /// Longest motion along x and along y, whole pixels.
    pub reach: u32,
}

/// Motions that patches start from.
#[derive(Clone, Copy, Debug)]
pub enum Start {
    /// At rest.
    Rest,
    /// From the field of the next coarser level, or from rest where that is better.
    Field(ImageId),
    /// From the best of what an earlier pass found for the patch and for its four neighbours.
    Patches(ImageId),
}

/// The motions of the patches of `here`, two levels above it, to where `there` shows them.
pub fn pass(plan: &mut PlanBuilder, [here, there]: [ImageId; 2], options: &Options) -> ImageId {
    let Options { start, steps, reach } = *options;
    // At rest nothing is read of a start: any image will do.
    let (start, scale, starts, rest) = match start {
        Start::Rest => (here, 1.0, 0, 0),
        Start::Field(field) => (field, 2.0, 1, 1),
        Start::Patches(patches) => (patches, 1.0, 5, 0),
    };
    let params = Params { scale, reach: reach as f32, starts, rest, steps };
    let level = plan.desc(here).level + STRIDE_LEVELS;
    // A patch and one pixel around it.
    let support = Support::Pixels(reach + MARGIN as u32 + 2);
    plan.pass_at(&KERNEL, &[here, there, start], &params, &[Class::Field], support, level)
}

#[inline(always)]
fn patches<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    for y in window.y0..window.y1 {
        let row = band.row_mut(0, y);
        for x in window.x0..window.x1 {
            let patch = Patch::new(simd, &pass.inputs[0], [STRIDE * x - MARGIN, STRIDE * y - MARGIN]);
            let search = Search { there: &pass.inputs[1], start: &pass.inputs[2], params, patch };
            let motion = search.motion(simd, x, y);
            row[2 * (x - window.x0) as usize..][..2].copy_from_slice(&motion);
        }
    }
}

/// A patch that does not move.
struct Patch<S: Simd> {
    /// Its first pixel.
    corner: [i32; 2],
    rows: [f32x8<S>; SIDE],
    gradients: [[f32x8<S>; 2]; SIDE],
    /// The gradients' mean.
    mean: [f32; 2],
    /// The Hessian of 3.1, of gradients without their mean: xx, xy and yy over its determinant.
    inverse: [f32; 3],
}

impl<S: Simd> Patch<S> {
    #[inline(always)]
    fn new(simd: S, view: &View<'_>, corner: [i32; 2]) -> Self {
        let mut copy = [0.0; COPY];
        let (pixels, stride) = patch(view, [corner[0] - 1, corner[1] - 1], 10, &mut copy);
        let zero = f32x8::splat(simd, 0.0);
        let (mut rows, mut gradients) = ([zero; SIDE], [[zero; 2]; SIDE]);
        let (mut sums, mut squares) = ([zero; 2], [zero; 3]);
        for y in 0..SIDE {
            let at = (y + 1) * stride;
            let across = eight(simd, pixels, at + 2) - eight(simd, pixels, at);
            let along = eight(simd, pixels, at + stride + 1) - eight(simd, pixels, at - stride + 1);
            let [gx, gy] = [across * 0.5, along * 0.5];
            rows[y] = eight(simd, pixels, at + 1);
            gradients[y] = [gx, gy];
            sums = [sums[0] + gx, sums[1] + gy];
            squares = [gx.mul_add(gx, squares[0]), gx.mul_add(gy, squares[1]), gy.mul_add(gy, squares[2])];
        }
        let mean = [sum(sums[0]) / PIXELS, sum(sums[1]) / PIXELS];
        let xx = sum(squares[0]) - PIXELS * mean[0] * mean[0] + TEXTURE;
        let xy = sum(squares[1]) - PIXELS * mean[0] * mean[1];
        let yy = sum(squares[2]) - PIXELS * mean[1] * mean[1] + TEXTURE;
        let determinant = xx * yy - xy * xy;
        Self { corner, rows, gradients, mean, inverse: [xx, xy, yy].map(|v| v / determinant) }
    }

    /// Fit of the patch to the other picture at a motion.
    #[inline(always)]
    fn fit(&self, simd: S, view: &View<'_>, motion: [f32; 2]) -> Fit {
        let whole = motion.map(f32::floor);
        let corner = [self.corner[0] + whole[0] as i32, self.corner[1] + whole[1] as i32];
        let fx = f32x8::splat(simd, motion[0] - whole[0]);
        let fy = f32x8::splat(simd, motion[1] - whole[1]);
        let mut copy = [0.0; COPY];
        let (pixels, stride) = patch(view, corner, 9, &mut copy);
        let zero = f32x8::splat(simd, 0.0);
        let (mut difference, mut square, mut slope) = (zero, zero, [zero; 2]);
        let mut above = zero;
        for y in 0..SIDE + 1 {
            let left = eight(simd, pixels, y * stride);
            let value = (eight(simd, pixels, y * stride + 1) - left).mul_add(fx, left);
            if y > 0 {
                let off = (value - above).mul_add(fy, above) - self.rows[y - 1];
                let [gx, gy] = self.gradients[y - 1];
                difference += off;
                square = off.mul_add(off, square);
                slope = [off.mul_add(gx, slope[0]), off.mul_add(gy, slope[1])];
            }
            above = value;
        }
        let difference = sum(difference);
        Fit {
            error: sum(square) - difference * difference / PIXELS,
            slope: [sum(slope[0]) - self.mean[0] * difference, sum(slope[1]) - self.mean[1] * difference],
        }
    }
}

/// Fit of a patch at a motion.
struct Fit {
    /// Sum of the squared differences, without that of their mean.
    error: f32,
    /// Sum of the differences times the gradients, without their means.
    slope: [f32; 2],
}

/// The search for one patch.
struct Search<'a, S: Simd> {
    there: &'a View<'a>,
    start: &'a View<'a>,
    params: &'a Params,
    patch: Patch<S>,
}

impl<S: Simd> Search<'_, S> {
    /// The motion of patch (x, y).
    #[inline(always)]
    fn motion(&self, simd: S, x: i32, y: i32) -> [f32; 2] {
        let params = self.params;
        let mut first = [0.0; 2];
        if params.starts > 0 {
            first = self.started(x, y);
        }
        let mut best = self.patch.fit(simd, self.there, first);
        let neighbours = [[-1, 0], [1, 0], [0, -1], [0, 1]];
        for i in 0..neighbours.len() + 1 {
            let motion = match neighbours.get(i) {
                Some(_) if i as u32 + 1 >= params.starts => continue,
                Some([dx, dy]) => self.started(x + dx, y + dy),
                None if params.rest == 0 => continue,
                None => [0.0; 2],
            };
            let other = self.patch.fit(simd, self.there, motion);
            if other.error < BETTER * best.error - ROUNDING {
                (best, first) = (other, motion);
            }
        }
        let [xx, xy, yy] = self.patch.inverse;
        let (mut motion, mut result, mut least, mut slope) = (first, first, best.error, best.slope);
        for _ in 0..params.steps {
            let step = [yy * slope[0] - xy * slope[1], xx * slope[1] - xy * slope[0]];
            for c in 0..2 {
                let near = (motion[c] - step[c]).clamp(first[c] - FARTHEST, first[c] + FARTHEST);
                motion[c] = near.clamp(-params.reach, params.reach);
            }
            let fit = self.patch.fit(simd, self.there, motion);
            if fit.error < least {
                (least, result) = (fit.error, motion);
            }
            slope = fit.slope;
        }
        result
    }

    /// Motion of the start at patch (x, y), which may lie beyond the picture's edge.
    #[inline(always)]
    fn started(&self, x: i32, y: i32) -> [f32; 2] {
        let (view, scale) = (self.start, self.params.scale);
        // Patches lie between four pixels of a coarser field, and at one of their own.
        let twice = scale as i32;
        let corner = [twice * x + (twice - 1) / 2, twice * y + (twice - 1) / 2];
        let pixel = |dx: i32, dy: i32| {
            let at = view.offset(corner[0] + dx, corner[1] + dy);
            [view.data()[at], view.data()[at + 1]]
        };
        let share = 0.5 * (scale - 1.0);
        let next = twice - 1;
        let (a, b, c, d) = (pixel(0, 0), pixel(next, 0), pixel(0, next), pixel(next, next));
        let mut motion = [0.0; 2];
        for i in 0..2 {
            let (top, bottom) = (a[i] + (b[i] - a[i]) * share, c[i] + (d[i] - c[i]) * share);
            let value = scale * (top + (bottom - top) * share);
            motion[i] = value.clamp(-self.params.reach, self.params.reach);
        }
        motion
    }
}

/// `side` rows of as many pixels from `corner` on, clamped to the picture: where they begin in the image, or in a copy,
/// and what lies between rows.
#[inline(always)]
fn patch<'a>(
    view: &View<'a>,
    corner: [i32; 2],
    side: usize,
    copy: &'a mut [f32; COPY],
) -> (&'a [f32], usize) {
    let ([x, y], window, far) = (corner, view.window(), side as i32);
    if x >= window.x0 && y >= window.y0 && x + far <= window.x1 && y + far <= window.y1 {
        return (&view.data()[view.offset(x, y)..], view.stride());
    }
    for row in 0..far {
        for column in 0..far {
            copy[row as usize * side + column as usize] = view.pixel1(x + column, y + row);
        }
    }
    (copy.as_slice(), side)
}

/// The sum of the lanes, in the same order for all instruction sets.
#[inline(always)]
fn sum<S: Simd>(v: f32x8<S>) -> f32 {
    let v = v.to_array();
    ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]))
}
