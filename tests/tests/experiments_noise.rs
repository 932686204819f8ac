//! Experiments on the anisotropy of noise, § 2.6.3: distribution 2.152, significance 2.154, and the
//! number of samples that a Gaussian window is worth (Figure 2.23).

use isophote::kernels::shared::tensor::scalar;
use isophote::kernels::smoothing::gaussian_blur;
use isophote::kernels::structure::tensor_display::least_significant;
use isophote_engine::{Class, Image, PlanBuilder};
use isophote_tests::pictures::from_fn;
use isophote_tests::random::Random;
use isophote_tests::run;
use isophote_tests::table::Table;

/// Pr(A <= a) for tensors of m random gradients (2.153).
fn distribution(a: f64, m: f64) -> f64 {
    1.0 - (1.0 - a * a).powf(0.5 * (m - 1.0))
}

/// Independent unsmoothed tensors: those of white noise by central differences, three pixels apart,
/// share no pixel.
fn independent_tensors() -> Vec<[f32; 3]> {
    let mut random = Random::new(263);
    let picture = from_fn(1200, 1200, |_, _| {
        let v = (0.5 + 0.1 * random.normal()) as f32;
        [v, v, v, 1.0]
    });
    let params = [("derivative", "central"), ("rho", "0"), ("space", "luminance")];
    let tensor = run::node("structure_tensor", &params, &picture);
    let mut found = Vec::new();
    for y in (2..1198).step_by(3) {
        for x in (2..1198).step_by(3) {
            let t = tensor.pixel(x, y);
            found.push([t[0], t[1], t[2]]);
        }
    }
    found
}

/// Anisotropies of the tensors of box windows of m gradients each.
fn of_windows(tensors: &[[f32; 3]], m: usize) -> Vec<f64> {
    let mut found: Vec<f64> = tensors
        .chunks_exact(m)
        .map(|window| {
            let sum = window.iter().fold([0.0; 3], |s, t| [s[0] + t[0], s[1] + t[1], s[2] + t[2]]);
            f64::from(scalar::anisotropy(sum[0], sum[1], sum[2]))
        })
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

#[test]
fn the_anisotropy_of_noise_follows_its_distribution() {
    let tensors = independent_tensors();
    let mut table = Table::new(
        4,
        "2.153, Fig. 2.22",
        "Anisotropy of box windows of m random gradients against its distribution, Kolmogorov-Smirnov distance",
        &["m", "windows", "distance", "limit at 1 %"],
    );
    for m in [5, 9, 25, 49, 81, 169] {
        let found = of_windows(&tensors, m);
        let n = found.len() as f64;
        let distance = found
            .iter()
            .enumerate()
            .map(|(i, a)| {
                let p = distribution(*a, m as f64);
                (p - i as f64 / n).abs().max(((i + 1) as f64 / n - p).abs())
            })
            .fold(0.0, f64::max);
        let limit = 1.628 / n.sqrt();
        table.row(&[m.to_string(), found.len().to_string(), format!("{distance:.4}"), format!("{limit:.4}")]);
        assert!(distance < limit, "m = {m}");
        // The test has teeth: other window sizes are rejected.
        let other = (1.5 * m as f64).max(m as f64 + 3.0);
        let wrong = found
            .iter()
            .enumerate()
            .map(|(i, a)| (distribution(*a, other) - i as f64 / n).abs())
            .fold(0.0, f64::max);
        assert!(wrong > limit, "m = {m} would pass for {other}");
    }
    table.print();
}

#[test]
fn the_threshold_lets_pass_the_share_of_noise_that_it_should() {
    let tensors = independent_tensors();
    let mut table = Table::new(
        4,
        "2.154",
        "Anisotropy above which a window of m gradients is no noise, and the share of noise above it",
        &["window", "alpha", "threshold", "share above"],
    );
    for (side, alpha) in [(5usize, 0.05), (7, 0.05), (9, 0.05), (13, 0.1), (13, 0.05), (13, 0.01)] {
        let m = side * side;
        let limit = f64::from(least_significant(alpha as f32, m as f32));
        let found = of_windows(&tensors, m);
        let share = found.iter().filter(|a| **a > limit).count() as f64 / found.len() as f64;
        table.row(&[
            format!("{side} x {side}"),
            format!("{:.0} %", 100.0 * alpha),
            format!("{limit:.4}"),
            format!("{:.1} %", 100.0 * share),
        ]);
        if (side, alpha) == (13, 0.05) {
            assert!((limit - 0.1872).abs() < 5e-5, "{limit}");
        }
        // Three standard deviations of a share of so many.
        let deviation = (alpha * (1.0 - alpha) / found.len() as f64).sqrt();
        assert!((share - alpha).abs() < 3.0 * deviation, "{share} for {alpha}");
    }
    table.print();
}

/// Anisotropies of random gradients under the library's own Gaussian window.
fn under_gaussian(sigma: f32, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let gradients: Image = from_fn(400, 400, |_, _| {
        let (x, y) = (random.normal() as f32, random.normal() as f32);
        [x * x, x * y, y * y, 1.0]
    });
    let mut plan = PlanBuilder::new(400, 400).unwrap();
    let input = plan.input("tensor", 4, Class::Field);
    let smoothed = gaussian_blur::pass(&mut plan, input, sigma, Class::Field);
    plan.output("output", smoothed);
    let smoothed = run::whole(&plan.finish().unwrap(), &[("tensor", gradients)]);
    let margin = (3.0 * sigma).ceil() as i32;
    let mut found = Vec::new();
    for y in margin..400 - margin {
        for x in margin..400 - margin {
            let t = smoothed.pixel(x, y);
            found.push(f64::from(scalar::anisotropy(t[0], t[1], t[2])));
        }
    }
    found
}

/// The m whose density (2.152) comes nearest to the histogram of `found`, by least squares.
fn fitted(found: &[f64]) -> f64 {
    const BINS: usize = 200;
    let mut histogram = [0.0; BINS];
    for a in found {
        histogram[((a * BINS as f64) as usize).min(BINS - 1)] += BINS as f64 / found.len() as f64;
    }
    let squares = |m: f64| -> f64 {
        histogram
            .iter()
            .enumerate()
            .map(|(i, h)| {
                let a = (i as f64 + 0.5) / BINS as f64;
                (h - (m - 1.0) * a * (1.0 - a * a).powf(0.5 * (m - 3.0))).powi(2)
            })
            .sum()
    };
    // The sum of squares has one minimum: close in on it.
    let (mut low, mut high) = (4.0, 1000.0);
    while high - low > 1e-3 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if squares(a) < squares(b) { high = b } else { low = a }
    }
    low
}

#[test]
fn a_gaussian_window_is_worth_four_pi_sigma_squared_samples() {
    let mut table = Table::new(
        4,
        "2.158, Fig. 2.23",
        "Samples that a Gaussian window is worth: m fitted to (2.152), cut-off 3 sigma",
        &["sigma", "fitted m", "4 pi sigma^2", "ratio"],
    );
    for sigma in 1..=5 {
        let seeds = 1..=(sigma * sigma).min(8) as u64;
        let found: Vec<f64> = seeds.flat_map(|seed| under_gaussian(sigma as f32, seed)).collect();
        let fitted = fitted(&found);
        let expected = 4.0 * std::f64::consts::PI * f64::from(sigma * sigma);
        table.row(&[
            sigma.to_string(),
            format!("{fitted:.1}"),
            format!("{expected:.1}"),
            format!("{:.2}", fitted / expected),
        ]);
        // Under a window of few pixels the distribution is not quite of the family that is fitted.
        let bound = 0.02 + 0.07 / f64::from(sigma);
        assert!((fitted / expected - 1.0).abs() < bound, "sigma {sigma}: {fitted} for {expected}");
    }
    table.print();
}

/// Anisotropies of random gradients under a Gaussian cut off at a disc of radius `cutoff` sigma.
fn under_disc(sigma: i32, cutoff: f64, seed: u64) -> Vec<f64> {
    const SIDE: i32 = 300;
    let mut random = Random::new(seed);
    let gradients: Vec<[f64; 2]> = (0..SIDE * SIDE).map(|_| [random.normal(), random.normal()]).collect();
    let (radius, sigma) = (cutoff * f64::from(sigma), f64::from(sigma));
    let reach = radius as i32;
    let taps: Vec<(i32, f64)> = (-reach..=reach)
        .flat_map(|y| (-reach..=reach).map(move |x| (x, y)))
        .filter(|(x, y)| f64::from(x * x + y * y) <= radius * radius)
        .map(|(x, y)| (y * SIDE + x, (-0.5 * f64::from(x * x + y * y) / (sigma * sigma)).exp()))
        .collect();
    let mut found = Vec::new();
    for y in reach..SIDE - reach {
        for x in reach..SIDE - reach {
            let (mut e, mut f, mut g) = (0.0, 0.0, 0.0);
            for (offset, weight) in &taps {
                let [u, v] = gradients[(y * SIDE + x + offset) as usize];
                (e, f, g) = (e + weight * u * u, f + weight * u * v, g + weight * v * v);
            }
            found.push((e - g).hypot(2.0 * f) / (e + g));
        }
    }
    found
}

/// The integral of the Gaussian's square root over what its window holds (2.156), of a disc instead of a square.
fn area_of_disc(sigma: i32, cutoff: f64) -> f64 {
    4.0 * std::f64::consts::PI * f64::from(sigma * sigma) * (1.0 - (-0.25 * cutoff * cutoff).exp())
}

#[test]
fn a_disc_window_is_worth_less_than_the_gaussian_and_more_than_its_area() {
    let mut table = Table::new(
        4,
        "2.155, Fig. 2.23",
        "Samples that a Gaussian window cut off at a disc is worth: m fitted to (2.152), between the areas (2.155)",
        &["sigma", "cut-off", "area", "fitted m", "4 pi sigma^2"],
    );
    for (sigma, cutoff) in [(2, 2.0), (2, 2.5), (2, 3.0), (3, 2.0), (3, 2.5), (3, 3.0)] {
        let found: Vec<f64> = (1..=3).flat_map(|seed| under_disc(sigma, cutoff, seed)).collect();
        let fitted = fitted(&found);
        let [least, most] = [area_of_disc(sigma, cutoff), area_of_disc(sigma, f64::INFINITY)];
        let number = |v: f64| format!("{v:.1}");
        table.row(&[
            sigma.to_string(),
            format!("{cutoff} sigma"),
            number(least),
            number(fitted),
            number(most),
        ]);
        // Windows of this many pixels fluctuate by two percent.
        assert!(0.98 * least < fitted && fitted < 1.02 * most, "sigma {sigma}, {cutoff}: {fitted}");
        if cutoff >= 2.5 {
            assert!((fitted / most - 1.0).abs() < 0.12, "sigma {sigma}, {cutoff}: {fitted} for {most}");
        }
    }
    table.print();
}
