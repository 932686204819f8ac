//! The smoothed structure tensor of a colour, where tensors of low contrast are taken from an earlier
//! field before smoothing (§ 2.7.3, 6.2). Gradients by the 3x3 operator of (2.27), coverage as in
//! `gradient_tensor`.
//!
//! One pass instead of four, since the coherence-enhancing filter asks for it twice in each iteration.
//! The result counts as valid everywhere (w = 1): every tensor comes from somewhere.
//!
//! Cost: 30 operations for the sums of columns and rows of each channel, 40 for the tensor, and
//! 4 radius + 2 multiply-adds for each of its three values.

pub use crate::kernels::shaders::carried_tensor::Params;
use crate::kernels::shared::coverage::premultiply;
use crate::kernels::simd::line_buffer::{LineBuffer, WIDE_STRIP, strips_of};
use crate::kernels::simd::pixels::{eight, read, write};
use crate::kernels::simd::window_sum::{gaussian_radius, gaussian_table};
use crate::kernels::smoothing::gaussian_blur;
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

/// Entries of the table of weights, the centre included.
const TAPS: usize = 12;
/// Largest radius: what the workgroups' memory holds.
const MAX_RADIUS: u32 = 8;
/// Weights of the derivative operator across the derivative (2.27).
const OPERATOR: [f32; 2] = [162.32 / 256.0, 46.84 / 256.0];

crate::kernel!(carried_tensor {
    cpu: run,
    cost: |p| 120.0 + 12.0 * f64::from(p.radius),
    tolerance: Tolerance {
        absolute: 2e-6,
        relative: 1e-4,
        outliers: 0.01,
        reason: "differences of neighbours magnify the last bits of the colours, and a tensor at the \
                 threshold of validity goes either way, which shows over the whole window",
    },
});

/// The tensor of `color`, smoothed by `rho` pixels, with tensors from `earlier` where sqrt(lambda1)
/// before smoothing is not above `threshold`.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, earlier: ImageId, rho: f32, threshold: f32) -> ImageId {
    let wanted = gaussian_radius(rho, 3.0);
    // Wider windows are smoothed by passes of their own.
    let radius = if wanted > MAX_RADIUS { 0 } else { wanted };
    let mut weights = [[0.0; 4]; TAPS / 4];
    weights.copy_from_slice(&gaussian_table(rho, radius)[..TAPS / 4]);
    let params =
        Params { radius: radius as i32, threshold: threshold * threshold, smoothing: OPERATOR, weights };
    let support = Support::Pixels(radius + 1);
    let tensor = plan.pass(&KERNEL, &[color, earlier], &params, Class::Field, support);
    if radius < wanted { gaussian_blur::pass(plan, tensor, rho, Class::Field) } else { tensor }
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    // A radius known to the compiler unrolls the sums of the usual one.
    match params.radius {
        3 => dispatch!(pass.level, simd => tensors(simd, pass, &params, 3, band)),
        r => dispatch!(pass.level, simd => tensors(simd, pass, &params, r as usize, band)),
    }
}

/// Rows of one strip on their way through the pass.
#[derive(Default)]
struct Strip {
    colors: LineBuffer,
    /// True for rows in `colors` that are opaque.
    opaque: [bool; 3],
    /// The next row that `colors` takes in.
    next: i32,
    /// Smoothed and derived columns of a row, four channels each.
    columns: Vec<f32>,
    /// E, F and G of a row.
    tensors: Vec<f32>,
    /// The same smoothed along the row, for as many rows as the window is high.
    ring: Vec<f32>,
    scratch: Vec<f32>,
}

#[inline(always)]
fn tensors<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, r: usize, band: &mut Band<'_>) {
    let (window, [width, height]) = (band.window, pass.inputs[0].full());
    let mut weights = [0.0; TAPS];
    for (i, weight) in weights.iter_mut().enumerate() {
        *weight = params.weights[i / 4][i % 4];
    }
    let reach = r as i32;
    let mut strip = Strip::default();
    for (x0, x1) in strips_of(2 * WIDE_STRIP, window.x0, window.x1) {
        strip.colors.start(x0 - reach, x1 + reach, 1, 4);
        let wide = strip.colors.stride();
        let narrow = ((x1 - x0) as usize).next_multiple_of(8);
        strip.columns.resize(8 * wide, 0.0);
        strip.tensors.resize(3 * wide, 0.0);
        strip.ring.resize((2 * r + 1) * 3 * narrow, 0.0);
        // Rows beyond the picture are its last ones.
        let row = |y: i32| y.clamp(0, height - 1);
        strip.next = row(window.y0 - reach) - 1;
        for y in window.y0 - reach..window.y1 + reach {
            strip.gradients(simd, pass, params, [x0 - reach, x1 + reach], row(y));
            strip.extend([x0 - reach, x1 + reach], width);
            let slot = y.rem_euclid(2 * reach + 1) as usize * 3 * narrow;
            for c in 0..3 {
                let source = &strip.tensors[c * wide..(c + 1) * wide];
                let target = &mut strip.ring[slot + c * narrow..slot + (c + 1) * narrow];
                for at in (0..narrow).step_by(8) {
                    // One slice for all taps, whose places in it the compiler knows.
                    let taps = &source[at..at + 2 * r + 8];
                    let mut sum = eight(simd, taps, r) * weights[0];
                    for k in 1..=r {
                        let both = eight(simd, taps, r - k) + eight(simd, taps, r + k);
                        sum = both.mul_add(f32x8::splat(simd, weights[k]), sum);
                    }
                    sum.store_slice(&mut target[at..at + 8]);
                }
            }
            let done = y - reach;
            if done >= window.y0 {
                let start = 4 * (x0 - window.x0) as usize;
                let target = &mut band.row_mut(0, done)[start..start + 4 * (x1 - x0) as usize];
                strip.smooth_columns(simd, &weights, r, narrow, done, target);
            }
        }
    }
}

impl Strip {
    /// The tensors of row `y`, columns `x0..x1`; rows must come in order.
    #[inline(always)]
    fn gradients<S: Simd>(
        &mut self,
        simd: S,
        pass: &CpuPass<'_>,
        params: &Params,
        [x0, x1]: [i32; 2],
        y: i32,
    ) {
        self.take_in(simd, &pass.inputs[0], y + 1);
        // The coverage of opaque rows has no gradient: its products are exact, and left out.
        let opaque = self.opaque == [true; 3];
        let channels = if opaque { 3 } else { 4 };
        for c in 0..channels {
            self.sum_columns(simd, params, y, c);
        }
        let len = self.colors.stride();
        let earlier = &pass.inputs[1];
        let window = earlier.window();
        let row = earlier.offset(window.x0, y);
        let row = &earlier.data()[row..row + earlier.stride()];
        for i in (0..(x1 - x0) as usize).step_by(8) {
            let [e, f, g] = self.tensor(simd, params, opaque, y, i);
            let d = (e - g) * 0.5;
            let lambda1 = (e + g) * 0.5 + (d * d + f * f).sqrt();
            let valid = lambda1.simd_gt(f32x8::splat(simd, params.threshold));
            let mut tensor = [e, f, g];
            if !valid.all_true() {
                let x = x0 + i as i32;
                let [e, f, g, _] = if x >= window.x0 && x + 8 <= window.x1 {
                    read(simd, &row[4 * (x - window.x0) as usize..][..32])
                } else {
                    read(simd, earlier.padded_row(y, x, (x + 8).min(x1), &mut self.scratch))
                };
                tensor = [valid.select(tensor[0], e), valid.select(tensor[1], f), valid.select(tensor[2], g)];
            }
            for c in 0..3 {
                tensor[c].store_slice(&mut self.tensors[c * len + i..c * len + i + 8]);
            }
        }
    }

    /// Takes in the rows of `view` up to `last`.
    #[inline(always)]
    fn take_in<S: Simd>(&mut self, simd: S, view: &View<'_>, last: i32) {
        let one = f32x8::splat(simd, 1.0);
        while self.next <= last {
            let mut least = one;
            self.colors.load_mapped(
                simd,
                view,
                self.next,
                #[inline(always)]
                |pixels| {
                    least = least.at_most(pixels[3]);
                    premultiply(pixels)
                },
            );
            self.opaque[self.next.rem_euclid(3) as usize] = least.simd_ge(one).all_true();
            self.next += 1;
        }
    }

    /// Smooths and derives channel `c` along the columns about row `y`.
    #[inline(always)]
    fn sum_columns<S: Simd>(&mut self, simd: S, params: &Params, y: i32, c: usize) {
        let len = self.colors.stride();
        let (above, _) = self.colors.row(y - 1, c).as_chunks::<8>();
        let blocks = above.len();
        let here = &self.colors.row(y, c).as_chunks::<8>().0[..blocks];
        let below = &self.colors.row(y + 1, c).as_chunks::<8>().0[..blocks];
        let (smoothed, derived) = self.columns[2 * c * len..2 * (c + 1) * len].split_at_mut(len);
        let smoothed = &mut smoothed.as_chunks_mut::<8>().0[..blocks];
        let derived = &mut derived.as_chunks_mut::<8>().0[..blocks];
        for i in 0..blocks {
            let (above, here, below) =
                (eight(simd, &above[i], 0), eight(simd, &here[i], 0), eight(simd, &below[i], 0));
            let across = f32x8::splat(simd, params.smoothing[1]);
            (above + below).mul_add(across, here * params.smoothing[0]).store_slice(&mut smoothed[i]);
            ((below - above) * 0.5).store_slice(&mut derived[i]);
        }
    }

    /// E, F and G of eight gradients of row `y`, from column `i` of the strip on.
    #[inline(always)]
    fn tensor<S: Simd>(&self, simd: S, params: &Params, opaque: bool, y: i32, i: usize) -> [f32x8<S>; 3] {
        let (zero, len) = (f32x8::splat(simd, 0.0), self.colors.stride());
        let (mut dx, mut dy) = ([zero; 4], [zero; 4]);
        for c in 0..if opaque { 3 } else { 4 } {
            let columns = &self.columns[2 * c * len..2 * (c + 1) * len];
            let (smoothed, derived) = (&columns[i..i + 10], &columns[len + i..len + i + 10]);
            dx[c] = (eight(simd, smoothed, 2) - eight(simd, smoothed, 0)) * 0.5;
            let sides = eight(simd, derived, 0) + eight(simd, derived, 2);
            dy[c] = sides.mul_add(
                f32x8::splat(simd, params.smoothing[1]),
                eight(simd, derived, 1) * params.smoothing[0],
            );
        }
        if !opaque {
            let alpha = eight(simd, self.colors.row(y, 3), i + 1);
            for c in 0..3 {
                let color = eight(simd, self.colors.row(y, c), i + 1);
                // The quotient rule without its division: coverage squared times the gradient of the colour.
                dx[c] = alpha * dx[c] - color * dx[3];
                dy[c] = alpha * dy[c] - color * dy[3];
            }
        }
        [
            dx[0] * dx[0] + dx[1] * dx[1] + dx[2] * dx[2],
            dx[0] * dy[0] + dx[1] * dy[1] + dx[2] * dy[2],
            dy[0] * dy[0] + dy[1] * dy[1] + dy[2] * dy[2],
        ]
    }

    /// Repeats the first and last tensors of the picture in the columns beyond it.
    #[inline(always)]
    fn extend(&mut self, [x0, x1]: [i32; 2], width: i32) {
        let len = self.colors.stride();
        for row in self.tensors.chunks_exact_mut(len) {
            if x0 < 0 {
                let first = row[-x0 as usize];
                row[..-x0 as usize].fill(first);
            }
            if x1 > width {
                let last = (width - x0) as usize;
                let value = row[last - 1];
                row[last..(x1 - x0) as usize].fill(value);
            }
        }
    }

    /// The Gaussian along the columns about row `y`.
    #[inline(always)]
    fn smooth_columns<S: Simd>(
        &self,
        simd: S,
        weights: &[f32; TAPS],
        r: usize,
        narrow: usize,
        y: i32,
        target: &mut [f32],
    ) {
        let one = f32x8::splat(simd, 1.0);
        let (count, mut rows) = (2 * r as i32 + 1, [&self.ring[..0]; 2 * MAX_RADIUS as usize + 1]);
        for k in 0..=2 * r {
            let at = (y + k as i32 - r as i32).rem_euclid(count) as usize * 3 * narrow;
            rows[k] = &self.ring[at..at + 3 * narrow];
        }
        for i in 0..target.len().div_ceil(32) {
            let mut tensor = [one; 4];
            for c in 0..3 {
                let at = c * narrow + 8 * i;
                let mut sum = eight(simd, rows[r], at) * weights[0];
                for k in 1..=r {
                    let both = eight(simd, rows[r - k], at) + eight(simd, rows[r + k], at);
                    sum = both.mul_add(f32x8::splat(simd, weights[k]), sum);
                }
                tensor[c] = sum;
            }
            let end = target.len().min(32 * i + 32);
            write(tensor, &mut target[32 * i..end]);
        }
    }
}
