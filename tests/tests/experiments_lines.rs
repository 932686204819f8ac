//! Experiments on the difference of Gaussians: the two forms agree (4.9, 4.10), and the response is
//! that of the scale-normalized Laplacian (4.5).

use isophote_engine::Image;
use isophote_tests::compare::distance;
use isophote_tests::pictures::{self, from_fn};
use isophote_tests::run;

/// The grey of CIELAB lightness L, gamma-encoded.
fn grey_of_lightness(l: f64) -> f32 {
    let f = (l + 16.0) / 116.0;
    let y = if f > 6.0 / 29.0 { f.powi(3) } else { (f - 16.0 / 116.0) / 7.787_037 };
    let encoded = if y <= 0.003_130_8 { 12.92 * y } else { 1.055 * y.powf(1.0 / 2.4) - 0.055 };
    encoded as f32
}

#[test]
fn the_tau_form_and_the_sharpening_form_agree() {
    let picture = pictures::scenery(160, 120);
    println!("tau      form without threshold   tanh");
    for tau in [0.5f64, 0.9, 0.956, 0.99] {
        let (epsilon, phi) = (0.4f64, 1.7f64);
        let text = |v: f64| format!("{v}");
        let (p, epsilon_p, phi_p) = (tau / (1.0 - tau), epsilon / (1.0 - tau), phi * (1.0 - tau));
        let by = |form: &str, threshold: &str| {
            let params = [
                ("form", form),
                ("threshold", threshold),
                ("tau", &text(tau)),
                ("epsilon", &text(epsilon)),
                ("phi", &text(phi)),
                ("p", &text(p)),
                ("epsilon_p", &text(epsilon_p)),
                ("phi_p", &text(phi_p)),
            ];
            run::node("difference_of_gaussians", &params, &picture)
        };
        // S = D / (1 - tau), in units of L up to some hundreds.
        let (plain, mut sharpened) = (by("tau", "none"), by("sharpen", "none"));
        for v in sharpened.data_mut() {
            *v *= 1.0 - tau as f32;
        }
        let (worst, _) = distance(&plain, &sharpened);
        let (worst_tanh, _) = distance(&by("tau", "tanh"), &by("sharpen", "tanh"));
        println!("{tau:5}    {worst:22.1e}   {worst_tanh:.1e}");
        assert!(worst < 2e-4, "to rounding, in units of L");
        assert!(worst_tanh < 1e-3);
        assert!(plain.data().iter().any(|v| v.abs() > 0.1), "there is something to compare");
    }
}

/// Lightness 50 + 30 cos(omega x) as a picture.
fn wave(omega: f64) -> Image {
    from_fn(256, 96, |x, _| {
        let v = grey_of_lightness(50.0 + 30.0 * (omega * f64::from(x - 128)).cos());
        [v, v, v, 1.0]
    })
}

/// Response of the DoG without threshold at the crest of a wave.
fn response(sigma: f64, k: f64, omega: f64) -> f64 {
    let params =
        [("threshold", "none"), ("tau", "1"), ("sigma_e", &*format!("{sigma}")), ("k", &*format!("{k}"))];
    let out = run::node("difference_of_gaussians", &params, &wave(omega));
    f64::from(out.pixel(128, 48)[0])
}

#[test]
fn the_response_is_that_of_the_scale_normalized_laplacian() {
    println!("sigma     k   DoG / (k - 1)   -sigma^2 Laplacian   ratio");
    for sigma in [2.0, 4.0, 8.0] {
        // The same wave, measured in sigmas.
        let omega = 0.8 / sigma;
        let laplacian = 30.0 * 0.8f64.powi(2) * (-0.5 * 0.8f64.powi(2)).exp();
        let mut ratios = Vec::new();
        for k in [1.6, 1.4, 1.2, 1.1] {
            let normalized = response(sigma, k, omega) / (k - 1.0);
            let ratio = normalized / laplacian;
            println!("{sigma:5}  {k:4}  {normalized:14.3}  {laplacian:19.3}  {ratio:6.3}");
            ratios.push(ratio);
        }
        // What (4.5) becomes for these k, in the limit of untruncated Gaussians.
        for (k, ratio) in [1.6, 1.4, 1.2, 1.1].into_iter().zip(&ratios) {
            let x = 0.5 * 0.8f64.powi(2);
            let exact = ((-x).exp() - (-x * k * k).exp()) / (k - 1.0) / (2.0 * x * (-x).exp());
            assert!((ratio / exact - 1.0).abs() < 0.06, "sigma {sigma}, k {k}: {ratio} for {exact}");
        }
        assert!((ratios[3] - 1.0).abs() < 0.1, "the limit k -> 1");
    }
}

#[test]
fn the_response_does_not_depend_on_scale() {
    // Twice the scale on a picture of twice the size: the same response.
    let responses: Vec<f64> = [2.0, 4.0, 8.0].iter().map(|s| response(*s, 1.6, 0.8 / s)).collect();
    println!("responses at sigma 2, 4, 8: {responses:.3?}");
    for pair in responses.windows(2) {
        assert!((pair[0] / pair[1] - 1.0).abs() < 0.02);
    }
}
