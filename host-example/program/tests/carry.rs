//! Painted maps that are carried along motion: on their things, sharp, between key frames, and refused where they do not fit.

use std::path::Path;

use image::{GrayImage, Luma, Rgba, RgbaImage};

use crate::support::{fails, folder, isophote, succeeds, turning_triangle};

/// Size of the frames.
const SIZE: (u32, u32) = (160, 120);
/// Numbers of the frames.
const FRAMES: std::ops::RangeInclusive<i64> = 1..=8;

/// Frames of a triangle that turns, with motion, and pictures of them.
fn shot(folder: &Path) {
    turning_triangle(folder);
    let render = |out: &str| {
        let mut command = isophote();
        command.current_dir(folder).args(["render", "triangle.gltf", out, "--animate", "--fps", "12"]);
        succeeds(command.args([
            "--frames",
            "1-8",
            "--size",
            "160x120",
            "--background",
            "transparent",
            "--no-ground",
        ]));
    };
    render("shot.####.exr");
    render("plain.####.png");
}

/// A mask of the thing in a frame, with `value` where it is.
fn mask(folder: &Path, frame: i64, value: u8) -> GrayImage {
    let plain = image::open(folder.join(format!("plain.{frame:04}.png"))).expect("a picture").into_rgba8();
    GrayImage::from_fn(SIZE.0, SIZE.1, |x, y| Luma([if plain.get_pixel(x, y)[3] > 127 { value } else { 0 }]))
}

/// Runs the verb; what it warns of.
fn carry(folder: &Path, arguments: &[&str]) -> String {
    let mut command = isophote();
    let (said, warned) = succeeds(command.current_dir(folder).arg("carry").args(arguments));
    let lines = if arguments.contains(&"--quiet") { 0 } else { 1 };
    assert_eq!(said.lines().count(), lines, "{said}");
    warned
}

fn carried(folder: &Path, frame: i64) -> GrayImage {
    image::open(folder.join(format!("out/mask.{frame:04}.png"))).expect("a map").into_luma8()
}

#[test]
fn a_mask_stays_on_its_thing_as_sharp_as_it_was_painted() {
    let folder = folder();
    let at = folder.path();
    shot(at);
    // From the middle to both ends.
    mask(at, 4, 255).save(at.join("mask.0004.png")).expect("the folder is writable");
    carry(at, &["mask.####.png", "shot.####.exr", "out/mask.####.png"]);
    assert_eq!(carried(at, 4), mask(at, 4, 255), "its own frame is as it was painted");
    for frame in FRAMES {
        let (found, wanted) = (carried(at, frame), mask(at, frame, 255));
        let pairs = || found.pixels().zip(wanted.pixels()).map(|(a, b)| (a[0] > 127, b[0] > 127));
        let both = pairs().filter(|(a, b)| *a && *b).count();
        let either = pairs().filter(|(a, b)| *a || *b).count();
        assert!(both * 100 >= either * 93, "frame {frame}: {both} of {either}");
        // Nothing between is spread beyond the border of the thing.
        let between = found.pixels().filter(|pixel| !matches!(pixel[0], 0..16 | 240..=255)).count();
        assert!(between * 20 < either, "frame {frame}: {between} of {either}");
    }
    // One file and the number of its frame are the same; what is there stays without --force.
    let one = ["mask.0004.png", "shot.####.exr", "again/mask.####.png", "--key", "4"];
    carry(at, &one);
    for frame in FRAMES {
        let name = format!("again/mask.{frame:04}.png");
        assert!(image::open(at.join(name)).expect("a map").into_luma8() == carried(at, frame));
    }
    let refused = |arguments: &[&str], words: &[&str]| {
        fails(isophote().current_dir(at).arg("carry").args(arguments), 2, words);
    };
    refused(&one, &["again/mask.0001.png", "--force"]);
    refused(&[&one[..2], &["mask.####.png", "--force"]].concat(), &["mask.0004.png"]);
}

#[test]
fn between_two_key_frames_both_are_seen_and_neutral_is_what_nobody_knows() {
    let folder = folder();
    let at = folder.path();
    shot(at);
    let map = |frame: i64, value: u8| {
        let thing = mask(at, frame, 1);
        RgbaImage::from_fn(SIZE.0, SIZE.1, |x, y| {
            let blue = if thing.get_pixel(x, y)[0] > 0 { value } else { 128 };
            Rgba([128, 128, blue, 255])
        })
    };
    map(1, 0).save(at.join("control.0001.png")).expect("the folder is writable");
    map(8, 255).save(at.join("control.0008.png")).expect("the folder is writable");
    carry(at, &["control.####.png", "shot.####.exr", "out/control.####.png", "--quiet"]);
    let mut last = -100.0;
    for frame in FRAMES {
        let map = image::open(at.join(format!("out/control.{frame:04}.png"))).expect("a map");
        // Alpha that nobody painted stays away.
        assert_eq!(map.color(), image::ColorType::Rgb8);
        let map = map.into_rgb8();
        let thing = mask(at, frame, 1);
        let pairs = map.pixels().zip(thing.pixels()).filter(|(_, is_thing)| is_thing[0] > 0);
        let blues: Vec<f32> = pairs.map(|(pixel, _)| f32::from(pixel[2])).collect();
        let mean = blues.iter().sum::<f32>() / blues.len() as f32;
        assert!(mean > last + 15.0, "frame {frame}: {mean} after {last}");
        last = mean;
        assert!(map.pixels().all(|pixel| (127..=128).contains(&pixel[0])));
    }
    // One of two that has alpha gives it to both.
    let with_alpha = RgbaImage::from_pixel(SIZE.0, SIZE.1, Rgba([128, 128, 128, 0]));
    with_alpha.save(at.join("control.0008.png")).expect("the folder is writable");
    carry(at, &["control.####.png", "shot.####.exr", "alpha/control.####.png", "--quiet"]);
    let alpha = |frame: i64| {
        let map = image::open(at.join(format!("alpha/control.{frame:04}.png"))).expect("a map").into_rgba8();
        map.get_pixel(SIZE.0 / 2, SIZE.1 / 2)[3]
    };
    assert!((127..=128).contains(&alpha(1)) && alpha(5) < 80 && alpha(8) == 0);
    // Looks take them by their frames.
    let mut apply = isophote();
    apply.current_dir(at).args(["apply", "ink", "shot.####.exr", "ink.####.png"]);
    succeeds(apply.args(["--control", "out/control.####.png", "--frames", "1-2"]));
}

#[test]
fn motion_is_estimated_where_there_is_none_and_what_does_not_fit_is_refused() {
    let folder = folder();
    let at = folder.path();
    // A texture that goes three pixels to the right a frame.
    for frame in FRAMES {
        let picture = GrayImage::from_fn(SIZE.0, SIZE.1, |x, y| {
            let (x, y) = ((x as f32) - 3.0 * frame as f32, y as f32);
            let waves = (x * 0.31).sin() * (y * 0.23).cos() + (x * 0.11 + y * 0.17).sin();
            Luma([(128.0 + 55.0 * waves) as u8])
        });
        picture.save(at.join(format!("shot.{frame:04}.png"))).expect("the folder is writable");
    }
    let square = |left: u32| {
        let inside = move |x: u32, y: u32| (left..left + 40).contains(&x) && (40..80).contains(&y);
        GrayImage::from_fn(SIZE.0, SIZE.1, move |x, y| Luma([if inside(x, y) { 255 } else { 0 }]))
    };
    square(50).save(at.join("mask.png")).expect("the folder is writable");
    let told = carry(at, &["mask.png", "shot.####.png", "out/mask.####.png", "--motion", "estimate"]);
    let (found, wanted) = (carried(at, 8), square(71));
    let other = found.pixels().zip(wanted.pixels()).filter(|(a, b)| (a[0] > 127) != (b[0] > 127)).count();
    assert!(other < 160, "{other} pixels are elsewhere");
    // What comes in at the left was never seen.
    assert!(told.contains("another key frame") && told.contains("frame 8"), "{told}");
    let refused = |arguments: &[&str], words: &[&str]| {
        fails(isophote().current_dir(at).arg("carry").args(arguments).arg("--force"), 2, words);
    };
    let (shot, out) = ("shot.####.png", "out/mask.####.png");
    refused(&["mask.png", shot, out], &["no motion vectors", "--motion estimate"]);
    refused(&["mask.png", shot, out, "--key", "20"], &["--key", "no frame 20", "from 1 to 8"]);
    refused(&["mask.png", "shot.0001.png", out], &["shot.0001.png", "place for a frame number"]);
    refused(&["mask.png", shot, "out/mask.####.jpg"], &["mask.0001.jpg", ".png"]);
    refused(&["other.####.png", shot, out], &["other.####.png"]);
    square(0).save(at.join("far.0020.png")).expect("the folder is writable");
    refused(&["far.####.png", shot, out], &["far.####.png", "1 to 8"]);
    RgbaImage::new(SIZE.0, SIZE.1).save(at.join("two.0001.png")).expect("the folder is writable");
    square(0).save(at.join("two.0002.png")).expect("the folder is writable");
    refused(&["two.####.png", shot, out], &["two.0002.png", "is grey", "by themselves"]);
    std::fs::rename(at.join("shot.0005.png"), at.join("away.png")).expect("it is there");
    refused(&["mask.png", shot, out, "--motion", "estimate"], &["no frame 5"]);
    std::fs::rename(at.join("away.png"), at.join("shot.0005.png")).expect("it is there");
    GrayImage::new(10, 10).save(at.join("small.png")).expect("the folder is writable");
    refused(&["small.png", shot, out, "--motion", "estimate"], &["160x120", "10x10"]);
}
