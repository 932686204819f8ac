//! Colours of spaces in which the library does not compute: the same as when somebody changes them before and after.

use super::film::{self, RANGE, connect_motion};
use super::reference::*;
use super::render::{SIZE, through};
use isophote::ColourSpace;
use isophote_abi::openfx::*;
use isophote_colour::{Conversion, Space};
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::ffi::CStr;

const FILTER: &CStr = kOfxImageEffectContextFilter;

/// Options beyond the first, by their places, which saved projects hold.
const OPTIONS: [(i32, Space); 9] = [
    (4, Space::P3),
    (5, Space::Rec2020),
    (6, Space::Aces),
    (7, Space::DisplayP3),
    (8, Space::EncodedRec709),
    (9, Space::EncodedRec2020),
    (10, Space::AdobeRgb),
    (11, Space::Pq),
    (12, Space::Hlg),
];

/// Floats of RGBA in another space.
fn changed(bytes: &[u8], from: Space, to: Space, is_premultiplied: bool) -> Vec<u8> {
    let layout = Layout::default();
    let mut numbers = values(bytes, &layout);
    if let Some(conversion) = Conversion::of_spaces(from, to, is_premultiplied) {
        for pixel in numbers.chunks_exact_mut(4) {
            conversion.apply(pixel);
        }
    }
    packed(&numbers, &layout)
}

fn picture(layout: Layout, bytes: &[u8]) -> Picture {
    Picture::packed_in(layout, WIDTH, HEIGHT, bytes)
}

pub fn other_spaces_are_changed_once(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    for id in ["gaussian", "cartoon"] {
        let effect = Expected { node: isophote::registry::find(id).unwrap() };
        let (described, graph) = (Described::new(&host, effect.plugin(binary)), effect.graph(false));
        for alpha in [None, Some(kOfxImageUnPreMultiplied)] {
            let layout = Layout { alpha, ..Layout::default() };
            let source = source(layout, false);
            for (option, space) in OPTIONS {
                let instance = described.instance(FILTER);
                plain(&instance);
                instance.set("working_space", option);
                instance.connect("Source", source.clone());
                let got = instance.render(layout, SIZE).packed();
                let light = changed(&source.packed(), space, Space::Linear, alpha.is_none());
                let result = through(&graph, &picture(layout, &light), layout, ColourSpace::Linear);
                let wanted = changed(&result, Space::Linear, space, alpha.is_none());
                assert!(got == wanted, "{id} {space:?} {alpha:?}");
                instance.set("mix", 0.0);
                assert!(instance.render(layout, SIZE).packed() == source.packed(), "{id} {space:?}");
            }
        }
    }
    host.no_faults();
}

pub fn the_same_picture_comes_of_every_space(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let described = Described::new(&host, binary.plugin("org.isophote.gaussian"));
    let light = source(layout, false).packed();
    let render = |option: i32, bytes: &[u8]| {
        let instance = described.instance(FILTER);
        instance.set("working_space", option);
        instance.connect("Source", picture(layout, bytes));
        instance.render(layout, SIZE).packed()
    };
    let wanted = render(0, &light);
    assert!(difference(&wanted, &light, &layout) > 0.05);
    for (option, space) in OPTIONS {
        let result = render(option, &changed(&light, Space::Linear, space, true));
        let worst = difference(&changed(&result, space, Space::Linear, true), &wanted, &layout);
        assert!(worst < 2e-3, "{space:?}: {worst}");
    }
    host.no_faults();
}

/// Frames around are changed as the one that is rendered, in parts as in the whole.
pub fn neighbours_and_tiles_have_the_colours_of_the_frame(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let described = Described::new(&host, binary.plugin("org.isophote.oil_paint"));
    let steadied = |option: i32, frame: &dyn Fn(i64) -> Vec<u8>| -> Instance<'_> {
        let instance = described.instance(kOfxImageEffectContextGeneral);
        plain(&instance);
        instance.set("working_space", option);
        instance.set("steadiness", 0.5);
        instance.set("window", 1);
        let [width, height] = film::SIZE;
        let frames = (RANGE[0]..=RANGE[1])
            .map(|number| Picture::packed_in(layout, width, height, &frame(number)))
            .collect();
        instance.connect_film("Source", RANGE[0] as i32, frames);
        connect_motion(&instance);
        instance
    };
    let shown = |number: i64| packed(&film::frame(number), &layout);
    let wide = steadied(7, &shown);
    let light = steadied(0, &|number| changed(&shown(number), Space::DisplayP3, Space::Linear, true));
    let got = film::render(&wide, 5);
    let wanted = film::render(&light, 5).packed();
    assert!(got.packed() == changed(&wanted, Space::Linear, Space::DisplayP3, true));
    let window = [17, 5, 40, 21];
    let (status, part) = wide.try_render(layout, film::SIZE, &Wanted { time: 5.0, ..Wanted::new(window) });
    assert_eq!(status, kOfxStatOK);
    assert!(part.crop(window).packed() == got.crop(window).packed());
    wide.set("steadiness", 0.0);
    assert!(film::render(&wide, 5).packed() != got.packed());
    host.no_faults();
}

/// Coverage and lines alone are no colours.
pub fn what_is_no_colour_is_not_changed(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let render = |id: &str, layout: Layout, option: i32| {
        let instance = Described::new(&host, binary.plugin(id)).instance(FILTER);
        plain(&instance);
        instance.set("working_space", option);
        instance.connect("Source", source(layout, true));
        instance.render(layout, SIZE).packed()
    };
    let coverage = Layout { components: kOfxImageComponentAlpha, ..Layout::default() };
    assert!(render("org.isophote.gaussian", coverage, 7) == render("org.isophote.gaussian", coverage, 1));
    let layout = Layout::default();
    let graph = Expected { node: isophote::registry::find("flow_dog").unwrap() }.graph(false);
    let light = changed(&source(layout, true).packed(), Space::Pq, Space::Linear, true);
    let wanted = through(&graph, &picture(layout, &light), layout, ColourSpace::Linear);
    assert!(render("org.isophote.flow_dog", layout, 11) == wanted);
    host.no_faults();
}
