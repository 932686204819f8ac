//! The gradient-directed shock filter (§ 6.4.3): where the flow-based Laplacian of Gaussian (Listing 6.1) is
//! above the threshold, the pixel of least luma along the major eigenvector (Listing 6.2); where it is
//! below its opposite, the one of greatest luma; elsewhere the pixel itself.
//!
//! The colour moves as a whole; coverage stays, and pixels that are covered less than half as much as
//! the centre are passed over. Of equal ones the first stays, the nearer before the farther.
//!
//! The radius is whole steps of the full-size picture. On a proxy these may end within a step; what
//! the last one finds then counts by its share, so that small radii fade instead of ending at once.
//!
//! Cost: that of the derivative; then four comparisons per step, and nothing where the threshold is not reached.

pub use crate::kernels::shaders::directed_shock::Params;
use crate::kernels::shared::tensor::axis;
use crate::kernels::simd::pixels::{BLOCK, Block, fetch4, offsets, write};
use isophote_engine::apart;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Rect, Support, Tolerance, View};
use luma_taps::{Line, LumaTaps, STRIP};

#[path = "directed_shock/flow_log.rs"]
mod flow_log;
#[path = "directed_shock/luma_taps.rs"]
mod luma_taps;

crate::kernel!(directed_shock {
    cpu: |simd, pass, params, band| strips(simd, pass, &params, band),
    cost: |p| 60.0 + 50.0 * f64::from(p.reach) + 60.0 * f64::from(p.radius * p.scale),
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 1e-6,
        outliers: 5e-3,
        reason: "colours are moved, not computed; which one is decided by comparisons of luma, by a response \
                 whose taps nearly cancel, and by a line that meets a pixel's border, on the last bit",
    },
});

/// Narrower Gaussians than this see no neighbour.
const LEAST_SIGMA: f32 = 0.2;

/// Options of the filter.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation of the second derivative, pixels.
    pub sigma: f32,
    /// Distance within which pixels are looked for, pixels of the full-size picture.
    pub radius: f32,
    /// The size that is rendered over the full size.
    pub scale: f32,
    /// Responses up to this, in the unit of luma, leave a pixel alone.
    pub threshold: f32,
}

/// Sharpens `color` along the major eigenvectors of `tensors`, by the second derivative of `smooth`, which may
/// be the same.
pub fn pass(
    plan: &mut PlanBuilder,
    color: ImageId,
    tensors: ImageId,
    smooth: ImageId,
    options: &Options,
) -> ImageId {
    let Options { sigma, radius, scale, threshold } = *options;
    let sigma = sigma.max(LEAST_SIGMA);
    let params = Params { sigma, reach: flow_log::CUTOFF * sigma, radius, scale, threshold };
    let support = Support::Pixels(reach(&params) as u32);
    plan.pass(&KERNEL, &[color, tensors, smooth], &params, Class::Colour, support)
}

/// The most pixels that are read to any side.
fn reach(params: &Params) -> i32 {
    steps(params).max(flow_log::radius(params.reach))
}

/// Most steps to a side that an extremum is looked for.
fn steps(params: &Params) -> i32 {
    ((params.radius + 1e-3).floor() * params.scale).ceil() as i32
}

#[inline(always)]
fn strips<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (window, radius) = (band.window, steps(params));
    let [color, tensors, smooth] = [0, 1, 2].map(|i| &pass.inputs[i]);
    let derivative = [params.sigma, params.reach];
    let (mut smoothed, mut plain) = (LumaTaps::default(), LumaTaps::default());
    let same = std::ptr::eq(color.data(), smooth.data());
    for x0 in (window.x0..window.x1).step_by(STRIP as usize) {
        let strip = Rect { x0, x1: (x0 + STRIP).min(window.x1), ..window };
        smoothed.load(simd, smooth, strip, reach(params), true);
        // The luma of opaque pixels is the same, weighted by coverage or not.
        let shared = same && smoothed.is_opaque();
        if !shared {
            plain.load(simd, color, strip, radius, false);
        }
        for y in window.y0..window.y1 {
            let (start, end) = ((x0 - window.x0) as usize, (strip.x1 - window.x0) as usize);
            let row = &mut band.row_mut(0, y)[4 * start..4 * end];
            for i in (0..end - start).step_by(BLOCK) {
                let block = Block { x: x0 + i as i32, y, len: BLOCK.min(end - start - i) };
                let target = &mut row[4 * i..4 * (i + block.len)];
                let [e, f, g, _] = block.read(simd, tensors);
                let (_, n) = axis((e - g) * 0.5, f);
                let line = smoothed.line(simd, block.x, y, n);
                let z = if smoothed.is_opaque() {
                    apart!(simd, flow_log::response::<_, true>(simd, derivative, &smoothed, &line, block))
                } else {
                    apart!(simd, flow_log::response::<_, false>(simd, derivative, &smoothed, &line, block))
                };
                let active = z.abs().simd_gt(f32x8::splat(simd, params.threshold));
                if !active.any_true() {
                    write::<S, 4>(block.read(simd, color), target);
                    continue;
                }
                let (lumas, line) = if shared {
                    (&smoothed, line.shortened(radius))
                } else {
                    (&plain, plain.line(simd, block.x, y, n))
                };
                // Over so short a reach neighbours seldom come to lie farther apart.
                let colors = match (lumas.is_opaque(), line.rows()) {
                    (true, 1) => apart!(
                        simd,
                        extreme::<_, true, 1>(simd, pass, params, radius, lumas, &line, block, active, z),
                    ),
                    (true, _) => apart!(
                        simd,
                        extreme::<_, true, 0>(simd, pass, params, radius, lumas, &line, block, active, z),
                    ),
                    (false, _) => apart!(
                        simd,
                        extreme::<_, false, 0>(simd, pass, params, radius, lumas, &line, block, active, z),
                    ),
                };
                write(colors, target);
            }
        }
    }
}

/// The best candidates of eight pixels so far.
struct Best<S: Simd> {
    /// Luma, negative where the minimum is looked for.
    value: f32x8<S>,
    /// Position, relative to the centre.
    offset: [i32x8<S>; 2],
    /// Least coverage of a candidate.
    least_alpha: f32x8<S>,
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the inner function of one loop")]
fn extreme<S: Simd, const OPAQUE: bool, const ROWS: usize>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    radius: i32,
    lumas: &LumaTaps,
    line: &Line<S>,
    block: Block,
    active: mask32x8<S>,
    z: f32x8<S>,
) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let steps = (line.major_share * (params.radius + 1e-3)).floor() * params.scale;
    let last = steps.ceil();
    // Above the threshold lies the zone of a minimum: erode. Below its opposite: dilate.
    let sign = z.simd_gt(zero).select(-one, one);
    let mut alpha = one;
    if !OPAQUE {
        alpha = lumas.coverage(simd, block.x, block.y);
    }
    let luma = lumas.centre(simd, block.x, block.y);
    let none = i32x8::splat(simd, 0);
    let mut best = Best { value: luma * sign, offset: [none; 2], least_alpha: alpha * 0.5 };
    // The best within whole steps.
    let mut whole = best.offset;
    for k in 1..=radius {
        let active = active & last.simd_ge(f32x8::splat(simd, k as f32));
        if !active.any_true() {
            break;
        }
        for along in [k, -k] {
            let across = line.slope * along as f32;
            // The pixels on both sides of the line; one and the same where it meets a centre.
            let first: i32x8<S> = (across + 0.001).floor().to_int();
            let second: i32x8<S> = (across + 0.999).floor().to_int();
            let apart = second.simd_gt(first);
            let [a, b] = lumas.pair::<_, ROWS>(simd, line, along, first, 0.001);
            let mut coverage = [one; 2];
            if !OPAQUE {
                coverage = lumas.pair_coverage::<_, ROWS>(simd, line, along, first, 0.001);
            }
            let far = [apart.select(b, a), apart.select(coverage[1], coverage[0])];
            best.compare::<OPAQUE>(line, active, sign, far, along, second);
            best.compare::<OPAQUE>(line, active, sign, [a, coverage[0]], along, first);
        }
        if params.scale != 1.0 {
            let inside = steps.simd_ge(f32x8::splat(simd, k as f32));
            whole = [inside.select(best.offset[0], whole[0]), inside.select(best.offset[1], whole[1])];
        }
    }
    let share = steps - steps.floor();
    let partly = share.simd_gt(zero) & active;
    let whole = partly.any_true().then_some(whole);
    let [r, g, b] = moved(simd, &pass.inputs[0], block, best.offset, whole, share);
    [r, g, b, if OPAQUE { one } else { alpha }]
}

/// The colours that lie `offset` from eight pixels; where the last step counts by a `share` above 0, and those at
/// `whole` are given, the rest is theirs.
#[inline(always)]
fn moved<S: Simd>(
    simd: S,
    color: &View<'_>,
    block: Block,
    offset: [i32x8<S>; 2],
    whole: Option<[i32x8<S>; 2]>,
    share: f32x8<S>,
) -> [f32x8<S>; 3] {
    let columns = block.columns(simd);
    let [mut r, mut g, mut b, _] =
        fetch4(simd, color, offsets(color, columns + offset[0], offset[1] + block.y));
    if let Some(whole) = whole {
        let [near_r, near_g, near_b, _] =
            fetch4(simd, color, offsets(color, columns + whole[0], whole[1] + block.y));
        let part = share.simd_gt(f32x8::splat(simd, 0.0));
        r = part.select(near_r + (r - near_r) * share, r);
        g = part.select(near_g + (g - near_g) * share, g);
        b = part.select(near_b + (b - near_b) * share, b);
    }
    [r, g, b]
}

impl<S: Simd> Best<S> {
    /// Takes the pixel of this luma and coverage, `along` and `across` the line, where it
    /// is better.
    #[inline(always)]
    fn compare<const OPAQUE: bool>(
        &mut self,
        line: &Line<S>,
        active: mask32x8<S>,
        sign: f32x8<S>,
        [luma, alpha]: [f32x8<S>; 2],
        along: i32,
        across: i32x8<S>,
    ) {
        let mut eligible = active;
        if !OPAQUE {
            eligible &= alpha.simd_ge(self.least_alpha);
        }
        let value = luma * sign;
        let better = value.simd_gt(self.value) & eligible;
        let along = i32x8::splat(across.simd, along);
        self.value = better.select(value, self.value);
        self.offset[0] = better.select(line.along_x.select(along, across), self.offset[0]);
        self.offset[1] = better.select(line.along_x.select(across, along), self.offset[1]);
    }
}
