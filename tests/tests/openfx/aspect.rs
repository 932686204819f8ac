//! Pixels that are not square, by their aspect or by a proxy that shrinks one side: what is shown is what
//! square pixels show.

use super::reference::*;
use super::scale::{SIDE, photo};
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::ffi::CStr;

/// Least agreement, in decibels.
const LEAST: f64 = 50.0;
/// By the lines of a structure, which are one pixel thin.
const LEAST_OF_LINES: f64 = 40.0;
/// By strokes and hatches, whose edges are as crisp as pixels.
const LEAST_OF_MARKS: f64 = 40.0;

/// A way to have half as many pixels along one axis.
#[derive(Clone, Copy, Debug)]
struct Squeeze {
    axis: usize,
    aspect: f64,
    scale: f64,
    squeeze: f64,
}

const SQUEEZES: [Squeeze; 3] = [
    Squeeze { axis: 0, aspect: 2.0, scale: 1.0, squeeze: 1.0 },
    Squeeze { axis: 0, aspect: 1.0, scale: 1.0, squeeze: 0.5 },
    Squeeze { axis: 1, aspect: 1.0, scale: 0.5, squeeze: 2.0 },
];

impl Squeeze {
    fn layout(&self, layout: Layout) -> Layout {
        let Self { aspect, scale, squeeze, .. } = *self;
        Layout { aspect, scale, squeeze, claimed_scale: scale, ..layout }
    }

    fn size(&self) -> [i32; 2] {
        if self.axis == 0 { [SIDE / 2, SIDE] } else { [SIDE, SIDE / 2] }
    }

    fn wanted(&self) -> Wanted {
        let [width, height] = self.size();
        Wanted { scale: self.scale, squeeze: self.squeeze, ..Wanted::new([0, 0, width, height]) }
    }

    /// Means of two pixels, of `channels` values, along the axis.
    fn of(&self, values: &[f32], channels: usize) -> Vec<f32> {
        let ([width, height], side) = (self.size().map(|n| n as usize), SIDE as usize);
        let mut means = Vec::with_capacity(width * height * channels);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let at = |n: usize| if self.axis == 0 { [2 * x + n, y] } else { [x, 2 * y + n] };
            let value = |[x, y]: [usize; 2], c: usize| values[(y * side + x) * channels + c];
            means.extend((0..channels).map(|c| 0.5 * (value(at(0), c) + value(at(1), c))));
        }
        means
    }

    fn render(&self, instance: &Instance<'_>, layout: Layout) -> Vec<f32> {
        let (status, picture) = instance.try_render(self.layout(layout), self.size(), &self.wanted());
        assert_eq!(status, kOfxStatOK);
        values(&picture.packed(), &layout)
    }
}

fn picture(layout: Layout, size: [i32; 2], values: &[f32]) -> Picture {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_ne_bytes()).collect();
    Picture::packed_in(layout, size[0], size[1], &bytes)
}

fn psnr(a: &[f32], b: &[f32]) -> f64 {
    assert_eq!(a.len(), b.len());
    let square: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    -10.0 * (square / a.len() as f64).log10()
}

pub fn oblong_pixels_show_what_square_ones_show(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let full = photo();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    instance.connect("Source", picture(layout, [SIDE; 2], &full));
    let result = values(&instance.render(layout, [SIDE; 2]).packed(), &layout);
    let mut least = f64::INFINITY;
    for squeeze in SQUEEZES {
        let source = picture(squeeze.layout(layout), squeeze.size(), &squeeze.of(&full, 4));
        instance.connect("Source", source);
        least = least.min(psnr(&squeeze.render(&instance, layout), &squeeze.of(&result, 4)));
    }
    println!("{}: {least:.1} dB", effect.plugin(binary).identifier());
    let wanted = match effect.node.id {
        "tensor_view" => LEAST_OF_LINES,
        "ink" => LEAST_OF_MARKS,
        _ => LEAST,
    };
    assert!(least >= wanted, "{least:.1} dB");
    host.no_faults();
}

pub fn guides_have_oblong_pixels_too(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let depth_layout = Layout { components: kOfxImageComponentAlpha, ..layout };
    let full = vec![0.5; (SIDE * SIDE * 4) as usize];
    let places = || (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x - SIDE / 2, y - SIDE / 2)));
    let inside = |x: i32, y: i32| (x / 2).pow(2) + (y / 2).pow(2) < (SIDE / 6).pow(2);
    let normals: Vec<f32> = places()
        .flat_map(|(x, y)| if inside(x, y) { [0.6, 0.0, 0.8, 1.0] } else { [0.0, 0.0, 1.0, 1.0] })
        .collect();
    let depths: Vec<f32> = places().map(|(x, y)| if inside(x, y) { 2.0 } else { 1e20 }).collect();
    let Some(instance) = guided(&host, binary, effect) else { return };
    let connect = |layout: Layout, depth_layout: Layout, size, [color, normal, depth]: [&[f32]; 3]| {
        instance.connect("Source", picture(layout, size, color));
        instance.connect("Normal", picture(layout, size, normal));
        instance.connect("Depth", picture(depth_layout, size, depth));
    };
    connect(layout, depth_layout, [SIDE; 2], [&full, &normals, &depths]);
    let result = values(&instance.render(layout, [SIDE; 2]).packed(), &layout);
    for squeeze in SQUEEZES {
        let given = [squeeze.of(&full, 4), squeeze.of(&normals, 4), squeeze.of(&depths, 1)];
        let layouts = [layout, depth_layout].map(|layout| squeeze.layout(layout));
        connect(layouts[0], layouts[1], squeeze.size(), given.each_ref().map(Vec::as_slice));
        let near = psnr(&squeeze.render(&instance, layout), &squeeze.of(&result, 4));
        println!("{} {squeeze:?}: {near:.1} dB", effect.plugin(binary).identifier());
        assert!(near > 25.0, "{} {squeeze:?}: {near:.1} dB", effect.plugin(binary).identifier());
    }
    host.no_faults();
}

/// The picture of the tests, half transparent, with alpha as `state` says.
fn cut_out(state: Option<&'static CStr>) -> (Layout, Vec<f32>) {
    let mut pixels = scene(WIDTH, HEIGHT, false);
    if state == Some(kOfxImageUnPreMultiplied) {
        for pixel in pixels.chunks_exact_mut(4).filter(|pixel| pixel[3] > 0.0) {
            let alpha = pixel[3];
            pixel[..3].iter_mut().for_each(|v| *v /= alpha);
        }
    }
    (Layout { alpha: state, aspect: 1.0667, ..Layout::default() }, pixels)
}

pub fn alpha_and_masks_are_those_of_the_hosts_pixels(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextGeneral);
    instance.set("working_space", 1);
    let mut results = Vec::new();
    for state in [Some(kOfxImagePreMultiplied), Some(kOfxImageUnPreMultiplied)] {
        let (layout, pixels) = cut_out(state);
        instance.connect("Source", picture(layout, [WIDTH, HEIGHT], &pixels));
        let got = values(&instance.render(layout, [WIDTH, HEIGHT]).packed(), &layout);
        for (after, before) in got.chunks_exact(4).zip(pixels.chunks_exact(4)) {
            assert_eq!(after[3], before[3], "{}", effect.plugin(binary).identifier());
            assert!(after.iter().all(|v| v.is_finite()), "{}", effect.plugin(binary).identifier());
        }
        results.push(got);
    }
    let over_black = results[1].chunks_exact(4).map(|p| [p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]]);
    let both = results[0].chunks_exact(4).zip(over_black);
    let worst = both.flat_map(|(a, b)| [0, 1, 2].map(|c| (a[c] - b[c]).abs())).fold(0.0, f32::max);
    assert!(worst < 2e-3, "{}: {worst} between the relations to alpha", effect.plugin(binary).identifier());
    let (layout, pixels) = cut_out(Some(kOfxImagePreMultiplied));
    let mask_layout = Layout { components: kOfxImageComponentAlpha, ..layout };
    let amounts: Vec<f32> = (0..WIDTH * HEIGHT).map(|i| (i % 2) as f32).collect();
    instance.connect("Source", picture(layout, [WIDTH, HEIGHT], &pixels));
    instance.connect("Mask", picture(mask_layout, [WIDTH, HEIGHT], &amounts));
    let got = values(&instance.render(layout, [WIDTH, HEIGHT]).packed(), &layout);
    for (i, value) in got.iter().enumerate() {
        let wanted = if amounts[i / 4] == 1.0 { results[0][i] } else { pixels[i] };
        assert_eq!(*value, wanted, "{}", effect.plugin(binary).identifier());
    }
    host.no_faults();
}
