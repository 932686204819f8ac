//! Second pass of the separable flow-based difference of Gaussians: a Gaussian of the response along
//! the stream line of the tensor field (§ 2.9, 4.5), then the threshold (4.8).
//!
//! Cost: 4 sigma_m steps per pixel, each one bilinear sample of two values and one (Euler, two-step) or two
//! samples of orientation with their tangents, about 70 or 110 operations.

use crate::declare::choice::Numbered;
pub use crate::kernels::shaders::flow_dog_tangent::Params;
use crate::kernels::shared::edge_threshold::{Xdog, edge_of_sums};
use crate::kernels::shared::sampling::sample_linear2;
use crate::kernels::shared::stream::{Field, FieldView, Integrator, Stream, half_length};
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::pixels::Block;
use crate::kernels::trace::tile_copy::{TWO, TileCopy};
use crate::kernels::trace::{AlongLines, FieldCopy, Inputs, Lines, along_lines, both_sides};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(flow_dog_tangent {
    cpu: run,
    cost: |p| {
        2.0 * f64::from(half_length(p.sigma))
            * if p.integrator == Integrator::Midpoint as u32 { 110.0 } else { 70.0 }
            + 30.0
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "stream lines add up roundings, which the slope of the threshold magnifies; where the \
                 field is undetermined the last bit decides where a line goes",
    },
});

/// Options of the smoothing along lines.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation along the lines, pixels.
    pub sigma: f32,
    /// Integrator by which lines are stepped.
    pub integrator: Integrator,
    /// The threshold.
    pub xdog: Xdog,
}

/// The edge image of a `response` (u alpha, alpha): smoothed along the stream lines of `field` (E - G, F) by
/// standard deviation `sigma` pixels, thresholded as `xdog` says.
pub fn pass(plan: &mut PlanBuilder, response: ImageId, field: ImageId, options: &Options) -> ImageId {
    let Options { sigma, integrator, xdog } = *options;
    let params = Params {
        sigma,
        integrator: integrator as u32,
        threshold: xdog.threshold as u32,
        epsilon: xdog.epsilon,
        phi: xdog.phi,
        faintness: xdog.faintness,
    };
    plan.pass(&KERNEL, &[response, field], &params, Class::Field, Support::Pixels(reach(&params) as u32))
}

/// The most pixels that are read to any side: a bilinear sample at distance L reads one pixel further.
fn reach(params: &Params) -> i32 {
    half_length(params.sigma) as i32 + 1
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let inputs = Inputs {
        source: pass.inputs[0],
        field: pass.inputs[1],
        integrator: Integrator::of(params.integrator),
        nearest: false,
        reach: reach(&params),
    };
    let falloff = -0.721_347_52 / (params.sigma * params.sigma).max(1e-6);
    // All lanes share the arc length, and so the weights.
    let weights = (1..=half_length(params.sigma) as i32).map(|u| (falloff * (u * u) as f32).exp2()).collect();
    along_lines(pass.level, &inputs, &mut Smooth { inputs, params, weights }, band);
}

/// A Gaussian along the lines.
struct Smooth<'a> {
    inputs: Inputs<'a>,
    params: Params,
    /// At arc length 1, 2, ...
    weights: Vec<f32>,
}

impl AlongLines<TWO, 1> for Smooth<'_> {
    #[inline(always)]
    fn near<S: Simd>(
        &mut self,
        simd: S,
        field: &FieldCopy<'_>,
        integrator: Integrator,
        source: &TileCopy<TWO>,
        [first, second]: &[Block; 2],
    ) -> [[f32x8<S>; 1]; 2] {
        let ([a, b], [c, d]) = (self.sides(simd, first), self.sides(simd, second));
        let mut sums = [first.read(simd, &self.inputs.source), second.read(simd, &self.inputs.source)];
        let mut lines = Lines::new(simd, field, integrator, [a, b, c, d]);
        self.add(
            simd,
            field,
            &mut lines,
            &mut sums,
            #[inline(always)]
            |place| source.sample(simd, place),
        );
        [[self.edge(sums[0])], [self.edge(sums[1])]]
    }

    #[inline(always)]
    fn far<S: Simd>(
        &mut self,
        simd: S,
        field: &FieldView<'_>,
        integrator: Integrator,
        source: &View<'_>,
        block: &Block,
    ) -> [f32x8<S>; 1] {
        let mut lines = Lines::new(simd, field, integrator, self.sides(simd, block));
        let mut sums = [block.read(simd, source)];
        self.add(
            simd,
            field,
            &mut lines,
            &mut sums,
            #[inline(always)]
            |[x, y]| sample_linear2(simd, source, *x, *y),
        );
        [self.edge(sums[0])]
    }
}

impl Smooth<'_> {
    /// Both sides of the lines through a block.
    #[inline(always)]
    fn sides<S: Simd>(&self, simd: S, block: &Block) -> [Stream<S>; 2] {
        let [difference, f] = block.read(simd, &self.inputs.field);
        both_sides(simd, block, tangent(difference, f, f32x8::splat(simd, 0.0)))
    }

    /// Adds the weighted (u alpha, alpha) along the lines to those of their blocks.
    #[inline(always)]
    fn add<S: Simd, F: Field<S>, const BLOCKS: usize, const LINES: usize>(
        &self,
        simd: S,
        field: &F,
        lines: &mut Lines<S, F, LINES>,
        sums: &mut [[f32x8<S>; 2]; BLOCKS],
        sample: impl Fn(&F::Place) -> [f32x8<S>; 2],
    ) {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        lines.trace(
            simd,
            field,
            [one; LINES],
            self.weights.len(),
            #[inline(always)]
            |k, i, point| {
                let weight = point.active.select(f32x8::splat(simd, self.weights[k]), zero);
                let [v, alpha] = sample(&point.place);
                let [sum, norm] = sums[i / 2];
                sums[i / 2] = [weight.mul_add(v, sum), weight.mul_add(alpha, norm)];
                point.active
            },
        );
    }

    /// The edge image of weighted sums of (u alpha, alpha).
    #[inline(always)]
    fn edge<S: Simd>(&self, sums: [f32x8<S>; 2]) -> f32x8<S> {
        let Params { threshold, epsilon, phi, faintness, .. } = self.params;
        edge_of_sums(sums, threshold, epsilon, phi, faintness)
    }
}
