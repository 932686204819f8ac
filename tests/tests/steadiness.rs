//! The yardstick of steadiness, on sequences whose numbers are known in advance.

use isophote_engine::Image;
use isophote_tests::pictures::from_fn;
use isophote_tests::random::Random;
use isophote_tests::run;
use isophote_tests::steadiness::{Entry, Frame, Shot, carried, measure, table};

const SIZE: (u32, u32) = (72, 48);
const COUNT: usize = 4;

/// A value of its own for every whole place.
fn texture(x: i32, y: i32) -> f32 {
    Random::new(u64::from(x.wrapping_add(1 << 20) as u32) << 32 | u64::from(y.wrapping_add(1 << 20) as u32))
        .unit() as f32
}

/// Surface seen at a pixel: a value of a texture, motion, depth and number.
struct Seen {
    value: f32,
    motion: [f32; 2],
    depth: f32,
    id: f32,
}

fn shot(seen: impl Fn(i32, i32, i32) -> Seen) -> Shot {
    let (w, h) = SIZE;
    let frame = |t: i32| Frame {
        color: from_fn(w, h, |x, y| [seen(t, x, y).value, 0.5 * seen(t, x, y).value, 0.3, 1.0]),
        motion: from_fn(w, h, |x, y| seen(t, x, y).motion),
        motion_forward: from_fn(w, h, |x, y| seen(t, x, y).motion.map(|way| -way)),
        depth: from_fn(w, h, |x, y| [seen(t, x, y).depth]),
        object_id: from_fn(w, h, |x, y| [seen(t, x, y).id]),
        normal: from_fn(w, h, |_, _| [0.0, 0.0, 1.0, 1.0]),
        rest: from_fn(w, h, |_, _| [0.0; 4]),
    };
    Shot { name: "synthetic".into(), frames: (0..COUNT as i32).map(frame).collect(), is_static: false }
}

/// Everything moves by (3, -2) pixels a frame.
fn panning() -> Shot {
    shot(|t, x, y| Seen { value: texture(x - 3 * t, y + 2 * t), motion: [-3.0, 2.0], depth: 2.0, id: 1.0 })
}

/// A square goes to the right by 4 pixels a frame before a wall at rest.
fn passing() -> Shot {
    shot(|t, x, y| {
        let left = 10 + 4 * t;
        match (left..left + 16).contains(&x) && (12..28).contains(&y) {
            true => Seen { value: texture(x - left, y), motion: [-4.0, 0.0], depth: 1.0, id: 2.0 },
            false => Seen { value: texture(x, y), motion: [0.0, 0.0], depth: 2.0, id: 1.0 },
        }
    })
}

fn error(shot: &Shot) -> f64 {
    measure(shot, &shot.plain(), &shot.plain()).error
}

fn with_motion(mut shot: Shot, change: impl Fn(&mut [f32])) -> Shot {
    for frame in &mut shot.frames {
        frame.motion.data_mut().chunks_exact_mut(2).for_each(&change);
    }
    shot
}

#[test]
fn what_is_carried_exactly_has_no_error() {
    let found = measure(&panning(), &panning().plain(), &panning().plain());
    assert_eq!(found.error, 0.0);
    // A pixel counts unless it came in at the left or the bottom.
    let expected = f64::from((SIZE.0 - 3) * (SIZE.1 - 2)) / f64::from(SIZE.0 * SIZE.1);
    assert!((found.counted - expected).abs() < 1e-9, "{} for {expected}", found.counted);
    assert_eq!((found.energy_of_plain, found.energy_of_still), (1.0, 1.0));
}

#[test]
fn motion_that_is_wrong_by_a_pixel_or_points_the_other_way_is_an_error() {
    // Two independent uniform values differ by a third in the mean; blue is constant, and green half of red.
    let expected = (1.0 + 0.5) / 3.0 / 3.0;
    let changes: [fn(&mut [f32]); 4] = [|m| m[0] += 1.0, |m| m[1] -= 1.0, |m| m[0] = -m[0], |m| m[1] = -m[1]];
    for change in changes {
        let found = error(&with_motion(panning(), change));
        assert!((found / expected - 1.0).abs() < 0.1, "{found} for {expected}");
    }
    let found = error(&with_motion(panning(), |m| m[0] += 0.25));
    assert!(
        found > 0.1 * expected && found < 0.9 * expected,
        "a part of a pixel is a smaller error: {found}"
    );
}

#[test]
fn what_was_covered_does_not_count() {
    assert_eq!(error(&passing()), 0.0);
    let visible = |shot: &Shot| carried(shot, 1, &shot.frames[0].color).iter().filter(|c| c.counts).count();
    // The wall that the square left behind.
    assert_eq!(visible(&passing()), (SIZE.0 * SIZE.1 - 4 * 16) as usize);
    let flatten = |mut shot: Shot, depth: bool, id: bool| {
        for frame in &mut shot.frames {
            if depth {
                frame.depth.data_mut().fill(2.0);
            }
            if id {
                frame.object_id.data_mut().fill(1.0);
            }
        }
        shot
    };
    assert_eq!(error(&flatten(passing(), true, false)), 0.0, "the number alone tells");
    assert_eq!(error(&flatten(passing(), false, true)), 0.0, "the depth alone tells");
    assert!(error(&flatten(passing(), true, true)) > 0.0, "without either the error shows");
}

#[test]
fn what_shows_no_object_does_not_count() {
    let mut shot = panning();
    for frame in &mut shot.frames {
        frame.object_id.data_mut().fill(0.0);
    }
    assert!(carried(&shot, 1, &shot.frames[0].color).iter().all(|c| !c.counts));
    shot.is_static = true;
    assert!(carried(&shot, 1, &shot.frames[0].color).iter().any(|c| c.counts), "unless nothing moves");
}

#[test]
fn noise_has_the_error_of_noise_and_blur_lowers_it_and_the_energy() {
    let shot = Shot::noisy(&panning().frames[0], 6, 0.01);
    let plain = shot.plain();
    let found = measure(&shot, &plain, &plain);
    // The mean of |difference of two normal values|.
    let expected = 0.01 * 2.0 / std::f64::consts::PI.sqrt();
    assert!((found.error / expected - 1.0).abs() < 0.02, "{} for {expected}", found.error);
    assert_eq!((found.ratio, found.counted), (1.0, 1.0));
    let blurred: Vec<Image> = plain.iter().map(|p| run::node("gaussian", &[("sigma", "2")], p)).collect();
    let found = measure(&shot, &blurred, &plain);
    // A Gaussian's noise gain is 1 / (2 sigma sqrt(pi)).
    let gain = 0.5 / (2.0 * std::f64::consts::PI.sqrt());
    assert!((found.ratio / gain - 1.0).abs() < 0.1, "{} for {gain}", found.ratio);
    assert!(found.energy_of_plain < 0.2 && found.energy_of_still < 0.2, "{found:?}");
}

#[test]
fn a_table_compares_with_the_entries_that_it_is_told() {
    let shot = Shot::noisy(&panning().frames[0], 3, 0.01);
    let mean = |upto: usize| {
        let mut mean = shot.frames[0].color.clone();
        for (i, v) in mean.data_mut().iter_mut().enumerate() {
            *v = shot.frames[..=upto].iter().map(|f| f.color.data()[i]).sum::<f32>() / (upto + 1) as f32;
        }
        mean
    };
    let rows = table(
        &shot,
        vec![
            Entry::new("still", |t| shot.frames[t].color.clone()),
            Entry::new("steady", mean).against("still"),
        ],
    );
    assert_eq!(rows[0].name, "still");
    assert_eq!((rows[0].steadiness.ratio, rows[0].steadiness.energy_of_still), (1.0, 1.0));
    let steady = rows[1].steadiness;
    assert!(steady.ratio < 0.6, "a mean over frames is steadier: {steady:?}");
    assert!((steady.energy_of_still - steady.energy_of_plain).abs() < 1e-9, "{steady:?}");
    assert!((steady.energy_of_still - 1.0).abs() < 0.05, "and as sharp where nothing moves: {steady:?}");
}
