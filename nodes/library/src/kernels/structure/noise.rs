//! White noise, uniform in 0..1: what line integral convolution makes a tensor field visible with
//! (§ 2.9). Grey and opaque.
//!
//! A grain is a pixel of the full-size picture, and its value a hash of its place there, so that tiles fit
//! together. A proxy's pixel is the mean of the grains that it covers: what the full picture made smaller
//! shows. Below an eighth of the size, grains are as wide as an eighth of a pixel.
//!
//! Cost: about 15 integer operations a grain.

pub use crate::kernels::shaders::noise::Params;
use crate::kernels::simd::pixels::write;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*, u32x8};
use isophote_engine::{Band, Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(noise {
    cpu: |simd, pass, params, band| rows(simd, &params, band),
    cost: |p| 15.0 * f64::from(p.count * p.count),
    tolerance: Tolerance::of_rounding(
        1e-6,
        0.0,
        "integers and exact divisions at full size; means of them on proxies"
    ),
});

/// Most grains along a side of a pixel.
const MOST: f32 = 8.0;

/// Adds the pass: noise for a picture rendered at `scale` of its full size, which stands at `origin`, pixels of that
/// size, in the canonical one.
pub fn pass(plan: &mut PlanBuilder, scale: f32, origin: [f32; 2], seed: u32) -> ImageId {
    pass_at(plan, scale, origin, seed, 0)
}

/// The same at a level of the pyramid; `scale` is the size of a picture at that level over the full size, and `origin` is
/// in pixels of that level.
pub fn pass_at(plan: &mut PlanBuilder, scale: f32, origin: [f32; 2], seed: u32, level: i8) -> ImageId {
    let grain = (1.0 / (scale * MOST)).max(1.0);
    let pixel_size = (1.0 / scale).min(MOST);
    // A whole number of grains fits; any other number touches one more at each end.
    let count = if pixel_size.fract() == 0.0 { pixel_size } else { pixel_size.ceil() + 1.0 } as i32;
    let params = Params { pixel_size, grain, count, seed, origin };
    plan.pass_at(&KERNEL, &[], &params, &[Class::Colour], Support::Pixels(0), level)
}

const LANES: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

const fn mixed(v: u32) -> u32 {
    let h = (v ^ (v >> 16)).wrapping_mul(0x7feb_352d);
    let h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}

#[inline(always)]
fn mixed_lanes<S: Simd>(v: u32x8<S>) -> u32x8<S> {
    let c = |n: u32| u32x8::splat(v.simd, n);
    let h = (v ^ (v >> 16)) * c(0x7feb_352d);
    let h = (h ^ (h >> 15)) * c(0x846c_a68b);
    h ^ (h >> 16)
}

#[inline(always)]
fn rows<S: Simd>(simd: S, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    for y in window.y0..window.y1 {
        let place = y as f32 + params.origin[1];
        let (low_y, high_y) = (place * params.pixel_size, (place + 1.0) * params.pixel_size);
        for (i, pixels) in band.row_mut(0, y).chunks_mut(32).enumerate() {
            let x = window.x0 + 8 * i as i32;
            let x = f32x8::from_slice(simd, &LANES) + x as f32 + params.origin[0];
            let (low_x, high_x) = (x * params.pixel_size, (x + 1.0) * params.pixel_size);
            let mut sum = zero;
            for j in 0..params.count {
                let y = low_y.floor() + j as f32;
                let weight_y = (high_y.min(y + 1.0) - low_y.max(y)).max(0.0);
                let row = u32x8::splat(simd, mixed((y * params.grain).floor() as i32 as u32 ^ params.seed));
                for i in 0..params.count {
                    let x = low_x.floor() + i as f32;
                    let weight_x = (high_x.at_most(x + 1.0) - low_x.at_least(x)).at_least(zero);
                    let column: i32x8<S> = (x * params.grain).floor().to_int();
                    let h = mixed_lanes(row + column.bitcast::<u32x8<S>>());
                    sum += (h >> 8).to_float::<f32x8<S>>() / 16_777_216.0 * (weight_x * weight_y);
                }
            }
            let value = sum / ((high_x - low_x) * (high_y - low_y));
            write([value, value, value, one], pixels);
        }
    }
}
