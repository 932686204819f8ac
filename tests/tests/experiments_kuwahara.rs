//! Experiments on the Kuwahara filters: the two ways to the sums of the generalized filter, the weighting
//! functions of both kinds (Figs. 5.22, 5.27), and restoration of a noisy picture (Fig. 5.31).

use isophote::kernels::shared::sampled_sectors;
use isophote::kernels::shared::sectors::Polynomial;
use isophote_engine::Image;
use isophote_engine::fearless_simd::{Level, dispatch, prelude::*};
use isophote_tests::compare::{distance, psnr};
use isophote_tests::pictures::{self, Kind, from_fn};
use isophote_tests::random::Random;
use isophote_tests::run;
use isophote_tests::table::Table;

#[test]
fn fourier_and_spatial_sums_agree() {
    let pictures = [
        ("scenery", pictures::scenery(160, 120)),
        ("noise", pictures::color(Kind::Noise, 160, 120)),
        ("light to 10,000", pictures::color(Kind::Hdr, 160, 120)),
        ("cut-out", pictures::color(Kind::CutOut, 160, 120)),
    ];
    let title = "Generalized Kuwahara filter: greatest and mean difference of Fourier and spatial sums";
    let mut table = Table::new(12, "§ 5.3.2", title, &["picture", "radius", "greatest", "mean"]);
    for (name, picture) in &pictures {
        for radius in ["3", "6", "12"] {
            let by = |method: &str| {
                run::node("generalized_kuwahara", &[("radius", radius), ("method", method)], picture)
            };
            let (worst, mean) = distance(&by("spatial"), &by("fft"));
            table.row(&[*name, radius, &format!("{worst:.0e}"), &format!("{mean:.0e}")]);
            let scale = picture.data().iter().fold(1.0f32, |m, v| m.max(v.abs()));
            assert!(worst < 4e-3 * scale, "{name}, radius {radius}: {worst}");
            assert!(mean < 1e-4 * f64::from(scale), "{name}, radius {radius}: {mean}");
        }
    }
    table.print();
}

/// All polynomial weights at a point of the unit disc (5.38).
fn polynomial_weights(p: Polynomial, n: u32, [x, y]: [f64; 2]) -> Vec<f64> {
    let value = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
        let (along, across) = (x * cos + y * sin, y * cos - x * sin);
        (along + f64::from(p.zeta) - f64::from(p.eta) * across * across).max(0.0).powi(2)
    };
    let all: Vec<f64> = (0..n).map(value).collect();
    let share = (-3.125 * (x * x + y * y)).exp() / all.iter().sum::<f64>();
    all.into_iter().map(|p| p * share).collect()
}

/// Sampled weights of four sectors a quarter turn apart.
fn four(n: u32, [x, y]: [f64; 2]) -> [f32; 4] {
    let table = sampled_sectors::table(n);
    dispatch!(Level::new(), simd => sampled_sectors::sample(simd, table, x as f32, y as f32).to_array())
}

/// Points of the unit disc.
fn disc() -> impl Iterator<Item = [f64; 2]> {
    let at = |i: i32| f64::from(i) / 40.0;
    (-40..=40)
        .flat_map(move |j| (-40..=40).map(move |i| [at(i), at(j)]))
        .filter(|[x, y]| x * x + y * y <= 1.0)
}

#[test]
fn sectors_sum_to_the_gaussian() {
    let title = "Sum of all sectors against the Gaussian, and the two kinds of weights against each other";
    let columns =
        ["sectors", "sampled, greatest error", "polynomial, greatest error", "kinds, greatest difference"];
    let mut table = Table::new(12, "Fig. 5.22", title, &columns);
    for n in [4, 8] {
        let polynomial = Polynomial::new(6.0, n);
        let (mut sampled, mut exact, mut apart) = (0.0f64, 0.0f64, 0.0f64);
        for [x, y] in disc() {
            let gaussian = (-3.125 * (x * x + y * y)).exp();
            let weights = polynomial_weights(polynomial, n, [x, y]);
            exact = exact.max((weights.iter().sum::<f64>() - gaussian).abs());
            let (even, h) = (four(n, [x, y]), std::f64::consts::FRAC_1_SQRT_2);
            let mut sum: f32 = even.iter().sum();
            if n == 8 {
                sum += four(n, [(x + y) * h, (y - x) * h]).iter().sum::<f32>();
            }
            sampled = sampled.max((f64::from(sum) - gaussian).abs());
            apart = apart.max((f64::from(even[0]) - weights[0]).abs());
        }
        table.row(&[format!("{n}"), format!("{sampled:.3}"), format!("{exact:.0e}"), format!("{apart:.2}")]);
        assert!(exact < 1e-12 && sampled < 0.006, "{n} sectors: {exact}, {sampled}");
        assert!(apart < 0.2, "{n} sectors: the kinds differ by {apart}");
    }
    table.print();
}

/// Least and greatest grey in a square around a pixel, as their difference.
fn contrast(image: &Image, x: i32, y: i32, reach: i32) -> f32 {
    let (mut least, mut most) = (f32::MAX, f32::MIN);
    for j in -reach..=reach {
        for i in -reach..=reach {
            let p = image.pixel(
                (x + i).clamp(0, image.width() as i32 - 1),
                (y + j).clamp(0, image.height() as i32 - 1),
            );
            let grey = (p[0] + p[1] + p[2]) / 3.0;
            (least, most) = (least.min(grey), most.max(grey));
        }
    }
    most - least
}

#[test]
fn the_two_weightings_differ_near_high_contrast_only() {
    let picture = pictures::scenery(240, 180);
    let by = |weights: &str| run::node("anisotropic_kuwahara", &[("weights", weights)], &picture);
    let (texture, polynomial) = (by("texture"), by("polynomial"));
    let mut found: Vec<(f32, f32)> = Vec::new();
    for y in 0..180 {
        for x in 0..240 {
            let (a, b) = (texture.pixel(x, y), polynomial.pixel(x, y));
            let off = (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max);
            found.push((contrast(&picture, x, y, 6), off));
        }
    }
    let title = "Difference of the anisotropic filter with sampled and with polynomial weights, of 255";
    let columns = ["contrast within the radius", "share of pixels", "mean", "greatest"];
    let mut table = Table::new(12, "Fig. 5.27e", title, &columns);
    let mut means = Vec::new();
    for [low, high] in [[0.0, 0.15], [0.15, 0.4], [0.4, 2.0]] {
        let part: Vec<f32> = found.iter().filter(|(c, _)| (low..high).contains(c)).map(|(_, d)| *d).collect();
        let mean = part.iter().sum::<f32>() / part.len() as f32;
        let worst = part.iter().copied().fold(0.0, f32::max);
        let share = 100.0 * part.len() as f32 / found.len() as f32;
        table.row(&[
            format!("{low} to {high}"),
            format!("{share:.0} %"),
            format!("{:.2}", 255.0 * mean),
            format!("{:.1}", 255.0 * worst),
        ]);
        means.push((mean, worst));
    }
    table.print();
    assert!(means[0].1 < 8.0 / 255.0, "flat parts differ by {}", means[0].1);
    let [flat, _, edges] = [means[0].0, means[1].0, means[2].0];
    assert!(edges > 20.0 * flat, "edges differ by {edges} on average, flat parts by {flat}");
}

/// `picture` with Gaussian noise of standard deviation `gaussian`, and a share of pixels that are black or
/// white.
fn noisy(picture: &Image, gaussian: f64, impulses: f64) -> Image {
    let mut random = Random::new(531);
    from_fn(picture.width(), picture.height(), |x, y| {
        let p = picture.pixel(x, y);
        if random.unit() < impulses {
            let v = (random.unit() < 0.5) as u8 as f32;
            return [v, v, v, 1.0];
        }
        let mut add = |v: f32| (v + (gaussian * random.normal()) as f32).clamp(0.0, 1.0);
        [add(p[0]), add(p[1]), add(p[2]), 1.0]
    })
}

/// `picture` with fine strands that bend, three pixels from one to the next, as fur has them.
fn with_strands(picture: &Image) -> Image {
    from_fn(picture.width(), picture.height(), |x, y| {
        let [u, v] = [x as f32, y as f32];
        let (sin, cos) = (0.6 + 0.4 * (0.03 * u).sin() + 0.3 * (0.02 * v).cos()).sin_cos();
        let strand = 0.12 * ((u * cos + v * sin) * std::f32::consts::TAU / 3.0).sin();
        let p = picture.pixel(x, y);
        let add = |v: f32| (v + strand).clamp(0.0, 1.0);
        [add(p[0]), add(p[1]), add(p[2]), 1.0]
    })
}

/// Share of the pixels that noise threw far off and that still are, in percent.
fn remaining(result: &Image, spoilt: &Image, picture: &Image) -> f64 {
    let far = |image: &Image, x: i32, y: i32| {
        let (a, b) = (image.pixel(x, y), picture.pixel(x, y));
        (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max) > 0.25
    };
    let (mut hit, mut left) = (0, 0);
    for y in 0..picture.height() as i32 {
        for x in 0..picture.width() as i32 {
            if far(spoilt, x, y) {
                hit += 1;
                left += i32::from(far(result, x, y));
            }
        }
    }
    100.0 * f64::from(left) / f64::from(hit.max(1))
}

#[test]
fn the_anisotropic_filter_restores_what_noise_has_spoilt() {
    let scenery = pictures::scenery(384, 288);
    let strands = with_strands(&scenery);
    let cases = [
        ("2 % Gaussian, 5 % impulses", &scenery, 0.02, false),
        ("5 % impulses", &scenery, 0.0, false),
        ("5 % impulses on fine strands", &strands, 0.0, true),
    ];
    let title = "Peak signal-to-noise ratio against the clean picture, dB, and impulses left";
    let filters = ["anisotropic_kuwahara", "generalized_kuwahara", "flow_bilateral"];
    let columns: Vec<&str> = ["noise", "none"].into_iter().chain(filters).collect();
    let mut table = Table::new(13, "Fig. 5.31", title, &columns);
    for (name, picture, gaussian, detailed) in cases {
        let spoilt = noisy(picture, gaussian, 0.05);
        let none = psnr(&spoilt, picture);
        let results = filters.map(|filter| run::node(filter, &[], &spoilt));
        let ratios = results.each_ref().map(|result| psnr(result, picture));
        let left = results.each_ref().map(|result| remaining(result, &spoilt, picture));
        let mut cells = vec![name.to_owned(), format!("{none:.1}")];
        cells.extend(ratios.iter().zip(left).map(|(ratio, left)| format!("{ratio:.1} ({left:.0} % left)")));
        table.row(&cells);
        let [anisotropic, generalized, bilateral] = ratios;
        // It smooths fine detail away as well.
        let gain = if detailed { 3.0 } else { 10.0 };
        assert!(anisotropic > none + gain, "{name}: {anisotropic} dB for {none}");
        assert!(anisotropic > bilateral + 3.0, "{name}: {anisotropic} dB, flow bilateral {bilateral}");
        assert!(anisotropic > generalized - 0.5, "{name}: {anisotropic} dB, generalized {generalized}");
        // The bilateral filter takes impulses for edges.
        assert!(left[0] < 5.0 && left[2] > 50.0, "{name}: {left:?} % of the impulses left");
        // Where it smooths detail away besides, it is worse than no filter; where there is none to lose, to
        // soften impulses a little is better than nothing.
        assert!(!detailed || bilateral < none - 0.3, "{name}: flow bilateral {bilateral} dB for {none}");
    }
    table.print();
}
