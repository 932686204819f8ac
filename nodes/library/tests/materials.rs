//! Paper and hatching that a host gives, on the CPU executor.

use crate::result;
use isophote::ColourSpace;
use isophote::engine::Image;

const SIZE: [i32; 2] = [160, 120];

fn picture(value: impl Fn(i32, i32) -> [f32; 4]) -> Image {
    result::picture(SIZE, value)
}

fn grey(value: f32) -> Image {
    picture(|_, _| [value, value, value, 1.0])
}

fn styled(style: &str, settings: &[(&str, &str)], inputs: result::Inputs<'_>) -> Image {
    result::of(style, settings, ColourSpace::Srgb, inputs)
}

/// Mean of a value of the pixels off the borders.
fn mean(image: &Image, value: impl Fn([i32; 2], &[f32]) -> f32) -> f32 {
    let places = (20..SIZE[1] - 20).flat_map(|y| (20..SIZE[0] - 20).map(move |x| [x, y]));
    let all: Vec<f32> = places.map(|[x, y]| value([x, y], image.pixel(x, y))).collect();
    all.iter().sum::<f32>() / all.len() as f32
}

/// Lines, `every` pixels apart and `wide` pixels wide.
fn lines(x: i32, every: i32, wide: i32) -> f32 {
    if x % every < wide { 0.0 } else { 1.0 }
}

#[test]
fn hatching_covers_what_the_tone_asks_for_however_it_is_drawn() {
    // A twelfth, a quarter, a half and three quarters; a grey file that is one tone; tones that are out of order.
    let tones = picture(|x, _| [lines(x, 12, 1), lines(x, 12, 3), lines(x, 12, 6), lines(x, 12, 9)]);
    let one = picture(|x, _| [lines(x, 5, 2); 4]);
    let odd = picture(|x, y| [lines(x, 6, 3), lines(y, 6, 1), lines(x + y, 8, 5), 1.0]);
    for level in [0.15, 0.3, 0.42, 0.55] {
        let color = grey(level);
        let settings = [("line_amount", "0"), ("grain", "0"), ("carving", "0")];
        // By the style's own hatching, whose means are known.
        let own = styled("ink", &settings, &[("color", &color)]);
        let wanted = mean(&own, |_, pixel| pixel[1]);
        for (name, hatching) in [("tones", &tones), ("one", &one), ("odd", &odd)] {
            let drawn = styled("ink", &settings, &[("color", &color), ("hatching", hatching)]);
            let found = mean(&drawn, |_, pixel| pixel[1]);
            assert!((found - wanted).abs() < 0.03, "{name} at {level}: {found} for {wanted}");
        }
    }
}

#[test]
fn marks_stand_where_the_hatching_has_them() {
    let tones = picture(|x, _| [lines(x, 12, 3); 4]);
    let drawn = styled("ink", &[("line_amount", "0")], &[("color", &grey(0.45)), ("hatching", &tones)]);
    let on_marks = |is_on: bool| {
        let sum = |of: &dyn Fn(f32) -> f32| {
            mean(&drawn, |[x, _], pixel| if (x % 12 < 3) == is_on { of(pixel[1]) } else { 0.0 })
        };
        sum(&|v| v) / sum(&|_| 1.0)
    };
    assert!(on_marks(true) < 0.5 * on_marks(false), "{} {}", on_marks(true), on_marks(false));
}

#[test]
fn paper_gives_its_colours_and_a_grain_that_stains_have_no_part_in() {
    // Small pits in paper that grows darker to the right by far more than they are deep.
    let shade = |x: i32| 0.9 - 0.3 * x as f32 / SIZE[0] as f32;
    let pit = |x: i32, y: i32| x % 4 == 0 && y % 4 == 0;
    let paper = picture(|x, y| {
        let v = shade(x) * if pit(x, y) { 0.97 } else { 1.0 };
        [v, v, 0.8 * v, 1.0]
    });
    let white = styled("watercolor", &[], &[("color", &grey(1.0)), ("paper", &paper)]);
    for x in [20, 90, 140] {
        for (channel, share) in [(0, 1.0), (2, 0.8)] {
            let (found, wanted) = (white.pixel(x, 61)[channel], share * shade(x));
            assert!((found - wanted).abs() < 0.012, "{x} {channel}: {found} for {wanted}");
        }
    }
    let settings = [("style", "charcoal"), ("line_amount", "0"), ("paper_color", "#ffffff")];
    let drawn = styled("ink", &settings, &[("color", &grey(0.4)), ("paper", &paper)]);
    // Ink stays out of the pits, on the light side as on the dark one: against the paper it is lighter there.
    for half in [0..SIZE[0] / 2, SIZE[0] / 2..SIZE[0]] {
        let kept = |in_pits: bool| {
            let share =
                |of: &dyn Fn(i32, i32, f32) -> f32| {
                    mean(&drawn, |[x, y], pixel| {
                        if half.contains(&x) && pit(x, y) == in_pits { of(x, y, pixel[1]) } else { 0.0 }
                    })
                };
            share(&|x, y, v| v / paper.pixel(x, y)[1]) / share(&|_, _, _| 1.0)
        };
        assert!(kept(true) > kept(false) + 0.015, "{half:?}: {} {}", kept(true), kept(false));
    }
}

#[test]
fn transparent_paper_is_white_and_even_paper_has_no_grain() {
    let color = picture(|x, y| [0.2 + 0.004 * x as f32, 0.5, 0.3 + 0.004 * y as f32, 1.0]);
    for style in ["watercolor", "ink", "blueprint"] {
        let on = |paper: &Image| styled(style, &[], &[("color", &color), ("paper", paper)]);
        let (white, clear) = (on(&grey(1.0)), on(&picture(|_, _| [0.0; 4])));
        let far = white.data().iter().zip(clear.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(far < 1e-4, "{style}: {far}");
    }
    // Where nothing else is uneven, paint on even paper is even.
    let settings = [("clouds", "0"), ("bleeding", "0"), ("gaps", "0"), ("backruns", "0")];
    let painted = styled("watercolor", &settings, &[("color", &grey(0.5)), ("paper", &grey(0.9))]);
    let first = painted.pixel(80, 60)[1];
    assert!(mean(&painted, |_, pixel| (pixel[1] - first).abs()) < 2e-3);
    let own = styled("watercolor", &settings, &[("color", &grey(0.5))]);
    assert!(mean(&own, |_, pixel| (pixel[1] - own.pixel(80, 60)[1]).abs()) > 5e-3);
}
