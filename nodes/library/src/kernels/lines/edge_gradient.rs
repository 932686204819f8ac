//! First and second derivatives of the lightness of a smoothed Lab image (§ 4.1, 4.2.1): gx, gy, the
//! gradient's magnitude as the height of the step that would have it, and the Laplacian.
//!
//! A magnitude in L per pixel says little by itself, since smoothing lowers it: after a standard deviation
//! of 1.4 pixels the step from black to white has 25. Divided by what a step of height 1 has after the same
//! smoothing, thresholds mean the same at every scale.
//! Cost: 24 multiply-adds and a square root per pixel.

pub use crate::kernels::shaders::edge_gradient::Params;
use crate::kernels::simd::line_buffer::{Row, STRIP, for_rows};
use crate::kernels::simd::pixels::{BLOCK, eight, write};
use crate::kernels::simd::window_sum::{gaussian_radius, gaussian_table};
use crate::kernels::smoothing::gaussian_blur;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(edge_gradient {
    cpu: |simd, pass, params, band| derivatives(simd, pass, &params, band),
    cost: |_| 40.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-3,
        outliers: 2e-3,
        reason: "differences of neighbours magnify the last bits of L, up to 5e-5 and more in HDR",
    },
});

/// The gradient of the L of a Lab image after smoothing by `sigma` pixels; `sobel` by the Sobel operator
/// (2.23), else by the 3x3 operator optimized for rotation invariance (2.26).
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, sigma: f32, sobel: bool) -> ImageId {
    let smooth = gaussian_blur::pass_colour(plan, lab, sigma);
    let table = gaussian_table(sigma, gaussian_radius(sigma, 3.0));
    let [centre, side] = if sobel { [0.5, 0.25] } else { [162.32 / 256.0, 46.84 / 256.0] };
    // On both sides of a step between two pixels, the central difference is half the two middle weights.
    let scale = 2.0 / (table[0][0] + table[0][1]);
    plan.pass(&KERNEL, &[smooth], &Params { centre, side, scale }, Class::Field, Support::Pixels(1))
}

#[inline(always)]
fn derivatives<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    for_rows::<S, 4>(
        simd,
        &pass.inputs[0],
        band,
        [STRIP, 1],
        weighted,
        #[inline(always)]
        |Row { buffer, y, .. }, target| {
            let light = [buffer.row(y - 1, 0), buffer.row(y, 0), buffer.row(y + 1, 0)];
            let cover = [buffer.row(y - 1, 3), buffer.row(y, 3), buffer.row(y + 1, 3)];
            for (i, pixels) in target.chunks_mut(4 * BLOCK).enumerate() {
                let at = BLOCK * i;
                let zero = f32x8::splat(simd, 0.0);
                let (alpha, own) = (eight(simd, cover[1], at + 1), eight(simd, light[1], at + 1));
                let own = alpha.simd_gt(0.0).select(own / alpha.at_least(1e-30), zero);
                // How far the neighbours are above the pixel, as far as they are covered.
                let mut rise = [[zero; 3]; 3];
                for dy in 0..3 {
                    for dx in 0..3 {
                        rise[dy][dx] =
                            eight(simd, light[dy], at + dx) - own * eight(simd, cover[dy], at + dx);
                    }
                }
                let [[nw, n, ne], [w, _, e], [sw, s, se]] = rise;
                let gx = ((e - w) * params.centre + ((ne - nw) + (se - sw)) * params.side) * 0.5;
                let gy = ((s - n) * params.centre + ((sw - nw) + (se - ne)) * params.side) * 0.5;
                let height = (gx * gx + gy * gy).sqrt() * params.scale * alpha;
                let laplacian = ((n + s) + (e + w)) * 0.666_666_7 + ((nw + ne) + (sw + se)) * 0.166_666_67;
                write([gx, gy, height, laplacian], pixels);
            }
        },
    );
}

/// Lightness times coverage in place of lightness.
#[inline(always)]
fn weighted<S: Simd>([l, a, b, alpha]: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    [l * alpha, a, b, alpha]
}
