//! Experiments on derivative operators and the eigen solver: Figure 2.7 (angular error and rotation
//! invariance on zone plates) and § 2.3.4.

use isophote::kernels::tensor_algebra::{self, scalar};
use isophote_engine::Image;
use isophote_engine::fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*};
use isophote_tests::pictures::from_fn;
use isophote_tests::random::Random;
use isophote_tests::run;

const OPERATORS: [&str; 4] = ["central", "sobel", "scharr3", "scharr5"];

/// Radius of a zone plate, where its frequency is 0.9 of Nyquist's, or 0 for the inverted one.
const RADIUS: f64 = 120.0;
const SIDE: u32 = 512;

/// Figure 2.7: a zone plate and an inverted one, side by side; noise of this variance on top.
fn zone_plates(variance: f64) -> Image {
    let mut random = Random::new(27);
    from_fn(SIDE, SIDE / 2, |x, y| {
        let (_, [dx, dy]) = place(x, y);
        let r = dx.hypot(dy);
        let top = 0.9 * std::f64::consts::PI;
        let phase = if x < SIDE as i32 / 2 {
            top * r * r / (2.0 * RADIUS)
        } else {
            top * (r - r * r / (2.0 * RADIUS))
        };
        let noise = if variance > 0.0 { variance.sqrt() * random.normal() } else { 0.0 };
        let value = (0.5 + 0.5 * phase.cos() + noise) as f32;
        [value, value, value, 1.0]
    })
}

/// Which plate a pixel is of, and where it lies from that plate's centre.
fn place(x: i32, y: i32) -> (usize, [f64; 2]) {
    let plate = usize::from(x >= SIDE as i32 / 2);
    let half = f64::from(SIDE) / 4.0;
    let left = plate as f64 * 2.0 * half;
    (plate, [f64::from(x) + 0.5 - left - half, f64::from(y) + 0.5 - half])
}

/// Angular errors in degrees of all pixels well inside the plates, with the angle of the gradient in
/// degrees, 0..90.
fn errors(picture: &Image, params: &[(&str, &str)]) -> Vec<(f64, f64)> {
    let tensor = run::node("structure_tensor", params, picture);
    let mut errors = Vec::new();
    for y in 0..SIDE as i32 / 2 {
        for x in 0..SIDE as i32 {
            let (_, [dx, dy]) = place(x, y);
            let r = dx.hypot(dy);
            if !(12.0..RADIUS - 6.0).contains(&r) {
                continue;
            }
            let t = tensor.pixel(x, y);
            let (.., [vx, vy]) = scalar::eigen(t[0], t[1], t[2]);
            let cross = (f64::from(vx) * dy - f64::from(vy) * dx).abs() / r;
            errors.push((cross.min(1.0).asin().to_degrees(), (dy / dx).abs().atan().to_degrees()));
        }
    }
    errors
}

fn mean(errors: &[(f64, f64)]) -> f64 {
    errors.iter().map(|(e, _)| e).sum::<f64>() / errors.len() as f64
}

#[test]
fn optimized_operators_err_less_and_smoothing_repairs_noise() {
    let (clean, noisy) = (zone_plates(0.0), zone_plates(0.001));
    println!("mean angular error   clean   noisy   noisy, rho 2");
    let mut table = Vec::new();
    for operator in OPERATORS {
        let by = |picture: &Image, rho: &str| {
            mean(&errors(picture, &[("derivative", operator), ("rho", rho), ("space", "luminance")]))
        };
        let row = [by(&clean, "0"), by(&noisy, "0"), by(&noisy, "2")];
        println!("{operator:20} {:6.3}  {:6.3}  {:6.3}", row[0], row[1], row[2]);
        table.push(row);
    }
    for pair in table.windows(2) {
        assert!(pair[0][0] > 1.2 * pair[1][0], "without noise each operator beats the one before it");
    }
    for [clean, noisy, smoothed] in table {
        assert!(noisy > clean + 2.0, "all suffer from noise");
        assert!(smoothed < clean + 0.25, "the smoothed tensor repairs it");
    }
}

#[test]
fn scharr_is_more_rotation_invariant_than_sobel_at_every_angle() {
    let clean = zone_plates(0.0);
    let binned = |operator: &str| {
        let mut bins = [(0.0, 0.0); 18];
        for (error, angle) in
            errors(&clean, &[("derivative", operator), ("rho", "0"), ("space", "luminance")])
        {
            let bin = &mut bins[((angle / 5.0) as usize).min(17)];
            *bin = (bin.0 + error, bin.1 + 1.0);
        }
        bins.map(|(sum, count)| sum / count)
    };
    let all = OPERATORS.map(binned);
    println!("angle   {}", OPERATORS.map(|o| format!("{o:>8}")).join(" "));
    for bin in 0..18usize {
        let row: Vec<String> = all.iter().map(|o| format!("{:8.3}", o[bin])).collect();
        println!("{:2}..{:2}  {}", 5 * bin, 5 * bin + 5, row.join(" "));
    }
    let [_, sobel, scharr3, scharr5] = &all;
    for (bin, limit) in sobel.iter().enumerate() {
        assert!(scharr3[bin] < *limit, "scharr3 at {} degrees", 5 * bin);
        assert!(scharr5[bin] < *limit, "scharr5 at {} degrees", 5 * bin);
    }
    let spread =
        |o: &[f64; 18]| o.iter().fold(0.0f64, |m, v| m.max(*v)) - o.iter().fold(f64::MAX, |m, v| m.min(*v));
    assert!(spread(scharr3) < 0.5 * spread(sobel), "the error depends less on the angle");
}

/// Eigenvalues and angle of the major eigenvector, in double precision.
fn exact(e: f64, f: f64, g: f64) -> (f64, f64, f64) {
    let (b, d) = (0.5 * (e + g), 0.5 * (e - g));
    let r = d.hypot(f);
    let lambda1 = b + r;
    ((lambda1), ((e * g - f * f).max(0.0) / lambda1), 0.5 * f.atan2(d))
}

/// The vectors' way, one tensor in all lanes.
fn on_lanes([e, f, g]: [f32; 3]) -> (f32, f32, [f32; 2]) {
    #[inline(always)]
    fn lanes<S: Simd>(simd: S, [e, f, g]: [f32; 3]) -> (f32, f32, [f32; 2]) {
        let c = |v: f32| f32x8::splat(simd, v);
        let eigen = tensor_algebra::eigen(c(e), c(f), c(g));
        (eigen.lambda1[5], eigen.lambda2[5], [eigen.major[0][5], eigen.major[1][5]])
    }
    dispatch!(Level::new(), simd => lanes(simd, [e, f, g]))
}

#[test]
fn the_eigen_solver_is_as_exact_as_its_numbers_allow() {
    let epsilon = f64::from(f32::EPSILON);
    let mut random = Random::new(234);
    println!(
        "condition   lambda1   lambda2   lambda2 by B - R   angle   (worst errors in units of the last place)"
    );
    for exponent in 0..=7 {
        let condition = 10f64.powi(exponent);
        let mut worst = [0.0f64; 4];
        for _ in 0..20_000 {
            // Some lie along an axis nearly exactly, where the determinant loses nothing.
            let angle = if random.below(2) == 0 {
                random.unit() * std::f64::consts::PI
            } else {
                random.normal() / condition.sqrt() + 0.5 * std::f64::consts::PI * random.below(2) as f64
            };
            let (sin, cos) = angle.sin_cos();
            let lambda1 = 10f64.powf(24.0 * random.unit() - 12.0);
            let lambda2 = lambda1 / condition;
            let [e, f, g] = [
                lambda1 * cos * cos + lambda2 * sin * sin,
                (lambda1 - lambda2) * sin * cos,
                lambda1 * sin * sin + lambda2 * cos * cos,
            ]
            .map(|v| v as f32);
            let (ef, ff, gf) = (f64::from(e), f64::from(f), f64::from(g));
            let (want1, want2, want_angle) = exact(ef, ff, gf);
            let (got1, got2, [x, y]) = scalar::eigen(e, f, g);
            let (lane1, lane2, [lx, ly]) = on_lanes([e, f, g]);
            let near = |a: f32, b: f32| (a - b).abs() <= 4.0 * f32::EPSILON * a.abs().max(b.abs());
            assert!(near(got1, lane1) && (x * ly - y * lx).abs() < 4.0 * f32::EPSILON, "{e} {f} {g}");
            let determinant = ef * gf - ff * ff;
            if determinant <= 0.0 {
                continue;
            }
            // What rounding E G and F^2 must cost, however the rest is done.
            let loss = (ef * gf + ff * ff) / determinant;
            let error2 = (f64::from(got2) / want2 - 1.0).abs() / epsilon / loss;
            let error2_lanes = (f64::from(lane2) / want2 - 1.0).abs() / epsilon / loss;
            let radius = ((0.5 * (e - g)).powi(2) + f * f).sqrt();
            let naive = f64::from(0.5 * (e + g) - radius);
            worst[0] = worst[0].max((f64::from(got1) / want1 - 1.0).abs() / epsilon);
            worst[1] = worst[1].max(error2.max(error2_lanes));
            worst[2] = worst[2].max((naive / want2 - 1.0).abs() / epsilon / loss);
            if want1 > want2 * 1.000_01 {
                let turned = f64::from(y).atan2(f64::from(x)) - want_angle;
                let off = (turned / std::f64::consts::PI - (turned / std::f64::consts::PI).round()).abs();
                worst[3] = worst[3].max(off * std::f64::consts::PI / epsilon);
            }
        }
        println!(
            "{condition:9.0e}   {:7.2}   {:7.2}   {:16.2e}   {:5.2}",
            worst[0], worst[1], worst[2], worst[3]
        );
        assert!(worst[0] < 4.0, "the larger eigenvalue is exact to a few last places");
        assert!(worst[1] < 4.0, "the smaller one loses no more than the determinant must");
        assert!(worst[3] < 4.0, "the angle is exact to a few last places");
        if exponent >= 3 {
            assert!(worst[2] > 10.0 * worst[1], "the textbook formula is worse by an order of magnitude");
        }
    }
}
