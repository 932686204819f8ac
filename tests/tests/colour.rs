//! Colour, alpha and bad pixels, for every node: what enters in a space leaves in it, nothing that is
//! not finite spreads, flat pictures stay flat and opaque ones opaque, transparent pixels lend no colour.

use isophote::colour_space::{ColourSpace, Encoding};
use isophote::kernels::colour::{colour_export, colour_import, lightness};
use isophote::spec::{ImageKind, NodeSpec};
use isophote::{Graph, Request};
use isophote_engine::cpu::Control;
use isophote_engine::{Class, Image, PlanBuilder, Rect};
use isophote_tests::cases::{self, Setup};
use isophote_tests::compare::distance;
use isophote_tests::device;
use isophote_tests::pictures::{self, Kind, from_fn};
use isophote_tests::trials::Trials;
use isophote_tests::{plans, run};

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in isophote::registry::nodes() {
        trials.add("colour::finite", spec.id, || the_node_keeps_every_kind_of_picture_finite(spec));
        trials.add("colour::mixed_ends", spec.id, || shaders_bear_mixed_ends(spec));
        trials.add("colour::bad_pixel", spec.id, || a_bad_pixel_stays_where_it_is(spec));
        trials.add("colour::shape", spec.id, || fields_and_scalars_have_their_shape(spec));
        if spec.has_mix() {
            trials.add("colour::flat", spec.id, || flat_pictures_stay_flat_in_every_space(spec));
            trials.add("colour::fringe", spec.id, || a_cut_out_has_no_fringe(spec));
            trials.add("colour::opaque", spec.id, || what_is_opaque_stays_opaque(spec));
            trials.add("colour::mix", spec.id, || mix_leads_from_the_input_to_the_filter(spec));
        }
        if spec.has_mix() && spec.group == "smoothing" {
            trials.add("colour::encodings", spec.id, || the_encodings_agree_on_one_scene(spec));
        }
    }
    trials.add_plain("colour::every_space_is_left_as_it_was_entered", every_space_is_left_as_it_was_entered);
    trials.add_plain(
        "colour::lightness_comes_straight_from_the_hosts_colour",
        lightness_comes_straight_from_the_hosts_colour,
    );
}

fn default_graph(spec: &'static NodeSpec) -> Graph {
    cases::setup(spec, false).graph
}

/// Size of the pictures that all settings are tried on.
const SIZE: [u32; 2] = [31, 23];

/// Multiply-adds of a plan at that size above which one picture is enough.
const COSTLY: f64 = 1e9;

fn the_node_keeps_every_kind_of_picture_finite(spec: &'static NodeSpec) -> Vec<String> {
    let mut wrong = Vec::new();
    let settings = cases::settings(spec, 4).into_iter().chain(cases::mixed_ends(spec));
    for (turn, setting) in settings.enumerate() {
        let mut setup = cases::setup(spec, false);
        setting.apply(&mut setup.graph, setup.node);
        let [width, height] = SIZE;
        let request = Request::new(width, height);
        let kinds = if is_costly(&setup, request) { 1 } else { 3 };
        // Every kind meets every space, though not with every setting.
        let spaces = ColourSpace::ALL.into_iter().cycle().skip(turn);
        for (kind, space) in [Kind::Hdr, Kind::Broken, Kind::CutOut].into_iter().zip(spaces).take(kinds) {
            let picture = pictures::color(kind, width, height);
            let out = run::graph(&setup.graph, Request { space, ..request }, &picture);
            if out.data().iter().any(|v| !v.is_finite()) {
                wrong.push(format!("({}) {kind:?} {space:?} is not finite", setting.label));
            }
        }
    }
    wrong
}

/// True where a small picture takes long, as with all lengths at their greatest.
fn is_costly(setup: &Setup, request: Request) -> bool {
    plans::cost(run::planned(&setup.graph, request).plan()) > COSTLY
}

/// With some sliders at one end and the others at the other, shaders give numbers, and on the whole the picture that
/// the CPU gives: what is no number may leave a clamp as black. (Single pixels may differ: long lines through fields
/// that are hardly smoothed turn on the last bit.)
fn shaders_bear_mixed_ends(spec: &'static NodeSpec) -> Option<Vec<String>> {
    let mut gpu = device::executor(spec.id)?;
    let [width, height] = SIZE;
    let mut wrong = Vec::new();
    for (setting, space) in cases::mixed_ends(spec).into_iter().zip(ColourSpace::ALL.into_iter().cycle()) {
        let mut setup = cases::setup(spec, false);
        setting.apply(&mut setup.graph, setup.node);
        let picture = pictures::color(Kind::Steps, width, height);
        let planned = run::planned(&setup.graph, Request { space, ..Request::new(width, height) });
        let (plan, region) = (planned.plan(), Rect::of_size(width, height));
        let here = run::whole(plan, &[("color", picture.clone())]);
        let there = match gpu.run_images(plan, &[("color", &picture)], region, Control::default()) {
            Ok(mut images) => images.swap_remove(0),
            Err(e) => {
                wrong.push(format!("({}) {space:?}: {e}", setting.label));
                continue;
            }
        };
        let scale = here.data().iter().fold(1e-3f32, |m, v| m.max(v.abs()));
        let mean = |image: &Image| {
            image.data().iter().map(|v| f64::from(*v)).sum::<f64>() / image.data().len() as f64
        };
        let apart = (mean(&here) - mean(&there)).abs() / f64::from(scale);
        // Written so that what is no number is wrong.
        if !(apart < 0.02 && there.data().iter().all(|v| v.is_finite())) {
            wrong.push(format!("({}) {space:?}: means are {apart} of the range apart", setting.label));
        }
    }
    Some(wrong)
}

fn a_bad_pixel_stays_where_it_is(spec: &'static NodeSpec) {
    // One pixel of the picture is not a number: it counts as black, and nothing else changes.
    let graph = default_graph(spec);
    let good = pictures::color(Kind::Noise, 40, 30);
    let (mut bad, mut black) = (good.clone(), good);
    let at = (15 * 40 + 20) * 4;
    bad.data_mut()[at..at + 3].fill(f32::NAN);
    black.data_mut()[at..at + 3].fill(0.0);
    let request = Request::new(40, 30);
    assert_eq!(run::graph(&graph, request, &bad), run::graph(&graph, request, &black));
}

/// Filters that give a flat picture another colour than its own.
const RECOLOURING: &[(&str, &str)] = &[
    ("quantize_luminance", "lightness moves to the middle of its bin"),
    ("cartoon", "lightness is quantized"),
    ("composite_lines", "the detector before it takes what is darker than black for a line"),
    ("blueprint", "the picture is drawn in one colour on paper of another"),
    ("ink", "tones become ink or paper"),
    ("watercolor", "pigment and paper have tones of their own"),
    ("toon_shading", "steps of light have tones of their own"),
    ("palette", "colours become those of a palette"),
    ("halftone", "tones become ink or paper"),
    ("importance", "a picture becomes a map of what matters in it"),
];

/// Filters that give a flat picture a texture.
const TEXTURED: &[(&str, &str)] = &[
    ("blueprint", "paper and grid are part of the style"),
    ("ink", "paper is part of the style"),
    ("watercolor", "granulation is part of the style"),
    ("halftone", "screens are the style"),
    ("oil_paint", "brush strokes begin with noise"),
    ("importance", "the middle matters more"),
];

fn is_listed(spec: &NodeSpec, list: &[(&str, &str)]) -> bool {
    list.iter().any(|(id, _)| *id == spec.id)
}

fn flat_pictures_stay_flat_in_every_space(spec: &'static NodeSpec) -> Vec<String> {
    let mut wrong = Vec::new();
    if is_listed(spec, TEXTURED) {
        return wrong;
    }
    for space in ColourSpace::ALL {
        // Ten thousand is a highlight in linear light, and nothing that is gamma-encoded.
        let bright = if space == ColourSpace::Srgb { [1.3, 4.0, 0.9] } else { [812.0, 10_000.0, 3.5] };
        for color in [[0.18, 0.4, 0.05], [0.0; 3], [1.0; 3], bright, [-0.4, 0.2, -0.01]] {
            let flat = from_fn(33, 21, |_, _| [color[0], color[1], color[2], 1.0]);
            let request = Request { space, ..Request::new(33, 21) };
            let out = run::graph(&default_graph(spec), request, &flat);
            let scale = color.iter().fold(1e-2f32, |m, c| m.max(c.abs()));
            let first = from_fn(33, 21, |_, _| std::array::from_fn::<f32, 4, _>(|c| out.data()[c]));
            let (uneven, _) = distance(&out, &first);
            if uneven > 1e-4 * scale || out.data().iter().any(|v| !v.is_finite()) {
                wrong.push(format!("{space:?} {color:?}: uneven by {uneven:e}"));
            }
            let (moved, _) = distance(&out, &flat);
            if !is_listed(spec, RECOLOURING) && moved > 1e-4 * scale {
                wrong.push(format!("{space:?} {color:?}: moves by {moved:e}"));
            }
        }
    }
    wrong
}

fn every_space_is_left_as_it_was_entered() {
    // A Gaussian of no width is the way in and out alone.
    let graph = run::single("gaussian", &[("sigma", "0")]);
    for kind in [Kind::Noise, Kind::Hdr, Kind::CutOut] {
        let picture = pictures::color(kind, 67, 43);
        for space in ColourSpace::ALL {
            for premultiplied in [false, true] {
                let mut expected = picture.clone();
                // What is transparent has no colour when it leaves premultiplied.
                if !premultiplied && kind == Kind::CutOut {
                    continue;
                }
                for pixel in expected.data_mut().chunks_exact_mut(4).filter(|p| p[3] == 0.0) {
                    pixel[..3].fill(0.0);
                }
                let request = Request { space, premultiplied, ..Request::new(67, 43) };
                let out = run::graph(&graph, request, &picture);
                for (e, o) in expected.data().chunks_exact(4).zip(out.data().chunks_exact(4)) {
                    let scale = e.iter().fold(1e-2f32, |m, v| m.max(v.abs()));
                    for (e, o) in e.iter().zip(o) {
                        assert!((e - o).abs() < 3e-5 * scale, "{kind:?} {space:?}: {e} became {o}");
                    }
                }
            }
        }
    }
}

/// The picture in another space.
fn converted(image: &Image, from: ColourSpace, to: ColourSpace) -> Image {
    let mut plan = PlanBuilder::new(image.width(), image.height()).unwrap();
    let input = plan.input("color", 4, Class::Colour);
    let working =
        colour_import::pass(&mut plan, input, Encoding { space: from, premultiplied: true, emission: false });
    let out =
        colour_export::pass(&mut plan, working, Encoding { space: to, premultiplied: true, emission: false });
    plan.output("output", out);
    run::whole(&plan.finish().unwrap(), &[("color", image.clone())])
}

fn the_encodings_agree_on_one_scene(spec: &'static NodeSpec) {
    // The same light in two spaces, filtered, is the same light.
    let linear = pictures::color(Kind::Hdr, 48, 32);
    let aces = converted(&linear, ColourSpace::Linear, ColourSpace::AcesCg);
    let graph = default_graph(spec);
    let by = |space, image: &Image| run::graph(&graph, Request { space, ..Request::new(48, 32) }, image);
    let direct = by(ColourSpace::Linear, &linear);
    let around = converted(&by(ColourSpace::AcesCg, &aces), ColourSpace::AcesCg, ColourSpace::Linear);
    let mut far = 0;
    for (a, b) in direct.data().chunks_exact(4).zip(around.data().chunks_exact(4)) {
        let scale = a.iter().fold(0.1f32, |m, v| m.max(v.abs()));
        far += usize::from(a.iter().zip(b).any(|(a, b)| (a - b).abs() > 2e-2 * scale));
    }
    assert!(far < 48 * 32 / 50, "{far} pixels differ");
}

fn a_cut_out_has_no_fringe(spec: &'static NodeSpec) -> Vec<String> {
    // A white disc on nothing: whatever the transparent part holds must never show.
    let disc = |hidden: f32| {
        from_fn(48, 40, |x, y| {
            let inside = (x - 24) * (x - 24) + (y - 20) * (y - 20) < 140;
            if inside { [0.9, 0.9, 0.9, 1.0] } else { [hidden, 0.0, hidden, 0.0] }
        })
    };
    let mut wrong = Vec::new();
    let graph = default_graph(spec);
    let request = Request { premultiplied: false, ..Request::new(48, 40) };
    let (clean, dirty) = (run::graph(&graph, request, &disc(0.0)), run::graph(&graph, request, &disc(0.8)));
    let visible = |image: &Image| -> Vec<f32> {
        image.data().chunks_exact(4).flat_map(|p| [p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]]).collect()
    };
    let worst =
        visible(&clean).iter().zip(visible(&dirty)).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
    if worst > 2e-3 {
        wrong.push(format!("hidden colour shows by {worst}"));
    }
    if !is_listed(spec, TEXTURED) {
        // What is visible of one flat object has one colour, to its very border.
        let middle = clean.pixel(24, 20);
        let off = clean
            .data()
            .chunks_exact(4)
            .filter(|p| p[3] > 0.02)
            .map(|p| (0..3).map(|c| (p[c] - middle[c]).abs()).fold(0.0, f32::max))
            .fold(0.0f32, f32::max);
        if off > 1e-3 {
            wrong.push(format!("the border's colour is off by {off}"));
        }
    }
    wrong
}

fn what_is_opaque_stays_opaque(spec: &'static NodeSpec) -> Vec<String> {
    let mut wrong = Vec::new();
    for setting in cases::settings(spec, 4) {
        let mut setup = cases::setup(spec, false);
        setting.apply(&mut setup.graph, setup.node);
        if spec.param("show").is_some() {
            // Lines alone lie on nothing.
            setup.graph.set_text(setup.node, "show", "picture").expect("styles of lines show pictures");
        }
        let [width, height] = SIZE;
        let request = Request::new(width, height);
        if is_costly(&setup, request) {
            continue;
        }
        let picture = pictures::color(Kind::Noise, width, height);
        assert!(picture.data().chunks_exact(4).all(|p| p[3] == 1.0));
        let out = run::graph(&setup.graph, request, &picture);
        if let Some(p) = out.data().chunks_exact(4).find(|p| p[3] != 1.0) {
            wrong.push(format!("({}): {}", setting.label, p[3]));
        }
    }
    wrong
}

fn lightness_comes_straight_from_the_hosts_colour() {
    let all = Rect::of_size(48, 32);
    for kind in [Kind::Noise, Kind::Hdr, Kind::Broken, Kind::CutOut] {
        let picture = pictures::color(kind, 48, 32);
        for (space, premultiplied) in ColourSpace::ALL.into_iter().flat_map(|s| [(s, false), (s, true)]) {
            let mut plan = PlanBuilder::new(48, 32).unwrap();
            let host = plan.input("color", 4, Class::Colour);
            let working =
                colour_import::pass(&mut plan, host, Encoding { space, premultiplied, emission: false });
            let direct = lightness::pass(&mut plan, working);
            plan.output("output", direct);
            let plan = plan.finish().unwrap();
            assert!(plan.windows(all)[working.index()].is_empty(), "the working colour is computed too");
            let direct = run::whole(&plan, &[("color", picture.clone())]);

            let mut plan = PlanBuilder::new(48, 32).unwrap();
            let host = plan.input("color", 4, Class::Colour);
            let working =
                colour_import::pass(&mut plan, host, Encoding { space, premultiplied, emission: false });
            plan.output("output", working);
            let working = run::whole(&plan.finish().unwrap(), &[("color", picture.clone())]);
            let mut plan = PlanBuilder::new(48, 32).unwrap();
            let color = plan.input("color", 4, Class::Colour);
            let around = lightness::pass(&mut plan, color);
            plan.output("output", around);
            let around = run::whole(&plan.finish().unwrap(), &[("color", working)]);
            for (a, b) in direct.data().iter().zip(around.data()) {
                assert!((a - b).abs() < 1e-3 + 1e-5 * b.abs(), "{kind:?} {space:?}: {a} for {b}");
            }
        }
    }
}

fn mix_leads_from_the_input_to_the_filter(spec: &'static NodeSpec) {
    let picture = pictures::color(Kind::Steps, 40, 30);
    let at = |mix: f32| {
        let mut setup = cases::setup(spec, false);
        setup.graph.set(setup.node, "mix", isophote::Value::Float(mix)).unwrap();
        run::graph(&setup.graph, Request::new(40, 30), &picture)
    };
    let (none, half, all) = (at(0.0), at(0.5), at(1.0));
    assert!(distance(&none, &picture).0 < 1e-5);
    if all.data().chunks_exact(4).all(|p| p[3] == 1.0) {
        for ((n, h), a) in none.data().iter().zip(half.data()).zip(all.data()) {
            assert!((0.5 * (n + a) - h).abs() < 1e-5);
        }
    }
}

fn fields_and_scalars_have_their_shape(spec: &'static NodeSpec) {
    let picture = pictures::color(Kind::Noise, 33, 17);
    let out = run::graph(&default_graph(spec), Request::new(33, 17), &picture);
    assert_eq!((out.width(), out.height(), out.channels()), (33, 17, spec.output.kind.channels()));
    if spec.output.kind == ImageKind::Tensor {
        for t in out.data().chunks_exact(4) {
            let [e, f, g] = [t[0], t[1], t[2]];
            let positive = e >= 0.0 && g >= 0.0 && e * g - f * f >= -1e-4 * (e + g) * (e + g);
            assert!(positive && (0.0..=1.0001).contains(&t[3]), "{t:?}");
        }
    }
}
