//! Merges a level of the multi-scale Kuwahara filter with the result of the coarser one (§ 5.5.2): what
//! varied much there stays as it is, the rest takes the coarser result, interpolated. What lies on an edge may stay as
//! well, since nothing may be painted across it.
//!
//! Cost: 4 interpolations on five channels and 20 operations.

pub use crate::kernels::shaders::propagate_colour::Params;
use crate::kernels::simd::pixels::{eight, for_blocks, read, write};
use crate::kernels::simd::upsampling::Upsampling;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(propagate_colour {
    cpu: |simd, pass, params, band| merge(simd, pass, &params, band),
    cost: |_| 50.0,
    tolerance: Tolerance::of_rounding(
        2e-5,
        2e-5,
        "interpolations in the same order, and a product with the deviation"
    ),
});

/// Options that say how much of a level is kept.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// p_s p_d^k at this level.
    pub gain: f32,
    /// tau_v: deviations up to this, times the gain, count for nothing.
    pub threshold: f32,
    /// A smoothed structure tensor whose edges are kept.
    pub edges: Option<ImageId>,
}

/// Gradients, the root of the tensor's trace, from which on a place lies on an edge and is kept as it is: those of steps by
/// 0.3 and by 0.6 under the usual smoothing.
const EDGE: [f32; 2] = [0.06, 0.12];

/// Adds the pass; `coarse` and the standard deviations found there lie one level above `color`.
pub fn pass(
    plan: &mut PlanBuilder,
    color: ImageId,
    coarse: ImageId,
    deviations: ImageId,
    options: &Options,
) -> ImageId {
    let Options { gain, threshold, edges } = *options;
    let edge = if edges.is_some() { EDGE[0] } else { -1.0 };
    let params = Params { gain, threshold, edge, inverse_ramp: 1.0 / (EDGE[1] - EDGE[0]) };
    // Where edges count for nothing, any image may stand for their tensor.
    let inputs = [color, coarse, deviations, edges.unwrap_or(color)];
    plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(1))
}

#[inline(always)]
fn merge<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (mut colours, mut spreads) = (Upsampling::default(), Upsampling::default());
    let columns = [band.window.x0, band.window.x1];
    let (mut filtered, mut deviations): (Vec<f32>, Vec<f32>) = (Vec::new(), Vec::new());
    let (zero, one, least) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0), f32x8::splat(simd, 1e-3));
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            if block.x == columns[0] {
                filtered.clear();
                filtered.extend_from_slice(colours.row::<4>(&pass.inputs[1], block.y, columns, true));
                deviations.clear();
                deviations.extend_from_slice(spreads.row::<1>(&pass.inputs[2], block.y, columns, false));
            }
            let at = (block.x - columns[0]) as usize;
            let [r, g, b, a] = block.read(simd, &pass.inputs[0]);
            let below: [f32x8<S>; 4] = read(simd, &filtered[4 * at..4 * at + 32]);
            let deviation = eight(simd, &deviations, at);
            let beta = (deviation * params.gain - params.threshold).within(zero, one);
            let beta = if params.edge >= 0.0 {
                let [e, _, g, _]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[3]);
                let steep = ((e + g).at_least(zero).sqrt() - params.edge) * params.inverse_ramp;
                beta.at_least(steep.within(zero, one))
            } else {
                beta
            };
            let beta = below[3].simd_lt(least).select(one, beta);
            let n = one / below[3].at_least(least);
            let mut out = [r, g, b, a];
            for (out, below) in out.iter_mut().zip(below).take(3) {
                let below = below * n;
                *out = (*out - below).mul_add(beta, below);
            }
            write(out, target);
        },
    );
}
