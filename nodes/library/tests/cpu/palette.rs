//! `palette` on the CPU executor: colours to the bit, nearness against arithmetic of 64 bits, and the means of dither.

use isophote::{ColourSpace, Graph, Planned, Request};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Image, Rect};
use std::collections::BTreeSet;

/// Nothing smoothed, and tones as they are.
const PLAIN: [(&str, &str); 2] = [("smoothing", "0"), ("fit", "0")];
const DITHERS: [&str; 3] = ["none", "bayer", "noise"];

/// A picture in the colours of a palette, with the settings of [`PLAIN`] and others.
fn painted(settings: &[(&str, &str)], request: Request, picture: &Image) -> Image {
    styled("palette", &[&PLAIN, settings].concat(), request, picture)
}

/// A picture through a node.
fn styled(node: &str, settings: &[(&str, &str)], request: Request, picture: &Image) -> Image {
    let mut graph = Graph::single(node).unwrap();
    let node = graph.node(0).unwrap();
    for (param, value) in settings {
        graph.set_text(node, param, value).unwrap();
    }
    let planned = Planned::new(&graph, request).unwrap();
    let region = Rect::of_size(picture.width(), picture.height());
    CpuExecutor::new()
        .run(planned.plan(), &[("color", picture)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

fn picture([width, height]: [u32; 2], pixel: impl Fn(u32, u32) -> [f32; 4]) -> Image {
    let pixels = (0..width * height).flat_map(|i| pixel(i % width, i / width));
    Image::from_vec(width, height, 4, pixels.collect()).unwrap()
}

/// Opaque colours of all kinds, no two alike in order.
fn medley(size: [u32; 2]) -> Image {
    picture(size, |x, y| {
        let part = |n: u32| ((x * 73 + y * 151 + x * y * 7) * n % 256) as f32 / 255.0;
        [part(1), part(37), part(101), 1.0]
    })
}

fn request(image: &Image) -> Request {
    Request::new(image.width(), image.height())
}

/// The colours that a picture has, as bits.
fn colours(image: &Image) -> BTreeSet<[u32; 3]> {
    image.data().chunks_exact(4).map(|p| [p[0], p[1], p[2]].map(f32::to_bits)).collect()
}

/// A colour of eight bits.
fn eight_bits(hex: &str) -> [f32; 3] {
    let number = u32::from_str_radix(hex.trim_start_matches('#'), 16).unwrap();
    [16, 8, 0].map(|shift| (number >> shift & 255) as f32 / 255.0)
}

/// Settings of a palette of one's own.
fn own<'a>(colours: &'a [&'a str], ids: &'a [String], count: &'a str) -> Vec<(&'a str, &'a str)> {
    let mut settings = vec![("palette", "own"), ("count", count)];
    settings.extend(ids.iter().map(String::as_str).zip(colours.iter().copied()));
    settings
}

fn ids() -> Vec<String> {
    (1..=16).map(|n| format!("color_{n}")).collect()
}

/// CIELAB (D65) of gamma-encoded colours, from their definitions.
fn lab(colour: [f32; 3]) -> [f64; 3] {
    let light = colour.map(|v| {
        let v = f64::from(v);
        if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    });
    let sum = |row: [f64; 3]| row[0] * light[0] + row[1] * light[1] + row[2] * light[2];
    let curve = |t: f64| {
        let edge = 6.0f64 / 29.0;
        if t > edge.powi(3) { t.cbrt() } else { t / (3.0 * edge * edge) + 4.0 / 29.0 }
    };
    let x = curve(sum([0.412_456_4, 0.357_576_1, 0.180_437_5]) / 0.950_47);
    let y = curve(sum([0.212_672_9, 0.715_152_2, 0.072_175]));
    let z = curve(sum([0.019_333_9, 0.119_192, 0.950_304_1]) / 1.088_83);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Sixteen colours, not in the order of anything.
const SIXTEEN: [&str; 16] = [
    "#08080a", "#f0f4f0", "#b02030", "#20a040", "#2030c0", "#e0d020", "#d060c0", "#30c0d0", "#704018",
    "#f0a070", "#606468", "#a8acb0", "#183020", "#f8d0d8", "#88b030", "#502878",
];

#[test]
fn palettes_of_every_count_give_their_colours_to_the_bit() {
    let medley = medley([64, 40]);
    let ids = ids();
    for count in 2..=16 {
        let allowed: BTreeSet<[u32; 3]> =
            SIXTEEN[..count].iter().map(|hex| eight_bits(hex).map(f32::to_bits)).collect();
        for dither in DITHERS {
            let count = count.to_string();
            let settings = [own(&SIXTEEN, &ids, &count), vec![("dither", dither)]].concat();
            let found = colours(&painted(&settings, request(&medley), &medley));
            assert!(found.is_subset(&allowed), "{count} colours, {dither}");
            // Each is the nearest to something.
            assert!(found.len() == allowed.len(), "{} of {count} colours, {dither}", found.len());
        }
    }
}

#[test]
fn palettes_that_ship_have_as_many_colours_as_they_say() {
    let medley = medley([96, 80]);
    let sizes = [
        ("comic", 16),
        ("gouache", 24),
        ("handheld", 4),
        ("home_computer", 16),
        ("four_colours", 4),
        ("graphics_card", 64),
        ("terminal", 8),
        ("blueprint", 2),
        ("ink_and_paper", 2),
        ("sepia", 5),
        ("silver", 6),
        ("pastel", 12),
        ("sunset", 8),
        ("forest", 8),
        ("night_city", 10),
        ("riso", 4),
    ];
    for (palette, size) in sizes {
        for dither in DITHERS {
            let settings = [("palette", palette), ("dither", dither), ("fit", "1")];
            let found = colours(&painted(&settings, request(&medley), &medley));
            assert!(
                found.len() <= size && 5 * found.len() > 3 * size,
                "{palette}, {dither}: {}",
                found.len()
            );
            for value in found.iter().flatten().map(|bits| f32::from_bits(*bits)) {
                assert_eq!(value, (value * 255.0).round() / 255.0, "{palette}, {dither}");
            }
        }
    }
}

#[test]
fn styles_end_in_the_colours_of_a_palette() {
    let waves = picture([96, 64], |x, y| {
        let wave = |f: f32| 0.5 + 0.45 * ((x as f32 * f).sin() * (y as f32 * 0.11 * f).cos());
        [wave(0.13), wave(0.21), wave(0.08), 1.0]
    });
    let straight = Request { premultiplied: false, ..request(&waves) };
    let riso = ["#25356f", "#e9503f", "#f2c23c", "#f6f1e3"];
    let allowed: BTreeSet<[u32; 3]> = riso.iter().map(|hex| eight_bits(hex).map(f32::to_bits)).collect();
    for style in ["cartoon", "ink"] {
        let free = colours(&styled(style, &[], straight, &waves));
        let found = colours(&styled(style, &[("palette", "riso")], straight, &waves));
        assert!(free.len() > 100 && found.len() > 1 && found.is_subset(&allowed), "{style}: {}", found.len());
        // Lines that are laid over something else keep their colour.
        let alone = [("show", "lines"), ("palette", "riso")];
        assert!(
            styled(style, &alone, straight, &waves) == styled(style, &alone[..1], straight, &waves),
            "{style}"
        );
    }
}

#[test]
fn halftones_are_printed_with_the_paper_and_the_inks_of_a_palette() {
    let flat = |v: f32| picture([48, 48], |_, _| [v, v, v, 1.0]);
    let print = |v: f32, more: &[(&str, &str)]| {
        let settings = [&[("palette", "riso"), ("paper_texture", "0"), ("softness", "0")], more].concat();
        let picture = flat(v);
        styled("halftone", &settings, Request { premultiplied: false, ..request(&picture) }, &picture)
    };
    let (paper, navy) = (eight_bits("#f6f1e3"), eight_bits("#25356f"));
    let near = |image: &Image, colour: [f32; 3]| {
        image.data().chunks_exact(4).all(|p| (0..3).all(|c| (p[c] - colour[c]).abs() < 2.0 / 255.0))
    };
    assert!(near(&print(1.0, &[]), paper));
    assert!(near(&print(0.0, &[("inks", "one")]), navy));
    // The same inks by hand.
    let by_hand = [
        ("palette", "none"),
        ("inks", "three_spots"),
        ("paper_color", "#f6f1e3"),
        ("spot_1", "#25356f"),
        ("spot_2", "#e9503f"),
        ("spot_3", "#f2c23c"),
        ("ink_color", "#25356f"),
    ];
    let other = [&by_hand[..4], &[("spot_3", "#e9503f"), ("spot_2", "#f2c23c")]].concat();
    let found = print(0.4, &[]);
    assert!(found == print(0.4, &by_hand) || found == print(0.4, &other));
}

#[test]
fn the_nearest_colour_is_the_nearest() {
    let medley = medley([128, 96]);
    let ids = ids();
    let palette = SIXTEEN.map(|hex| lab(eight_bits(hex)));
    let out = painted(&own(&SIXTEEN, &ids, "16"), request(&medley), &medley);
    for (wanted, found) in medley.data().chunks_exact(4).zip(out.data().chunks_exact(4)) {
        let wanted = lab([wanted[0], wanted[1], wanted[2]]);
        let least = palette.iter().map(|colour| apart(wanted, *colour)).fold(f64::MAX, f64::min);
        let found = apart(wanted, lab([found[0], found[1], found[2]]));
        assert!(found < least + 1e-3, "{found} for {least}");
    }
}

#[test]
fn pictures_of_the_palettes_colours_stay_as_they_are() {
    let ids = ids();
    let exact = picture([64, 64], |x, y| {
        let [r, g, b] = eight_bits(SIXTEEN[(x / 4 + y / 4 * 16) as usize % 16]);
        [r, g, b, 1.0]
    });
    for dither in DITHERS {
        let settings = [own(&SIXTEEN, &ids, "16"), vec![("dither", dither)]].concat();
        assert!(painted(&settings, request(&exact), &exact) == exact, "{dither}");
    }
}

/// Mean CIELAB lightness of the 32 x 32 pixels from (x, y) on.
fn lightness(image: &Image, x: u32, y: u32) -> f64 {
    let at = |i: u32| {
        let p = image.pixel((x + i % 32) as i32, (y + i / 32) as i32);
        lab([p[0], p[1], p[2]])[0]
    };
    (0..32 * 32).map(at).sum::<f64>() / 1024.0
}

#[test]
fn dither_keeps_the_means_of_a_ramp_of_greys() {
    let ramp = picture([512, 32], |x, _| {
        let v = (x as f32 + 0.5) / 512.0;
        [v, v, v, 1.0]
    });
    let ids = ids();
    for greys in [&["#000000", "#ffffff"][..], &["#ffffff", "#303030", "#909090", "#000000", "#c8c8c8"]] {
        let count = greys.len().to_string();
        for dither in ["bayer", "noise"] {
            let settings =
                [own(greys, &ids, &count), vec![("dither", dither), ("dither_size", "1")]].concat();
            let out = painted(&settings, request(&ramp), &ramp);
            for x in (0..512).step_by(32) {
                let (found, wanted) = (lightness(&out, x, 0), lightness(&ramp, x, 0));
                assert!(
                    (found - wanted).abs() < 1.5,
                    "{greys:?}, {dither}: {found:.2} for {wanted:.2} at {x}"
                );
            }
        }
    }
}

#[test]
fn spread_reaches_from_hard_borders_to_the_whole_way() {
    let ramp = picture([256, 32], |x, _| {
        let v = (x as f32 + 0.5) / 256.0;
        [v, v, v, 1.0]
    });
    let ids = ids();
    let at = |settings: &[(&str, &str)]| {
        let own = own(&["#000000", "#ffffff"], &ids, "2");
        painted(&[own, settings.to_vec()].concat(), request(&ramp), &ramp)
    };
    let hard = at(&[]);
    assert!(at(&[("dither", "noise"), ("spread", "0")]) == hard);
    // Columns in which both colours are.
    let mixed = |spread: &str| {
        let out = at(&[("dither", "noise"), ("spread", spread)]);
        let column = |x: i32| (0..32).map(|y| out.pixel(x, y)[0]).sum::<f32>();
        (0..256).filter(|x| (0.5..31.5).contains(&column(*x))).count()
    };
    let found = ["0.25", "0.5", "1"].map(mixed);
    assert!(found[0] > 30 && found[0] < found[1] && found[1] < found[2] && found[2] > 180, "{found:?}");
}

#[test]
fn any_light_and_what_is_no_number_end_in_colours_of_the_palette_and_alpha_stays() {
    let wild = picture([16, 16], |x, y| {
        let v = [0.0, 1.0, -3.0, 7.0, 4e3, 1e9, f32::NAN, f32::INFINITY][(x % 8) as usize];
        let w = [0.2, 1e4, f32::NAN, -1.0][(y % 4) as usize];
        [v, w, 0.5, if x < 8 { 1.0 } else { y as f32 / 15.0 }]
    });
    let ids = ids();
    let allowed: BTreeSet<[u32; 3]> = SIXTEEN.iter().map(|hex| eight_bits(hex).map(f32::to_bits)).collect();
    for dither in DITHERS {
        let settings = [own(&SIXTEEN, &ids, "16"), vec![("dither", dither)]].concat();
        let straight = Request { premultiplied: false, ..request(&wild) };
        let out = painted(&settings, straight, &wild);
        for (before, after) in wild.data().chunks_exact(4).zip(out.data().chunks_exact(4)) {
            assert_eq!(before[3], after[3]);
            let bits = [after[0], after[1], after[2]].map(f32::to_bits);
            assert!(after[3] == 0.0 || allowed.contains(&bits), "{dither}: {after:?} for {before:?}");
        }
        let linear = painted(&settings, Request { space: ColourSpace::Linear, ..request(&wild) }, &wild);
        assert!(linear.data().iter().all(|v| v.is_finite() && *v <= 1.0));
    }
}

/// A grey between black and white, in 64 x 64 pixels.
fn grey() -> Image {
    picture([64, 64], |_, _| [0.47, 0.47, 0.47, 1.0])
}

#[test]
fn patterns_belong_to_the_place_in_the_whole_picture_and_proxies_have_all_thresholds() {
    let (ids, grey) = (ids(), grey());
    for dither in ["bayer", "noise"] {
        let at = |size: &str, scale: f32, origin: [f64; 2]| {
            let dithered = vec![("dither", dither), ("dither_size", size)];
            let settings = [own(&["#000000", "#ffffff"], &ids, "2"), dithered].concat();
            painted(&settings, Request { scale, origin, ..request(&grey) }, &grey)
        };
        for (size, cell) in [("1", 1), ("3", 3)] {
            let (whole, part) = (at(size, 1.0, [0.0; 2]), at(size, 1.0, [11.0, 7.0]));
            for (x, y) in (0..50).flat_map(|y| (0..50).map(move |x| (x, y))) {
                assert_eq!(part.pixel(x, y), whole.pixel(x + 11, y + 7), "{dither} of {size} at {x}, {y}");
                let first = whole.pixel(x / cell * cell, y / cell * cell);
                assert_eq!(whole.pixel(x, y), first, "{dither} of {size} at {x}, {y}");
            }
        }
        let whole = lightness(&grey, 0, 0);
        for scale in [0.5, 0.25] {
            let found = lightness(&at("1", scale, [0.0; 2]), 0, 0);
            assert!((found - whole).abs() < 1.5, "{dither} at {scale}: {found:.2} for {whole:.2}");
        }
    }
}

#[test]
fn tones_are_fitted_to_those_of_the_palette() {
    let ids = ids();
    let dark = picture([64, 64], |_, _| [0.1, 0.1, 0.1, 1.0]);
    let at = |fit: &str| {
        let settings =
            [own(&["#505050", "#a0a0a0"], &ids, "2"), vec![("dither", "noise"), ("fit", fit)]].concat();
        lightness(&painted(&settings, request(&dark), &dark), 0, 0)
    };
    // Darker than the palette is its darkest colour; fitted, it is as far from that as from black before.
    let [low, high] = ["#505050", "#a0a0a0"].map(|hex| lab(eight_bits(hex))[0]);
    let wanted = low + (high - low) * 0.01 * lab([0.1; 3])[0];
    assert!((at("0") - low).abs() < 0.01 && (at("1") - wanted).abs() < 0.8, "{} {}", at("0"), at("1"));
}
