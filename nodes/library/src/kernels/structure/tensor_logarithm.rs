//! The logarithm of a tensor, or back: its eigenvalues' at the same eigenvectors. Interpolated between
//! them (the log-Euclidean mean of Arsigny et al., *Log-Euclidean Metrics for Fast and Simple Calculus on
//! Diffusion Tensors*, 2006), a field keeps its shape where it falls off like a Gaussian; between the
//! tensors themselves the larger outweighs the smaller on the whole way, and edges come out wider.
//!
//! Cost: one eigenanalysis and two logarithms or powers.

pub use crate::kernels::shaders::tensor_logarithm::Params;
use crate::kernels::shared::tensor::{axis, eigen};
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tensor_logarithm {
    cpu: run,
    cost: |_| 60.0,
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 2e-5,
        outliers: 0.0,
        reason: "the smaller eigenvalue of a tensor of nearly one direction is a small difference of large \
                 numbers, and its logarithm has that relative error",
    },
});

/// A gradient of 1e-6 a pixel: what is below has no direction.
const LEAST: f32 = 1e-12;
/// Keeps the smaller eigenvalue of an edge above rounding.
const SHARE: f32 = 1e-3;

/// Adds the pass: tensors to their logarithms.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    convert(plan, tensor, 0)
}

/// Adds the pass: logarithms to their tensors.
pub fn pass_inverse(plan: &mut PlanBuilder, logarithm: ImageId) -> ImageId {
    convert(plan, logarithm, 1)
}

fn convert(plan: &mut PlanBuilder, image: ImageId, inverse: u32) -> ImageId {
    let params = Params { inverse, least: LEAST, share: SHARE };
    plan.pass(&KERNEL, &[image], &params, Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(
        simd,
        pass,
        band,
        #[inline(always)]
        |[e, f, g, w]| {
            let [e, f, g] = if params.inverse != 0 { back(e, f, g) } else { forth(&params, e, f, g) };
            [e, f, g, w]
        },
    ));
}

#[inline(always)]
fn forth<S: Simd>(params: &Params, e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> [f32x8<S>; 3] {
    let least = f32x8::splat(e.simd, params.least);
    let eigen = eigen(e, f, g);
    let larger = eigen.lambda1.at_least(least);
    let smaller = eigen.lambda2.at_least(least).at_least(larger * params.share);
    composed(larger.ln(), smaller.ln(), eigen.major)
}

#[inline(always)]
fn back<S: Simd>(e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> [f32x8<S>; 3] {
    let mean = (e + g) * 0.5;
    let (radius, major) = axis((e - g) * 0.5, f);
    composed((mean + radius).exp(), (mean - radius).exp(), major)
}

/// The tensor with the eigenvalue `a` along the unit vector and `b` across.
#[inline(always)]
fn composed<S: Simd>(a: f32x8<S>, b: f32x8<S>, [x, y]: [f32x8<S>; 2]) -> [f32x8<S>; 3] {
    let (xx, yy) = (x * x, y * y);
    [a * xx + b * yy, (a - b) * x * y, a * yy + b * xx]
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
    use isophote_engine::{Image, Rect};

    fn run(image: &Image, add: impl Fn(&mut PlanBuilder, ImageId) -> ImageId) -> Image {
        let mut plan = PlanBuilder::new(image.width(), image.height()).unwrap();
        let tensor = plan.input("tensor", 4, Class::Field);
        let result = add(&mut plan, tensor);
        plan.output("tensor", result);
        let region = Rect::of_size(image.width(), image.height());
        CpuExecutor::new()
            .run(&plan.finish().unwrap(), &[("tensor", image)], region, &CallingThread, Control::default())
            .unwrap()
            .remove(0)
    }

    #[test]
    fn the_way_there_and_back_keeps_tensors() {
        // Of any size; with an eigenvalue that is no vanishing share of the other.
        let tensors =
            [[1.0, 0.0, 0.01, 1.0], [3e-6, 2e-6, 2e-6, 0.5], [40.0, -9.0, 4.0, 0.0], [2.0, 0.0, 2.0, 1.0]];
        let image = Image::from_vec(4, 1, 4, tensors.concat()).unwrap();
        let there = run(&image, pass);
        assert!((there.pixel(0, 0)[0]).abs() < 1e-6 && (there.pixel(0, 0)[2] - 0.01f32.ln()).abs() < 1e-5);
        let back = run(&there, pass_inverse);
        for (got, want) in back.data().chunks_exact(4).zip(tensors) {
            let size = want[0].max(want[2]);
            assert!(
                (0..3).all(|i| (got[i] - want[i]).abs() < 1e-4 * size) && got[3] == want[3],
                "{got:?} {want:?}"
            );
        }
    }

    #[test]
    fn no_tensor_has_no_direction_and_edges_keep_theirs() {
        let image = Image::from_vec(2, 1, 4, vec![0.0, 0.0, 0.0, 1.0, 0.36, 0.48, 0.64, 1.0]).unwrap();
        let there = run(&image, pass);
        let [e, f, g, _] = there.pixel(0, 0).try_into().unwrap();
        assert!(f == 0.0 && e == g && (e - LEAST.ln()).abs() < 1e-4, "{e} {f} {g}");
        let back = run(&there, pass_inverse);
        let [e, f, g, _]: [f32; 4] = back.pixel(1, 0).try_into().unwrap();
        assert!((2.0 * f).atan2(e - g) - 0.96f32.atan2(-0.28) < 1e-4, "{e} {f} {g}");
        assert!(e * g - f * f < 2e-3, "{e} {f} {g}");
    }
}
