//! Adds the gradient of what a renderer knows beside the colour to a structure tensor, as further
//! channels of the multi-image gradient (2.34).
//!
//! * Normals: the gradient of the components, weighted by validity as colour is by coverage.
//! * Depth: relative differences 2 (z - z0) / (z + z0), which are those of ln z, so that the scene's
//!   unit does not matter; jumps, also those to the background, are bounded to 1.
//! * Object numbers: 1 where a neighbour is another object, else 0.
//!
//! NaN and infinities count as nothing there. Cost: about 60 operations a pixel.

use crate::declare::choice::Numbered;
pub use crate::kernels::shaders::guide_tensor::Params;
use crate::kernels::shared::outer_product::validity;
use crate::kernels::simd::line_buffer::{LineBuffer, strips};
use crate::kernels::simd::pixels::{eight, read, write};
use crate::kernels::structure::gradient_tensor::least_lambda1;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(guide_tensor {
    cpu: run,
    cost: |_| 60.0,
    tolerance: Tolerance {
        absolute: 2e-6,
        relative: 1e-4,
        outliers: 0.002,
        reason: "differences of neighbours magnify the last bits of the guide, F may cancel, and a \
                 tensor at the threshold of validity goes either way",
    },
});

crate::declare::choice::numbered! {
    /// Contents of a guide image.
    pub enum Guide {
        /// View-space normal and validity.
        Normal = 0,
        /// Distance from the camera, 0 or less where there is nothing.
        Depth = 1,
        /// A whole number per object.
        ObjectId = 2,
    }
}

/// Options by which a guide counts.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Content of the image.
    pub kind: Guide,
    /// Factor on its tensor.
    pub weight: f32,
    /// As in [`Measure`](super::gradient_tensor::Measure), for the sum.
    pub threshold: Option<f32>,
}

/// Adds the pass: tensor plus the weighted tensor of the guide.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId, guide: ImageId, options: &Options) -> ImageId {
    let Options { kind, weight, threshold } = *options;
    let params = Params { kind: kind as u32, weight, threshold: least_lambda1(threshold) };
    plan.pass(&KERNEL, &[tensor, guide], &params, Class::Field, Support::Pixels(1))
}

#[expect(clippy::redundant_closure, reason = "a function that is handed on itself is called, not inlined")]
fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    match Guide::of(params.kind) {
        Guide::Normal => dispatch!(pass.level, simd => normals(simd, pass, &params, band)),
        Guide::Depth => {
            dispatch!(pass.level, simd => scalars(
                simd, pass, &params, band,
                #[inline(always)] |v| clean_depth(v),
                #[inline(always)] |v, centre| relative(v, centre),
            ));
        }
        Guide::ObjectId => {
            dispatch!(pass.level, simd => scalars(
                simd, pass, &params, band,
                #[inline(always)] |v| clean_number(v),
                #[inline(always)] |v, centre| other(v, centre),
            ));
        }
    }
}

#[inline(always)]
fn clean_normal<S: Simd>(v: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let c = |x: f32| f32x8::splat(v[0].simd, x);
    let good = [v[0].is_finite(), v[1].is_finite(), v[2].is_finite(), v[3].is_finite()];
    let valid = (good[0] & good[1] & good[2] & good[3]).select(v[3].within(c(0.0), c(1.0)), c(0.0));
    let mut normal = [c(0.0); 3];
    for i in 0..3 {
        normal[i] = good[i].select(v[i].within(c(-1.0), c(1.0)), c(0.0)) * valid;
    }
    let [x, y, z] = normal;
    [x, y, z, valid]
}

#[inline(always)]
fn clean_depth<S: Simd>(v: f32x8<S>) -> f32x8<S> {
    // Where there is nothing, or no number, the depth is far behind everything.
    let far = f32x8::splat(v.simd, 1e30);
    (v.is_finite() & v.simd_gt(f32x8::splat(v.simd, 0.0))).select(v.at_most(far), far)
}

#[inline(always)]
fn relative<S: Simd>(v: f32x8<S>, centre: f32x8<S>) -> f32x8<S> {
    let c = |x: f32| f32x8::splat(v.simd, x);
    ((v - centre) / ((v + centre) * 0.5)).within(c(-1.0), c(1.0))
}

#[inline(always)]
fn clean_number<S: Simd>(v: f32x8<S>) -> f32x8<S> {
    v.is_finite().select(v, f32x8::splat(v.simd, 0.0))
}

#[inline(always)]
fn other<S: Simd>(v: f32x8<S>, centre: f32x8<S>) -> f32x8<S> {
    let c = |x: f32| f32x8::splat(v.simd, x);
    (v - centre).abs().simd_gt(c(0.5)).select(c(1.0), c(0.0))
}

/// Eight pixels with their neighbours, row by row.
type Neighbours<S> = [[f32x8<S>; 3]; 3];

/// Vector `i` of one channel; the rows begin one pixel before the first vector.
#[inline(always)]
fn neighbours<S: Simd>(simd: S, rows: &[&[f32]; 3], i: usize) -> Neighbours<S> {
    let mut all = [[f32x8::splat(simd, 0.0); 3]; 3];
    for y in 0..3 {
        let row = &rows[y][8 * i..8 * i + 10];
        for x in 0..3 {
            all[y][x] = eight(simd, row, x);
        }
    }
    all
}

/// The optimized 3x3 operator (2.26, 2.27).
#[inline(always)]
fn gradient<S: Simd>([[nw, n, ne], [w, _, e], [sw, s, se]]: Neighbours<S>) -> [f32x8<S>; 2] {
    let x = ((ne - nw) + (se - sw)) * 0.091_484_375 + (e - w) * 0.317_031_25;
    let y = ((sw - nw) + (se - ne)) * 0.091_484_375 + (s - n) * 0.317_031_25;
    [x, y]
}

#[inline(always)]
fn normals<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    over_blocks(
        simd,
        pass,
        params,
        band,
        #[inline(always)]
        |rows, y| {
            rows.load_mapped(
                simd,
                &pass.inputs[1],
                y,
                #[inline(always)]
                |v| clean_normal(v),
            )
        },
        #[inline(always)]
        |rows: &[[&[f32]; 3]; 4], i| {
            let around = neighbours(simd, &rows[3], i);
            let (validity, [valid_x, valid_y]) = (around[1][1], gradient(around));
            let mut sums = [f32x8::splat(simd, 0.0); 3];
            for channel in &rows[..3] {
                let around = neighbours(simd, channel, i);
                let (centre, [gx, gy]) = (around[1][1], gradient(around));
                let (x, y) = (validity * gx - centre * valid_x, validity * gy - centre * valid_y);
                sums = [sums[0] + x * x, sums[1] + x * y, sums[2] + y * y];
            }
            sums
        },
    );
}

#[inline(always)]
fn scalars<S: Simd>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    band: &mut Band<'_>,
    clean: impl Fn(f32x8<S>) -> f32x8<S>,
    difference: impl Fn(f32x8<S>, f32x8<S>) -> f32x8<S>,
) {
    over_blocks(
        simd,
        pass,
        params,
        band,
        #[inline(always)]
        |rows, y| rows.load1(simd, &pass.inputs[1], y, &clean),
        #[inline(always)]
        |rows: &[[&[f32]; 3]; 1], i| {
            let mut around = neighbours(simd, &rows[0], i);
            let centre = around[1][1];
            for value in around.as_flattened_mut() {
                *value = difference(*value, centre);
            }
            let [x, y] = gradient(around);
            [x * x, x * y, y * y]
        },
    );
}

/// Adds the guide's tensor to the first input. `guide` gives it for vector `i` of a row, from the rows
/// above, at and below, channel by channel.
#[inline(always)]
fn over_blocks<S: Simd, const CHANNELS: usize>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    band: &mut Band<'_>,
    load: impl Fn(&mut LineBuffer, i32),
    guide: impl Fn(&[[&[f32]; 3]; CHANNELS], usize) -> [f32x8<S>; 3],
) {
    let window = band.window;
    let tensor = &pass.inputs[0];
    let mut rows = LineBuffer::default();
    for (x0, x1) in strips(window.x0, window.x1) {
        rows.start(x0, x1, 1, CHANNELS);
        load(&mut rows, window.y0 - 1);
        load(&mut rows, window.y0);
        for y in window.y0..window.y1 {
            load(&mut rows, y + 1);
            let around: [[&[f32]; 3]; CHANNELS] =
                std::array::from_fn(|c| [rows.row(y - 1, c), rows.row(y, c), rows.row(y + 1, c)]);
            let len = 4 * (x1 - x0) as usize;
            let at = tensor.offset(x0, y);
            let source = &tensor.data()[at..at + len];
            let start = 4 * (x0 - window.x0) as usize;
            let target = &mut band.row_mut(0, y)[start..start + len];
            for (i, (source, target)) in source.chunks(32).zip(target.chunks_mut(32)).enumerate() {
                let [e, f, g, _] = read(simd, source);
                let [x, y, z] = guide(&around, i);
                let (e, f, g) = (e + x * params.weight, f + y * params.weight, g + z * params.weight);
                write([e, f, g, validity(simd, params.threshold, e, f, g)], target);
            }
        }
    }
}
