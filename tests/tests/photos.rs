//! Styles of lines on photographs, on free ones of the documentation and on those beside the checkout: eyes, mouths and letters
//! are drawn, leaves and fur are not; and the cartoon style: flatter, with dark coherent
//! lines, without speckles or halos (compare Figure 4.8).

use isophote::Request;
use isophote_engine::Image;
use isophote_tests::pictures::from_fn;
use isophote_tests::{png, run};
use std::collections::BTreeSet;
use std::path::Path;

/// A photograph at half its size.
fn photo(name: &str) -> Option<Image> {
    let Some(assets) = png::assets() else {
        eprintln!("\n*** SKIPPED: no photographs beside the checkout ***\n");
        return None;
    };
    let full = png::read(&assets.join("photo").join(name)).unwrap();
    Some(from_fn(full.width() / 2, full.height() / 2, |x, y| {
        let at = |dx, dy| full.pixel(2 * x + dx, 2 * y + dy);
        [0, 1, 2, 3].map(|c| 0.25 * (at(0, 0)[c] + at(1, 0)[c] + at(0, 1)[c] + at(1, 1)[c]))
    }))
}

fn luma(p: &[f32]) -> f32 {
    0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]
}

/// Median size of the luma's gradient.
fn median_gradient(image: &Image) -> f32 {
    let (w, h) = (image.width() as i32, image.height() as i32);
    let mut all = Vec::new();
    for y in 1..h - 1 {
        for x in 1..w - 1 {
            let at = |dx: i32, dy: i32| luma(image.pixel(x + dx, y + dy));
            all.push((at(1, 0) - at(-1, 0)).hypot(at(0, 1) - at(0, -1)) / 2.0);
        }
    }
    all.sort_by(f32::total_cmp);
    all[all.len() / 2]
}

/// Colours that differ in their upper six bits.
fn distinct_colours(image: &Image) -> usize {
    let rounded = |p: &[f32]| [0, 1, 2].map(|c| (p[c].clamp(0.0, 1.0) * 63.0).round() as u8);
    image.data().chunks_exact(4).map(rounded).collect::<BTreeSet<_>>().len()
}

/// Greatest (`most`) or least luma around a pixel.
fn around(image: &Image, x: i32, y: i32, radius: i32, most: bool) -> f32 {
    let mut found = luma(image.pixel(x, y));
    for ny in (y - radius).max(0)..=(y + radius).min(image.height() as i32 - 1) {
        for nx in (x - radius).max(0)..=(x + radius).min(image.width() as i32 - 1) {
            let v = luma(image.pixel(nx, ny));
            found = if most { found.max(v) } else { found.min(v) };
        }
    }
    found
}

/// Least luma of the eight neighbours of a pixel that is not at the border.
fn least_beside(image: &Image, x: i32, y: i32) -> f32 {
    let rest = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))).filter(|d| *d != (0, 0));
    rest.map(|(dx, dy)| luma(image.pixel(x + dx, y + dy))).fold(f32::MAX, f32::min)
}

fn check(name: &str) {
    let Some(photo) = photo(name) else { return };
    let (w, h) = (photo.width() as i32, photo.height() as i32);
    let pixels = (w * h) as f32;
    let graph = run::single("cartoon", &[]);
    let request = Request { scale: 0.5, ..Request::new(photo.width(), photo.height()) };
    let cartoon = run::graph(&graph, request, &photo);
    png::write(&png::results().join(format!("cartoon-{name}")), &cartoon);

    let change =
        photo.data().iter().zip(cartoon.data()).map(|(a, b)| (a - b).abs()).sum::<f32>() / (4.0 * pixels);
    let (before, after) = (median_gradient(&photo), median_gradient(&cartoon));
    let (many, few) = (distinct_colours(&photo), distinct_colours(&cartoon));

    // Lines: clearly darker than anything nearby was.
    let is_line = |x: i32, y: i32| luma(cartoon.pixel(x, y)) < 0.6 * around(&photo, x, y, 1, false) - 0.02;
    let mut lines = vec![false; (w * h) as usize];
    let mut halos = 0;
    for y in 0..h {
        for x in 0..w {
            lines[(y * w + x) as usize] = is_line(x, y);
            halos += usize::from(luma(cartoon.pixel(x, y)) > around(&photo, x, y, 4, true) + 0.1);
        }
    }
    let line_at = |x: i32, y: i32| x >= 0 && y >= 0 && x < w && y < h && lines[(y * w + x) as usize];
    let (mut drawn, mut speckles, mut neighbours) = (0, 0, 0);
    for y in 0..h {
        for x in 0..w {
            if line_at(x, y) {
                let near = (-1..=1)
                    .flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)))
                    .filter(|d| *d != (0, 0) && line_at(x + d.0, y + d.1))
                    .count();
                drawn += 1;
                neighbours += near;
            }
            // Darker than all its neighbours by far.
            let is_inside = x > 0 && y > 0 && x < w - 1 && y < h - 1;
            speckles +=
                usize::from(is_inside && luma(cartoon.pixel(x, y)) < least_beside(&cartoon, x, y) - 0.15);
        }
    }
    let share = |n: usize| n as f32 / pixels;
    println!(
        "{name}: mean change {change:.3}, median gradient {before:.4} -> {after:.4}, colours {many} -> {few}, \
         lines {:.2} % with {:.1} neighbours each, speckles {:.3} %, halos {:.3} %",
        100.0 * share(drawn),
        neighbours as f32 / drawn.max(1) as f32,
        100.0 * share(speckles),
        100.0 * share(halos)
    );
    assert!(change > 0.01, "the picture changed");
    // Where little changes tones stay continuous.
    assert!(after < 0.7 * before, "flat parts became flatter");
    assert!(few < many * 4 / 5, "there are fewer colours");
    assert!(share(drawn) > 0.005 && share(drawn) < 0.25, "there are lines, and not only lines");
    assert!(neighbours as f32 / drawn as f32 > 1.9, "lines hang together");
    assert!(share(speckles) < 0.001, "no speckles");
    assert!(share(halos) < 0.005, "no halos");
}

#[test]
fn the_astronaut_becomes_a_cartoon() {
    check("astronaut.png");
}

#[test]
fn the_cat_becomes_a_cartoon() {
    check("chelsea.png");
}

/// Share of the pixels of a box of a blueprint that are line.
fn line_share(blueprint: &Image, [x0, y0, x1, y1]: [i32; 4]) -> f32 {
    let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y)));
    let lines = pixels.filter(|(x, y)| blueprint.pixel(*x, *y)[0] > 0.5).count();
    lines as f32 / ((x1 - x0) * (y1 - y0)) as f32
}

/// A photograph as lines alone, as [`run::single`] sets `params`.
fn line_drawing(name: &str, params: &[(&str, &str)]) -> Option<Image> {
    let photo = png::read(&png::assets()?.join("photo").join(name)).unwrap();
    let plain = [("fill", "0"), ("grid", "0"), ("paper_texture", "0")];
    let graph = run::single("blueprint", &[&plain, params].concat());
    let scale = photo.height() as f32 / 1080.0;
    Some(run::graph(&graph, Request { scale, ..Request::new(photo.width(), photo.height()) }, &photo))
}

/// Local contrast, inhibition and colours as styles had them not.
const WITHOUT: [(&str, &str); 3] = [("local_contrast", "0"), ("inhibition", "0"), ("colour_edges", "0")];

#[test]
fn eyes_and_mouths_are_drawn_and_fur_and_hair_are_not() {
    let Some(now) = line_drawing("astronaut.png", &[]) else { return };
    for (part, place) in [
        ("left eye", [190, 94, 214, 108]),
        ("right eye", [236, 96, 260, 109]),
        ("mouth", [203, 137, 249, 155]),
    ] {
        let share = line_share(&now, place);
        println!("astronaut, {part}: {:.1} %", 100.0 * share);
        assert!(share > 0.1, "{part}: {share}");
    }
    let (Some(now), Some(before)) = (line_drawing("chelsea.png", &[]), line_drawing("chelsea.png", &WITHOUT))
    else {
        return;
    };
    let contrast = [("inhibition", "0")];
    let Some(uninhibited) = line_drawing("chelsea.png", &contrast) else { return };
    let (eye, fur) = ([130, 80, 210, 150], [200, 0, 310, 70]);
    let [eye, fur] =
        [eye, fur].map(|place| [&now, &before, &uninhibited].map(|lines| line_share(lines, place)));
    println!("cat: eye {eye:?}, fur {fur:?} now, before, without inhibition");
    assert!(eye[0] > 0.9 * eye[1] && fur[0] < 0.5 * fur[2], "an eye stays, fur yields");
}

/// Part of a photograph, from its left and upper side to its right and lower one, pixels.
type Place = [i32; 4];

/// A free photograph that the documentation shows.
fn free_photo(name: &str) -> Image {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../xtask/docs/pictures/gallery");
    png::read(&folder.join(format!("{name}.jpg"))).unwrap()
}

/// A photograph in a style, as a picture of 1080 lines would be.
fn styled(photo: &Image, style: &str, params: &[(&str, &str)]) -> Image {
    let request =
        Request { scale: photo.height() as f32 / 1080.0, ..Request::new(photo.width(), photo.height()) };
    run::graph(&run::single(style, params), request, photo)
}

/// Standard deviation of the luma in a place: what is nothing but paper, ink or skin has hardly any.
fn deviation(image: &Image, [x0, y0, x1, y1]: Place) -> f32 {
    let lumas: Vec<f32> =
        (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))).map(|(x, y)| luma(image.pixel(x, y))).collect();
    let mean = lumas.iter().sum::<f32>() / lumas.len() as f32;
    (lumas.iter().map(|v| (v - mean) * (v - mean)).sum::<f32>() / lumas.len() as f32).sqrt()
}

/// Lines alone.
const BARE: [(&str, &str); 3] = [("fill", "0"), ("grid", "0"), ("paper_texture", "0")];

/// Eyes, then mouths and noses; on the lantern letters and a seal.
const FEATURES: [(&str, &[Place]); 5] = [
    ("astronaut", &[[190, 94, 214, 108], [236, 96, 260, 109], [203, 137, 249, 155]]),
    ("hopper", &[[188, 169, 233, 195], [264, 169, 310, 195], [230, 253, 286, 280]]),
    ("raccoon", &[[319, 164, 355, 195], [404, 176, 443, 206], [340, 240, 390, 288]]),
    ("lantern", &[[165, 90, 195, 120], [165, 122, 195, 153], [163, 155, 195, 184], [165, 187, 194, 213]]),
    ("cat", &[[130, 80, 210, 150], [298, 105, 345, 165]]),
];

#[test]
fn features_are_drawn_in_all_styles_of_lines() {
    for (style, params) in [("cartoon", &[][..]), ("ink", &[]), ("blueprint", &BARE)] {
        let found: Vec<f32> = FEATURES
            .iter()
            .flat_map(|(name, places)| {
                let drawn = styled(&free_photo(name), style, params);
                places.iter().map(move |place| deviation(&drawn, *place)).collect::<Vec<_>>()
            })
            .collect();
        let drawn = found.iter().filter(|deviation| **deviation >= 0.1).count();
        println!("{style}: {drawn} of {} features, {found:.2?}", found.len());
        assert!(drawn * 10 >= found.len() * 9, "{style}: {found:.2?}");
    }
}

#[test]
fn leaves_and_fur_have_few_lines_and_faces_in_soft_light_as_many_as_in_hard() {
    let share = |name: &str, inhibition: &str, place: Place| {
        let params = [&BARE[..], &[("inhibition", inhibition)]].concat();
        line_share(&styled(&free_photo(name), "blueprint", &params), place)
    };
    for (name, place) in [("raccoon", [35, 35, 210, 150]), ("palace", [300, 285, 500, 390])] {
        let [calm, busy] = ["1", "0"].map(|inhibition| share(name, inhibition, place));
        println!("{name}: {:.1} % of lines, {:.1} % without inhibition", 100.0 * calm, 100.0 * busy);
        assert!(calm <= 0.3 * busy, "{name}: {calm} of {busy}");
    }
    let soft = share("astronaut", "1", [180, 70, 275, 175]);
    let hard = share("hopper", "1", [141, 122, 356, 319]);
    println!("faces: {:.1} % of lines in soft light, {:.1} % in hard", 100.0 * soft, 100.0 * hard);
    assert!(soft >= hard * 2.0 / 3.0, "{soft} of {hard}");
}
