//! Colours of lines that artists paint: of files with bytes and in pictures of light, by frame, and what is refused.

use std::path::Path;
use std::process::Command;

use image::{Rgb, RgbImage, Rgba, RgbaImage};
use isophote_files::files::Existing;
use isophote_pictures::floats::{self, Picture};

use crate::support::{fails, folder, isophote, mattes, succeeds};

const SIZE: (u32, u32) = (96, 64);

fn apply(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).arg("apply").args(arguments).args(["--backend", "cpu", "--force"]);
    command
}

/// A tone with an edge across all columns.
fn tone(y: u32) -> u8 {
    if y < SIZE.1 / 2 { 235 } else { 60 }
}

/// Red of this strength on the left, nothing on the right.
fn paint(red: u8) -> RgbaImage {
    RgbaImage::from_fn(
        SIZE.0,
        SIZE.1,
        |x, _| if x < SIZE.0 / 2 { Rgba([red, 0, 0, 255]) } else { Rgba([0; 4]) },
    )
}

fn source(path: &Path) {
    let picture = RgbImage::from_fn(SIZE.0, SIZE.1, |_, y| Rgb([tone(y); 3]));
    picture.save(path).expect("it can be written");
}

fn read(path: &Path) -> RgbImage {
    image::open(path).expect("a picture was written").to_rgb8()
}

/// How much redder than green the line is in a column.
fn red(picture: &RgbImage, x: u32) -> i32 {
    let off = |y| i32::from(picture.get_pixel(x, y)[0]) - i32::from(picture.get_pixel(x, y)[1]);
    (0..SIZE.1).map(off).max().unwrap_or_default()
}

#[test]
fn lines_are_red_where_red_is_painted_and_their_own_elsewhere() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    source(&at("in.png"));
    paint(255).save(at("paint.png")).expect("it can be written");
    for style in ["cartoon", "ink", "blueprint"] {
        succeeds(&mut apply(folder.path(), &[style, "in.png", "plain.png"]));
        let run = [style, "in.png", "out.png", "--line-paint", "paint.png"];
        let (told, _) = succeeds(&mut apply(folder.path(), &run));
        assert!(told.contains("guides: line_paint from paint.png"), "{told}");
        let (plain, out) = (read(&at("plain.png")), read(&at("out.png")));
        let [own, left, right] = [red(&plain, 20), red(&out, 20), red(&out, 76)];
        assert!(left > own + 60 && right <= own + 8, "{style}: {own}, then {left} and {right}");
        let off = |x: u32, y: u32| out.get_pixel(x, y)[1].abs_diff(plain.get_pixel(x, y)[1]);
        let most = (60..SIZE.0).flat_map(|x| (0..SIZE.1).map(move |y| off(x, y))).max();
        assert!(most <= Some(1), "{style}: {most:?} where nothing is painted");
    }
}

#[test]
fn paint_shows_the_same_colour_in_pictures_of_light() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let light = |y: u32| ((f32::from(tone(y)) / 255.0 + 0.055) / 1.055).powf(2.4);
    let data = (0..SIZE.0 * SIZE.1).flat_map(|at| [light(at / SIZE.0); 3]).collect();
    let picture = Picture { width: SIZE.0, height: SIZE.1, channels: 3, data };
    let (precision, names) = (floats::Precision::Float, ["R", "G", "B"]);
    floats::save_exr(&at("in.exr"), Existing::Replace, &picture, &names, precision, (None, None))
        .expect("it can be written");
    source(&at("in.png"));
    paint(188).save(at("paint.png")).expect("as above");
    for (source, result) in [("in.exr", "out.exr"), ("in.png", "out.png")] {
        let lines = ["cartoon", source, result, "--line-paint", "paint.png", "--set", "line_width=3"];
        succeeds(&mut apply(folder.path(), &lines));
    }
    let (light, bytes) = (mattes::rgb(&at("out.exr")), read(&at("out.png")));
    assert!(red(&bytes, 20) > 40);
    for (light, bytes) in light.iter().flatten().zip(bytes.pixels().flat_map(|pixel| pixel.0)) {
        let shown = if *light < 0.0031308 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
        assert!((255.0 * shown - f32::from(bytes)).abs() < 2.0, "{light} beside {bytes}");
    }
}

#[test]
fn paint_comes_by_frame() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for frame in 1..=2 {
        source(&at(&format!("in.000{frame}.png")));
        let strength = if frame == 1 { 255 } else { 0 };
        paint(strength).save(at(&format!("paint.000{frame}.png"))).expect("it can be written");
    }
    let run = ["cartoon", "in.####.png", "out.####.png", "--line-paint", "paint.####.png"];
    succeeds(&mut apply(folder.path(), &run));
    let [first, second] = [1, 2].map(|frame| red(&read(&at(&format!("out.000{frame}.png"))), 20));
    assert!(first > 60 && second < 8, "{first} and {second}");
    let run = ["cartoon", "in.####.png", "out.####.png", "--line-paint", "missing.####.png"];
    fails(
        &mut apply(folder.path(), &run),
        2,
        &["missing.0001.png", "line paint files of the frames 1-2 are missing"],
    );
}

#[test]
fn what_cannot_be_followed_says_why() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    source(&at("in.png"));
    paint(255).save(at("paint.png")).expect("it can be written");
    RgbImage::new(9, 9).save(at("small.png")).expect("as above");
    for (style, file, words) in [
        ("watercolor", "paint.png", &["the style follows no line paint"][..]),
        ("cartoon", "small.png", &["small.png", "shows 9x9 pixels, and the picture 96x64"]),
        ("cartoon", "none.png", &["none.png"]),
    ] {
        let run = [style, "in.png", "out.png", "--line-paint", file];
        fails(&mut apply(folder.path(), &run), 2, words);
        assert!(!at("out.png").exists());
    }
}
