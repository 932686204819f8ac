//! Optical flow against motions that are known: pictures moved, turned and zoomed by a formula, brightness that
//! changes, pictures without texture, and parts against the whole.

use isophote::choice::Numbered;
use isophote::optical_flow::{self, Quality};
use isophote_engine::cpu::{CallingThread, CpuExecutor};
use isophote_engine::{Class, Image, Plan, PlanBuilder, Rect, Support};
use isophote_tests::pictures::{self, Kind, from_fn};
use isophote_tests::random::Random;
use isophote_tests::run;

const SIZE: [u32; 2] = [200, 140];

fn plan(size: [u32; 2], quality: Quality, reach: f32) -> Plan {
    let mut plan = PlanBuilder::new(size[0], size[1]).unwrap();
    let pictures = ["here", "there"].map(|name| plan.input(name, 4, Class::Colour));
    let motion = optical_flow::estimate(&mut plan, pictures, quality, reach);
    plan.output("motion", motion);
    plan.finish().unwrap()
}

/// The motion from `here` to `there`, at most a quarter of the picture.
fn motion(here: &Image, there: &Image, quality: Quality) -> Image {
    let size = [here.width(), here.height()];
    let plan = plan(size, quality, size[0].max(size[1]) as f32 / 4.0);
    run::whole(&plan, &[("here", here.clone()), ("there", there.clone())])
}

/// A smooth random texture, without a period, at any place.
struct Texture {
    waves: Vec<[f32; 4]>,
}

impl Texture {
    fn new() -> Self {
        let mut random = Random::new(9);
        let wave = |random: &mut Random| {
            let (length, angle) = (random.range(5.0, 60.0), random.range(0.0, std::f32::consts::TAU));
            let k = std::f32::consts::TAU / length;
            [k * angle.cos(), k * angle.sin(), random.range(0.0, 6.0), 0.01 * length.sqrt()]
        };
        Self { waves: (0..60).map(|_| wave(&mut random)).collect() }
    }

    fn at(&self, x: f32, y: f32) -> f32 {
        0.5 + self
            .waves
            .iter()
            .map(|[kx, ky, phase, size]| size * (kx * x + ky * y + phase).sin())
            .sum::<f32>()
    }

    /// A picture of what lies at `place` of each pixel.
    fn picture(&self, place: impl Fn([f32; 2]) -> [f32; 2]) -> Image {
        from_fn(SIZE[0], SIZE[1], |x, y| {
            let [u, v] = place([x as f32, y as f32]);
            let value = self.at(u, v);
            [value, value, value, 1.0]
        })
    }
}

/// Mean and greatest length of the difference to a true motion, `margin` pixels away from the border.
fn errors(found: &Image, truth: impl Fn([f32; 2]) -> [f32; 2], margin: i32) -> [f32; 2] {
    let (mut sum, mut most, mut count) = (0.0, 0.0f32, 0.0);
    for y in margin..found.height() as i32 - margin {
        for x in margin..found.width() as i32 - margin {
            let (got, want) = (found.pixel(x, y), truth([x as f32, y as f32]));
            let error = (got[0] - want[0]).hypot(got[1] - want[1]);
            sum += error;
            most = most.max(error);
            count += 1.0;
        }
    }
    [sum / count, most]
}

/// A point turned by `angle` and scaled by `scale` about the picture's middle, then moved.
fn transformed([x, y]: [f32; 2], angle: f32, scale: f32, [dx, dy]: [f32; 2]) -> [f32; 2] {
    let (cx, cy) = (SIZE[0] as f32 / 2.0, SIZE[1] as f32 / 2.0);
    let (sin, cos) = angle.sin_cos();
    let (x, y) = (scale * (x - cx), scale * (y - cy));
    [cx + cos * x - sin * y + dx, cy + sin * x + cos * y + dy]
}

#[test]
fn known_motions_are_found_to_a_fraction_of_a_pixel() {
    let texture = Texture::new();
    let there = texture.picture(|p| p);
    // What moves, angle, scale, motion; most that the mean and the greatest error may be, away from the border,
    // beyond which part of the picture has gone.
    let cases = [
        ("little", 0.0, 1.0, [0.3, -0.2], [0.08, 0.2]),
        ("some", 0.0, 1.0, [3.4, 1.7], [0.08, 0.2]),
        ("far", 0.0, 1.0, [-17.6, 9.3], [0.08, 0.9]),
        ("turned", 0.08, 1.0, [0.0, 0.0], [0.14, 0.9]),
        ("zoomed", 0.0, 1.08, [0.0, 0.0], [0.14, 0.9]),
        ("all of it", -0.05, 0.95, [4.0, -3.0], [0.14, 0.9]),
    ];
    for (what, angle, scale, by, [mean_limit, limit]) in cases {
        let place = |p| transformed(p, angle, scale, by);
        let here = texture.picture(place);
        let truth = |p: [f32; 2]| [place(p)[0] - p[0], place(p)[1] - p[1]];
        for quality in Quality::ALL {
            let [mean, most] = errors(&motion(&here, &there, *quality), truth, 24);
            println!("{what}, {quality:?}: mean {mean:.4}, greatest {most:.3}");
            assert!(mean < mean_limit && most < limit, "{what}, {quality:?}: mean {mean}, greatest {most}");
        }
    }
}

#[test]
fn brightness_may_change() {
    let texture = Texture::new();
    let there = texture.picture(|p| p);
    let mut here = texture.picture(|[x, y]| [x + 5.0, y - 2.0]);
    for value in here.data_mut().chunks_exact_mut(4) {
        value[..3].iter_mut().for_each(|v| *v = 0.95 * *v + 0.06);
    }
    let [mean, most] = errors(&motion(&here, &there, Quality::Medium), |_| [5.0, -2.0], 24);
    assert!(mean < 0.1 && most < 0.6, "mean {mean}, greatest {most}");
}

#[test]
fn what_does_not_move_stays() {
    for kind in [Kind::Noise, Kind::Steps, Kind::CutOut] {
        let picture = pictures::color(kind, 131, 87);
        for quality in Quality::ALL {
            let found = motion(&picture, &picture, *quality);
            let most = found.data().iter().fold(0.0f32, |m, v| m.max(v.abs()));
            assert!(most < 1e-3, "{kind:?}, {quality:?}: {most}");
        }
    }
}

#[test]
fn static_noise_does_not_shake() {
    let mut random = Random::new(5);
    let scenery = pictures::scenery(240, 180);
    let mut noisy = || {
        let mut image = scenery.clone();
        for pixel in image.data_mut().chunks_exact_mut(4) {
            pixel[..3].iter_mut().for_each(|v| *v += 0.01 * random.normal() as f32);
        }
        image
    };
    let (here, there) = (noisy(), noisy());
    let [mean, most] = errors(&motion(&here, &there, Quality::Medium), |_| [0.0; 2], 0);
    assert!(mean < 0.15 && most < 1.5, "mean {mean}, greatest {most}");
}

#[test]
fn pictures_without_texture_rest() {
    let grey = |v: f32| from_fn(90, 50, |_, _| [v, v, v, 1.0]);
    let empty = from_fn(90, 50, |_, _| [0.0; 4]);
    for (here, there) in [(grey(0.4), grey(0.4)), (grey(0.4), grey(0.6)), (empty.clone(), empty)] {
        let found = motion(&here, &there, Quality::Medium);
        assert!(found.data().iter().all(|v| v.abs() < 1e-4));
    }
}

#[test]
fn a_square_moves_over_a_plain_ground_that_stays() {
    let texture = Texture::new();
    let square = |at: i32| {
        from_fn(160, 120, |x, y| {
            let inside = (at..at + 40).contains(&x) && (40..80).contains(&y);
            let v = if inside { texture.at((x - at) as f32, y as f32) } else { 0.3 };
            [v, v, v, 1.0]
        })
    };
    let found = motion(&square(50), &square(59), Quality::Medium);
    for y in 50..70 {
        for x in 60..80 {
            let p = found.pixel(x, y);
            assert!((p[0] - 9.0).abs() < 0.3 && p[1].abs() < 0.3, "{p:?} at {x}, {y}");
        }
    }
    for (x, y) in [(10, 10), (150, 10), (10, 110), (150, 110), (12, 60)] {
        let p = found.pixel(x, y);
        assert!(p[0].hypot(p[1]) < 0.5, "{p:?} at {x}, {y}");
    }
}

#[test]
fn nothing_is_ever_not_finite_or_farther_than_the_reach() {
    for size in [[1, 1], [2, 9], [7, 5], [67, 43]] {
        for kind in [Kind::Noise, Kind::Hdr, Kind::CutOut] {
            let here = pictures::color(kind, size[0], size[1]);
            let there = pictures::moved(&pictures::color(Kind::Noise, size[0], size[1]), [5, 3]);
            for quality in Quality::ALL {
                let inputs = [("here", here.clone()), ("there", there.clone())];
                let found = run::whole(&plan(size, *quality, 6.0), &inputs);
                // The refinement may go a little beyond what the search has found.
                assert!(found.data().iter().all(|v| v.abs() < 12.0), "{kind:?} {quality:?} {size:?}");
            }
        }
    }
}

#[test]
fn a_part_is_the_same_part_of_the_whole() {
    let [w, h] = [330, 290];
    let here = pictures::scenery(w, h);
    let there = pictures::moved(&here, [4, -3]);
    let plan = plan([w, h], Quality::Medium, 8.0);
    assert!(matches!(plan.support(), Support::Pixels(_)));
    let inputs = [("here", here), ("there", there)];
    let whole = run::whole(&plan, &inputs);
    for part in [Rect { x0: 0, y0: 0, x1: 60, y1: 40 }, Rect { x0: 131, y0: 77, x1: 194, y1: 143 }] {
        for strip in [None, Some(8)] {
            let mut executor = CpuExecutor::new();
            executor.set_strip(strip);
            let got = run::region(&mut executor, &plan, &inputs, part, &CallingThread);
            assert!(got == whole.crop(part).unwrap(), "{part:?} in strips of {strip:?}");
        }
    }
}
