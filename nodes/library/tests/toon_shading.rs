//! Cel shading on the CPU executor: where steps lie, what they multiply, and what stays as it is.

use crate::result::{self, Inputs};
use isophote::ColourSpace;
use isophote::engine::Image;

const SIZE: [i32; 2] = [128, 96];

fn picture(value: impl Fn(i32, i32) -> [f32; 4]) -> Image {
    result::picture(SIZE, value)
}

/// The node on linear, premultiplied images.
fn shaded(settings: &[(&str, &str)], inputs: Inputs<'_>) -> Image {
    result::of("toon_shading", settings, ColourSpace::Linear, inputs)
}

fn at(image: &Image, x: i32, y: i32) -> [f32; 4] {
    image.row(y)[4 * x as usize..][..4].try_into().unwrap()
}

/// CIELAB lightness over 100 of a luminance.
fn lightness(y: f32) -> f32 {
    let f = if y > 0.008_856 { y.cbrt() } else { 7.787_037 * y + 16.0 / 116.0 };
    1.16 * f - 0.16
}

/// Grey steps that tell which one is there, crisp.
const GREYS: [(&str, &str); 6] = [
    ("color_1", "#000000"),
    ("color_2", "#808080"),
    ("color_3", "#ffffff"),
    ("at_2", "0.4"),
    ("at_3", "0.8"),
    ("softness", "0"),
];

const ALBEDO: [f32; 3] = [0.5, 0.25, 0.1];

fn opaque([r, g, b]: [f32; 3]) -> [f32; 4] {
    [r, g, b, 1.0]
}

/// Light that grows from the left to the right as `ALBEDO` reflects it.
fn ramp() -> (Image, Image) {
    let light = |x: i32| 1.2 * (x as f32 + 0.5) / SIZE[0] as f32;
    let lit = picture(|x, _| opaque(ALBEDO.map(|v| v * light(x))));
    (lit, picture(|_, _| opaque(ALBEDO)))
}

#[test]
fn steps_begin_where_they_are_asked_for() {
    let (lit, albedo) = ramp();
    for given in [
        &[("color", &lit), ("albedo", &albedo), ("diffuse", &lit)][..],
        &[("color", &lit), ("albedo", &albedo)],
    ] {
        let out = shaded(&GREYS, given);
        for x in 0..SIZE[0] {
            let l = lightness(1.2 * (x as f32 + 0.5) / SIZE[0] as f32);
            if (l - 0.4).abs() < 0.03 || (l - 0.8).abs() < 0.03 {
                continue;
            }
            let share: f32 = if l < 0.4 {
                0.0
            } else if l < 0.8 {
                0.215_86
            } else {
                1.0
            };
            let [r, g, b, a] = at(&out, x, 40);
            let expected = ALBEDO.map(|v| v * share);
            for (found, expected) in [r, g, b].iter().zip(expected) {
                assert!((found - expected).abs() < 2e-4, "{found} for {expected} at {x}");
            }
            assert_eq!(a, 1.0);
        }
    }
}

#[test]
fn borders_are_as_soft_as_they_are_asked_for() {
    let (lit, albedo) = ramp();
    let width = |softness: &str, of_all: &str| {
        let settings = [&GREYS[..5], &[("softness", of_all), ("softness_3", softness)]].concat();
        let out = shaded(&settings, &[("color", &lit), ("albedo", &albedo), ("diffuse", &lit)]);
        let between = |x: &i32| (0.25 * 0.24..0.25 * 0.98).contains(&at(&out, *x, 20)[1]);
        (0..SIZE[0]).filter(between).count()
    };
    let [crisp, soft, softer, all] =
        [width("0", "0"), width("0.2", "0"), width("0.4", "0"), width("0", "0.2")];
    assert!((1..=3).contains(&crisp), "{crisp}");
    assert!(soft > 10 && softer > soft + 10 && all == soft, "{soft} {softer} {all}");
}

#[test]
fn steps_above_their_number_have_no_effect() {
    let (lit, albedo) = ramp();
    let inputs: Inputs<'_> = &[("color", &lit), ("albedo", &albedo), ("diffuse", &lit)];
    let plain = shaded(&GREYS, inputs);
    let more = [&GREYS[..], &[("color_4", "#ff0000"), ("at_4", "0.1"), ("softness_6", "1")]].concat();
    assert_eq!(plain.data(), shaded(&more, inputs).data());
    let four = [&more[..], &[("steps", "4")]].concat();
    assert_ne!(plain.data(), shaded(&four, inputs).data());
}

/// A sphere before a sky, lit from above on the left.
struct Sphere {
    color: Image,
    albedo: Image,
    diffuse: Image,
    specular: Image,
    normal: Image,
}

const SKY: [f32; 4] = [0.3, 0.5, 0.9, 1.0];

fn sphere() -> Sphere {
    let normal = |x: i32, y: i32| {
        let [u, v] = [(x as f32 - 63.5) / 40.0, (47.5 - y as f32) / 40.0];
        let square = u * u + v * v;
        (square < 1.0).then(|| [u, v, (1.0 - square).sqrt()])
    };
    let light = |n: [f32; 3]| ((n[1] - n[0] + n[2]) / 3f32.sqrt()).max(0.0);
    let shine = |n: [f32; 3]| light(n).powi(60);
    let of = |value: &dyn Fn([f32; 3]) -> [f32; 3], nothing: [f32; 4]| {
        picture(|x, y| normal(x, y).map_or(nothing, |n| opaque(value(n))))
    };
    let none = [0.0; 4];
    Sphere {
        color: of(&|n| ALBEDO.map(|v| v * light(n) + shine(n)), SKY),
        albedo: of(&|_| ALBEDO, none),
        diffuse: of(&|n| ALBEDO.map(|v| v * light(n)), none),
        specular: of(&|n| [shine(n); 3], none),
        normal: of(&|n| n, none),
    }
}

impl Sphere {
    fn all(&self) -> [(&'static str, &Image); 5] {
        let Self { color, albedo, diffuse, specular, normal } = self;
        [
            ("color", color),
            ("albedo", albedo),
            ("diffuse", diffuse),
            ("specular", specular),
            ("normal", normal),
        ]
    }
}

#[test]
fn a_sphere_is_its_albedo_times_the_ramp_and_the_sky_stays() {
    let sphere = sphere();
    for inputs in [&sphere.all()[..], &sphere.all()[..2], &sphere.all()[..3]] {
        let out = shaded(&GREYS, inputs);
        let mut counts = [0; 3];
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let [r, g, b, _] = at(&out, x, y);
                let covered = at(&sphere.albedo, x, y)[3];
                if covered == 0.0 {
                    let [red, green, blue, _] = SKY;
                    for (found, expected) in [r, g, b].iter().zip([red, green, blue]) {
                        assert!((found - expected).abs() < 2e-4, "the sky at {x}, {y}: {found}");
                    }
                    continue;
                }
                let tones = [0.0, 0.215_86, 1.0];
                let exact = tones.iter().position(|t| (g - ALBEDO[1] * t).abs() < 2e-4);
                if let Some(tone) = exact {
                    assert!((r - ALBEDO[0] * tones[tone]).abs() < 1e-3, "{x}, {y}");
                    counts[tone] += 1;
                }
            }
        }
        // Nearly all is flat.
        assert!(counts.iter().all(|count| *count > 200), "{counts:?}");
        assert!(counts.iter().sum::<i32>() > 4300, "{counts:?}");
    }
}

#[test]
fn the_rim_is_where_surfaces_turn_away() {
    let sphere = sphere();
    let rim = [&GREYS[..], &[("rim", "1"), ("rim_width", "0.4"), ("rim_color", "#0000ff")]].concat();
    let (plain, out) = (shaded(&GREYS, &sphere.all()), shaded(&rim, &sphere.all()));
    assert_eq!(at(&out, 63, 47), at(&plain, 63, 47), "the middle");
    let [r, g, b, _] = at(&out, 63, 9);
    assert!(r < 0.01 && g < 0.01 && b > 0.95, "the border: {r} {g} {b}");
    assert_eq!(at(&out, 3, 3), at(&plain, 3, 3), "the sky");
    // Nothing turns where there are no normals.
    assert_eq!(shaded(&rim, &sphere.all()[..4]).data(), plain_without(&sphere).data());
}

fn plain_without(sphere: &Sphere) -> Image {
    shaded(&GREYS, &sphere.all()[..4])
}

#[test]
fn highlights_have_the_shape_of_mirrored_light() {
    let sphere = sphere();
    let settings = |size: &'static str| {
        [&GREYS[..], &[("highlight", "1"), ("highlight_size", size), ("highlight_color", "#00ff00")]].concat()
    };
    let count = |size| {
        let out = shaded(&settings(size), &sphere.all());
        out.data().chunks_exact(4).filter(|p| p[1] > 0.9 && p[0] < 0.1).count()
    };
    let [none, small, large] = [count("0"), count("0.4"), count("0.8")];
    assert_eq!(none, 0);
    assert!(small > 20 && large > 2 * small && large < 1500, "{small} {large}");
}

#[test]
fn metals_are_lit_by_what_they_mirror() {
    let sphere = sphere();
    let black = picture(|x, y| [0.0, 0.0, 0.0, at(&sphere.albedo, x, y)[3]]);
    let inputs = [
        ("color", &sphere.diffuse),
        ("albedo", &sphere.albedo),
        ("diffuse", &black),
        ("specular", &sphere.diffuse),
    ];
    let out = shaded(&GREYS, &inputs);
    let [r, g, ..] = at(&out, 50, 34);
    assert!((r - ALBEDO[0]).abs() < 2e-4 && (g - ALBEDO[1]).abs() < 2e-4, "{r} {g}");
}

/// Noise in -1..1.
fn noise(x: i32, y: i32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    for _ in 0..3 {
        h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    }
    (h >> 8) as f32 / 8_388_608.0 - 1.0
}

#[test]
fn a_noisy_picture_alone_falls_into_clean_shapes() {
    let photo = picture(|x, y| {
        let r = (x as f32 - 64.0).hypot(y as f32 - 48.0);
        let light = 0.02 + 0.5 / (1.0 + (r / 22.0).powi(6));
        let grain = 1.0 + 0.08 * noise(x, y);
        [light * grain, 0.6 * light * grain, 0.4 * light * grain, 1.0]
    });
    let out = shaded(&[], &[("color", &photo)]);
    // The light falls with the distance from the middle, and so do the steps: along each ray a border is crossed twice.
    let mut borders = 0;
    for y in 0..SIZE[1] {
        for x in 1..SIZE[0] {
            borders += i32::from((at(&out, x, y)[0] - at(&out, x - 1, y)[0]).abs() > 0.03);
        }
    }
    assert!((60..900).contains(&borders), "{borders}");
    let [dark, light] = [at(&out, 2, 2), at(&out, 64, 48)];
    assert!(light[0] > 4.0 * dark[0], "{dark:?} {light:?}");
    // Colours stay.
    assert!(light[0] > light[1] && light[1] > light[2], "{light:?}");
}
