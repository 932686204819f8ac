//! Ben-Day dots of `cartoon` on the CPU executor: their light from afar, what is solid, and what is not printed.

use super::light::{channel, encoded, farthest, mean, window};
use crate::result;
use isophote::{ColourSpace, Request};
use isophote_engine::{Image, Rect};

/// Colours as they are, without steps of lightness.
const PRINTED: [(&str, &str); 3] = [("posterize", "0"), ("n_a", "0"), ("dots", "1")];
const SKIN: [f64; 3] = [0.78, 0.5, 0.36];

/// The cartoon of a square picture of linear light.
fn cartoon(side: i32, settings: &[(&str, &str)], light: impl Fn(i32, i32) -> [f64; 3]) -> Image {
    let settings: Vec<_> = PRINTED.iter().chain(settings).copied().collect();
    let picture = picture(side, light);
    result::of("cartoon", &settings, ColourSpace::Srgb, &[("color", &picture)])
}

fn picture(side: i32, light: impl Fn(i32, i32) -> [f64; 3]) -> Image {
    result::picture([side, side], |x, y| {
        let [r, g, b] = light(x, y).map(|v| encoded(v) as f32);
        [r, g, b, 1.0]
    })
}

/// A flat colour on both sides of a black bar.
fn barred(x: i32, _: i32) -> [f64; 3] {
    if (30..36).contains(&x) { [0.0; 3] } else { SKIN }
}

/// The range of a channel, of encoded values.
fn range(image: &Image, channel: usize) -> f32 {
    let values = image.data().chunks_exact(4).map(|pixel| pixel[channel]);
    let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), v| (low.min(v), high.max(v)));
    high - low
}

#[test]
fn dots_have_the_colour_of_the_picture_from_afar() {
    const SIDE: usize = 192;
    let window = window(SIDE);
    let greys = [0.9, 0.6, 0.35, 0.2, 0.02].map(|v| [v; 3]);
    let colours = [SKIN, [0.25, 0.5, 0.85], [0.9, 0.85, 0.3], [0.6, 0.04, 0.03], [0.05, 0.2, 0.06]];
    for spacing in ["3", "3.7", "9", "21.5"] {
        for colour in greys.into_iter().chain(colours) {
            let out = cartoon(SIDE as i32, &[("dot_spacing", spacing)], |_, _| colour);
            for (c, wanted) in colour.iter().enumerate() {
                let found = mean(&channel(&out, c), SIDE, &window, &window);
                let off = 255.0 * (encoded(found) - encoded(*wanted)).abs();
                assert!(
                    off < 1.5,
                    "{spacing}: {found:.4} for {wanted}, channel {c} of {colour:?}: {off:.2}/255"
                );
            }
        }
    }
}

#[test]
fn dots_do_not_beat_with_pixels() {
    const SIDE: usize = 100;
    for cell in [3.0, 3.3, 4.1, 5.3] {
        let spacing = f64::to_string(&cell);
        for colour in [SKIN, [0.9; 3], [0.5; 3], [0.25, 0.5, 0.85]] {
            let out = cartoon(SIDE as i32, &[("dot_spacing", &*spacing)], |_, _| colour);
            for (c, wanted) in colour.iter().enumerate() {
                let most = farthest(&channel(&out, c), SIDE, cell, |_| *wanted) * 255.0;
                assert!(most < 2.0, "{spacing}: {most:.2}/255 in {c} of {colour:?}");
            }
        }
    }
}

#[test]
fn light_colours_are_dots_and_dark_and_pure_ones_are_solid() {
    for (colour, seen) in [(SKIN, 1), (SKIN, 2), ([0.25, 0.5, 0.85], 0), ([0.5; 3], 1)] {
        let out = cartoon(64, &[], |_, _| colour);
        assert!(range(&out, seen) > 0.2, "{colour:?}: {}", range(&out, seen));
    }
    for colour in [[0.03; 3], [0.0; 3], [0.7, 0.03, 0.02], [0.02, 0.03, 0.2], [1.0; 3], [4.0, 3.0, 2.0]] {
        let out = cartoon(64, &[], |_, _| colour);
        for c in 0..3 {
            assert!(range(&out, c) < 0.03, "{colour:?}: {} in {c}", range(&out, c));
        }
    }
}

#[test]
fn pale_tones_are_white_paper() {
    let out = cartoon(64, &[], |_, _| [0.985, 0.99, 0.985]);
    assert!(out.data().iter().all(|v| (v - 1.0).abs() < 1e-4));
}

#[test]
fn lines_are_drawn_over_dots() {
    for color in ["#000000", "#ffe030", "#3050ff"] {
        let settings = [("line_color", color), ("outline_width", "3")];
        let bare: Vec<_> = settings.into_iter().chain([("dots", "0")]).collect();
        let [dots, bare] = [&settings[..], &bare].map(|settings| cartoon(64, settings, barred));
        // Where the drawing without dots is all line.
        let line =
            [1, 3, 5].map(|at| u8::from_str_radix(&color[at..at + 2], 16).map_or(0.0, f32::from) / 255.0);
        let mut lines = 0;
        for (dots, bare) in dots.data().chunks_exact(4).zip(bare.data().chunks_exact(4)) {
            if bare.iter().zip(line).all(|(v, line)| (v - line).abs() < 1e-4) {
                lines += 1;
                assert!(dots.iter().zip(bare).all(|(a, b)| (a - b).abs() < 5e-3), "{color}: {dots:?}");
            }
        }
        assert!(lines > 20, "{lines} pixels of lines");
    }
    let [some, none] = ["1", "0"].map(|dots| cartoon(64, &[("show", "lines"), ("dots", dots)], barred));
    assert_eq!(some.data(), none.data(), "lines alone have no dots");
}

#[test]
fn dots_stay_on_the_paper() {
    let settings: Vec<_> = PRINTED.into_iter().chain([("dot_spacing", "5.3")]).collect();
    let picture = picture(64, |_, _| SKIN);
    let inputs = &[("color", &picture)][..];
    let request = Request { space: ColourSpace::Srgb, ..Request::new(64, 64) };
    let whole = result::at("cartoon", &settings, request, inputs);
    let region = Rect { x0: 13, y0: 22, x1: 50, y1: 41 };
    let part = result::part("cartoon", &settings, request, inputs, region);
    assert_eq!(whole.crop(region).unwrap().data(), part.data());
    // A picture that is cut out of a larger one.
    let moved = Request { origin: [7.0, 4.0], ..request };
    let moved = result::at("cartoon", &settings, moved, inputs);
    for (x, y) in [(20, 20), (31, 17), (40, 44)] {
        let (here, there) = (moved.pixel(x, y), whole.pixel(x + 7, y + 4));
        assert!(here.iter().zip(there).all(|(a, b)| (a - b).abs() < 1e-3), "{here:?} {there:?}");
    }
}
