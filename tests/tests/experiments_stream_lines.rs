//! Experiments on stream lines: their drift on a circular field (Figure 2.31), and the Gaussian along them
//! on images that are constant on pixels (2.193).

use isophote::kernels::shared::stream::{Integrator, STRETCH};
use isophote::kernels::smoothing::cabral_leedom;
use isophote::kernels::smoothing::line_integral_convolution::{self, Adapt, Options};
use isophote::nodes::smoothing::line_integral_convolution::options;
use isophote_engine::{Class, Image, PlanBuilder};
use isophote_tests::compare::psnr;
use isophote_tests::pictures::{self, Kind, from_fn};
use isophote_tests::random::Random;
use isophote_tests::run;
use isophote_tests::table::Table;

/// A cone: its grey value is the distance from the centre over 100 pixels, and its tensor field is
/// circular.
fn cone() -> Image {
    from_fn(161, 161, |x, y| {
        let v = (f64::from(x) - 80.0).hypot(f64::from(y) - 80.0) / 100.0;
        let v = v as f32;
        [v, v, v, 1.0]
    })
}

/// Distance outwards that stream lines of `integrator` lead, in pixels, weighted along the line.
fn drift(integrator: &str, radius: f64) -> f64 {
    let params = [("sigma", "8"), ("integrator", integrator), ("adapt", "none"), ("max_angle", "0")];
    let picture = cone();
    let smoothed = run::node("line_integral_convolution", &params, &picture);
    let (mut sum, mut count) = (0.0, 0.0);
    for y in 0..161 {
        for x in 0..161 {
            let r = (f64::from(x) - 80.0).hypot(f64::from(y) - 80.0);
            if (r - radius).abs() < 1.0 {
                sum += 100.0 * f64::from(smoothed.pixel(x, y)[0] - picture.pixel(x, y)[0]);
                count += 1.0;
            }
        }
    }
    sum / count
}

#[test]
fn euler_drifts_outwards_and_runge_kutta_does_not() {
    let mut table = Table::new(
        7,
        "Figure 2.31",
        "Drift outwards on a circular field, pixels, sigma 8",
        &["radius", "Euler", "Runge-Kutta", "two-step", "Cabral-Leedom"],
    );
    for radius in [16.0, 24.0, 36.0, 50.0] {
        let [euler, rk2, two_step, cabral] =
            ["euler", "rk2", "two_step", "cabral_leedom"].map(|i| drift(i, radius));
        let drifts = [euler, rk2, two_step, cabral].map(|drift| format!("{drift:.2}"));
        table.row(&[&[format!("{radius}")], &drifts[..]].concat());
        // Each step of length h leads h^2 / 2r outwards.
        assert!(euler > 0.8 * 8.0 * 0.7 / (2.0 * radius), "Euler drifts");
        assert!(rk2.abs() < 0.1 * euler, "the second order drifts ten times less: {rk2} to {euler}");
        assert!(two_step.abs() < 0.1 * euler, "and so does the two-step method: {two_step} to {euler}");
        assert!(cabral.abs() < euler, "directions of the pixels themselves do not lead outwards: {cabral}");
    }
    table.print();
}

#[test]
fn two_step_lines_are_as_good_as_runge_kuttas_and_stretched_ones_are_not() {
    let picture = pictures::scenery(240, 160);
    let mut random = Random::new(63);
    let noise = from_fn(240, 160, |_, _| {
        let v = random.unit() as f32;
        [v, v, v, 1.0]
    });
    let tensors = run::node("structure_tensor", &[("rho", "1")], &picture);
    let filtered = |picture: &Image, options: &Options| {
        let mut plan = PlanBuilder::new(240, 160).unwrap();
        let color = plan.input("color", 4, Class::Colour);
        let tensor = plan.input("tensor", 4, Class::Field);
        let out = line_integral_convolution::pass(&mut plan, color, tensor, options);
        plan.output("output", out);
        let inputs = [("color", picture.clone()), ("tensor", tensors.clone())];
        run::whole(&plan.finish().unwrap(), &inputs)
    };
    let mut table = Table::new(
        7,
        "§ 6.3",
        "Distance of lines in steps of one pixel from ones in steps of a quarter, dB, sigma 6, and noise that they leave",
        &["largest turn", "not filtered", "Euler", "Runge-Kutta", "two-step", "two-step, stretched"],
    );
    for max_angle in [0.0, 90.0] {
        let usual = Options { max_angle, ..options() };
        let all = [
            Options { integrator: Integrator::Euler, ..usual },
            Options { integrator: Integrator::Midpoint, ..usual },
            usual,
            Options { stretch: STRETCH, ..usual },
        ];
        let exact = Options { integrator: Integrator::Midpoint, step: 0.25, ..usual };
        let [clean, rough] = [&picture, &noise].map(|picture| filtered(picture, &exact));
        let none = psnr(&picture, &clean);
        let near = all.map(|options| psnr(&filtered(&picture, &options), &clean));
        let left = all.map(|options| deviation(&filtered(&noise, &options)) / deviation(&rough));
        let turn = if max_angle > 0.0 { format!("{max_angle} degrees") } else { "any".into() };
        let cells = near.iter().zip(left).map(|(near, left)| format!("{near:.1}, x{left:.2}")).collect();
        table.row(&[vec![turn, format!("{none:.1}")], cells].concat());
        let [euler, rk2, two_step, stretched] = near;
        assert!(two_step > rk2 - 2.5 && two_step > euler + 10.0, "{near:?}");
        assert!(stretched < two_step - 1.5 && left[3] > left[2] + 0.1, "{near:?}, {left:?}");
        // Lines that end at once leave the picture as it is.
        assert!(stretched > none + 4.0, "not filtered {none}, stretched {stretched}");
    }
    table.print();
}

/// Standard deviation of the reds.
fn deviation(image: &Image) -> f64 {
    let reds = || image.data().iter().step_by(4).map(|v| f64::from(*v));
    let count = reds().count() as f64;
    let mean = reds().sum::<f64>() / count;
    (reds().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
}

#[test]
fn long_lines_of_short_steps_weigh_as_the_gaussian() {
    // A bright column that horizontal lines meet: what reaches a pixel is the weight at its distance.
    let sigma = 40.0;
    let picture = from_fn(400, 3, |x, _| if x == 200 { [1.0; 4] } else { [0.0, 0.0, 0.0, 1.0] });
    let tensors = from_fn(400, 3, |_, _| [0.0, 0.0, 1.0, 1.0]);
    let options = Options { sigma, step: 0.25, adapt: Adapt::None, ..options() };
    let mut plan = PlanBuilder::new(400, 3).unwrap();
    let color = plan.input("color", 4, Class::Colour);
    let tensor = plan.input("tensor", 4, Class::Field);
    let out = line_integral_convolution::pass(&mut plan, color, tensor, &options);
    plan.output("output", out);
    let smoothed = run::whole(&plan.finish().unwrap(), &[("color", picture), ("tensor", tensors)]);
    let weight = |distance: i32| f64::from(smoothed.pixel(200 + distance, 1)[0]);
    for distance in [20, 40, 60, 75] {
        let got = weight(distance) / weight(4);
        let want = (f64::from(16 - distance * distance) / (2.0 * f64::from(sigma).powi(2))).exp();
        assert!((got / want - 1.0).abs() < 5e-4, "{got} for {want} at {distance} pixels");
    }
}

/// erf(x) for 0 <= x <= 2 by its Maclaurin series.
fn erf(x: f64) -> f64 {
    let (mut term, mut sum) = (x, x);
    for n in 1..60 {
        term *= -x * x / f64::from(n);
        sum += term / f64::from(2 * n + 1);
    }
    sum * 2.0 / std::f64::consts::PI.sqrt()
}

/// The Gaussian along the straight line through the centre of (x, y) at `angle`, over an image that is
/// constant on pixels, in double precision; cut where the filters cut it.
fn exact(image: &Image, x: i32, y: i32, angle: f64, sigma: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let limit = (2.0 * sigma).floor();
    let (mut sum, mut norm) = (0.0, 0.0);
    for (dx, dy) in [(cos, sin), (-cos, -sin)] {
        let mut cuts = vec![0.0, limit];
        for k in 0..limit as i32 + 1 {
            // Boundaries lie half a pixel and k whole ones from the centre.
            for d in [dx, dy] {
                cuts.push(((f64::from(k) + 0.5) / d.abs().max(1e-9)).min(limit));
            }
        }
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let at = |c: i32, d: f64| (f64::from(c) + 0.5 + d * middle).floor() as i32;
            let bound = |u: f64| erf(u / (sigma * std::f64::consts::SQRT_2));
            let weight = bound(pair[1]) - bound(pair[0]);
            sum += weight * f64::from(image.pixel(at(x, dx), at(y, dy))[0]);
            norm += weight;
        }
    }
    sum / norm
}

#[test]
fn cabral_leedom_integrates_the_gaussian_exactly_on_pixels() {
    const SIDE: u32 = 64;
    let picture = pictures::color(Kind::Noise, SIDE, SIDE);
    let mut table = Table::new(
        7,
        "2.193",
        "Largest error of the Gaussian along straight lines over noise constant on pixels, sigma 5",
        &["angle, degrees", "Runge-Kutta, step 1", "Cabral-Leedom"],
    );
    for degrees in [0.0f64, 11.0, 30.0, 45.0, 73.0, 90.0, 128.0] {
        let angle = degrees.to_radians();
        let (sin, cos) = angle.sin_cos();
        let tensors = from_fn(SIDE, SIDE, |_, _| [sin * sin, -sin * cos, cos * cos, 1.0].map(|v| v as f32));
        let options = Options {
            sigma: 5.0,
            stretch: 1.0,
            integrator: Integrator::Midpoint,
            adapt: Adapt::None,
            ..options()
        };
        let filtered = |exactly: bool| {
            let mut plan = PlanBuilder::new(SIDE, SIDE).unwrap();
            let color = plan.input("color", 4, Class::Colour);
            let tensor = plan.input("tensor", 4, Class::Field);
            let out = if exactly {
                cabral_leedom::pass(&mut plan, color, tensor, &options)
            } else {
                line_integral_convolution::pass(&mut plan, color, tensor, &options)
            };
            plan.output("output", out);
            let inputs = [("color", picture.clone()), ("tensor", tensors.clone())];
            run::whole(&plan.finish().unwrap(), &inputs)
        };
        let worst = |image: &Image| {
            let mut worst = 0.0f64;
            for y in 12..SIDE as i32 - 12 {
                for x in 12..SIDE as i32 - 12 {
                    let error = f64::from(image.pixel(x, y)[0]) - exact(&picture, x, y, angle, 5.0);
                    worst = worst.max(error.abs());
                }
            }
            worst
        };
        let (sampled, integrated) = (worst(&filtered(false)), worst(&filtered(true)));
        assert!(integrated < 1e-4, "{degrees} degrees: {integrated:e}");
        assert!(sampled > 10.0 * integrated, "samples are not the integral: {sampled:e}, {integrated:e}");
        table.row(&[format!("{degrees}"), format!("{sampled:.3}"), "below 1e-4".into()]);
    }
    table.print();
}
