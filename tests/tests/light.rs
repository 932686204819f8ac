//! Light beyond coverage: premultiplied colour where alpha is 0 or little, such as fire, glows and additive renders.
//! No node may lose it, and pictures without it must not notice.

use isophote::graph::GraphInput;
use isophote::kernels::shared::host_colour::has_light;
use isophote::request::Guides;
use isophote::spec::{ImageKind, NodeSpec};
use isophote::{ColourSpace, Graph, Request};
use isophote_engine::cpu::Control;
use isophote_engine::{Image, Rect};
use isophote_tests::cases;
use isophote_tests::compare::distance;
use isophote_tests::device::executor;
use isophote_tests::pictures::{self, Kind};
use isophote_tests::run;
use isophote_tests::sweep;
use isophote_tests::trials::Trials;

const SIDE: u32 = 64;

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in isophote::registry::nodes() {
        if spec.has_mix() && spec.inputs.iter().any(|p| p.kind == ImageKind::Color) {
            trials.add("light_survives", spec.id, || light_survives(spec));
            trials.add("light_is_even", spec.id, || even_light_stays_even(spec));
            trials.add("no_light", spec.id, || pictures_without_light_keep_their_bits(spec));
            trials.add("mask", spec.id, || the_mask_says_how_much_is_used(spec));
        }
    }
    trials.add("gaussian", "conserves", gaussian_conserves_light);
    trials.add("gaussian", "gpu", both_executors_agree);
}

/// A picture by the colour and alpha at every pixel.
fn picture(pixel: impl Fn(f32, f32) -> [f32; 4]) -> Image {
    let pixels = (0..SIDE * SIDE)
        .flat_map(|i| pixel((i % SIDE) as f32 - SIDE as f32 / 2.0, (i / SIDE) as f32 - SIDE as f32 / 2.0));
    Image::from_vec(SIDE, SIDE, 4, pixels.collect()).unwrap()
}

/// Red light without coverage around an opaque grey disc.
fn glow() -> Image {
    picture(|x, y| match x.hypot(y) {
        r if r < 4.0 => [0.4, 0.4, 0.4, 1.0],
        r if r < 18.0 => [0.8, 0.1, 0.0, 0.0],
        _ => [0.0; 4],
    })
}

fn request(space: ColourSpace, emission: bool) -> Request {
    Request { space, emission, ..Request::new(SIDE, SIDE) }
}

fn graph(spec: &'static NodeSpec) -> Graph {
    cases::setup(spec, false).graph
}

fn red(image: &Image) -> f64 {
    image.data().iter().step_by(4).map(|v| f64::from(*v)).sum()
}

fn light_survives(spec: &'static NodeSpec) {
    let glow = glow();
    let lost = red(&run::graph(&graph(spec), request(ColourSpace::Linear, false), &glow));
    let kept = red(&run::graph(&graph(spec), request(ColourSpace::Linear, true), &glow));
    let all = red(&glow);
    assert!(lost < 0.5 * all, "without its light a sum of {lost} is left of {all}");
    assert!(kept > 0.7 * all, "{kept} is left of {all}");
}

/// The same light everywhere, alone, and over what covers a little.
fn even_light_stays_even(spec: &'static NodeSpec) {
    let dark = run::graph(&graph(spec), request(ColourSpace::Srgb, true), &picture(|_, _| [0.0; 4]));
    let light = [0.6, 0.3, 0.125, 0.0];
    let lit = run::graph(&graph(spec), request(ColourSpace::Srgb, true), &picture(|_, _| light));
    for (lit, dark) in lit.data().chunks_exact(4).zip(dark.data().chunks_exact(4)) {
        for c in 0..4 {
            assert!((lit[c] - dark[c] - light[c]).abs() < 2e-3, "{lit:?} over {dark:?}");
        }
    }
}

fn pictures_without_light_keep_their_bits(spec: &'static NodeSpec) {
    for kind in [Kind::Noise, Kind::Steps] {
        let mut image = pictures::color(kind, 61, 47);
        // Straight colours of at most 1, multiplied.
        for pixel in image.data_mut().chunks_exact_mut(4) {
            let alpha = pixel[3].clamp(0.0, 1.0);
            pixel[..3].iter_mut().for_each(|v| *v = v.clamp(0.0, 1.0) * alpha);
            pixel[3] = alpha;
        }
        assert!(!has_light(image.data()), "{kind:?}");
        let result =
            |emission| run::graph(&graph(spec), Request { emission, ..Request::new(61, 47) }, &image);
        let (with, without) = (result(true), result(false));
        let same = with.data().iter().zip(without.data()).all(|(a, b)| a.to_bits() == b.to_bits() || a == b);
        assert!(same, "{kind:?}");
    }
}

fn gaussian_conserves_light() {
    let glow = glow();
    assert!(has_light(glow.data()));
    let single = run::single("gaussian", &[("sigma", "3")]);
    for space in [ColourSpace::Srgb, ColourSpace::Linear, ColourSpace::AcesCg] {
        let light = picture(|x, y| if x.hypot(y) < 14.0 { [0.8, 0.1, 0.0, 0.0] } else { [0.0; 4] });
        let out = run::graph(&single, request(space, true), &light);
        assert!((red(&out) / red(&light) - 1.0).abs() < 1e-3, "{space:?}: {} of {}", red(&out), red(&light));
        assert!(out.data().iter().skip(3).step_by(4).all(|a| *a == 0.0), "light covers nothing");
    }
}

fn both_executors_agree() -> Option<()> {
    let mut gpu = executor("light")?;
    let planned = run::planned(&run::single("coherent", &[]), request(ColourSpace::Linear, true));
    let inputs = [("color", glow())];
    let cpu = run::whole(planned.plan(), &inputs);
    let region = Rect::of_size(SIDE, SIDE);
    let inputs = [("color", &inputs[0].1)];
    let gpu = gpu.run_images(planned.plan(), &inputs, region, Control::default()).unwrap();
    let (worst, mean) = distance(&cpu, &gpu[0]);
    assert!(mean < 1e-3, "{worst} at worst, {mean} in the mean");
    Some(())
}

fn the_mask_says_how_much_is_used(spec: &'static NodeSpec) {
    let guides = Guides { mask: true, ..Guides::default() };
    let planned = run::planned(&graph(spec), Request { guides, ..Request::new(SIDE, SIDE) });
    let plain = run::planned(&graph(spec), Request::new(SIDE, SIDE));
    let color = sweep::input("color", Kind::Steps, [SIDE, SIDE]);
    let of = |mask: &dyn Fn(u32) -> f32| {
        let mask = Image::from_vec(SIDE, SIDE, 1, (0..SIDE * SIDE).map(mask).collect()).unwrap();
        run::whole(planned.plan(), &[("color", color.clone()), (GraphInput::Mask.id(), mask)])
    };
    let filtered = run::whole(plain.plan(), &[("color", color.clone())]);
    // Left half used, right half not, beyond the ends as at the ends.
    let halves = of(&|i| if i % SIDE < SIDE / 2 { 1.5 } else { f32::NAN });
    let untouched = of(&|_| 0.0);
    for y in 0..SIDE as i32 {
        for x in 0..SIDE as i32 {
            let want = if x < SIDE as i32 / 2 { &filtered } else { &untouched };
            assert_eq!(halves.pixel(x, y), want.pixel(x, y), "{x}, {y}");
        }
    }
    // A picture by itself is steady.
    assert!(untouched != filtered || spec.group == "time", "the node does something");
    // A picture that only went in and out again.
    let (worst, _) = distance(&untouched, &color);
    assert!(worst < 1e-3, "{worst}");
}
