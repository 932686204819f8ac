//! Sectors of a disc whose weighting functions are sampled (§ 5.3, 5.4.2), for the generalized and the
//! anisotropic Kuwahara filters. Twin of `shaders/shared/sampled_sectors.wgsl`.

use isophote_engine::fearless_simd::{Simd, f32x4, prelude::*};
use std::f64::consts::{PI, SQRT_2};
use std::sync::OnceLock;

/// sigma_r in units of the radius: the disc ends at 2.5 sigma_r (5.20).
pub const SIGMA_R: f64 = 0.4;

/// Nodes on a side of the sampled weighting functions; odd, so that some lie on the axes.
pub const TABLE_SIDE: usize = 43;

/// Sampled weights below this are 0: the smoothing of the sectors has an end as well.
const NEGLIGIBLE: f64 = 1e-4;

/// Rows of a table: those of the lower half mirror them.
const TABLE_ROWS: usize = TABLE_SIDE / 2 + 1;

/// Weights of four sectors a quarter turn apart, starting with h_0, at nodes that span the half y >= 0 of
/// the disc's bounding square, row by row; the last texels are unused. It is what a uniform block can hold
/// on every device.
pub type Table = [[f32; 4]; 960];

const _: () = assert!(TABLE_SIDE * TABLE_ROWS <= 960, "the nodes fit the table");

/// The weighting functions (5.11) for 4 or 8 sectors, sampled. Those between the four are found at
/// positions turned by 45 degrees.
pub fn table(sectors: u32) -> &'static Table {
    static TABLES: [OnceLock<Table>; 2] = [const { OnceLock::new() }; 2];
    TABLES[usize::from(sectors > 4)].get_or_init(|| {
        let mut table = [[0.0; 4]; 960];
        let node = |i: usize| 2.0 * i as f64 / (TABLE_SIDE - 1) as f64;
        for (index, texel) in table[..TABLE_SIDE * TABLE_ROWS].iter_mut().enumerate() {
            let (x, y) = (node(index % TABLE_SIDE) - 1.0, node(index / TABLE_SIDE));
            // Sector k looks along k quarter turns: the point is turned back.
            for (value, (u, v)) in texel.iter_mut().zip([(x, y), (y, -x), (-x, -y), (-y, x)]) {
                let w = weight(u, v, PI / f64::from(sectors));
                *value = if w < NEGLIGIBLE { 0.0 } else { w as f32 };
            }
        }
        table
    })
}

/// h_0 = (chi_0 * G_sigma_s) G_sigma_r at a point of the unit disc, for sectors of `half` angle on each
/// side, not normalised: 1 where the sector is whole and the centre is near.
pub fn weight(x: f64, y: f64, half: f64) -> f64 {
    let sigma = SIGMA_R / 3.0;
    // Along x the convolution of the sector is an integral of the Gaussian; along y it is summed.
    let (steps, reach) = (96, 5.0);
    let mut sum = 0.0;
    let mut norm = 0.0;
    for i in 0..steps {
        let t = reach * (2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0);
        let g = (-0.5 * t * t).exp();
        let border = (y + sigma * t).abs() / half.tan();
        sum += g * 0.5 * (1.0 + erf((x - border) / (sigma * SQRT_2)));
        norm += g;
    }
    sum / norm * (-(x * x + y * y) / (2.0 * SIGMA_R * SIGMA_R)).exp()
}

/// The error function to 1.5e-7 (Abramowitz and Stegun 7.1.26).
fn erf(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let p = [1.061_405_429, -1.453_152_027, 1.421_413_741, -0.284_496_736, 0.254_829_592];
    let series = p.iter().fold(0.0, |sum, c| (sum + c) * t);
    (1.0 - series * (-x * x).exp()).copysign(x)
}

/// The four weights of a table at a point of the unit disc, interpolated.
#[inline(always)]
pub fn sample<S: Simd>(simd: S, table: &Table, x: f32, y: f32) -> f32x4<S> {
    const SCALE: f32 = 0.5 * (TABLE_SIDE - 1) as f32;
    const LAST: [f32; 2] = [(TABLE_SIDE - 2) as f32, (TABLE_ROWS - 2) as f32];
    let (u, v) = (((x + 1.0) * SCALE).max(0.0), y.abs() * SCALE);
    // Positive: the conversion cuts as floor does.
    let (i, j) = (u.min(LAST[0]) as u32, v.min(LAST[1]) as u32);
    let fx = f32x4::splat(simd, (u - i as f32).min(1.0));
    let fy = f32x4::splat(simd, (v - j as f32).min(1.0));
    let texels = &table[j as usize * TABLE_SIDE + i as usize..][..TABLE_SIDE + 2];
    let (a, b) = (f32x4::from_slice(simd, &texels[0]), f32x4::from_slice(simd, &texels[1]));
    let c = f32x4::from_slice(simd, &texels[TABLE_SIDE]);
    let d = f32x4::from_slice(simd, &texels[TABLE_SIDE + 1]);
    let top = (b - a).mul_add(fx, a);
    let bottom = (d - c).mul_add(fx, c);
    let weights = (bottom - top).mul_add(fy, top);
    if y < 0.0 {
        // The lower half mirrors the upper one: the second and the fourth sector change places.
        let [h0, h1, h2, h3] = weights.to_array();
        return f32x4::simd_from(simd, [h0, h3, h2, h1]);
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::{Level, dispatch};

    fn sampled(table: &Table, x: f32, y: f32) -> [f32; 4] {
        dispatch!(Level::baseline(), simd => sample(simd, table, x, y).to_array())
    }

    #[test]
    fn sampled_sectors_are_those_of_the_definition() {
        for (x, y) in [(0.0, 0.0), (0.52, 0.31), (-0.3, -0.64), (0.1, -0.97), (-0.88, 0.02)] {
            let got = sampled(table(8), x, y);
            let (x, y) = (f64::from(x), f64::from(y));
            let want = [(x, y), (y, -x), (-x, -y), (-y, x)].map(|(u, v)| weight(u, v, PI / 8.0));
            for (got, want) in got.into_iter().zip(want) {
                assert!((f64::from(got) - want).abs() < 0.004, "at {x}, {y}: {got} for {want}");
            }
        }
    }

    #[test]
    fn the_sampled_sectors_sum_to_the_gaussian() {
        for sectors in [4, 8] {
            let table = table(sectors);
            for (x, y) in [(0.0, 0.0), (0.31, -0.2), (0.7, 0.69), (-0.05, 0.93), (-0.4, 0.1)] {
                let h = std::f32::consts::FRAC_1_SQRT_2;
                let mut sum: f32 = sampled(table, x, y).iter().sum();
                if sectors == 8 {
                    sum += sampled(table, (x + y) * h, (y - x) * h).iter().sum::<f32>();
                }
                let gaussian = (-3.125 * (x * x + y * y)).exp();
                assert!((sum - gaussian).abs() < 0.006, "{sectors} at {x}, {y}: {sum} for {gaussian}");
            }
        }
    }
}
