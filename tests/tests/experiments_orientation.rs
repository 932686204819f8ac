//! Experiments on derivative operators, edge tangent flow and the eigen solver: Figures 2.7 (angular
//! error and rotation invariance on zone plates), 2.15 and 2.20, and § 2.3.4.

use isophote::kernels::shared::tensor::{self, scalar};
use isophote_engine::Image;
use isophote_engine::fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*};
use isophote_tests::random::Random;
use isophote_tests::table::Table;
use isophote_tests::{run, zone_plates};

const OPERATORS: [&str; 4] = ["central", "sobel", "scharr3", "scharr5"];

/// Mean angular error of a node's tensors on the plates, in degrees.
fn error_of(picture: &Image, node: &str, params: &[(&str, &str)]) -> f64 {
    zone_plates::mean(&zone_plates::errors(&run::node(node, params, picture)))
}

#[test]
fn optimized_operators_err_less_and_smoothing_repairs_noise() {
    let (clean, noisy) = (zone_plates::picture(0.0), zone_plates::picture(0.001));
    let title = "Mean angular error of derivative operators on zone plates, in degrees";
    let mut table =
        Table::new(1, "Fig. 2.7, 2.15", title, &["operator", "clean", "noise", "noise, smoothed by rho 2"]);
    let mut rows = Vec::new();
    for operator in OPERATORS {
        let by = |picture: &Image, rho: &str| {
            let params = [("derivative", operator), ("rho", rho), ("space", "luminance")];
            error_of(picture, "structure_tensor", &params)
        };
        let row = [by(&clean, "0"), by(&noisy, "0"), by(&noisy, "2")];
        table.row(&[operator.to_owned(), show(row[0]), show(row[1]), show(row[2])]);
        rows.push(row);
    }
    table.print();
    for pair in rows.windows(2) {
        assert!(pair[0][0] > 1.2 * pair[1][0], "without noise each operator beats the one before it");
    }
    for [clean, noisy, smoothed] in rows {
        assert!(noisy > clean + 2.0, "all suffer from noise");
        assert!(smoothed < clean + 0.25, "the smoothed tensor repairs it");
    }
}

fn show(degrees: f64) -> String {
    format!("{degrees:.2}")
}

#[test]
fn the_structure_tensor_is_more_exact_than_every_edge_tangent_flow() {
    let pictures = [zone_plates::picture(0.0), zone_plates::picture(0.001)];
    let title = "Angular error of the structure tensor (rho 2) and of edge tangent flow (radius 6), optimized \
                 3x3 operator, in degrees; the pattern is half clean and half with noise";
    let columns =
        ["estimate", "mean, clean half", "mean, noisy half", "root mean square", "off by more than 5"];
    let mut table = Table::new(1, "Fig. 2.20", title, &columns);
    // Root mean square and share of the far off: what shows is not the error that all have of the
    // operator, but where strokes go astray.
    let mut by = |name: &str, node: &str, params: &[(&str, &str)]| {
        let halves = [0, 1].map(|i: usize| {
            zone_plates::errors_between(&run::node(node, params, &pictures[i]), 3.0, zone_plates::OUTER)
        });
        let means = [zone_plates::mean(&halves[0]), zone_plates::mean(&halves[1])];
        let all: Vec<f64> = halves.iter().flatten().map(|e| e.0).collect();
        let square = (all.iter().map(|e| e * e).sum::<f64>() / all.len() as f64).sqrt();
        let far = all.iter().filter(|e| **e > 5.0).count() as f64 / all.len() as f64;
        let percent = format!("{:.1} %", 100.0 * far);
        table.row(&[name.to_owned(), show(means[0]), show(means[1]), show(square), percent]);
        (means[1], square)
    };
    let tensor = by("structure tensor", "structure_tensor", &[("rho", "2"), ("space", "luminance")]);
    let mut flows = Vec::new();
    for kernel in ["box", "gaussian"] {
        for separable in ["false", "true"] {
            for iterations in ["1", "2", "3"] {
                let form = if separable == "true" { ", separable" } else { "" };
                let name = format!("edge tangent flow, {kernel}{form}, {iterations} times");
                let params = [
                    ("radius", "6"),
                    ("kernel", kernel),
                    ("separable", separable),
                    ("iterations", iterations),
                ];
                flows.push((iterations, by(&name, "edge_tangent_flow", &params)));
            }
        }
    }
    table.print();
    for (iterations, (noisy, square)) in flows {
        assert!(tensor.1 < 0.97 * square, "{tensor:?} against {square}");
        if iterations == "1" {
            assert!(tensor.0 < 0.8 * noisy, "one pass of edge tangent flow leaves more of the noise");
        }
    }
}

#[test]
fn scharr_is_more_rotation_invariant_than_sobel_at_every_angle() {
    let clean = zone_plates::picture(0.0);
    let binned = |operator: &str| {
        let mut bins = [(0.0, 0.0); 18];
        let params = [("derivative", operator), ("rho", "0"), ("space", "luminance")];
        for (error, angle) in zone_plates::errors(&run::node("structure_tensor", &params, &clean)) {
            let bin = &mut bins[((angle / 5.0) as usize).min(17)];
            *bin = (bin.0 + error, bin.1 + 1.0);
        }
        bins.map(|(sum, count)| sum / count)
    };
    let all = OPERATORS.map(binned);
    let title = "Mean angular error by the angle of the gradient, in degrees";
    let mut table =
        Table::new(2, "Fig. 2.7", title, &["angle", OPERATORS[0], OPERATORS[1], OPERATORS[2], OPERATORS[3]]);
    for bin in 0..18usize {
        let mut row = vec![format!("{}-{}", 5 * bin, 5 * bin + 5)];
        row.extend(all.iter().map(|o| show(o[bin])));
        table.row(&row);
    }
    table.print();
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
        let eigen = tensor::eigen(c(e), c(f), c(g));
        (eigen.lambda1[5], eigen.lambda2[5], [eigen.major[0][5], eigen.major[1][5]])
    }
    dispatch!(Level::new(), simd => lanes(simd, [e, f, g]))
}

/// A tensor of this condition, turned at random; some lie along an axis nearly exactly, where the
/// determinant loses nothing.
fn random_tensor(random: &mut Random, condition: f64) -> [f32; 3] {
    let angle = if random.below(2) == 0 {
        random.unit() * std::f64::consts::PI
    } else {
        random.normal() / condition.sqrt() + 0.5 * std::f64::consts::PI * random.below(2) as f64
    };
    let (sin, cos) = angle.sin_cos();
    let lambda1 = 10f64.powf(24.0 * random.unit() - 12.0);
    let lambda2 = lambda1 / condition;
    [
        lambda1 * cos * cos + lambda2 * sin * sin,
        (lambda1 - lambda2) * sin * cos,
        lambda1 * sin * sin + lambda2 * cos * cos,
    ]
    .map(|v| v as f32)
}

/// Relative errors of both eigenvalues, of the smaller one as B - R, and of the angle, in units of the last
/// place; `None` where rounding has made the determinant negative.
fn errors_of([e, f, g]: [f32; 3]) -> Option<[f64; 4]> {
    let epsilon = f64::from(f32::EPSILON);
    let (ef, ff, gf) = (f64::from(e), f64::from(f), f64::from(g));
    let (want1, want2, want_angle) = exact(ef, ff, gf);
    let (got1, got2, [x, y]) = scalar::eigen(e, f, g);
    let (lane1, lane2, [lx, ly]) = on_lanes([e, f, g]);
    let near = |a: f32, b: f32| (a - b).abs() <= 4.0 * f32::EPSILON * a.abs().max(b.abs());
    assert!(near(got1, lane1) && (x * ly - y * lx).abs() < 4.0 * f32::EPSILON, "{e} {f} {g}");
    let determinant = ef * gf - ff * ff;
    if determinant <= 0.0 {
        return None;
    }
    // What rounding E G and F^2 must cost, however the rest is done.
    let loss = (ef * gf + ff * ff) / determinant;
    let relative = |got: f32, want: f64| (f64::from(got) / want - 1.0).abs() / epsilon;
    let radius = ((0.5 * (e - g)).powi(2) + f * f).sqrt();
    let naive = 0.5 * (e + g) - radius;
    let angle = if want1 > want2 * 1.000_01 {
        let turned = f64::from(y).atan2(f64::from(x)) - want_angle;
        let off = (turned / std::f64::consts::PI - (turned / std::f64::consts::PI).round()).abs();
        off * std::f64::consts::PI / epsilon
    } else {
        0.0
    };
    let smaller = relative(got2, want2).max(relative(lane2, want2)) / loss;
    Some([relative(got1, want1), smaller, relative(naive, want2) / loss, angle])
}

#[test]
fn the_eigen_solver_is_as_exact_as_its_numbers_allow() {
    let mut random = Random::new(234);
    let mut table = Table::new(
        8,
        "2.3.4, Listing 2.1",
        "Worst relative errors of the eigen solver in units of the last place; those of lambda2 beyond what \
         its tensor's determinant loses",
        &["condition", "lambda1", "lambda2", "lambda2 as B - R", "angle"],
    );
    for exponent in 0..=7 {
        let mut worst = [0.0f64; 4];
        for _ in 0..20_000 {
            let tensor = random_tensor(&mut random, 10f64.powi(exponent));
            for (worst, error) in worst.iter_mut().zip(errors_of(tensor).into_iter().flatten()) {
                *worst = worst.max(error);
            }
        }
        table.row(&[
            format!("1e{exponent}"),
            format!("{:.1}", worst[0]),
            format!("{:.1}", worst[1]),
            format!("{:.0}", worst[2]),
            format!("{:.1}", worst[3]),
        ]);
        assert!(worst[0] < 4.0, "the larger eigenvalue is exact to a few last places");
        assert!(worst[1] < 4.0, "the smaller one loses no more than the determinant must");
        assert!(worst[3] < 4.0, "the angle is exact to a few last places");
        if exponent >= 3 {
            assert!(worst[2] > 10.0 * worst[1], "the textbook formula is worse by an order of magnitude");
        }
    }
    table.print();
}
