//! Pixels that may be edges (§ 4.1, 4.2.1): local maxima of the gradient's magnitude along the gradient
//! (Canny), or zero crossings of the Laplacian (Marr and Hildreth); 0 is none, 1 a weak and 2 a strong
//! candidate. Or, without any thinning, the thresholded magnitude as an edge image.
//!
//! Cost: eight neighbours and about 40 operations per pixel.

pub use crate::kernels::shaders::edge_candidates::Params;
use crate::kernels::simd::line_buffer::{Row, STRIP, for_rows};
use crate::kernels::simd::pixels::{BLOCK, eight, write};
use isophote_engine::fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(edge_candidates {
    cpu: |simd, pass, params, band| candidates(simd, pass, &params, band),
    cost: |_| 40.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "a height at a threshold, or as high as its neighbour, goes either way on the last bit",
    },
});

crate::declare::choice::choice! {
    /// Criterion of an edge.
    pub enum Method {
        /// Thin joined lines where the picture changes most.
        Maximum = 0 ("canny", "Canny"),
        /// Soft bands that darken from weak to strong edges.
        Magnitude = 2 ("sobel", "Sobel"),
        /// Closed contours where the Laplacian changes its sign.
        ZeroCrossing = 1 ("log_zero_crossing", "Zero crossings"),
    }
}

/// Values nearer to each other than this ratio count as equal: decided by rounding, lines would be ragged.
const TIE: f32 = 1.0005;

/// Options of edges; heights in units of L.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Method by which edges are found.
    pub method: Method,
    /// Height from which on an edge may continue a stronger one.
    pub low: f32,
    /// Height from which on an edge is drawn by itself.
    pub high: f32,
}

/// The candidates of a gradient image (see `edge_gradient`); heights in units of L. For
/// [`Method::Magnitude`] the edge image.
pub fn pass(plan: &mut PlanBuilder, gradient: ImageId, options: &Options) -> ImageId {
    let Options { method, low, high } = *options;
    let params = Params { method: method as u32, low, high: high.max(low) };
    plan.pass(&KERNEL, &[gradient], &params, Class::Field, Support::Pixels(1))
}

/// The rows around one, of one value.
type Around<'a> = [&'a [f32]; 3];

#[inline(always)]
fn candidates<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    for_rows::<S, 1>(
        simd,
        &pass.inputs[0],
        band,
        [STRIP, 1],
        std::convert::identity,
        #[inline(always)]
        |Row { buffer, y, .. }, target| {
            let heights = [buffer.row(y - 1, 2), buffer.row(y, 2), buffer.row(y + 1, 2)];
            let laplacians = [buffer.row(y - 1, 3), buffer.row(y, 3), buffer.row(y + 1, 3)];
            let (gx, gy) = (buffer.row(y, 0), buffer.row(y, 1));
            for (i, pixels) in target.chunks_mut(BLOCK).enumerate() {
                let at = BLOCK * i;
                let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
                let height = near(simd, &heights, at, 0, 0);
                if params.method == Method::Magnitude as u32 {
                    let t = (height - params.low) / (params.high - params.low).max(1e-3);
                    let t = t.within(0.0, 1.0);
                    write([one - t * t * (t * -2.0 + 3.0)], pixels);
                    continue;
                }
                let found = if params.method == Method::Maximum as u32 {
                    let g = [eight(simd, gx, at + 1), eight(simd, gy, at + 1)];
                    is_maximum(simd, &heights, at, height, g)
                } else {
                    is_crossing(simd, &laplacians, at)
                };
                let found = found & height.simd_gt(params.low);
                let class = height.simd_gt(params.high).select(one + one, one);
                write([found.select(class, zero)], pixels);
            }
        },
    );
}

/// Values of the pixels at (dx, dy) from those of a block.
#[inline(always)]
fn near<S: Simd>(simd: S, rows: &Around<'_>, at: usize, dx: i32, dy: i32) -> f32x8<S> {
    let start = (at as i32 + 1 + dx) as usize;
    eight(simd, rows[(1 + dy) as usize], start)
}

/// True where `height` is a maximum along the gradient. Of two equal neighbours, as both sides of a sharp
/// step are, the darker one is it.
#[inline(always)]
fn is_maximum<S: Simd>(
    simd: S,
    heights: &Around<'_>,
    at: usize,
    height: f32x8<S>,
    [gx, gy]: [f32x8<S>; 2],
) -> mask32x8<S> {
    let zero = f32x8::splat(simd, 0.0);
    let (ax, ay) = (gx.abs(), gy.abs());
    let upright = ay.simd_gt(ax);
    let (right, down) = (gx.simd_ge(zero), gy.simd_ge(zero));
    let (west, east) = (near(simd, heights, at, -1, 0), near(simd, heights, at, 1, 0));
    let (north, south) = (near(simd, heights, at, 0, -1), near(simd, heights, at, 0, 1));
    let (nw, ne) = (near(simd, heights, at, -1, -1), near(simd, heights, at, 1, -1));
    let (sw, se) = (near(simd, heights, at, -1, 1), near(simd, heights, at, 1, 1));
    let straight_ahead = upright.select(down.select(south, north), right.select(east, west));
    let straight_behind = upright.select(down.select(north, south), right.select(west, east));
    let corner_ahead = down.select(right.select(se, sw), right.select(ne, nw));
    let corner_behind = down.select(right.select(nw, ne), right.select(sw, se));
    let slant = ax.at_most(ay) / ax.at_least(ay).at_least(1e-30);
    let ahead = straight_ahead + (corner_ahead - straight_ahead) * slant;
    let behind = straight_behind + (corner_behind - straight_behind) * slant;
    height.simd_gt(behind * TIE) & (height * TIE).simd_ge(ahead)
}

/// True where the Laplacian changes its sign towards a neighbour and the pixel is the nearer one to 0. Of
/// two that are equally near, the left or upper one is it.
#[inline(always)]
fn is_crossing<S: Simd>(simd: S, laplacians: &Around<'_>, at: usize) -> mask32x8<S> {
    let zero = f32x8::splat(simd, 0.0);
    let own = near(simd, laplacians, at, 0, 0);
    let (size, bright) = (own.abs(), own.simd_ge(zero));
    let mut found = mask32x8::splat(simd, false);
    for (dx, dy) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
        let other = near(simd, laplacians, at, dx, dy);
        let nearer =
            if dx + dy > 0 { size.simd_le(other.abs() * TIE) } else { (size * TIE).simd_lt(other.abs()) };
        found |= nearer & (bright ^ other.simd_ge(zero));
    }
    found
}
