//! Experiments on the Kuwahara filters: the two ways to the sums of the generalized filter, the weighting
//! functions of both kinds (Figs. 5.22, 5.27), and restoration of a noisy picture (Fig. 5.31).

use isophote::kernels::painting::anisotropic_kuwahara::{self, Options};
use isophote::kernels::painting::anisotropic_kuwahara_texture;
use isophote_engine::{Class, Image, ImageId, PlanBuilder};
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

const RADIUS: f32 = 6.0;
const SIDE: u32 = 31;

/// Weight of each pixel of the disc in the filter by `pass` where all sectors weigh the same: its response to a
/// single white pixel on black, at the distance (x, y) from it, without an orientation.
fn response(pass: Pass, sectors: u32) -> impl Fn(i32, i32) -> f64 {
    let middle = SIDE as i32 / 2;
    let white = |x, y| if (x, y) == (middle, middle) { [1.0; 4] } else { [0.0, 0.0, 0.0, 1.0] };
    let mut plan = PlanBuilder::new(SIDE, SIDE).unwrap();
    let color = plan.input("color", 4, Class::Colour);
    let tensor = plan.input("tensor", 4, Class::Field);
    let options = Options {
        radius: RADIUS,
        sectors,
        q: 8.0,
        // No sector varies by more.
        threshold: 10.0,
        alpha: 1.0,
        deviation_floor: 0.0,
    };
    let result = pass(&mut plan, color, tensor, &options);
    plan.output("output", result);
    let inputs = [("color", from_fn(SIDE, SIDE, white)), ("tensor", from_fn(SIDE, SIDE, |_, _| [0.0; 4]))];
    let result = run::whole(&plan.finish().unwrap(), &inputs);
    move |x, y| f64::from(result.pixel(middle - x, middle - y)[0])
}

type Pass = fn(&mut PlanBuilder, ImageId, ImageId, &Options) -> ImageId;

#[test]
fn sectors_sum_to_the_gaussian() {
    let gaussian = |x: i32, y: i32| {
        let square = f64::from(x * x + y * y) / f64::from(RADIUS * RADIUS);
        if square <= 1.0005 { (-3.125 * square).exp() } else { 0.0 }
    };
    let reach = RADIUS as i32 + 1;
    let places = || (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (x, y)));
    let all: f64 = places().map(|(x, y)| gaussian(x, y)).sum();
    let title = "Weights of all sectors together, as the filters have them, against the Gaussian: greatest error, in \
                 percent of its peak";
    let mut table = Table::new(12, "Fig. 5.22", title, &["sectors", "sampled", "polynomial"]);
    for sectors in [4, 8] {
        let passes: [(Pass, f64); 2] = [
            // A table, read between its entries.
            (anisotropic_kuwahara_texture::pass, 0.01),
            // Exact; but each of eight sectors is divided by its own sum over pixels, and those of the diagonals are
            // others than those of the axes.
            (anisotropic_kuwahara::pass, if sectors == 4 { 1e-5 } else { 0.005 }),
        ];
        let errors = passes.map(|(pass, allowed)| {
            let found = response(pass, sectors);
            let off = |(x, y)| (found(x, y) * all - gaussian(x, y)).abs();
            let worst = places().map(off).fold(0.0, f64::max);
            assert!(worst < allowed, "{sectors} sectors: off by {worst} of 1");
            worst
        });
        let [sampled, polynomial] = errors.map(|e| format!("{:.3}", 100.0 * e));
        table.row(&[sectors.to_string(), sampled, polynomial]);
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
