//! Experiment on the separable forms of the bilateral filter (Fig. 3.6): along x and y it shows
//! artefacts that are aligned with the axes, along the local orientation it does not.

use isophote_engine::Image;
use isophote_tests::pictures::from_fn;
use isophote_tests::random::Random;
use isophote_tests::run;
use isophote_tests::table::Table;

const SIZE: i32 = 160;

/// A straight edge and a disc, as soft as a photograph's, with weak waves in all directions on them; the
/// whole turned by `degrees`. Sharper edges would show how the raster draws them at each angle.
fn turned(degrees: f64) -> Image {
    let mut random = Random::new(5);
    let waves: Vec<[f64; 3]> = (0..24)
        .map(|_| {
            let angle = f64::from(random.range(0.0, std::f32::consts::TAU));
            let frequency = std::f64::consts::TAU / f64::from(random.range(7.0, 16.0));
            [frequency * angle.cos(), frequency * angle.sin(), f64::from(random.range(0.0, 6.0))]
        })
        .collect();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let half = f64::from(SIZE) / 2.0;
    from_fn(SIZE as u32, SIZE as u32, |x, y| {
        let (x, y) = (f64::from(x) + 0.5 - half, f64::from(y) + 0.5 - half);
        let (u, v) = (cos * x + sin * y, cos * y - sin * x);
        let soft = |d: f64| 0.5 + 0.5 * (d / 4.0).tanh();
        let texture = waves.iter().map(|[fx, fy, phase]| (fx * u + fy * v + phase).cos()).sum::<f64>();
        let edge = 0.25 * soft(u + 0.2 * v);
        let disc = 0.15 * soft(18.0 - (u + 14.0).hypot(v - 10.0));
        let value = (0.35 + edge - disc + 0.007 * texture) as f32;
        [value, value, value, 1.0]
    })
}

/// The value at a place between pixels, by Catmull-Rom splines.
fn sample(image: &Image, x: f64, y: f64) -> f64 {
    let weights = |f: f64| {
        let (f2, f3) = (f * f, f * f * f);
        [
            -0.5 * f + f2 - 0.5 * f3,
            1.0 - 2.5 * f2 + 1.5 * f3,
            0.5 * f + 2.0 * f2 - 1.5 * f3,
            0.5 * f3 - 0.5 * f2,
        ]
    };
    let (x, y) = (x - 0.5, y - 0.5);
    let (wx, wy) = (weights(x - x.floor()), weights(y - y.floor()));
    let mut sum = 0.0;
    for (j, wy) in wy.iter().enumerate() {
        for (i, wx) in wx.iter().enumerate() {
            let p = image.pixel(x.floor() as i32 - 1 + i as i32, y.floor() as i32 - 1 + j as i32);
            sum += wx * wy * f64::from(p[0]);
        }
    }
    sum
}

/// Root mean square difference between two pictures after the second is turned back by `degrees`, in
/// a disc around the middle, in per cent of white.
fn difference(upright: &Image, turned: &Image, degrees: f64) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let half = f64::from(SIZE) / 2.0;
    let (mut sum, mut count) = (0.0, 0.0);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let (u, v) = (f64::from(x) + 0.5 - half, f64::from(y) + 0.5 - half);
            if u.hypot(v) < half - 24.0 {
                let there = sample(turned, cos * u - sin * v + half, sin * u + cos * v + half);
                sum += (f64::from(upright.pixel(x, y)[0]) - there).powi(2);
                count += 1.0;
            }
        }
    }
    100.0 * (sum / count).sqrt()
}

#[test]
fn oriented_filtering_shows_no_artefacts_along_the_axes() {
    let common = [("iterations", "5")];
    let oriented: &[(&str, &str)] = &[("sampling", "manual"), ("sigma_rg", "5"), ("sigma_rt", "5")];
    let variants = [
        ("full", "bilateral", &[("kernel", "full"), ("sigma_r", "5")][..]),
        ("xy-separable", "bilateral", &[("kernel", "xy"), ("sigma_r", "5")]),
        ("oriented", "oriented_bilateral", oriented),
    ];
    let angles = [15.0, 30.0, 45.0];
    let mut table = Table::new(
        9,
        "Fig. 3.6",
        "A picture filtered upright against itself filtered turned and turned back: RMS difference in per \
         cent of white",
        &["bilateral filter", "15 degrees", "30 degrees", "45 degrees"],
    );
    let mut row = |name: &str, differences: [f64; 3]| {
        let mut cells = vec![name.to_owned()];
        cells.extend(differences.iter().map(|d| format!("{d:.2}")));
        table.row(&cells);
        differences
    };
    row("none", angles.map(|angle| difference(&turned(0.0), &turned(angle), angle)));
    let [full, separable, oriented] = variants.map(|(name, node, params)| {
        let params: Vec<(&str, &str)> = params.iter().chain(&common).copied().collect();
        let upright = run::node(node, &params, &turned(0.0));
        row(name, angles.map(|angle| difference(&upright, &run::node(node, &params, &turned(angle)), angle)))
    });
    table.print();
    for i in 0..angles.len() {
        assert!(oriented[i] < 0.6 * separable[i], "at {} degrees", angles[i]);
        assert!(full[i] < 0.6 * separable[i], "at {} degrees", angles[i]);
    }
}
