//! Importance on the CPU executor: shapes, texture and blur, the middle, and what styles make of it.

use crate::result;
use isophote::ColourSpace;
use isophote::engine::Image;

const SIZE: i32 = 480;
/// Width of each of three stripes.
const THIRD: i32 = SIZE / 3;

fn picture(value: impl Fn(i32, i32) -> f32) -> Image {
    let mut image = Image::new(SIZE as u32, SIZE as u32, 4).unwrap();
    for (at, pixel) in image.data_mut().chunks_exact_mut(4).enumerate() {
        let (x, y) = (at as i32 % SIZE, at as i32 / SIZE);
        let v = value(x, y);
        pixel.copy_from_slice(&[v, v, v, 1.0]);
    }
    image
}

/// Numbers between 0 and 1 without order.
fn noise(x: i32, y: i32) -> f32 {
    let mut n = (x as u32).wrapping_mul(0x9e37_79b9) ^ (y as u32).wrapping_mul(0x85eb_ca6b);
    n = (n ^ (n >> 15)).wrapping_mul(0x2c1b_3c6d);
    n = (n ^ (n >> 12)).wrapping_mul(0x297a_2d39);
    ((n ^ (n >> 15)) >> 8) as f32 / 16_777_216.0
}

/// Discs of light on dark, 80 pixels apart, whose borders are so many pixels wide.
fn discs(x: i32, y: i32, soft: f32) -> f32 {
    let [dx, dy] = [x, y].map(|v| (v.rem_euclid(80) - 40) as f32 + 0.5);
    0.2 + 0.6 * ((26.0 - dx.hypot(dy)) / soft + 0.5).clamp(0.0, 1.0)
}

/// Sharp discs, noise, and discs out of focus, side by side.
fn kinds() -> Image {
    picture(|x, y| match x / THIRD {
        0 => discs(x, y, 1.0),
        1 => 0.2 + 0.6 * noise(x, y),
        _ => discs(x, y, 20.0),
    })
}

fn importance(image: &Image, centre: &str) -> Image {
    result::of("importance", &[("importance_centre", centre)], ColourSpace::Srgb, &[("color", image)])
}

fn at(image: &Image, x: i32, y: i32) -> f32 {
    image.row(y)[4 * x as usize + 1]
}

/// Mean over the middle half of a stripe.
fn mean(image: &Image, stripe: i32) -> f32 {
    let columns = stripe * THIRD + THIRD / 4..(stripe + 1) * THIRD - THIRD / 4;
    let rows = SIZE / 4..SIZE - SIZE / 4;
    let values = rows.flat_map(|y| columns.clone().map(move |x| at(image, x, y)));
    values.clone().sum::<f32>() / values.count() as f32
}

#[test]
fn sharp_shapes_matter_and_texture_and_blur_do_not() {
    let found = importance(&kinds(), "0");
    let [shapes, texture, blur] = [0, 1, 2].map(|stripe| mean(&found, stripe));
    assert!(shapes > 0.7 && texture < 0.4 && blur < 0.4, "{shapes} {texture} {blur}");
}

#[test]
fn the_middle_matters_more_where_that_is_asked_for() {
    let discs = picture(|x, y| discs(x, y, 1.0));
    let found = ["0", "1"].map(|centre| importance(&discs, centre));
    let corner = found.each_ref().map(|image| at(image, 2, 2));
    let middle = found.each_ref().map(|image| at(image, SIZE / 2, SIZE / 2));
    assert!(corner[1] < 0.4 * corner[0], "{corner:?}");
    assert!((middle[1] - middle[0]).abs() < 0.01 * middle[0], "{middle:?}");
}

/// Mean difference of neighbours in a row, of a stripe's middle half.
fn roughness(image: &Image, stripe: i32) -> f32 {
    let columns = stripe * THIRD + THIRD / 4..(stripe + 1) * THIRD - THIRD / 4;
    let rows = SIZE / 4..SIZE - SIZE / 4;
    rows.flat_map(|y| columns.clone().map(move |x| (at(image, x + 1, y) - at(image, x, y)).abs())).sum()
}

#[test]
fn styles_calm_texture_and_keep_shapes() {
    let image = kinds();
    let drawn = |importance: &str| {
        let settings = [("importance", importance), ("importance_centre", "0")];
        result::of("cartoon", &settings, ColourSpace::Srgb, &[("color", &image)])
    };
    let [plain, directed] = ["0", "1"].map(drawn);
    let more = [0, 1].map(|stripe| roughness(&directed, stripe) / roughness(&plain, stripe));
    assert!(more[0] > 0.99, "shapes: {more:?}");
    assert!(more[1] < 0.6, "texture: {more:?}");
}

#[test]
fn what_an_artist_painted_adds_to_what_is_found() {
    let image = kinds();
    let mut map = Image::new(SIZE as u32, SIZE as u32, 4).unwrap();
    map.data_mut().fill(0.5);
    let drawn = |importance: &str, map: &Image| {
        let settings = [("importance", importance)];
        result::of("cartoon", &settings, ColourSpace::Srgb, &[("color", &image), ("control", map)])
    };
    let alone = result::of("cartoon", &[("importance", "0.7")], ColourSpace::Srgb, &[("color", &image)]);
    assert_eq!(drawn("0.7", &map).data(), alone.data(), "a neutral map adds nothing");
    map.data_mut().iter_mut().skip(2).step_by(4).for_each(|v| *v = 0.0);
    let [without, both] = ["0", "0.7"].map(|importance| drawn(importance, &map));
    let dark = |image: &Image| image.data().chunks_exact(4).filter(|p| p[1] < 0.15).count();
    assert!(dark(&both) <= dark(&without), "no lines come back where a map takes all");
    assert!(dark(&without) < dark(&alone));
}
