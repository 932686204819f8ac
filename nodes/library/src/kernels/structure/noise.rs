//! White noise, uniform in 0..1: what line integral convolution makes a tensor field visible with
//! (§ 2.9). Grey and opaque.
//!
//! The value is a hash of the pixel's place in the full-size picture, so that tiles fit together and
//! proxies show the same grains. Cost: about 15 integer operations.

use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*, u32x8};
use isophote_engine::math::store4;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for noise {
        /// Pixels of the full-size picture per pixel.
        pub pixel_size: f32,
        /// Another number, another noise.
        pub seed: u32,
    }
}

crate::kernel!(noise {
    cpu: run,
    cost: |_| 15.0,
    tolerance: Tolerance { absolute: 0.0, relative: 0.0, outliers: 0.0, reason: "integers, and exact divisions" },
});

/// Adds the pass: noise for a picture rendered at `scale` of its full size.
pub fn white(plan: &mut PlanBuilder, scale: f32, seed: u32) -> ImageId {
    let params = Params { pixel_size: 1.0 / scale, seed };
    plan.pass_at(&KERNEL, &[], &params, &[Class::Colour], Support::Pixels(0), 0)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => rows(simd, &params, band));
}

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
    let place = |v: i32| ((v as f32 + 0.5) * params.pixel_size).floor() as u32;
    let one = f32x8::splat(simd, 1.0);
    for y in window.y0..window.y1 {
        let row = u32x8::splat(simd, mixed(place(y) ^ params.seed));
        for (i, pixels) in band.row_mut(0, y).chunks_mut(32).enumerate() {
            let columns = u32x8::from_fn(simd, |lane| place(window.x0 + (8 * i + lane) as i32));
            let h = mixed_lanes(row + columns);
            let value = (h >> 8).to_float::<f32x8<S>>() / 16_777_216.0;
            if pixels.len() == 32 {
                store4([value, value, value, one], pixels);
            } else {
                let mut block = [0.0; 32];
                store4([value, value, value, one], &mut block);
                pixels.copy_from_slice(&block[..pixels.len()]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
    use isophote_engine::{Image, Rect};

    fn noise(width: u32, height: u32, scale: f32, seed: u32) -> Image {
        let mut plan = PlanBuilder::new(width, height).unwrap();
        let image = white(&mut plan, scale, seed);
        plan.output("noise", image);
        let region = Rect::of_size(width, height);
        CpuExecutor::new()
            .run(&plan.finish().unwrap(), &[], region, &CallingThread, Control::default())
            .unwrap()
            .remove(0)
    }

    #[test]
    fn values_are_uniform_and_neighbours_independent() {
        let image = noise(257, 200, 1.0, 3);
        let value = |x: i32, y: i32| f64::from(image.pixel(x, y)[0]) - 0.5;
        let mean = |f: &dyn Fn(i32, i32) -> f64| {
            (0..199 * 256).map(|i| f(i % 256, i / 256)).sum::<f64>() / (199.0 * 256.0)
        };
        assert!(mean(&value).abs() < 0.005);
        assert!((mean(&|x, y| value(x, y).powi(2)) * 12.0 - 1.0).abs() < 0.02);
        for (dx, dy) in [(1, 0), (0, 1), (1, 1)] {
            let correlation = mean(&|x, y| value(x, y) * value(x + dx, y + dy)) * 12.0;
            assert!(correlation.abs() < 0.02, "{dx}, {dy}: {correlation}");
        }
        assert!(image != noise(257, 200, 1.0, 4));
    }

    #[test]
    fn a_proxy_shows_grains_of_the_full_picture() {
        let (full, half) = (noise(64, 64, 1.0, 0), noise(32, 32, 0.5, 0));
        for i in 0..32 {
            assert_eq!(half.pixel(i, 3), full.pixel(2 * i + 1, 7));
        }
    }
}
