//! `tensor_display` on the CPU executor.

use isophote::kernels::structure::tensor_display::*;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Class, Image, PlanBuilder, Rect};

/// The grey that a tensor is shown as; of Harris with k 0.04, of significance above an anisotropy of 0.5.
fn grey([e, f, g]: [f32; 3], show: Show) -> f64 {
    let mut plan = PlanBuilder::new(1, 1).unwrap();
    let tensor = plan.input("tensor", 4, Class::Field);
    let shown = pass(&mut plan, tensor, &Options { show, k: 0.04, threshold: 0.5 });
    plan.output("color", shown);
    let image = Image::from_vec(1, 1, 4, vec![e, f, g, 1.0]).unwrap();
    let region = Rect::of_size(1, 1);
    let result = CpuExecutor::new()
        .run(&plan.finish().unwrap(), &[("tensor", &image)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0);
    let pixel = result.pixel(0, 0);
    assert!(pixel[0] == pixel[1] && pixel[1] == pixel[2] && pixel[3] == 1.0);
    f64::from(pixel[0])
}

#[test]
fn measures_are_those_of_the_eigenvalues() {
    let (l1, l2) = (0.03f64, 0.004f64);
    let (sin, cos) = 0.7f64.sin_cos();
    let tensor = [l1 * cos * cos + l2 * sin * sin, (l1 - l2) * sin * cos, l1 * sin * sin + l2 * cos * cos]
        .map(|v| v as f32);
    let a = (l1 - l2) / (l1 + l2);
    let root = (l1.sqrt() - l2.sqrt()) / (l1.sqrt() + l2.sqrt());
    let toned = |v: f64, half: f64| v / (v.abs() + half);
    let harris = l1 * l2 - 0.04 * (l1 + l2).powi(2);
    for (show, want) in [
        (Show::Anisotropy, a),
        (Show::AnisotropySqrt, root),
        (Show::AnisotropySquared, a * a),
        (Show::Magnitude, toned(l1.sqrt(), 0.1)),
        (Show::Harris, 0.5 + 0.5 * toned(harris.signum() * harris.abs().sqrt(), 0.0025)),
        (Show::Foerstner, toned(l1 * l2 / (l1 + l2), 0.0025)),
        (Show::TomasiKanade, toned(l2, 0.0025)),
        (Show::Rohr, toned((l1 * l2).sqrt(), 0.0025)),
        (Show::Significance, a),
    ] {
        let got = grey(tensor, show);
        assert!((got - want).abs() < 1e-4, "{show:?}: {got} for {want}");
    }
    // Eigenvalues 3 and 1 are of anisotropy 0.5, which is not above the threshold.
    assert_eq!(grey([3.0, 0.0, 1.0], Show::Significance), 0.0);
}

#[test]
fn the_threshold_of_significance_is_the_published_one() {
    assert!((least_significant(0.05, 169.0) - 0.1872).abs() < 5e-5);
    assert!(least_significant(0.05, 1.0) >= 1.0 && least_significant(0.05, 0.0) >= 1.0);
}

#[test]
fn extreme_tensors_are_shown_between_black_and_white() {
    for v in [0.0, 1e-38, 1.0, 1e30] {
        for show in [Show::Magnitude, Show::Harris, Show::Foerstner, Show::TomasiKanade, Show::Rohr] {
            for tensor in [[v, 0.0, v], [v, v, v], [0.0, 0.0, v]] {
                assert!((0.0..=1.0).contains(&grey(tensor, show)), "{show:?} of {tensor:?}");
            }
            assert!(show == Show::Magnitude || grey([v, v, v], show) <= 0.5, "an edge is no corner");
        }
    }
}
