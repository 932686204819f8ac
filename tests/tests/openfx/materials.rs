//! Paper and hatching of clips, which are tiled.

use super::reference::*;
use super::render::through;
use isophote::graph::GraphInput;
use isophote::{ColourSpace, Graph};
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::Described;
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::ffi::CString;

/// Size of the pictures.
const SIZE: [i32; 2] = [WIDTH, HEIGHT];

/// Columns and rows of a tile.
const TILE: [i32; 2] = [13, 7];

/// A tile with a dark corner, and the picture that it fills when it is laid from the lower left corner on.
fn tile(dark: f32) -> (Vec<u8>, Vec<u8>) {
    let pixel = |x: i32, y: i32| {
        let value = if x < 6 && y < 3 { dark } else { 1.0 };
        [value, value, 1.0, 1.0].map(f32::to_ne_bytes).concat()
    };
    let places = |width: i32, height: i32| (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
    let small = places(TILE[0], TILE[1]).flat_map(|(x, y)| pixel(x, y)).collect();
    let lowest = HEIGHT - TILE[1];
    let laid = |(x, y): (i32, i32)| pixel(x.rem_euclid(TILE[0]), (y - lowest).rem_euclid(TILE[1]));
    (small, places(WIDTH, HEIGHT).flat_map(laid).collect())
}

pub fn materials_of_any_size_are_tiled(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextGeneral);
    let names = instance.effect.clip_names();
    let source = source(layout, true);
    instance.connect("Source", source.clone());
    let color = source.packed();
    for (clip, input, dark) in [("Paper", GraphInput::Paper, 0.9), ("Hatching", GraphInput::Hatching, 0.0)] {
        if !names.iter().any(|name| name == clip) {
            continue;
        }
        plain(&instance);
        let graph = with_material(&effect, input);
        let (small, whole) = tile(dark);
        instance.connect(clip, Picture::packed_in(layout, TILE[0], TILE[1], &small));
        let got = instance.render(layout, SIZE).packed();
        let reference = Through::of(&graph, SIZE);
        let inputs = [("color", color.as_slice(), layout), (input.id(), &whole, layout)];
        let want = reference.c(&inputs, layout);
        assert!(got == want, "{} {clip}", effect.node.id);
        assert!(
            got != through(&graph, &source, layout, ColourSpace::Srgb),
            "{} minds no {clip}",
            effect.node.id
        );
        // Generators have no end: their pixels are asked for where the picture is, and are no tile.
        let name = CString::new(format!("{ROI_PREFIX}{clip}")).unwrap();
        for endless in [f64::from(i32::MAX), f64::INFINITY] {
            let of_generator = Layout { endless: Some(endless), ..layout };
            instance.connect(clip, Picture::packed_in(of_generator, WIDTH, HEIGHT, &whole));
            let all = [0.0, 0.0, f64::from(WIDTH), f64::from(HEIGHT)];
            let asked = instance.regions(all, 1.0).expect("a region").numbers(&name);
            assert_eq!(asked, all, "{} {clip}", effect.node.id);
            let got = instance.render(layout, SIZE).packed();
            assert!(got == want, "{} {clip} without an end", effect.node.id);
        }
        instance.disconnect(clip);
    }
    host.no_faults();
}

/// The graph of an effect that takes a material.
fn with_material(effect: &Expected, input: GraphInput) -> Graph {
    let mut graph = effect.graph(false);
    let first = graph.find("t").or_else(|_| graph.find("n")).unwrap();
    graph.connect_input(input, first, input.id()).unwrap();
    graph
}
