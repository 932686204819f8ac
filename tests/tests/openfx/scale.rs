//! Proxies: every effect at half size against the full-size result made smaller.

use super::reference::*;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;

/// Side of the full picture.
pub const SIDE: i32 = 192;
/// Least agreement of a proxy, in decibels.
const LEAST: f64 = 40.0;
/// By lines alone, which stand and fall with what is around them, by strokes of a brush with borders that are lines, by
/// shocks, which decide for one side of an edge, and by areas of a palette, whose borders are as crisp as pixels.
const LEAST_OF_LINES: f64 = 32.0;
/// By strokes of a pen and hatches, whose edges are as crisp as pixels.
const LEAST_OF_MARKS: f64 = 26.0;
/// Of screens, whose borders are a pixel wide at every size, and mix as light does, not as the means of encoded values that
/// they are compared with.
const LEAST_OF_SCREENS: f64 = 21.0;

/// A photo-like picture: soft shading and forms with edges as wide as a lens makes them.
pub fn photo() -> Vec<f32> {
    let soft = |d: f32| 1.0 / (1.0 + (-d / 3.0).exp());
    let pixel = |x: i32, y: i32| {
        let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
        let sky = 0.55 + 0.25 * (y / SIDE as f32) + 0.02 * (x * 0.05).sin();
        let hill = soft(y - 110.0 - 25.0 * (x * 0.03).sin());
        let ball = soft(38.0 - ((x - 70.0).powi(2) + (y - 75.0).powi(2)).sqrt());
        let light = 0.35 + 0.3 * ((x - 70.0) * -0.01 + (y - 75.0) * -0.012 + 0.4).clamp(0.0, 1.0);
        let mut colour = [sky * 0.8, sky * 0.9, sky];
        let hills = [0.25, 0.35 + 0.04 * (x * 0.09 + y * 0.04).sin(), 0.2];
        for (c, h) in colour.iter_mut().zip(hills) {
            *c += (h - *c) * hill;
        }
        for (c, b) in colour.iter_mut().zip([light * 1.5, light * 0.8, light * 0.5]) {
            *c += (b - *c) * ball;
        }
        [colour[0], colour[1], colour[2], 1.0]
    };
    (0..SIDE).flat_map(|y| (0..SIDE).flat_map(move |x| pixel(x, y))).collect()
}

/// Means of two by two pixels.
fn halved(values: &[f32], side: usize) -> Vec<f32> {
    let at = |x: usize, y: usize, c: usize| values[(y * side + x) * 4 + c];
    let half = side / 2;
    let mean = |x: usize, y: usize, c: usize| {
        (at(2 * x, 2 * y, c)
            + at(2 * x + 1, 2 * y, c)
            + at(2 * x, 2 * y + 1, c)
            + at(2 * x + 1, 2 * y + 1, c))
            / 4.0
    };
    (0..half).flat_map(|y| (0..half).flat_map(move |x| (0..4).map(move |c| mean(x, y, c)))).collect()
}

pub fn half_size_looks_like_full_size_made_smaller(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let half_layout = Layout { scale: 0.5, claimed_scale: 0.5, ..layout };
    let full = photo();
    let half = halved(&full, SIDE as usize);
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    instance.connect("Source", Picture::packed_in(layout, SIDE, SIDE, &packed(&full, &layout)));
    let result = values(&instance.render(layout, [SIDE; 2]).packed(), &layout);
    let wanted = halved(&result, SIDE as usize);
    let side = SIDE / 2;
    instance.connect("Source", Picture::packed_in(half_layout, side, side, &packed(&half, &layout)));
    let at_half = Wanted { scale: 0.5, ..Wanted::new([0, 0, side, side]) };
    let (status, picture) = instance.try_render(half_layout, [side; 2], &at_half);
    assert_eq!(status, kOfxStatOK);
    let got = values(&picture.packed(), &layout);
    let square: f64 = got.iter().zip(&wanted).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let psnr = -10.0 * (square / got.len() as f64).log10();
    println!("{}: {psnr:.1} dB", effect.plugin(binary).identifier());
    let least = match effect.node.id {
        "halftone" => LEAST_OF_SCREENS,
        "ink" => LEAST_OF_MARKS,
        "blueprint" | "oil_paint" | "coherent" | "palette" => LEAST_OF_LINES,
        _ => LEAST,
    };
    assert!(psnr >= least, "{psnr:.1} dB");
    host.no_faults();
}
