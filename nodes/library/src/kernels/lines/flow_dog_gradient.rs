//! First pass of the separable flow-based difference of Gaussians (§ 4.5, Listing 4.1): a
//! one-dimensional difference of Gaussians across the tangent, on lightness and coverage.
//!
//! Steps have length 1 along the axis nearer to the gradient, so a sample lies between two pixels of
//! one row or column, and two reads interpolate it exactly as a bilinear sample would.
//! Cost: per step (about 3 k sigma_e of them) four reads of two values; four exponentials per pixel.

use crate::kernels::blocks::{Block, for_blocks_in_tiles, offsets, write2};
use crate::kernels::edge_threshold::{LEAST_COVERAGE, Xdog, dog_response};
use crate::kernels::tensor_algebra::tangent;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, prelude::*};
use isophote_engine::math::{Elementary, load_pairs, load_pixel, spread, transposed};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::params! {
    /// Uniform block.
    pub struct Params for flow_dog_gradient {
        /// -1 / (2 sigma^2) of the narrower Gaussian.
        pub narrow: f32,
        /// The same of the wider Gaussian.
        pub wide: f32,
        /// Cut-off, in pixels.
        pub halfwidth: f32,
        /// Weight of the smoothed lightness.
        pub base: f32,
        /// Weight of the difference of Gaussians.
        pub edge: f32,
    }
}

crate::kernel!(flow_dog_gradient {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        f64::from(p.halfwidth) * 0.88 * 50.0 + 40.0
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-4,
        outliers: 1e-2,
        reason: "the slope of a tangent is exact to a few units in the last place and shifts samples by \
                 as much times the local contrast, which is large beside a difference of Gaussians of \
                 highlights; a diagonal may take the other axis, and the last step may fall on either \
                 side of the cut-off",
    },
});

/// Cut-off, in standard deviations of the wider Gaussian; `precision` of Listing 4.1.
const PRECISION: f32 = 3.0;

/// Response across the orientations of `field` (E - G, F) of (L alpha, alpha), as (u alpha, alpha), for standard
/// deviations `sigma` and `k` `sigma` pixels.
pub fn response(
    plan: &mut PlanBuilder,
    lightness: ImageId,
    field: ImageId,
    sigma: f32,
    k: f32,
    xdog: &Xdog,
) -> ImageId {
    let halfwidth = halfwidth(sigma, k);
    let falloff = |sigma: f32| -0.5 / (sigma * sigma).max(1e-6);
    let params = Params {
        narrow: falloff(sigma),
        wide: falloff(k * sigma),
        halfwidth,
        base: xdog.base,
        edge: xdog.edge,
    };
    // A step is at least one pixel long, and a sample reaches one pixel further across.
    let support = Support::Pixels(halfwidth as u32 + 1);
    plan.pass(&KERNEL, &[lightness, field], &params, Class::Field, support)
}

/// How far the first pass reaches, in pixels.
pub fn halfwidth(sigma: f32, k: f32) -> f32 {
    (PRECISION * k * sigma).min(1024.0)
}

/// The line across the tangent through eight pixels.
#[derive(Clone, Copy)]
pub struct Across<S: Simd> {
    /// Absolute columns and rows of the pixels.
    pub at: [i32x8<S>; 2],
    /// All ones in lanes that step along y.
    upright: i32x8<S>,
    /// Pixels across per step.
    slope: f32x8<S>,
    /// Length of a step, 1..=sqrt 2.
    pub step: f32x8<S>,
}

impl<S: Simd> Across<S> {
    /// The lines across the tangents of the orientations (E - G, F) at the pixels of `block`.
    #[inline(always)]
    pub fn new(simd: S, block: &Block, [difference, f]: [f32x8<S>; 2]) -> Self {
        let [tx, ty] = tangent(difference, f, f32x8::splat(simd, 0.0));
        let upright = tx.abs().simd_gt(ty.abs());
        let slope = upright.select(-ty / tx, -tx / ty);
        let none = i32x8::splat(simd, 0);
        Self {
            at: [block.columns(simd), i32x8::splat(simd, block.y)],
            upright: upright.select(!none, none),
            slope,
            step: (slope * slope + 1.0).sqrt(),
        }
    }

    /// Offsets (x, y) of the pixel at or before step `k`, and the share of the one after it.
    #[inline(always)]
    fn place(&self, k: i32) -> ([i32x8<S>; 2], f32x8<S>) {
        let across = self.slope * k as f32;
        let whole = across.floor();
        let i: i32x8<S> = whole.to_int();
        let k = i32x8::splat(self.slope.simd, k);
        let upright = self.upright;
        ([(k & !upright) | (i & upright), (i & !upright) | (k & upright)], across - whole)
    }

    /// The pixels nearest to step `k`. Ties are decided off the middle, so that rounding does not.
    #[inline(always)]
    pub fn nearest(&self, k: i32) -> [i32x8<S>; 2] {
        let i: i32x8<S> = (self.slope * k as f32 + 0.502).floor().to_int();
        let k = i32x8::splat(self.slope.simd, k);
        let upright = self.upright;
        [
            self.at[0] + ((k & !upright) | (i & upright)),
            self.at[1] + ((i & !upright) | (k & upright)),
        ]
    }

    /// Sample of an interleaved two-channel image at step `k`; `inner` lines stay off the picture's edges.
    #[inline(always)]
    fn sample2(&self, simd: S, view: &View<'_>, k: i32, inner: bool) -> [f32x8<S>; 2] {
        let ([ox, oy], f) = self.place(k);
        let (x, y) = (self.at[0] + ox, self.at[1] + oy);
        if inner {
            let (held, stride, data) = (view.window(), view.stride() as i32, view.data());
            let a = (y - held.y0) * stride + (x - held.x0) * 2;
            let next = (self.upright & i32x8::splat(simd, 2)) | (!self.upright & i32x8::splat(simd, stride));
            let (a, b, f) = (a.to_array(), (a + next).to_array(), spread(f));
            let mut pixels = [f32x8::splat(simd, 0.0); 4];
            for (i, pixel) in pixels.iter_mut().enumerate() {
                let a = load_pixel(simd, data, a[i]).combine(load_pixel(simd, data, a[i + 4]));
                let b = load_pixel(simd, data, b[i]).combine(load_pixel(simd, data, b[i + 4]));
                *pixel = a + (b - a) * f[i];
            }
            let [v, alpha, _, _] = transposed(pixels);
            return [v, alpha];
        }
        let one = i32x8::splat(simd, 1);
        let (next_x, next_y) = (x + (self.upright & one), y + (!self.upright & one));
        let a = load_pairs(simd, view.data(), offsets(view, x, y).to_array());
        let b = load_pairs(simd, view.data(), offsets(view, next_x, next_y).to_array());
        let (f0, f1) = f.interleave(f);
        (a[0] + (b[0] - a[0]) * f0).deinterleave(a[1] + (b[1] - a[1]) * f1).into()
    }
}

/// The Gaussian at the steps of a line, one after another: exp(a k^2) grows by exp(a (2 k + 1)) from step
/// k, and that by exp(2 a).
#[derive(Clone, Copy)]
struct Falloff<S: Simd> {
    exponent: f32x8<S>,
    value: f32x8<S>,
    ratio: f32x8<S>,
    growth: f32x8<S>,
}

impl<S: Simd> Falloff<S> {
    /// For steps of length `step` and the Gaussian exp(`exponent` d^2).
    #[inline(always)]
    fn new(step: f32x8<S>, exponent: f32) -> Self {
        let exponent = step * step * exponent;
        let ratio = exponent.exp();
        Self { exponent, value: f32x8::splat(step.simd, 1.0), ratio, growth: ratio * ratio }
    }

    /// The value at step `k`, the one after the last asked for; the first is 1.
    #[inline(always)]
    fn at(&mut self, k: i32) -> f32x8<S> {
        if k % 16 == 0 {
            // Roundings grow with the square of the steps.
            self.value = (self.exponent * (k * k) as f32).exp();
            self.ratio = (self.exponent * (2 * k + 1) as f32).exp();
            return self.value;
        }
        self.value *= self.ratio;
        self.ratio *= self.growth;
        self.value
    }
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => gradient(simd, pass, &params, band));
}

#[inline(always)]
fn gradient<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (lightness, field) = (&pass.inputs[0], &pass.inputs[1]);
    let reach = params.halfwidth as i32 + 2;
    for_blocks_in_tiles::<2>(band, #[inline(always)] |block, target| {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let orientation = block.read2(simd, field);
        let line = Across::new(simd, &block, orientation);
        // Away from the picture's edges no position needs to be clamped, and there is a next row to read into.
        let [w, h] = lightness.full();
        let inner = block.x >= reach && block.x + 7 + reach < w && block.y >= reach && block.y + reach < h;
        let [middle, alpha] = block.read2(simd, lightness);
        let (mut narrow, mut narrow_alpha, mut wide, mut wide_alpha) = (middle, alpha, middle, alpha);
        let mut falloff = [Falloff::new(line.step, params.narrow), Falloff::new(line.step, params.wide)];
        for k in 1..=params.halfwidth as i32 {
            let near = (line.step * k as f32).simd_le(params.halfwidth);
            let ahead = line.sample2(simd, lightness, k, inner);
            let behind = line.sample2(simd, lightness, -k, inner);
            let (v, a) = (ahead[0] + behind[0], ahead[1] + behind[1]);
            let n = near.select(falloff[0].at(k), zero);
            let w = near.select(falloff[1].at(k), zero);
            narrow = v.mul_add(n, narrow);
            narrow_alpha = a.mul_add(n, narrow_alpha);
            wide = v.mul_add(w, wide);
            wide_alpha = a.mul_add(w, wide_alpha);
        }
        let covered = narrow_alpha.min(wide_alpha).simd_gt(LEAST_COVERAGE);
        let narrow = narrow / covered.select(narrow_alpha, one);
        let wide = wide / covered.select(wide_alpha, one);
        let u = dog_response(narrow, wide, params.base, params.edge);
        write2([covered.select(u, zero) * alpha, alpha], target);
    });
}
