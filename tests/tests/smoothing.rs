//! Promises of diffusion, mean curvature flow and morphology: the maximum principle, the law by which
//! discs shrink, the algebra of openings and closings.

use isophote_engine::Image;
use isophote_tests::compare::distance;
use isophote_tests::pictures::{self, Kind, from_fn};
use isophote_tests::run;

/// Least and greatest colour.
fn range(image: &Image) -> [f32; 2] {
    let colors = image.data().chunks_exact(4).flat_map(|p| &p[..3]);
    colors.fold([f32::MAX, f32::MIN], |[low, high], v| [low.min(*v), high.max(*v)])
}

#[test]
fn diffusion_and_curvature_flow_stay_within_the_range_of_the_picture() {
    let settings: [(&str, &[(&str, &str)]); 6] = [
        ("anisotropic_diffusion", &[("time_step", "0.25"), ("contrast", "100")]),
        ("anisotropic_diffusion", &[("time_step", "0.25"), ("diffusivity", "exponential")]),
        ("anisotropic_diffusion", &[("time_step", "0.25"), ("scheme", "edge_enhancing")]),
        ("anisotropic_diffusion", &[("time_step", "0.25"), ("scheme", "coherence_enhancing")]),
        ("mean_curvature_flow", &[("time_step", "0.25")]),
        ("mean_curvature_flow", &[("time_step", "0.25"), ("constraint", "1"), ("shock_every", "2")]),
    ];
    for kind in [Kind::Noise, Kind::Steps] {
        let picture = pictures::color(kind, 67, 43);
        let [low, high] = range(&picture);
        for (node, params) in settings {
            let [least, greatest] = range(&run::node(node, params, &picture));
            assert!(least > low - 1e-5 && greatest < high + 1e-5, "{node} {params:?}: {least} to {greatest}");
        }
    }
}

/// Pixels in a disc of light, as far as they are light.
fn area(image: &Image) -> f64 {
    image.data().chunks_exact(4).map(|p| f64::from(((p[0] - 0.2) / 0.6).clamp(0.0, 1.0))).sum()
}

#[test]
fn discs_shrink_by_the_law_of_mean_curvature() {
    // A circle under curvature flow loses 2 pi of area per unit of time, whatever its radius.
    for radius in [12.0f32, 20.0] {
        let disc = from_fn(64, 64, |x, y| {
            let d = radius - (x as f32 - 31.5).hypot(y as f32 - 31.5);
            let v = 0.5 + 0.3 * (d / 2.0).tanh();
            [v, v, v, 1.0]
        });
        let flow = |iterations: &str| run::node("mean_curvature_flow", &[("iterations", iterations)], &disc);
        let (early, late) = (area(&flow("10")), area(&flow("50")));
        let lost = early - late;
        let expected = std::f64::consts::TAU * 40.0 * 0.25;
        println!(
            "radius {radius}: {early:.1} to {late:.1}, {:.2} of the area that the law takes",
            lost / expected
        );
        assert!((lost / expected - 1.0).abs() < 0.25);
    }
}

#[test]
fn the_constraint_protects_what_follows_the_orientation_and_slows_the_rest() {
    let picture = pictures::scenery(120, 90);
    let by = |constraint: &str| run::node("mean_curvature_flow", &[("constraint", constraint)], &picture);
    let change = |image: &Image| {
        image.data().iter().zip(picture.data()).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>()
    };
    let (free, half, full) = (change(&by("0")), change(&by("0.5")), change(&by("1")));
    assert!(full < half && half < free, "{free} {half} {full}");
}

/// One minus the picture.
fn inverted(image: &Image) -> Image {
    from_fn(image.width(), image.height(), |x, y| {
        let p = image.pixel(x, y);
        [1.0 - p[0], 1.0 - p[1], 1.0 - p[2], p[3]]
    })
}

#[test]
fn openings_and_closings_are_idempotent_and_dual() {
    let picture = pictures::scenery(97, 71);
    for radius in ["0", "1", "3", "4.6"] {
        let by = |operator: &str, image: &Image| {
            run::node("morphology", &[("operator", operator), ("radius", radius)], image)
        };
        for (operator, dual) in [("open", "close"), ("open_close", "close_open"), ("dilate", "erode")] {
            let once = by(operator, &picture);
            let around = inverted(&by(dual, &inverted(&picture)));
            assert!(distance(&once, &around).0 < 1e-5, "{operator} at {radius}");
            if operator != "dilate" {
                // Up to the encoding on the way in and out.
                let twice = by(operator, &once);
                assert!(distance(&once, &twice).0 < 1e-5, "{operator} at {radius} is not idempotent");
            }
        }
        let (opened, closed) = (by("open", &picture), by("close", &picture));
        for ((o, p), c) in opened.data().iter().zip(picture.data()).zip(closed.data()) {
            assert!(*o < p + 1e-5 && *c > p - 1e-5);
        }
    }
}

#[test]
fn a_dilation_takes_the_greatest_value_of_a_disc() {
    let picture = pictures::color(Kind::Noise, 41, 29);
    let dilated = run::node("morphology", &[("operator", "dilate"), ("radius", "3")], &picture);
    for (x, y) in [(0, 0), (20, 14), (40, 28), (3, 25)] {
        let mut most = 0.0f32;
        for dy in -3i32..=3 {
            for dx in -3i32..=3 {
                if dx * dx + dy * dy <= 12 {
                    most = most.max(picture.pixel((x + dx).clamp(0, 40), (y + dy).clamp(0, 28))[1]);
                }
            }
        }
        assert!((dilated.pixel(x, y)[1] - most).abs() < 1e-5, "at {x}, {y}");
    }
}
