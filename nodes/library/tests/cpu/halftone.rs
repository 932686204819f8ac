//! `halftone` on the CPU executor: the light of what it prints, seen from afar.

use super::light::{channel, encoded, farthest, mean, window};
use isophote::{Graph, Planned, Request};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Image, Rect};

const SHAPES: [&str; 4] = ["dots", "lines", "rings", "squares"];
/// Black ink on white paper without a texture, and nothing smoothed; rings around a point outside the picture.
const PLAIN: [(&str, &str); 7] = [
    ("inks", "one"),
    ("ink_color", "#000000"),
    ("paper_color", "#ffffff"),
    ("paper_texture", "0"),
    ("n_a", "0"),
    ("center_x", "-210"),
    ("center_y", "-130"),
];

/// A square print of a picture of linear light, with the settings of [`PLAIN`] and others.
fn print(side: u32, settings: &[(&str, &str)], picture: impl Fn(u32, u32) -> [f64; 3]) -> Image {
    let mut graph = Graph::single("halftone").unwrap();
    let node = graph.node(0).unwrap();
    for (param, value) in PLAIN.iter().chain(settings) {
        graph.set_text(node, param, value).unwrap();
    }
    let pixels = (0..side * side).flat_map(|i| {
        let [r, g, b] = picture(i % side, i / side).map(|v| encoded(v) as f32);
        [r, g, b, 1.0]
    });
    let color = Image::from_vec(side, side, 4, pixels.collect()).unwrap();
    let planned = Planned::new(&graph, Request::new(side, side)).unwrap();
    let region = Rect::of_size(side, side);
    CpuExecutor::new()
        .run(planned.plan(), &[("color", &color)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

#[test]
fn the_light_of_flat_fields_is_that_of_the_picture() {
    const SIDE: usize = 192;
    let window = window(SIDE);
    for shape in SHAPES {
        for cell in ["3", "3.7", "8", "21.5", "64"] {
            for tone in [0.0, 0.02, 0.1, 0.22, 0.5, 0.78, 0.95, 1.0] {
                let out = print(SIDE as u32, &[("shape", shape), ("cell", cell)], |_, _| [tone; 3]);
                let found = mean(&channel(&out, 1), SIDE, &window, &window);
                let off = 255.0 * (encoded(found) - encoded(tone)).abs();
                assert!(off < 1.5, "{shape} of {cell}: {found:.4} for {tone}, {off:.2}/255 off");
            }
        }
    }
}

#[test]
fn screens_do_not_beat_with_pixels() {
    const SIDE: usize = 100;
    for shape in SHAPES {
        for (cell, angle) in [(3.0, -45.0), (3.0, 0.0), (3.3, 15.0), (4.0, -45.0), (4.1, 3.0), (5.3, 30.3)] {
            let [size, turned] = [cell, angle].map(|v: f64| v.to_string());
            let settings = [("shape", shape), ("cell", &*size), ("angle", &*turned)];
            let mut tones: Vec<(f64, f64)> =
                [0.05, 0.35, 0.5, 0.83].iter().map(|tone| (*tone, 0.0)).collect();
            tones.push((0.1, 0.8));
            for (tone, rise) in tones {
                let ramp = |x: f64| tone + rise * x / SIDE as f64;
                let out = print(SIDE as u32, &settings, |x, _| [ramp(f64::from(x) + 0.5); 3]);
                let most = farthest(&channel(&out, 1), SIDE, cell, ramp) * 255.0;
                assert!(
                    most < 2.0,
                    "{shape} of {cell} at {angle}: {most:.2}/255 from {tone} rising by {rise}"
                );
            }
        }
    }
}

/// Strength of waves of `values` that run along an angle, `cell` pixels long.
fn waves(values: &[f64], side: usize, cell: f64, degrees: f64) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let (mut re, mut im) = (0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let (x, y) = ((i % side) as f64, (i / side) as f64);
        let phase = std::f64::consts::TAU * (x * cos - y * sin) / cell;
        re += (value - mean) * phase.cos();
        im += (value - mean) * phase.sin();
    }
    re.hypot(im) / values.len() as f64
}

#[test]
fn plates_lie_at_the_angles_of_printers_and_turn_together() {
    const SIDE: usize = 160;
    // Pale tints, each of which one plate prints: magenta, cyan, yellow, and grey for black.
    let tints = [([1.0, 0.6, 0.85], 1, 75.0), ([0.6, 0.9, 1.0], 0, 15.0), ([1.0, 0.97, 0.5], 2, 0.0)];
    for turned in [0.0, 11.0] {
        let angle = turned.to_string();
        let settings = [("inks", "cmyk"), ("cell", "8"), ("angle", &*angle), ("grey_replacement", "1")];
        for (tint, seen, own) in tints.into_iter().chain([([0.6; 3], 1, 45.0)]) {
            let out = channel(&print(SIDE as u32, &settings, |_, _| tint), seen);
            let strength = |degrees: f64| waves(&out, SIDE, 8.0, degrees + turned);
            let expected = strength(own);
            assert!(expected > 0.05, "{tint:?}: {expected:.3} at {own}");
            for other in [0.0, 15.0, 45.0, 75.0].into_iter().filter(|other| *other != own) {
                let found = strength(other);
                assert!(found < 0.2 * expected, "{tint:?}: {found:.3} at {other}, {expected:.3} at {own}");
            }
        }
    }
}

#[test]
fn misregistration_moves_plates_by_as_many_pixels() {
    const SIDE: u32 = 96;
    const FAR: f64 = 6.0;
    let disc = |tint: [f64; 3]| {
        move |x: u32, y: u32| {
            let inside = (f64::from(x) - 47.5).hypot(f64::from(y) - 47.5) < 24.0;
            if inside { tint } else { [1.0; 3] }
        }
    };
    // Centre of the ink that a channel shows.
    let centre = |far: &str, tint: [f64; 3], seen: usize| {
        let settings = [("inks", "cmyk"), ("cell", "3"), ("misregistration", far), ("grey_replacement", "1")];
        let values = channel(&print(SIDE, &settings, disc(tint)), seen);
        let (mut all, mut sum) = (0.0, [0.0; 2]);
        for (i, value) in values.iter().enumerate() {
            let ink = 1.0 - value;
            all += ink;
            sum = [sum[0] + ink * f64::from(i as u32 % SIDE), sum[1] + ink * f64::from(i as u32 / SIDE)];
        }
        sum.map(|v| v / all)
    };
    let moves = |tint, seen| {
        let ([x, y], [u, v]) = (centre("0", tint, seen), centre(&FAR.to_string(), tint, seen));
        [u - x, v - y]
    };
    let found = [moves([1.0, 0.5, 0.8], 1), moves([0.5, 0.88, 1.0], 0), moves([1.0, 0.97, 0.4], 2)];
    for [x, y] in found {
        assert!((x.hypot(y) - FAR).abs() < 0.3, "{:.2} pixels", x.hypot(y));
    }
    for (one, other) in [(0, 1), (1, 2), (2, 0)] {
        let apart = (found[one][0] - found[other][0]).hypot(found[one][1] - found[other][1]);
        assert!(apart > FAR, "{found:?}");
    }
    let [x, y] = moves([0.4; 3], 1);
    assert!(x.hypot(y) < 0.05, "black stays, and moves by {:.3}", x.hypot(y));
}

#[test]
fn paper_stays_bare_in_white_and_brighter_and_ink_is_solid_in_black() {
    for shape in SHAPES {
        for (level, wanted) in [(1.0, 1.0), (6.0, 1.0), (0.0, 0.0)] {
            let out = print(24, &[("shape", shape), ("cell", "5")], |_, _| [level; 3]);
            for value in out.data().chunks_exact(4).flat_map(|pixel| &pixel[..3]) {
                assert!((value - wanted).abs() < 2e-3, "{shape}: {value} for {level}");
            }
        }
    }
}

#[test]
fn a_light_ink_on_dark_paper_prints_the_lights() {
    let settings = [("ink_color", "#ffffff"), ("paper_color", "#101030")];
    let at = |level: f64| print(8, &settings, |_, _| [level; 3]).pixel(4, 4)[1];
    assert!(at(0.0) < 0.07 && at(1.0) > 0.999, "{} {}", at(0.0), at(1.0));
}

/// Mean encoded colour of a print of a flat one.
fn seen(settings: &[(&str, &str)], color: [f64; 3]) -> [f64; 3] {
    const SIDE: usize = 144;
    let window = window(SIDE);
    let out = print(SIDE as u32, settings, |_, _| color);
    [0, 1, 2].map(|c| mean(&channel(&out, c), SIDE, &window, &window))
}

#[test]
fn process_inks_mix_the_colours_of_the_picture() {
    for color in [[0.6, 0.45, 0.35], [0.2, 0.3, 0.45], [0.5; 3], [0.08, 0.06, 0.05], [0.35, 0.42, 0.2]] {
        for shape in ["dots", "lines", "squares"] {
            let found = seen(&[("inks", "cmyk"), ("shape", shape), ("cell", "4")], color);
            for (found, wanted) in found.iter().zip(color) {
                let off = 255.0 * (encoded(*found) - encoded(wanted)).abs();
                assert!(off < 8.0, "{shape}: {found:.3} for {wanted} of {color:?}");
            }
        }
    }
}

#[test]
fn spot_colours_take_the_hues_and_tones_that_they_can_print() {
    let spots = [("inks", "two_spots"), ("spot_1", "#152a6e"), ("spot_2", "#f0503c"), ("cell", "4")];
    // Red stays red, blue blue, and greys keep their light.
    let [r, _, b] = seen(&spots, [0.7, 0.3, 0.25]);
    assert!(r > 1.5 * b, "{r} {b}");
    let [r, _, b] = seen(&spots, [0.1, 0.15, 0.4]);
    assert!(b > 1.5 * r, "{r} {b}");
    for grey in [0.1, 0.25, 0.5, 0.8] {
        let [r, g, b] = seen(&spots, [grey; 3]);
        let found = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert!((encoded(found) - encoded(grey)).abs() < 0.04, "{found:.3} for {grey}");
    }
}
