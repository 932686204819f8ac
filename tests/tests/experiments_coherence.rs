//! Experiments of § 6: shapes survive coherence-enhancing filtering (Fig. 6.15), which converges where
//! the equations it replaces do not (Fig. 6.19), and shock filters keep to the range of their input.

use isophote_engine::Image;
use isophote_tests::compare::distance;
use isophote_tests::pictures::{self, Kind, from_fn};
use isophote_tests::png;
use isophote_tests::run;
use isophote_tests::table::Table;

/// By how much the values of `image` leave the range of `of`, channel by channel.
fn beyond(image: &Image, of: &Image) -> f32 {
    let mut worst = 0.0f32;
    for c in 0..3 {
        let channel =
            |image: &'_ Image| image.data().iter().skip(c).step_by(4).copied().collect::<Vec<f32>>();
        let (ours, theirs) = (channel(image), channel(of));
        let least = theirs.iter().copied().fold(f32::INFINITY, f32::min);
        let greatest = theirs.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        for v in ours {
            worst = worst.max(v - greatest).max(least - v);
        }
    }
    worst
}

/// 2 image - Gaussian: unsharp masking of weight 1.
fn unsharp(image: &Image) -> Image {
    let mut result = run::node("gaussian", &[("sigma", "3")], image);
    for (r, i) in result.data_mut().chunks_exact_mut(4).zip(image.data().chunks_exact(4)) {
        for c in 0..3 {
            r[c] = 2.0 * i[c] - r[c];
        }
    }
    result
}

/// Largest slope between neighbours in a row.
fn sharpness(image: &Image) -> f32 {
    let row = image.row(image.height() as i32 / 2);
    row.chunks_exact(4).zip(row.chunks_exact(4).skip(1)).map(|(a, b)| (b[0] - a[0]).abs()).fold(0.0, f32::max)
}

#[test]
fn shock_filters_keep_to_the_range_of_their_input() {
    let soft = run::node(
        "gaussian",
        &[("sigma", "2")],
        &from_fn(64, 48, |x, _| {
            let v = if x < 32 { 0.25 } else { 0.75 };
            [v, v, 1.0 - v, 1.0]
        }),
    );
    let pictures = [
        ("soft edge", soft),
        ("scenery", pictures::scenery(160, 120)),
        ("noise", pictures::color(Kind::Noise, 96, 64)),
    ];
    let mut table = Table::new(
        15,
        "§ 6.4.1",
        "How far values leave the range of the picture; steepest slope across a soft edge, before 0.10",
        &["filter", "soft edge", "scenery", "noise", "slope"],
    );
    for variant in ["osher_rudin", "coherence_enhancing", "gradient_directed"] {
        let filter = |image: &Image| run::node("shock", &[("variant", variant), ("iterations", "10")], image);
        let results: Vec<Image> = pictures.iter().map(|(_, p)| filter(p)).collect();
        let mut cells = vec![format!("shock, {variant}")];
        for (result, (name, picture)) in results.iter().zip(&pictures) {
            let outside = beyond(result, picture);
            // A step may round, and nothing more.
            assert!(outside <= 1e-6, "{variant} leaves the range of the {name} by {outside}");
            cells.push(format!("{:.3}", outside.max(0.0)));
        }
        let slope = sharpness(&results[0]);
        assert!(slope > 1.5 * sharpness(&pictures[0].1), "{variant} sharpens to {slope}");
        cells.push(format!("{slope:.2}"));
        table.row(&cells);
    }
    let results: Vec<Image> = pictures.iter().map(|(_, p)| unsharp(p)).collect();
    let mut cells = vec!["unsharp masking".to_owned()];
    for (result, (name, picture)) in results.iter().zip(&pictures) {
        let outside = beyond(result, picture);
        assert!(outside > 0.03, "unsharp masking of the {name} stays inside: {outside}");
        cells.push(format!("{outside:.3}"));
    }
    cells.push(format!("{:.2}", sharpness(&results[0])));
    table.row(&cells);
    table.print();
}

/// Side of the square around one disc.
const SQUARE: i32 = 48;
/// Radii of the discs, pixels.
const RADII: [f32; 4] = [4.0, 6.0, 9.0, 14.0];

/// Dark discs on a light ground, with edges as soft as a lens makes them.
fn discs() -> Image {
    from_fn(SQUARE as u32 * RADII.len() as u32, SQUARE as u32, |x, y| {
        let (dx, dy) = ((x % SQUARE) as f32 + 0.5 - 24.2, y as f32 + 0.5 - 23.9);
        let distance = dx.hypot(dy) - RADII[(x / SQUARE) as usize];
        let v = 0.2 + 0.6 * (0.5 + distance / 1.5).clamp(0.0, 1.0);
        [v, v, v, 1.0]
    })
}

/// Areas of the discs: how much darker than the ground their squares are.
fn areas(image: &Image) -> [f64; RADII.len()] {
    std::array::from_fn(|disc| {
        let columns = disc as i32 * SQUARE..(disc as i32 + 1) * SQUARE;
        let dark = columns.flat_map(|x| (0..SQUARE).map(move |y| (x, y)));
        dark.map(|(x, y)| f64::from((0.8 - image.pixel(x, y)[0]) / 0.6)).sum()
    })
}

#[test]
fn discs_keep_their_area() {
    let discs = discs();
    let before = areas(&discs);
    let after = |id: &str, params: &[(&str, &str)]| {
        let after = areas(&run::node(id, params, &discs));
        [0, 1, 2, 3].map(|i| after[i] / before[i] - 1.0)
    };
    let mut table = Table::new(
        14,
        "Fig. 6.15",
        "Change of the area of dark discs of some radii, in percent",
        &["filter", "4 px", "6 px", "9 px", "14 px"],
    );
    let cells = |name: &str, changes: [f64; 4]| {
        let percents = changes.map(|c| format!("{:+.0}", 100.0 * c));
        [vec![name.to_owned()], percents.to_vec()].concat()
    };
    let coherent = after("coherence_enhancing", &[("iterations", "10")]);
    table.row(&cells("coherence-enhancing filter, 10 iterations", coherent));
    let flow = after("mean_curvature_flow", &[("iterations", "15")]);
    table.row(&cells("mean curvature flow, 15 steps", flow));
    let sharpened = after("mean_curvature_flow", &[("iterations", "15"), ("shock_every", "5")]);
    table.row(&cells("the same, shock filter after every 5", sharpened));
    table.print();
    assert!(coherent.iter().all(|change| change.abs() < 0.02), "{coherent:?}");
    for shrinking in [flow, sharpened] {
        assert!(shrinking[0] < -0.15 && shrinking[1] < -0.07, "{shrinking:?}");
    }
}

#[test]
fn fifty_iterations_converge_where_the_equation_goes_on_shrinking() {
    let discs = discs();
    let mut table = Table::new(
        14,
        "Fig. 6.19",
        "Change of the area of dark discs after 50 iterations, and mean change of a pixel over the last ten",
        &["filter", "4 px", "6 px", "9 px", "14 px", "last ten"],
    );
    let mut limits = Vec::new();
    for (name, id, setting) in [
        ("coherence-enhancing filter", "coherence_enhancing", ("sigma_a", "1.5")),
        ("mean curvature flow, shock filter after every 5", "mean_curvature_flow", ("shock_every", "5")),
    ] {
        let after = |iterations: &str| run::node(id, &[("iterations", iterations), setting], &discs);
        let (forty, fifty) = (after("40"), after("50"));
        let (before, now) = (areas(&discs), areas(&fifty));
        let changes = [0, 1, 2, 3].map(|i| now[i] / before[i] - 1.0);
        let (_, last) = distance(&forty, &fifty);
        let percents = changes.map(|c| format!("{:+.0}", 100.0 * c));
        table.row(&[vec![name.to_owned()], percents.to_vec(), vec![format!("{last:.4}")]].concat());
        limits.push((changes, last));
    }
    table.print();
    let [(kept, steady), (shrunk, going)] = limits[..] else { panic!("two filters were compared") };
    assert!(kept.iter().all(|change| change.abs() < 0.06), "{kept:?}");
    assert!(shrunk[0] < -0.5 && shrunk[1] < -0.25, "{shrunk:?}");
    assert!(5.0 * steady < going, "{steady} against {going}");
}

/// A photograph where they lie beside the checkout, and a painted scene.
fn pictures() -> Vec<(&'static str, Image)> {
    let photo = |name: &'static str| {
        let full = png::read(&png::assets()?.join("photo").join(name)).ok()?;
        // The middle: faces, of a woman and of a cat.
        let (x0, y0) = (full.width() as i32 / 2 - 96, full.height() as i32 / 4 - 40);
        Some((
            name,
            from_fn(192, 160, |x, y| full.pixel(x0 + x, (y0 + y).max(0)).try_into().unwrap_or([0.0; 4])),
        ))
    };
    let found = ["astronaut.png", "chelsea.png"].into_iter().filter_map(photo);
    found.chain([("scenery", pictures::scenery(192, 160))]).collect()
}

#[test]
fn fifty_iterations_settle_on_pictures_where_weickerts_filter_does_not() {
    let mut table = Table::new(
        14,
        "Fig. 6.19",
        "Mean change of a pixel from the 40th to the 50th iteration, of 255",
        &[
            "picture",
            "coherence-enhancing filter",
            "Weickert's shock filter, sigma_i 3",
            "the same, sigma_i 0",
            "constrained mean curvature flow, shock filter after every 5",
            "the same, not constrained",
        ],
    );
    for (name, picture) in pictures() {
        let moved = |id: &str, settings: &[(&str, &str)]| {
            let after = |n| run::node(id, &[settings, &[("iterations", n)]].concat(), &picture);
            255.0 * distance(&after("40"), &after("50")).1
        };
        let coherent = moved("coherence_enhancing", &[]);
        // What abstracts in it is the smoothing before the second derivative; without, it only sharpens and settles.
        let [weickert, sharpening] =
            ["3", "0"].map(|s| moved("shock", &[("variant", "coherence_enhancing"), ("sigma_i", s)]));
        let constrained =
            moved("mean_curvature_flow", &[("constraint", "1"), ("shock_every", "5"), ("rho", "2")]);
        let free = moved("mean_curvature_flow", &[("shock_every", "5")]);
        let cells = [coherent, weickert, sharpening, constrained, free].map(|v| format!("{v:.2}"));
        table.row(&[vec![name.to_owned()], cells.to_vec()].concat());
        assert!(3.0 * coherent < weickert, "{name}: {coherent}, by Weickert's filter {weickert}");
        // Mean curvature flow goes on by little in each step, and does not stop.
        assert!(constrained > 0.1 && free > 0.1, "{name}: {constrained}, {free}");
    }
    table.print();
}
