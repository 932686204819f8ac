//! Experiments on the difference of Gaussians: the two forms agree (4.9, 4.10), the response is that of the
//! scale-normalized Laplacian (4.5), and the separable flow-based filter is the two-dimensional one (§ 4.5).

use isophote_engine::Image;
use isophote_tests::compare::{distance, psnr};
use isophote_tests::pictures::{self, from_fn};
use isophote_tests::run;
use isophote_tests::table::Table;

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
    let title = "Largest difference between the tau form and the sharpening form";
    let mut table = Table::new(11, "4.9, 4.10", title, &["tau", "response, units of L", "after tanh"]);
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
        assert!(worst < 2e-4, "to rounding, in units of L: {worst}");
        assert!(worst_tanh < 1e-3, "{worst_tanh}");
        assert!(plain.data().iter().any(|v| v.abs() > 0.1), "there is something to compare");
        table.row(&[text(tau), "below 2e-4".into(), "below 1e-3".into()]);
    }
    table.print();
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
    let title = "Difference of Gaussians / (k - 1) against the scale-normalized Laplacian, on a wave";
    let columns = ["sigma", "k", "DoG / (k - 1)", "Laplacian", "ratio"];
    let mut table = Table::new(11, "4.5", title, &columns);
    for sigma in [2.0, 4.0, 8.0] {
        // The same wave, measured in sigmas.
        let omega = 0.8 / sigma;
        let laplacian = 30.0 * 0.8f64.powi(2) * (-0.5 * 0.8f64.powi(2)).exp();
        let mut ratios = Vec::new();
        for k in [1.6, 1.4, 1.2, 1.1] {
            let normalized = response(sigma, k, omega) / (k - 1.0);
            let ratio = normalized / laplacian;
            table.row(&[
                format!("{sigma}"),
                format!("{k}"),
                format!("{normalized:.2}"),
                format!("{laplacian:.2}"),
                format!("{ratio:.2}"),
            ]);
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
    table.print();
}

#[test]
fn the_response_does_not_depend_on_scale() {
    // Twice the scale on a picture of twice the size: the same response.
    let responses: Vec<f64> = [2.0, 4.0, 8.0].iter().map(|s| response(*s, 1.6, 0.8 / s)).collect();
    let mut table = Table::new(
        11,
        "4.5",
        "Response at a crest, the wave growing with the filter",
        &["sigma 2", "sigma 4", "sigma 8"],
    );
    let cells: Vec<String> = responses.iter().map(|r| format!("{r:.2}")).collect();
    table.row(&cells);
    table.print();
    for pair in responses.windows(2) {
        assert!((pair[0] / pair[1] - 1.0).abs() < 0.02);
    }
}

#[test]
fn the_separable_filter_is_the_two_dimensional_one() {
    let picture = pictures::scenery(160, 120);
    let by = |kernel: &str, integrator: &str, threshold: &str| {
        let params = [("kernel", kernel), ("integrator", integrator), ("threshold", threshold)];
        run::node("flow_dog", &params, &picture)
    };
    let mut table = Table::new(
        10,
        "section 4.5",
        "Separable flow-based difference of Gaussians against the two-dimensional kernel",
        &[
            "stream lines",
            "samples",
            "largest difference of the response, units of L",
            "edge images alike, dB",
        ],
    );
    let mut likeness = Vec::new();
    for (integrator, samples) in [("cabral_leedom", "nearest"), ("rk2", "bilinear"), ("euler", "bilinear")] {
        let at = |kernel| by(kernel, integrator, "none");
        let (worst, mean) = distance(&at("separable"), &at("two_dimensional"));
        let edges = psnr(&by("separable", integrator, "tanh"), &by("two_dimensional", integrator, "tanh"));
        if samples == "nearest" {
            assert!(worst < 5e-3 && mean < 2e-4, "to rounding: {worst:e}, mean {mean:e}");
            table.row(&[integrator, samples, "below 0.005 (rounding)", "above 60"]);
            assert!(edges > 60.0, "{edges} dB");
        } else {
            assert!(mean > 2e-3, "interpolated samples make an approximation of it: {mean:e}");
            table.row(&[integrator.to_owned(), samples.into(), format!("{worst:.1}"), format!("{edges:.0}")]);
            likeness.push(edges);
        }
    }
    table.print();
    assert!(likeness.iter().all(|db| *db > 25.0), "indistinguishable to the eye: {likeness:?} dB");
}
