//! Expectations of an artist of styles as they come: empty light stays empty, tones keep their order and reach the ink,
//! nothing happens along borders that does not happen elsewhere, and a picture looks the same at every size.

use isophote::Request;
use isophote_engine::Image;
use isophote_tests::pictures::from_fn;
use isophote_tests::random::Random;
use isophote_tests::scenery::{forms, landscape};
use isophote_tests::{png, run};

/// Styles of lines, with what makes their paper plain where that is a pattern of its own.
const LINE_STYLES: [(&str, &[(&str, &str)]); 7] = [
    ("ink", &[("style", "ink")]),
    ("ink", &[("style", "pencil")]),
    ("ink", &[("style", "charcoal")]),
    ("ink", &[("style", "woodcut")]),
    ("ink", &[("style", "pastel")]),
    ("blueprint", &[("grid", "0")]),
    ("cartoon", &[("posterize", "0")]),
];
/// Styles that draw tones by marks.
const MARKED: [&str; 4] = ["ink", "pencil", "charcoal", "woodcut"];

/// The sRGB grey of a lightness, 0..=1.
fn grey(lightness: f32) -> f32 {
    let f = (lightness + 16.0) / 116.0;
    let y = if lightness > 8.0 { f * f * f } else { lightness / 903.3 };
    if y <= 0.003_130_8 { 12.92 * y } else { 1.055 * y.powf(1.0 / 2.4) - 0.055 }
}

/// A field whose lightness is a function of the place, with noise of a standard deviation, 0..=1.
fn field(size: u32, noise: f64, lightness: impl Fn(f32, f32) -> f32) -> Image {
    let mut random = Random::new(7);
    from_fn(size, size, |x, y| {
        let plain = grey(lightness(x as f32 / size as f32, y as f32 / size as f32));
        let v = plain + (random.normal() * noise) as f32;
        [v, v, v, 1.0]
    })
}

fn luma(image: &Image, x: i32, y: i32) -> f32 {
    let [r, g, b, ..] = image.pixel(x, y) else { panic!("no colour") };
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// The mean of a window about a pixel.
fn local_mean(image: &Image, x: i32, y: i32, radius: i32) -> f32 {
    let (width, height) = (image.width() as i32, image.height() as i32);
    let (mut sum, mut count) = (0.0, 0.0);
    for v in (y - radius).max(0)..(y + radius + 1).min(height) {
        for u in (x - radius).max(0)..(x + radius + 1).min(width) {
            sum += luma(image, u, v);
            count += 1.0;
        }
    }
    sum / count
}

#[test]
fn light_and_empty_stays_empty() {
    type Lightness = fn(f32, f32) -> f32;
    let fields: [(&str, Lightness); 7] = [
        ("flat 70", |_, _| 70.0),
        ("flat 82", |_, _| 82.0),
        ("flat 97", |_, _| 97.0),
        ("ramp to the right", |x, _| 70.0 + 28.0 * x),
        ("ramp down", |_, y| 98.0 - 28.0 * y),
        ("slanted ramp", |x, y| 70.0 + 14.0 * (x + y)),
        ("round ramp", |x, y| 70.0 + 28.0 * ((x - 0.5).hypot(y - 0.5) * 1.4).min(1.0)),
    ];
    let mut faults = Vec::new();
    for (id, params) in LINE_STYLES {
        for (name, lightness) in fields {
            for noise in [0.0, 0.01] {
                let result = run::node(id, params, &field(96, noise, lightness));
                let mut most = 0.0f32;
                for y in 0..96 {
                    for x in 0..96 {
                        // Ramps are steepest at the border, where half of the window is missing.
                        let (u, v) = (x.clamp(4, 91), y.clamp(4, 91));
                        most = most.max((luma(&result, u, v) - local_mean(&result, u, v, 4)).abs());
                    }
                }
                if most >= 2.0 / 255.0 {
                    let found = most * 255.0;
                    faults.push(format!("{id} {params:?}, {name}, noise {noise}: {found:.2}/255"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn tones_keep_their_order_and_reach_the_ink() {
    for style in MARKED {
        let means: Vec<f32> = (1..=19)
            .map(|i| {
                let flat = field(128, 0.0, |_, _| i as f32 * 5.0);
                local_mean(&run::node("ink", &[("style", style)], &flat), 64, 64, 48)
            })
            .collect();
        for (i, pair) in means.windows(2).enumerate() {
            assert!(
                pair[0] <= pair[1] + 0.012,
                "{style}: L {} is lighter than the next: {means:?}",
                i * 5 + 5
            );
        }
        let (ink, paper) = (0.087, 0.955);
        let reached = (paper - means[1]) / (paper - ink);
        assert!(reached >= 0.85, "{style}: L 10 reaches {reached:.2} of the ink");
        assert!(means[8] < means[18] - 0.15, "{style} tells L 45 from L 95: {means:?}");
    }
}

#[test]
fn ink_knows_black_and_white() {
    let ramp = field(256, 0.0, |x, _| 100.0 * x);
    let result = run::node("ink", &[], &ramp);
    let greys = (0..256 * 256).filter(|i| (0.3..0.75).contains(&luma(&result, i % 256, i / 256))).count();
    // Borders of hatches are as wide as a pixel.
    assert!(greys < 256 * 256 / 8, "{greys} pixels are neither black nor white");
}

#[test]
fn borders_are_like_the_rest() {
    const SIZE: i32 = 256;
    for style in MARKED {
        for (name, slanted) in [("vertical", 0.0), ("slanted", 0.5)] {
            let ramp = field(SIZE as u32, 0.0, |x, y| 20.0 + 45.0 * ((1.0 - slanted) * y + slanted * x));
            let result = run::node("ink", &[("style", style)], &ramp);
            // Along the left border and well inside, row by row of the same tones.
            let deviation = |from: i32, to: i32| {
                let mut sum = 0.0f64;
                for y in 0..SIZE {
                    for x in from..to {
                        sum += f64::from(luma(&result, x, y) - local_mean(&result, x, y, 8)).powi(2);
                    }
                }
                (sum / f64::from((to - from) * SIZE)).sqrt()
            };
            let (border, inside) = (deviation(0, 6), deviation(120, 136));
            assert!(
                (0.75..1.3).contains(&(border / inside)),
                "{style}, {name} ramp: {border:.4} along the border, {inside:.4} inside"
            );
        }
    }
}

/// A picture made smaller by a whole number.
fn smaller(image: &Image, by: i32) -> Image {
    let share = 1.0 / (by * by) as f32;
    from_fn(image.width() / by as u32, image.height() / by as u32, |x, y| {
        let mut sum = [0.0; 4];
        for i in 0..by * by {
            let pixel = image.pixel(x * by + i % by, y * by + i / by);
            sum = [0, 1, 2, 3].map(|c| sum[c] + pixel[c] * share);
        }
        sum
    })
}

fn psnr(a: &Image, b: &Image) -> f64 {
    let squares: f64 = a.data().iter().zip(b.data()).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    // Alpha is the same and does not count.
    -10.0 * (squares / (a.data().len() as f64 * 0.75)).log10()
}

#[test]
fn a_picture_looks_the_same_at_every_size() {
    let looks = [
        ("cartoon", 30.0),
        ("oil_paint", 30.0),
        ("painting", 30.0),
        ("coherent", 30.0),
        ("watercolor", 30.0),
        ("ink", 20.0),
        ("blueprint", 20.0),
    ];
    for (id, least) in looks {
        let result = |height: u32| {
            let picture = landscape(height);
            let request =
                Request { reference_height: 480, ..Request::new(picture.width(), picture.height()) };
            run::graph(&run::single(id, &[]), request, &picture)
        };
        let small = result(240);
        for by in [2, 4] {
            let found = psnr(&smaller(&result(240 * by as u32), by), &small);
            assert!(found >= least, "{id}: {found:.1} dB between 240 and {} lines", 240 * by);
        }
    }
}

/// Mean L, a and b of windows of 8 pixels.
fn coarse_lab(image: &Image) -> Vec<[f64; 3]> {
    let small = smaller(image, 8);
    small.data().chunks_exact(4).map(lab).collect()
}

/// CIELAB of an sRGB colour, D65.
fn lab(pixel: &[f32]) -> [f64; 3] {
    let decoded = [0, 1, 2].map(|c| {
        let v = f64::from(pixel[c].clamp(0.0, 1.0));
        if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    });
    let rows = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
    let white = [0.950_47, 1.0, 1.088_83];
    let [x, y, z] = [0, 1, 2].map(|i| {
        let row: [f64; 3] = rows[i];
        let v = (0..3).map(|c| row[c] * decoded[c]).sum::<f64>() / white[i];
        if v > 0.008_856 { v.cbrt() } else { 7.787 * v + 16.0 / 116.0 }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let count = pairs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (a, b) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |f: &dyn Fn(f64, f64) -> f64| pairs.iter().map(|p| f(p.0 - a, p.1 - b)).sum::<f64>();
    sum(&|x, y| x * y) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt()
}

/// Lines of the pictures that lengths are meant for: as programs have it, where pictures are half as high or less.
const REFERENCE: u32 = 540;

/// Faults of a style's lightness, hue and mean on a picture.
fn unlike(id: &str, params: &[(&str, &str)], name: &str, picture: &Image, faults: &mut Vec<String>) {
    let request = Request { reference_height: REFERENCE, ..Request::new(picture.width(), picture.height()) };
    let result = run::graph(&run::single(id, params), request, picture);
    let (before, after) = (coarse_lab(picture), coarse_lab(&result));
    let lightness: Vec<(f64, f64)> = before.iter().zip(&after).map(|(a, b)| (a[0], b[0])).collect();
    let two_tone = params.iter().any(|p| ["ink", "woodcut"].contains(&p.1));
    let (found, least) = (correlation(&lightness), if two_tone { 0.8 } else { 0.9 });
    if found < least {
        faults.push(format!("{id} {params:?} on {name}: lightness correlates by {found:.3}"));
    }
    if id == "ink" {
        return;
    }
    let shift = lightness.iter().map(|(a, b)| b - a).sum::<f64>() / lightness.len() as f64;
    // Transparent paint is never black, and lights are paper.
    let most = if id == "watercolor" { 10.0 } else { 4.0 };
    if shift.abs() > most {
        faults.push(format!("{id} on {name}: lightness shifts by {shift:.1}"));
    }
    // The mean turn of hues, by chroma.
    let turned = before.iter().zip(&after).fold([0.0; 2], |[x, y], (a, b)| {
        let (cross, dot) = (a[1] * b[2] - a[2] * b[1], a[1] * b[1] + a[2] * b[2]);
        [x + dot, y + cross]
    });
    let degrees = turned[1].atan2(turned[0]).to_degrees();
    if degrees.abs() > 5.0 {
        faults.push(format!("{id} on {name}: hues turn by {degrees:.1} degrees"));
    }
}

#[test]
fn pictures_are_recognised() {
    let mut pictures = vec![("forms".to_owned(), forms()[0].1.clone()), ("landscape".into(), landscape(240))];
    if let Some(assets) = png::assets() {
        for name in ["astronaut.png", "chelsea.png"] {
            pictures.push((name.into(), smaller(&png::read(&assets.join("photo").join(name)).unwrap(), 2)));
        }
    }
    let mut faults = Vec::new();
    for (name, picture) in &pictures {
        for id in ["cartoon", "watercolor", "oil_paint", "painting", "coherent"] {
            unlike(id, &[], name, picture, &mut faults);
        }
        for style in ["ink", "pencil", "charcoal", "woodcut", "pastel"] {
            unlike("ink", &[("style", style)], name, picture, &mut faults);
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// Steepest rise of a row over four pixels.
fn steepest(image: &Image, y: i32) -> f32 {
    (8..image.width() as i32 - 12)
        .map(|x| (luma(image, x + 4, y) - luma(image, x, y)).abs())
        .fold(0.0, f32::max)
}

#[test]
fn soft_lights_have_no_rings_and_shadows_have_borders() {
    let drawn = |picture: &Image, settings: &[(&str, &str)]| {
        let request = Request::new(picture.width(), picture.height());
        run::graph(&run::single("cartoon", settings), request, picture)
    };
    // A light out of focus.
    let light = field(192, 0.005, |x, y| {
        let r2 = (x - 0.5).powi(2) + (y - 0.5).powi(2);
        35.0 + 45.0 * (-r2 / (2.0 * 0.22 * 0.22)).exp()
    });
    let plain = steepest(&light, 96);
    let found = steepest(&drawn(&light, &[("line_amount", "0")]), 96);
    assert!(found < 1.5 * plain, "{found:.3} for {plain:.3}");

    // A shadow with a penumbra of 24 pixels, between which nothing else is.
    let shadow = field(192, 0.0, |x, _| 50.0 + 20.0 * ((x - 0.5) * 8.0).clamp(-0.5, 0.5));
    let hard = steepest(&drawn(&shadow, &[("line_amount", "0")]), 96);
    let soft = steepest(&drawn(&shadow, &[("line_amount", "0"), ("posterize_smooth", "1")]), 96);
    let plain = steepest(&shadow, 96);
    assert!(hard > 3.0 * plain && soft < 0.5 * hard, "{hard:.3} hard, {soft:.3} soft, {plain:.3} before");
}

#[test]
fn watercolours_are_transparent_paint_on_white_paper() {
    let painted = |picture: &Image| {
        run::graph(&run::single("watercolor", &[]), Request::new(picture.width(), picture.height()), picture)
    };
    let flat = |value: f32| painted(&from_fn(96, 64, |_, _| [value, value, value, 1.0]));
    assert!(flat(0.0).data().iter().all(|v| *v > 0.1), "the darkest wash keeps some paper");
    assert!(flat(0.97).data().iter().all(|v| *v > 0.985), "lights are paper");

    // Strokes of a letter, three pixels wide.
    let is_stroke = |x: i32| x % 16 < 3;
    for [ground, ink] in [[0.75, 0.1], [0.15, 0.85]] {
        let picture = from_fn(96, 64, |x, _| {
            let v = if is_stroke(x) { ink } else { ground };
            [v, v, v, 1.0]
        });
        let result = painted(&picture);
        let column = |x: i32| (0..64).map(|y| f64::from(result.pixel(x, y)[1])).sum::<f64>() / 64.0;
        // They waver by less than the gaps between them.
        let [least, greatest] = (32..64).map(column).fold([1.0f64, 0.0], |[a, b], v| [a.min(v), b.max(v)]);
        assert!(greatest - least > 0.25, "{ground} and {ink}: {least:.2} to {greatest:.2}");
    }
}
