//! One pass of the edge tangent flow (2.134) over a disc or, for the separable form, a row or a column.
//!
//! It is computed on the tensors n n^T of unit vectors, which have no sign to get wrong: by (2.136) the
//! sum over the neighbours of w_s w_m <n(y), n(x)> n(y) is the sum of w_s w_m n(y) n(y)^T, times n(x);
//! and since w_m (2.135) is the sum of a term of y and one of x, two sums of the neighbours' tensors,
//! plain and by their magnitude, are all it takes. Normals n stand for tangents t, which turn with them.
//!
//! A pixel without a gradient would keep its zero vector, and hole the field: it takes the axis that
//! vectors would turn to in its place, the major eigenvector of the weighted sum, unless the neighbours
//! leave that to chance.
//!
//! Cost: 7 multiply-adds per neighbour, pi radius^2 of them, and about 50 operations. The shader reads
//! them through workgroup memory, about radius^2 / 16 + radius / 2 + 1 loads a pixel.

pub use crate::kernels::shaders::edge_tangent_flow::Params;
use crate::kernels::shared::tensor::axis;
use crate::kernels::simd::line_buffer::{self, LineBuffer, Row, STRIP, for_rows};
use crate::kernels::simd::pixels::{BLOCK, eight, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

/// Entries of the table, the centre included.
const TAPS: usize = 24;
/// Largest reach, in pixels.
const MAX_REACH: i32 = TAPS as i32 - 1;

crate::kernel!(edge_tangent_flow {
    cpu: |simd, pass, params, band| rows(simd, pass, &params, band),
    cost: |p| {
        let [x, y] = p.reach.map(f64::from);
        7.0 * (2.0 * x + 1.0) * (2.0 * y + 1.0) + 50.0
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 0.0,
        outliers: 0.01,
        reason: "where the vectors around point everywhere, or are all across the centre's, the sum is \
                 small and its direction is that of the roundings",
    },
});

crate::declare::choice::choice! {
    /// Spatial weight w_s of the neighbours.
    pub enum Window {
        /// All neighbours nearer than the radius alike.
        Box ("box", "All alike"),
        /// Nearer neighbours more than others.
        Gaussian ("gaussian", "Near ones more"),
    }
}

/// The neighbours of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Neighbours {
    /// All nearer than the radius.
    Disc,
    /// Neighbours in the same row.
    Row,
    /// Neighbours in the same column.
    Column,
}

/// Options of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Neighbours lie nearer than this, pixels.
    pub radius: f32,
    /// Their spatial weight.
    pub window: Window,
    /// Neighbours that count.
    pub neighbours: Neighbours,
    /// The last pass gives tensors with their validity.
    pub last: bool,
}

/// Adds a pass. `flow` is what [`flow_start`](super::flow_start) or the pass before gave, `largest`
/// its largest magnitude; the `last` pass gives tensors with their validity.
pub fn pass(plan: &mut PlanBuilder, flow: ImageId, largest: ImageId, options: &Options) -> ImageId {
    let Options { radius, window, neighbours, last } = *options;
    // Nearer than the radius, strictly; a last bit must not decide about a whole number.
    let reach = ((radius - 1e-3).ceil() as i32 - 1).clamp(0, MAX_REACH);
    let sigma = f64::from(radius.max(0.1)) / 3.0;
    let mut weights = [[0.0; 4]; TAPS / 4];
    for i in 0..=reach as usize {
        weights[i / 4][i % 4] = match window {
            Window::Box => 1.0,
            Window::Gaussian => (-((i * i) as f64) / (2.0 * sigma * sigma)).exp() as f32,
        };
    }
    let params = Params {
        reach: match neighbours {
            Neighbours::Disc => [reach, reach],
            Neighbours::Row => [reach, 0],
            Neighbours::Column => [0, reach],
        },
        limit: radius.max(1e-2).powi(2) * (1.0 - 1e-5),
        last: u32::from(last),
        weights,
    };
    plan.pass(&KERNEL, &[flow, largest], &params, Class::Field, Support::Pixels(reach as u32))
}

impl Params {
    /// Spatial weight at a distance along an axis.
    #[inline(always)]
    fn weight(&self, i: i32) -> f32 {
        self.weights[i as usize / 4][i as usize % 4]
    }
}

/// The neighbours in one row.
struct Span {
    /// The row, from the centre's.
    dy: i32,
    /// Number of them to either side.
    half: i32,
    /// Spatial weight of the row.
    weight: f32,
}

#[inline(always)]
fn rows<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let inverse = 1.0 / pass.inputs[1].pixel1(0, 0).max(f32::MIN_POSITIVE);
    let [reach_x, reach_y] = params.reach;
    let half = |j: i32| (0..=reach_x).rev().find(|i| ((i * i + j * j) as f32) < params.limit);
    let spans: Vec<Span> = (-reach_y..=reach_y)
        .filter_map(|dy| half(dy).map(|half| Span { dy, half, weight: params.weight(dy.abs()) }))
        .collect();
    let radius = reach_x.max(reach_y);
    for_rows::<S, 4>(
        simd,
        &pass.inputs[0],
        band,
        [STRIP, radius],
        std::convert::identity,
        #[inline(always)]
        |Row { buffer, y, .. }, target| {
            for (block, pixels) in target.chunks_mut(4 * BLOCK).enumerate() {
                let centre = radius as usize + BLOCK * block;
                let [plain, strong] = sums(simd, buffer, params, &spans, y, centre);
                let own = line_buffer::pixels(simd, &buffer.channels(y), centre);
                write(turned(simd, params, own, plain, strong, inverse), pixels);
            }
        },
    );
}

/// The weighted sums of the tensors around eight pixels, plain and by their magnitudes.
#[inline(always)]
fn sums<S: Simd>(
    simd: S,
    buffer: &LineBuffer,
    params: &Params,
    spans: &[Span],
    y: i32,
    centre: usize,
) -> [[f32x8<S>; 3]; 2] {
    let zero = f32x8::splat(simd, 0.0);
    let (mut plain, mut strong) = ([zero; 3], [zero; 3]);
    for &Span { dy, half, weight } in spans {
        let len = 2 * half as usize + 8;
        let first = centre - half as usize;
        let e = &buffer.row(y + dy, 0)[first..first + len];
        let f = &buffer.row(y + dy, 1)[first..first + len];
        let g = &buffer.row(y + dy, 2)[first..first + len];
        let m = &buffer.row(y + dy, 3)[first..first + len];
        for i in 0..=2 * half as usize {
            let w = f32x8::splat(simd, weight * params.weight((i as i32 - half).abs()));
            let by_magnitude = eight(simd, m, i) * w;
            let e = eight(simd, e, i);
            let f = eight(simd, f, i);
            let g = eight(simd, g, i);
            plain = [e.mul_add(w, plain[0]), f.mul_add(w, plain[1]), g.mul_add(w, plain[2])];
            strong = [
                e.mul_add(by_magnitude, strong[0]),
                f.mul_add(by_magnitude, strong[1]),
                g.mul_add(by_magnitude, strong[2]),
            ];
        }
    }
    [plain, strong]
}

/// The centre's tensor after the pass.
#[inline(always)]
fn turned<S: Simd>(
    simd: S,
    params: &Params,
    own: [f32x8<S>; 4],
    plain: [f32x8<S>; 3],
    strong: [f32x8<S>; 3],
    inverse: f32,
) -> [f32x8<S>; 4] {
    let c = |v: f32| f32x8::splat(simd, v);
    // (2.135), twice: m(y) + (1 - m(x)).
    let rest = c(1.0) - own[3] * inverse;
    let mut m = plain;
    for i in 0..3 {
        m[i] = strong[i] * inverse + rest * plain[i];
    }
    let (radius, sum) = axis((m[0] - m[2]) * 0.5, m[1]);
    let (_, [x, y]) = axis((own[0] - own[2]) * 0.5, own[1]);
    let v = [m[0] * x + m[1] * y, m[1] * x + m[2] * y];
    let length = v[0] * v[0] + v[1] * v[1];
    let long = length.simd_gt(c(1e-24));
    let factor = c(1.0) / length.sqrt();
    // A pixel without a gradient takes the axis that vectors would turn to, where there is one.
    let none = (own[0] + own[2]).simd_eq(c(0.0));
    let undecided = none & radius.simd_lt((m[0] + m[2]) * 0.025);
    let vx = none.select(sum[0], long.select(v[0] * factor, x));
    let vy = none.select(sum[1], long.select(v[1] * factor, y));
    let keeps = (m[0] + m[2]).simd_lt(c(1e-12)) | undecided;
    let e = keeps.select(own[0], vx * vx);
    let f = keeps.select(own[1], vx * vy);
    let g = keeps.select(own[2], vy * vy);
    let w = if params.last != 0 { (e + g).simd_gt(c(0.0)).select(c(1.0), c(0.0)) } else { own[3] };
    [e, f, g, w]
}
