//! Rendering: every effect, context, depth and set of components, against the C table.

use super::reference::*;
use isophote::ColourSpace;
use isophote::Value;
use isophote::graph::GraphInput;
use isophote::spec::Unit;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::ffi::CStr;
use std::sync::atomic::Ordering;

pub const SIZE: [i32; 2] = [WIDTH, HEIGHT];
const DEPTHS: [&CStr; 4] = [kOfxBitDepthFloat, kOfxBitDepthHalf, kOfxBitDepthShort, kOfxBitDepthByte];
const COMPONENTS: [&CStr; 3] = [kOfxImageComponentRGBA, kOfxImageComponentRGB, kOfxImageComponentAlpha];

/// Result of the C table for a picture.
pub fn through(graph: &isophote::Graph, source: &Picture, layout: Layout, space: ColourSpace) -> Vec<u8> {
    let through = Through {
        space,
        premultiplied: layout.alpha != Some(kOfxImageUnPreMultiplied),
        ..Through::of(graph, SIZE)
    };
    through.c(&[("color", &source.packed(), layout)], layout)
}

pub fn every_effect_equals_the_c_table_in_every_context_depth_and_component(
    binary: &Binary,
    effect: Expected,
) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, effect.plugin(binary));
    let graph = effect.graph(false);
    for components in COMPONENTS {
        for depth in DEPTHS {
            let layout = Layout { depth, components, ..Layout::default() };
            let source = source(layout, false);
            let wanted = through(&graph, &source, layout, ColourSpace::Srgb);
            for context in [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral] {
                let instance = described.instance(context);
                plain(&instance);
                instance.connect("Source", source.clone());
                let got = instance.render(layout, SIZE).packed();
                let worst = difference(&got, &wanted, &layout);
                let allowed = if depth == kOfxBitDepthFloat || depth == kOfxBitDepthHalf { 0.0 } else { 1.0 };
                assert!(
                    worst <= allowed,
                    "{} {depth:?} {components:?} {context:?}: {worst}",
                    effect.plugin(binary).identifier()
                );
            }
        }
    }
    host.no_faults();
}

pub fn spaces_and_relations_to_alpha_equal_the_c_table(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, effect.plugin(binary));
    let graph = effect.graph(false);
    let instance = described.instance(kOfxImageEffectContextFilter);
    for alpha in [None, Some(kOfxImagePreMultiplied), Some(kOfxImageUnPreMultiplied)] {
        for (index, space) in [ColourSpace::Linear, ColourSpace::Srgb, ColourSpace::Srgb, ColourSpace::AcesCg]
            .into_iter()
            .enumerate()
        {
            let layout = Layout { alpha, ..Layout::default() };
            let source = source(layout, false);
            plain(&instance);
            instance.set("working_space", index as i32);
            instance.connect("Source", source.clone());
            let got = instance.render(layout, SIZE).packed();
            let wanted = through(&graph, &source, layout, space);
            assert!(got == wanted, "{} {alpha:?} {space:?}", effect.plugin(binary).identifier());
        }
    }
    host.no_faults();
}

pub fn the_colour_space_that_a_host_names_counts(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let described = Described::new(&host, binary.plugin("org.isophote.gaussian"));
    let render = |space: i32, name: Option<&'static CStr>| {
        let instance = described.instance(kOfxImageEffectContextFilter);
        instance.set("working_space", space);
        instance.connect("Source", source(layout, true));
        if let Some(name) = name {
            instance.put("Source", kOfxImageClipPropColourspace, name);
        }
        instance.render(layout, SIZE).packed()
    };
    let [linear, srgb, _, aces] = [0, 1, 2, 3].map(|space| render(space, None));
    assert!(linear != srgb && linear != aces);
    assert!(render(0, Some(c"srgb_tx")) == srgb && render(1, Some(c"lin_rec709_srgb")) == linear);
    assert!(render(1, Some(c"ofx_scene_linear")) == linear && render(0, Some(c"ACEScg")) == aces);
    assert!(render(3, Some(c"ofx_scene_linear")) == aces && render(0, Some(c"arri_logc4")) == linear);
    assert!(render(2, Some(c"lin_rec709_srgb")) == srgb, "as is");
    let [p3, display_p3] = [4, 7].map(|space| render(space, None));
    assert!(p3 != linear && display_p3 != srgb && p3 != display_p3);
    assert!(render(0, Some(c"lin_p3d65")) == p3 && render(1, Some(c"displayp3_display")) == display_p3);
    assert!(render(4, Some(c"ofx_scene_linear")) == p3 && render(7, Some(c"ofx_display_sdr")) == display_p3);
    assert!(render(7, Some(c"ofx_scene_linear")) == linear && render(4, Some(c"srgb_tx")) == srgb);
    host.no_faults();
}

pub fn the_alpha_of_the_source_stays_unless_it_is_processed(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    instance.set("working_space", 1);
    let source = source(layout, false);
    instance.connect("Source", source.clone());
    let got = values(&instance.render(layout, SIZE).packed(), &layout);
    let before = values(&source.packed(), &layout);
    for (after, before) in got.chunks_exact(4).zip(before.chunks_exact(4)) {
        assert_eq!(after[3], before[3], "{}", effect.plugin(binary).identifier());
        assert!(after.iter().all(|v| v.is_finite()));
    }
    // An opaque image is one, whatever its alpha holds.
    let opaque = Layout { alpha: Some(kOfxImageOpaque), ..layout };
    instance.connect("Source", source_of_opaque(&source, opaque));
    let got = values(&instance.render(opaque, SIZE).packed(), &layout);
    assert!(got.chunks_exact(4).all(|p| (p[3] - 1.0).abs() < 1e-6), "{}", effect.plugin(binary).identifier());
    host.no_faults();
}

/// Of a glow without coverage around a little square with some, whether alpha is filtered or stays.
pub fn light_beyond_coverage_survives(binary: &Binary, effect: Expected) {
    // A view of the picture's tensor is opaque, whatever the picture shows.
    if effect.is_lines() || effect.node.id == "tensor_view" {
        return;
    }
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let [width, height] = SIZE;
    let pixels = (0..width * height).flat_map(|i| {
        let (x, y) = ((i % width - width / 2).abs(), (i / width - height / 2).abs());
        match x.max(y) {
            0..2 => [0.2_f32, 0.2, 0.2, 0.5],
            2..9 => [0.8, 0.1, 0.0, 0.0],
            _ => [0.0; 4],
        }
    });
    let source =
        Picture::packed_in(layout, width, height, &pixels.flat_map(f32::to_ne_bytes).collect::<Vec<u8>>());
    let red = |picture: &Picture| values(&picture.packed(), &layout).iter().step_by(4).sum::<f32>();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    instance.connect("Source", source.clone());
    for process_alpha in [0, 1] {
        instance.set("process_alpha", process_alpha);
        let kept = red(&instance.render(layout, SIZE)) / red(&source);
        assert!(kept > 0.7, "{}: {kept} of the light is left", effect.plugin(binary).identifier());
    }
    host.no_faults();
}

fn source_of_opaque(source: &Picture, layout: Layout) -> Picture {
    Picture::packed_in(layout, WIDTH, HEIGHT, &source.packed())
}

pub fn lines_are_shown_alone_or_over_the_source(binary: &Binary, effect: Expected) {
    if !effect.is_lines() {
        return;
    }
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    let source = source(layout, true);
    instance.connect("Source", source.clone());
    for over in [false, true] {
        instance.set("lines_output", i32::from(over));
        let got = instance.render(layout, SIZE).packed();
        assert!(got == through(&effect.graph(over), &source, layout, ColourSpace::Srgb));
    }
    host.no_faults();
}

pub fn guides_enter_in_the_general_context(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let depth_layout = Layout { components: kOfxImageComponentAlpha, ..layout };
    let Some(instance) = guided(&host, binary, effect) else { return };
    let step = |x: i32| if x < WIDTH / 2 { [0.0, 0.0, 1.0, 1.0] } else { [0.8, 0.0, 0.6, 1.0] };
    let normals: Vec<f32> = (0..WIDTH * HEIGHT).flat_map(|i| step(i % WIDTH)).collect();
    let depths: Vec<f32> =
        (0..WIDTH * HEIGHT).map(|i| if i / WIDTH < HEIGHT / 2 { 2.0 } else { 5.0 }).collect();
    let bytes = |values: &[f32]| values.iter().flat_map(|v| v.to_ne_bytes()).collect::<Vec<u8>>();
    let (normals, depths) = (bytes(&normals), bytes(&depths));
    let source = source(layout, true);
    instance.connect("Source", source.clone());
    instance.connect("Normal", Picture::packed_in(layout, WIDTH, HEIGHT, &normals));
    instance.connect("Depth", Picture::packed_in(depth_layout, WIDTH, HEIGHT, &depths));
    let got = instance.render(layout, SIZE).packed();
    let mut graph = effect.graph(false);
    for (id, value) in [("guide_weight", "1"), ("rim", "1"), ("rim_width", "0.9")] {
        if let Ok(node) = graph.find("n")
            && graph.value(node, id).is_ok()
        {
            graph.set_text(node, id, value).unwrap();
        }
    }
    if let Ok(tensor) = graph.find("t") {
        graph.set_text(tensor, "guide_weight", "1").unwrap();
    }
    let wanted = Through::of(&graph, SIZE).c(
        &[
            ("color", &source.packed(), layout),
            ("normal", &normals, layout),
            ("depth", &depths, depth_layout),
        ],
        layout,
    );
    assert!(got == wanted, "{}", effect.plugin(binary).identifier());
    let without = through(&graph, &source, layout, ColourSpace::Srgb);
    assert!(got != without, "{} does not mind its guides", effect.plugin(binary).identifier());
    host.no_faults();
}

/// A picture of floats of one colour.
fn everywhere(color: [f32; 4]) -> Vec<u8> {
    color.map(f32::to_ne_bytes).concat().repeat((WIDTH * HEIGHT) as usize)
}

/// Clips of colours of surfaces and their light: half of the picture's, and a third.
fn layers_of(color: &[u8], layout: &Layout) -> [(&'static str, Vec<u8>); 3] {
    [("Albedo", 0.9), ("Diffuse", 0.5), ("Specular", 0.3)].map(|(clip, share)| {
        let dimmed = values(color, layout).into_iter().map(|v| v * share);
        (clip, dimmed.flat_map(f32::to_ne_bytes).collect())
    })
}

pub fn object_numbers_and_painted_flow_enter_in_the_general_context(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextGeneral);
    let names = instance.effect.clip_names();
    plain(&instance);
    let mut graph = effect.graph(false);
    let first = graph.find("t").or_else(|_| graph.find("n")).unwrap();
    let source = source(layout, true);
    instance.connect("Source", source.clone());
    let color = source.packed();
    let mut inputs = vec![("color", color.as_slice(), layout)];
    // Numbers in bytes are numbers, and not shares of the largest.
    let numbers = Layout { components: kOfxImageComponentAlpha, depth: kOfxBitDepthByte, ..layout };
    let objects: Vec<u8> = (0..WIDTH * HEIGHT).map(|i| if i % WIDTH < WIDTH / 2 { 3 } else { 200 }).collect();
    if names.contains(&"ObjectId".to_owned()) {
        instance.connect("ObjectId", Picture::packed_in(numbers, WIDTH, HEIGHT, &objects));
        graph.connect_input(GraphInput::ObjectId, first, "object_id").unwrap();
        inputs.push(("object_id", &objects, numbers));
    }
    let (flow, map) = (everywhere([0.85, 0.85, 0.0, 1.0]), everywhere([0.9, 0.8, 0.2, 0.6]));
    let has = |clip: &str| names.iter().any(|name| name == clip);
    let painted = [("Flow", GraphInput::Flow, &flow), ("Control", GraphInput::Control, &map)];
    for (clip, input, pixels) in painted.into_iter().filter(|(clip, ..)| has(clip)) {
        instance.connect(clip, Picture::packed_in(layout, WIDTH, HEIGHT, pixels));
        graph.connect_input(input, first, input.id()).unwrap();
        inputs.push((input.id(), pixels, layout));
    }
    let layers = layers_of(&color, &layout);
    let has_layers = has("Albedo");
    for (name, layer) in layers.iter().filter(|_| has_layers) {
        let input = GraphInput::from_id(&name.to_ascii_lowercase()).unwrap();
        instance.connect(name, Picture::packed_in(layout, WIDTH, HEIGHT, layer));
        graph.connect_input(input, first, input.id()).unwrap();
        inputs.push((input.id(), layer, layout));
    }
    let got = instance.render(layout, SIZE).packed();
    let wanted = Through::of(&graph, SIZE).c(&inputs, layout);
    assert!(got == wanted, "{}", effect.plugin(binary).identifier());
    assert!(
        !(has_layers || has("Control") || has("Paper"))
            || got != through(&graph, &source, layout, ColourSpace::Srgb),
        "{} does not mind its clips",
        effect.node.id
    );
    let follows_flow = ["oil_paint", "painting", "coherent", "line_integral_convolution", "flow_bilateral"];
    if follows_flow.contains(&effect.node.id) {
        let without = through(&graph, &source, layout, ColourSpace::Srgb);
        assert!(got != without, "{} does not mind its flow map", effect.node.id);
    }
    host.no_faults();
}

pub fn a_mask_decides_where_the_effect_shows(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let mask_layout = Layout { components: kOfxImageComponentAlpha, ..layout };
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextGeneral);
    plain(&instance);
    let source = source(layout, true);
    instance.connect("Source", source.clone());
    let full = values(&instance.render(layout, SIZE).packed(), &layout);
    let amount = |x: i32| [0.0_f32, 1.0, 0.25][(x * 3 / WIDTH) as usize];
    let mask: Vec<u8> = (0..WIDTH * HEIGHT).flat_map(|i| amount(i % WIDTH).to_ne_bytes()).collect();
    instance.connect("Mask", Picture::packed_in(mask_layout, WIDTH, HEIGHT, &mask));
    let got = values(&instance.render(layout, SIZE).packed(), &layout);
    let before = values(&source.packed(), &layout);
    for (i, ((got, full), before)) in got.iter().zip(&full).zip(&before).enumerate() {
        let a = amount(i as i32 / 4 % WIDTH);
        let wanted = full * a + before * (1.0 - a);
        assert!(
            (got - wanted).abs() <= 1e-6 * wanted.abs().max(1.0),
            "{}",
            effect.plugin(binary).identifier()
        );
        assert!(a == 0.25 || *got == if a == 1.0 { *full } else { *before });
    }
    instance.set("mask_apply", 0);
    assert_eq!(values(&instance.render(layout, SIZE).packed(), &layout), full);
    host.no_faults();
}

pub fn identity_is_what_is_rendered(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    assert!(!instance.is_identity());
    let mix = if effect.is_lines() { "lines_mix" } else { "mix" };
    if !instance.has(mix) {
        return;
    }
    instance.set(mix, 0.0);
    if effect.is_lines() {
        assert!(!instance.is_identity(), "lines alone are no identity");
        instance.set("lines_output", 1);
    }
    assert!(instance.is_identity(), "{}", effect.plugin(binary).identifier());
    let source = source(layout, false);
    instance.connect("Source", source.clone());
    assert!(instance.render(layout, SIZE).packed() == source.packed());
    instance.set(mix, 1.0);
    let nodes = [effect.node, isophote::registry::find("composite_lines").unwrap()];
    let node = nodes[usize::from(effect.is_lines())];
    for param in node.params().filter(|p| p.neutral_at_zero && p.id != "mix") {
        let name = if effect.is_lines() { format!("lines_{}", param.id) } else { param.id.to_owned() };
        match param.default {
            Value::Int(_) => instance.set(&name, 0),
            _ => instance.set(&name, if param.unit == Unit::Pixels { 0.009 } else { 0.0 }),
        }
        assert!(instance.is_identity(), "{} {name}", effect.plugin(binary).identifier());
        assert!(instance.render(layout, SIZE).packed() == source.packed());
        // And what the filter itself makes of it is no other picture.
        let mut graph = effect.graph(effect.is_lines());
        let id = graph.find(if effect.is_lines() { "l" } else { "n" }).unwrap();
        let zero = if matches!(param.default, Value::Int(_)) { "0" } else { "0.0" };
        graph.set_text(id, param.id, zero).unwrap();
        let filtered = through(&graph, &source, layout, ColourSpace::Srgb);
        let worst = difference(&filtered, &source.packed(), &layout);
        assert!(worst < 2e-6, "{} {name}: {worst}", effect.plugin(binary).identifier());
        let Value::Float(_) = param.default else {
            instance.set(&name, 1);
            continue;
        };
        instance.set(&name, 1.0);
        assert!(!instance.is_identity());
    }
    host.no_faults();
}

pub fn a_missing_source_is_transparent_black_and_a_missing_output_a_failure(
    binary: &Binary,
    effect: Expected,
) {
    let host = Host::new(Behaviour::default());
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextGeneral);
    let layout = Layout::default();
    assert!(instance.render(layout, SIZE).packed().iter().all(|b| *b == 0));
    let alpha = Layout { components: kOfxImageComponentAlpha, depth: kOfxBitDepthByte, ..layout };
    assert!(instance.render(alpha, SIZE).packed().iter().all(|b| *b == 0));
    instance.connect("Source", source(layout, true));
    let wanted = Wanted::new([0, 0, WIDTH, HEIGHT]);
    assert_eq!(instance.render_connected(&wanted), kOfxStatFailed);
    assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
    host.no_faults();
}

pub fn unknown_depths_are_refused(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance =
        Described::new(&host, binary.plugin("org.isophote.gaussian")).instance(kOfxImageEffectContextFilter);
    let layout = Layout::default();
    let unknown = Layout { depth: kOfxBitDepthNone, ..layout };
    instance.connect("Source", source(unknown, true));
    let wanted = Wanted::new([0, 0, WIDTH, HEIGHT]);
    assert_eq!(instance.try_render(layout, SIZE, &wanted).0, kOfxStatErrImageFormat);
    instance.connect("Source", source(layout, true));
    assert_eq!(instance.try_render(unknown, SIZE, &wanted).0, kOfxStatErrImageFormat);
    assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
}

pub fn the_threads_of_the_host_give_the_same_pixels(binary: &Binary, effect: Expected) {
    let layout = Layout::default();
    let render = |processors, null_functions| {
        let host = Host::new(Behaviour { processors, null_functions, ..Behaviour::default() });
        let described = Described::new(&host, effect.plugin(binary));
        let instance = described.instance(kOfxImageEffectContextFilter);
        instance.connect("Source", source(layout, true));
        let got = instance.render(layout, SIZE).packed();
        host.no_faults();
        (got, host.inner.runs.load(Ordering::SeqCst))
    };
    let (alone, _) = render(0, false);
    let (together, runs) = render(3, false);
    assert!(together == alone);
    assert!(runs > 0, "the host's threads were not used");
    assert!(render(1, false).0 == alone && render(0, true).0 == alone);
}

pub fn a_host_that_returns_before_its_threads_gets_the_same_pixels(binary: &Binary) {
    let layout = Layout::default();
    let render = |processors, returns_early| {
        let host = Host::new(Behaviour { processors, returns_early, ..Behaviour::default() });
        let described = Described::new(&host, binary.plugin("org.isophote.cartoon"));
        let instance = described.instance(kOfxImageEffectContextFilter);
        instance.connect("Source", source(layout, true));
        let pictures: Vec<_> = (0..4).map(|_| instance.render(layout, SIZE).packed()).collect();
        let late = host.inner.wait();
        host.no_faults();
        (pictures, late)
    };
    let (alone, _) = render(0, false);
    let (got, late) = render(3, true);
    assert!(late > 0, "no thread was left running");
    assert!(got == alone);
}

pub fn twelve_renders_on_four_threads_are_the_same(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let described = Described::new(&host, effect.plugin(binary));
    let render = || {
        let instance = described.instance(kOfxImageEffectContextFilter);
        instance.connect("Source", source(layout, false));
        instance.render(layout, SIZE).packed()
    };
    let first = render();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..3 {
                    // As one host has it: everything anew for every frame, on every thread.
                    let again = Described::new(&host, effect.plugin(binary));
                    let instance = again.instance(kOfxImageEffectContextFilter);
                    instance.connect("Source", source(layout, false));
                    assert!(instance.render(layout, SIZE).packed() == first);
                }
            });
        }
    });
    assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
    host.no_faults();
}

pub fn a_host_that_wants_to_stop_is_heard(binary: &Binary, effect: Expected) {
    let layout = Layout::default();
    for after in [0, 3] {
        let host = Host::new(Behaviour { abort_after: Some(after), ..Behaviour::default() });
        let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
        instance.connect("Source", source(layout, true));
        let wanted = Wanted::new([0, 0, WIDTH, HEIGHT]);
        let (status, picture) = instance.try_render(layout, SIZE, &wanted);
        assert_eq!(status, kOfxStatOK);
        assert_eq!(picture.touched_outside([0; 4]), 0, "it went on");
        assert!(host.inner.abort_calls.load(Ordering::SeqCst) > after);
        assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
        host.no_faults();
    }
}
