//! Clips that effects can do without, and how masks are read.

use super::reference::*;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::sync::atomic::Ordering;

const SIZE: [i32; 2] = [WIDTH, HEIGHT];

pub fn an_output_that_nobody_takes_is_rendered(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let described = Described::new(&host, binary.plugin("org.isophote.gaussian"));
    let instance = described.instance(kOfxImageEffectContextFilter);
    instance.connect("Source", source(layout, true));
    let wanted = instance.render(layout, SIZE).packed();
    // As previews of nodes without anything behind them.
    instance.connect("Output", Picture::new(layout, SIZE[0], SIZE[1]));
    instance.put("Output", kOfxImageClipPropConnected, 0);
    assert_eq!(instance.render_connected(&Wanted::new([0, 0, WIDTH, HEIGHT])), kOfxStatOK);
    assert!(instance.take_output().packed() == wanted);
    host.no_faults();
}

pub fn guides_and_masks_of_unknown_formats_count_as_none(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextGeneral);
    plain(&instance);
    instance.connect("Source", source(layout, true));
    let wanted = instance.render(layout, SIZE).packed();
    let clips = instance.effect.clip_names();
    for name in clips.iter().filter(|name| !["Source", "Output"].contains(&name.as_str())) {
        for unknown in [
            Layout { depth: kOfxBitDepthNone, ..layout },
            Layout { components: kOfxImageComponentNone, ..layout },
        ] {
            instance.connect(name, source(unknown, true));
            assert!(instance.render(layout, SIZE).packed() == wanted, "{name} {unknown:?}");
        }
        instance.disconnect(name);
    }
    assert!(host.inner.messages.lock().unwrap().is_empty());
    assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
    host.no_faults();
}

pub fn pixels_that_cannot_be_read_are_told_of(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let described = Described::new(&host, binary.plugin("org.isophote.gaussian"));
    let instance = described.instance(kOfxImageEffectContextFilter);
    instance.connect("Source", source(Layout { depth: kOfxBitDepthNone, ..layout }, true));
    let wanted = Wanted::new([0, 0, WIDTH, HEIGHT]);
    assert_eq!(instance.try_render(layout, SIZE, &wanted).0, kOfxStatErrImageFormat);
    let said = host.inner.messages.lock().unwrap().join("\n");
    assert!(said.contains("Give it RGBA, RGB or Alpha"), "{said}");
    host.no_faults();
}

/// An effect on a picture, with clips beside it.
fn blurring<'h>(host: &'h Host, binary: &Binary, source: &Picture) -> Instance<'h> {
    let described = Described::new(host, binary.plugin("org.isophote.gaussian"));
    let instance = described.instance(kOfxImageEffectContextGeneral);
    plain(&instance);
    instance.connect("Source", source.clone());
    instance
}

pub fn a_mask_may_be_any_part_of_its_picture(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let source = source(layout, true);
    let instance = blurring(&host, binary, &source);
    let full = values(&instance.render(layout, SIZE).packed(), &layout);
    let before = values(&source.packed(), &layout);
    let pixel = [0.8_f32, 0.4, 0.1, 0.6];
    let luminance = 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
    let rgba = pixel.repeat((WIDTH * HEIGHT) as usize);
    let render = |components, from: i32, inverted: i32| {
        let mask = Layout { components, ..layout };
        instance.connect("Mask", Picture::packed_in(mask, WIDTH, HEIGHT, &packed(&rgba, &mask)));
        instance.set("mask_from", from);
        instance.set("mask_invert", inverted);
        values(&instance.render(layout, SIZE).packed(), &layout)
    };
    for (from, amount) in [pixel[3], luminance, pixel[0], pixel[1], pixel[2]].into_iter().enumerate() {
        for inverted in [0, 1] {
            let share = if inverted == 1 { 1.0 - amount } else { amount };
            let got = render(kOfxImageComponentRGBA, from as i32, inverted);
            for ((got, full), before) in got.iter().zip(&full).zip(&before) {
                let wanted = full * share + before * (1.0 - share);
                assert!((got - wanted).abs() < 1e-5, "{from} {inverted}: {got} for {wanted}");
            }
        }
    }
    // Without alpha the first channel stands for it.
    let rgb = render(kOfxImageComponentRGB, 0, 0);
    assert!(rgb == render(kOfxImageComponentRGBA, 2, 0));
    host.no_faults();
}

pub fn an_inverted_mask_shows_the_effect_beside_its_picture(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let source = source(layout, true);
    let instance = blurring(&host, binary, &source);
    let full = instance.render(layout, SIZE);
    let mask = Layout { components: kOfxImageComponentAlpha, ..layout };
    let half = 1.0_f32.to_ne_bytes().repeat((WIDTH / 2 * HEIGHT) as usize);
    instance.connect("Mask", Picture::packed_in(mask, WIDTH / 2, HEIGHT, &half));
    instance.set("mask_invert", 1);
    let got = instance.render(layout, SIZE);
    let (left, right) = ([0, 0, WIDTH / 2, HEIGHT], [WIDTH / 2, 0, WIDTH, HEIGHT]);
    assert!(got.crop(left).packed() == source.crop(left).packed());
    assert!(got.crop(right).packed() == full.crop(right).packed());
    host.no_faults();
}
