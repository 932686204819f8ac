//! Experiments on how the structure tensor is sampled, stored and propagated over scales: Figures 2.17
//! (oversampling), 2.18 (8-bit storage) and 2.29 (multi-scale estimation).

use isophote::kernels::shared::tensor::scalar;
use isophote::kernels::smoothing::gaussian_blur;
use isophote_engine::{Class, Image, PlanBuilder};
use isophote_tests::pictures::from_fn;
use isophote_tests::random::Random;
use isophote_tests::table::Table;
use isophote_tests::{run, zone_plates};

fn show(degrees: f64) -> String {
    format!("{degrees:.2}")
}

#[test]
fn oversampling_helps_without_noise_and_does_not_matter_with_it() {
    let pictures = [zone_plates::picture(0.0), zone_plates::picture(0.001)];
    let mut table = Table::new(
        3,
        "Fig. 2.17",
        "Mean angular error of the smoothed structure tensor (rho 2), in degrees",
        &["derivatives", "clean", "noise"],
    );
    let mut by = |name: &str, params: &[(&str, &str)]| {
        let params = [&[("space", "luminance"), ("rho", "2")], params].concat();
        let error = |i: usize| {
            zone_plates::mean(&zone_plates::errors(&run::node("structure_tensor", &params, &pictures[i])))
        };
        let row = [error(0), error(1)];
        table.row(&[name.to_owned(), format!("{:.3}", row[0]), format!("{:.3}", row[1])]);
        row
    };
    let oversampled = by("Gaussian, sigma 0.867, oversampled", &[("oversample", "true")]);
    let gaussian = by("Gaussian, sigma 0.867", &[("derivative", "gaussian")]);
    let scharr5 = by("optimized 5x5", &[("derivative", "scharr5")]);
    by("optimized 3x3", &[("derivative", "scharr3")]);
    table.print();
    assert!(oversampled[0] < 0.2 * gaussian[0], "oversampling helps much without noise");
    assert!(oversampled[0] < 0.8 * scharr5[0], "and is better than the best operator");
    assert!(oversampled[1] > 0.6 * gaussian[1], "with noise there is little left of that");
    assert!(oversampled[1] > 0.9 * scharr5[1], "and nothing against the best operator");
}

/// The tensor as it comes back from an 8-bit texture that just holds its greatest value.
fn stored_in_bytes(tensor: &Image) -> Image {
    let top = tensor.data().chunks_exact(4).fold(0.0f32, |m, t| m.max(t[0]).max(t[2]));
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() / 255.0;
    from_fn(tensor.width(), tensor.height(), |x, y| {
        let t = tensor.pixel(x, y);
        [
            top * byte(t[0] / top),
            top * (2.0 * byte(0.5 + 0.5 * t[1] / top) - 1.0),
            top * byte(t[2] / top),
            1.0,
        ]
    })
}

fn smoothed(tensor: &Image, rho: f32) -> Image {
    let mut plan = PlanBuilder::new(tensor.width(), tensor.height()).unwrap();
    let input = plan.input("tensor", 4, Class::Field);
    let result = gaussian_blur::pass(&mut plan, input, rho, Class::Field);
    plan.output("output", result);
    run::whole(&plan.finish().unwrap(), &[("tensor", tensor.clone())])
}

#[test]
fn dividing_by_the_magnitude_rescues_storage_in_eight_bits() {
    let picture = zone_plates::picture(0.0);
    let mut table = Table::new(
        3,
        "Fig. 2.18",
        "Mean angular error of tensors stored in 32 and in 8 bits a value, in degrees",
        &["tensor", "32 bits", "8 bits", "8 bits, then smoothed by rho 2"],
    );
    let mut by = |name: &str, normalize: &str| {
        let params =
            [("derivative", "scharr3"), ("space", "luminance"), ("rho", "0"), ("normalize", normalize)];
        let exact = run::node("structure_tensor", &params, &picture);
        let stored = stored_in_bytes(&exact);
        let row =
            [&exact, &stored, &smoothed(&stored, 2.0)].map(|t| zone_plates::mean(&zone_plates::errors(t)));
        table.row(&[name.to_owned(), show(row[0]), show(row[1]), show(row[2])]);
        row
    };
    let plain = by("gradient times gradient", "false");
    let normalized = by("divided by the magnitude", "true");
    table.print();
    let lost = |row: [f64; 3]| row[1] - row[0];
    assert!(lost(plain) > 0.5, "eight bits are too few for squares of gradients");
    assert!(lost(normalized) < 0.4 * lost(plain), "and enough for what is linear in them");
}

/// Side of the ring pattern and distance of its rings, pixels.
const RINGS: u32 = 256;
const PERIOD: f64 = 24.0;

/// Rings around the middle, with Gaussian noise of this variance.
fn rings(variance: f64) -> Image {
    let mut random = Random::new(229);
    let middle = f64::from(RINGS) / 2.0;
    from_fn(RINGS, RINGS, |x, y| {
        let r = (f64::from(x) + 0.5 - middle).hypot(f64::from(y) + 0.5 - middle);
        let value =
            0.5 + 0.5 * (r * std::f64::consts::TAU / PERIOD).cos() + variance.sqrt() * random.normal();
        [value as f32, value as f32, value as f32, 1.0]
    })
}

/// Mean angular error on the rings, in degrees, and the share of pixels that are off by more than 15.
fn off_the_rings(tensor: &Image) -> (f64, f64) {
    let middle = f64::from(RINGS) / 2.0;
    let (mut sum, mut far, mut count) = (0.0, 0.0, 0.0);
    for y in 0..RINGS as i32 {
        for x in 0..RINGS as i32 {
            let (dx, dy) = (f64::from(x) + 0.5 - middle, f64::from(y) + 0.5 - middle);
            let r = dx.hypot(dy);
            if !(PERIOD..middle - 4.0).contains(&r) {
                continue;
            }
            let t = tensor.pixel(x, y);
            let [tx, ty] = scalar::tangent(t[0], t[1], t[2]);
            let error = ((f64::from(tx) * dx + f64::from(ty) * dy).abs() / r).min(1.0).asin().to_degrees();
            sum += error;
            far += f64::from(u8::from(error > 15.0));
            count += 1.0;
        }
    }
    (sum / count, far / count)
}

#[test]
fn several_scales_see_through_strong_noise() {
    let (clean, noisy) = (rings(0.0), rings(0.25));
    let mut table = Table::new(
        6,
        "Fig. 2.29",
        "Angular error on rings 24 pixels apart under noise of variance 0.25, rho 2",
        &["levels", "clean, mean", "noise, mean", "noise, more than 15 degrees off"],
    );
    let mut found = Vec::new();
    for levels in ["1", "2", "3", "4"] {
        let params = [("levels", levels), ("space", "luminance")];
        let on = |picture: &Image| off_the_rings(&run::node("structure_tensor", &params, picture));
        let (without, (mean, far)) = (on(&clean).0, on(&noisy));
        table.row(&[levels.to_owned(), show(without), show(mean), format!("{:.1} %", 100.0 * far)]);
        found.push((without, mean, far));
    }
    table.print();
    assert!(found[0].1 > 10.0, "one scale is lost in the noise");
    assert!(found[1].1 < 0.75 * found[0].1, "a second one helps");
    assert!(found[2].1 < 0.5 * found[0].1, "and a third one more");
    assert!(found.iter().all(|f| f.0 < 2.0), "without noise more levels do little harm");
}
