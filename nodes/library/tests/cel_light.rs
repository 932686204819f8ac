//! Steps of light in `cartoon` on the CPU executor: what they multiply, what stays, and lines, which know nothing of them.

use crate::result::{self, Inputs};
use isophote::ColourSpace;
use isophote::engine::Image;

const SIZE: [i32; 2] = [96, 64];
const ALBEDO: [f32; 3] = [0.5, 0.25, 0.1];
const SKY: [f32; 4] = [0.3, 0.5, 0.9, 1.0];

/// Grey steps, with nothing smoothed, and lines that are not seen.
const GREYS: [(&str, &str); 8] = [
    ("shading", "light"),
    ("light_steps", "3"),
    ("shadow_color", "#000000"),
    ("middle_color", "#808080"),
    ("light_color", "#ffffff"),
    ("line_color", "#00000000"),
    ("n_a", "0"),
    ("sigma_a", "0"),
];

fn cartoon(settings: &[(&str, &str)], inputs: Inputs<'_>) -> Image {
    result::of("cartoon", settings, ColourSpace::Linear, inputs)
}

/// A wall whose light grows from the left to the right, below a sky.
struct Wall {
    color: Image,
    albedo: Image,
    diffuse: Image,
    specular: Image,
}

fn light(x: i32) -> f32 {
    1.2 * (x as f32 + 0.5) / SIZE[0] as f32
}

fn wall() -> Wall {
    let below = |nothing: [f32; 4], value: &dyn Fn(i32) -> [f32; 3]| {
        result::picture(SIZE, |x, y| {
            let [r, g, b] = value(x);
            if y < 20 { nothing } else { [r, g, b, 1.0] }
        })
    };
    let lit = |x: i32| ALBEDO.map(|v| v * light(x));
    Wall {
        color: below(SKY, &lit),
        albedo: below([0.0; 4], &|_| ALBEDO),
        diffuse: below([0.0; 4], &lit),
        specular: below([0.0; 4], &|_| [0.0; 3]),
    }
}

impl Wall {
    fn all(&self) -> [(&'static str, &Image); 4] {
        let Self { color, albedo, diffuse, specular } = self;
        [("color", color), ("albedo", albedo), ("diffuse", diffuse), ("specular", specular)]
    }
}

/// CIELAB lightness over 100 of a luminance.
fn lightness(y: f32) -> f32 {
    let f = if y > 0.008_856 { y.cbrt() } else { 7.787_037 * y + 16.0 / 116.0 };
    1.16 * f - 0.16
}

fn expect(out: &Image, x: i32, y: i32, wanted: [f32; 3]) {
    for (found, wanted) in out.pixel(x, y).iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-3, "{found} for {wanted} at {x}, {y}");
    }
}

#[test]
fn light_is_painted_in_steps_on_surfaces_and_the_sky_stays() {
    let wall = wall();
    for (count, borders) in [("3", &[0.55, 0.88][..]), ("2", &[0.7])] {
        let settings = [&GREYS[..], &[("light_steps", count)]].concat();
        for inputs in [&wall.all()[..], &wall.all()[..2]] {
            let out = cartoon(&settings, inputs);
            for x in 0..SIZE[0] {
                let l = lightness(light(x));
                if borders.iter().any(|border| (l - border).abs() < 0.03) {
                    continue;
                }
                let tones = if borders.len() == 2 { &[0.0, 0.215_86, 1.0][..] } else { &[0.0, 1.0] };
                let tone = tones[borders.iter().filter(|border| l > **border).count()];
                expect(&out, x, 45, ALBEDO.map(|v| v * tone));
                expect(&out, x, 6, [SKY[0], SKY[1], SKY[2]]);
            }
        }
    }
}

#[test]
fn more_light_moves_shadows_back() {
    let wall = wall();
    let dark = |exposure: &str| {
        let settings = [&GREYS[..], &[("exposure", exposure)]].concat();
        let out = cartoon(&settings, &wall.all());
        (0..SIZE[0]).filter(|x| out.pixel(*x, 45)[0] < 0.01).count()
    };
    let [dim, plain, bright] = [dark("-1"), dark("0"), dark("1")];
    assert!(dim > plain && plain > bright && bright > 2, "{dim} {plain} {bright}");
}

#[test]
fn a_picture_alone_has_its_lightness_for_light() {
    let wall = wall();
    let out = cartoon(&GREYS, &wall.all()[..1]);
    let tones: Vec<f32> = [2, 40, 90].map(|x| out.pixel(x, 45)[0]).to_vec();
    assert!(tones[0] < 0.01 && tones[1] > tones[0] + 0.01 && tones[2] > tones[1] + 0.05, "{tones:?}");
}

#[test]
fn layers_change_nothing_until_light_is_chosen_and_lines_never() {
    let wall = wall();
    let [all, alone] = [&wall.all()[..], &wall.all()[..1]].map(|inputs| cartoon(&[], inputs));
    assert_eq!(all.data(), alone.data());
    let [lightness, light] = ["lightness", "light"].map(|shading| {
        let settings = [("shading", shading), ("show", "lines"), ("sigma_a", "0"), ("line_amount", "1")];
        cartoon(&settings, &wall.all())
    });
    let lines = lightness.data().chunks_exact(4).filter(|pixel| pixel[3] > 0.5).count();
    assert!(lines > 50, "{lines} pixels of lines");
    for (a, b) in lightness.data().chunks_exact(4).zip(light.data().chunks_exact(4)) {
        assert!((a[3] - b[3]).abs() < 1e-5, "{a:?} {b:?}");
    }
}
