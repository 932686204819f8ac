//! Guides: the program knows all that the library has, painted flow maps bend what styles draw, and control maps direct it.

use std::fs;
use std::path::Path;
use std::process::Command;

use image::{Rgba, RgbaImage};
use isophote_finishing::stylize::preset::Lengths;
use isophote_finishing::stylize::style::Style;
use isophote_loader::{Control, Input, Library};
use isophote_pictures::exr::Guide;
use isophote_pictures::pixels::{Pixels, Precision, Samples};

use crate::support::{self, fails, folder, isophote, picture, succeeds};

const SIZE: (u32, u32) = (96, 64);

fn apply(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = isophote();
    // Lengths of a picture with 1,080 rows would be less than a pixel here.
    command.current_dir(folder).arg("apply").args(arguments).args([
        "--backend",
        "cpu",
        "--lengths",
        "pixels",
    ]);
    command
}

/// A flow map that leads down to the right everywhere.
fn flow() -> RgbaImage {
    RgbaImage::from_pixel(SIZE.0, SIZE.1, Rgba([217, 217, 0, 255]))
}

#[test]
fn every_guide_of_the_library_is_known() {
    let library = Library::from_file(support::library()).expect("the library");
    let mut known: Vec<&str> = Guide::ALL.map(Guide::id).into();
    // Masks have an option of their own, and of Cryptomattes the program makes the maps of rules by itself.
    known.extend(["mask", "cryptomatte"]);
    known.sort_unstable();
    let mut listed: Vec<&str> = library.guides().expect("the guides").iter().map(|guide| guide.id).collect();
    listed.sort_unstable();
    assert_eq!(known, listed);
}

#[test]
fn a_flow_map_bends_what_a_style_draws() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let input = picture(SIZE.0, SIZE.1);
    input.save(at("in.png")).expect("the picture can be written");
    flow().save(at("flow.png")).expect("as above");
    succeeds(&mut apply(folder.path(), &["oil_paint", "in.png", "plain.png"]));
    succeeds(&mut apply(folder.path(), &["oil_paint", "in.png", "bent.png", "--flow", "flow.png"]));
    let read = |name: &str| image::open(at(name)).expect("a picture was written").to_rgb8().into_raw();
    assert_ne!(read("plain.png"), read("bent.png"));
    // As the library does it.
    let library = Library::from_file(support::library()).expect("the library");
    let mut style = Style::load(&library, "oil_paint", &[]).expect("the style");
    style.lengths = Lengths::Pixels;
    let request = style.request(&library, SIZE).expect("the size is possible");
    let pixels =
        |channels, bytes| Pixels::new(SIZE.0, SIZE.1, channels, Samples::U8(bytes)).expect("as many");
    let (color, flow) = (pixels(3, input.into_raw()), pixels(4, flow().into_raw()));
    let inputs = [Input { name: "color", pixels: &color }, Input { name: "flow", pixels: &flow }];
    let mut result = Pixels::zeroed(SIZE.0, SIZE.1, 3, Precision::U8);
    style
        .graph
        .process(None, &request, &inputs, &mut result, &mut Control::default())
        .expect("the style can be computed");
    let Samples::U8(wanted) = result.samples() else { panic!("bytes were asked for") };
    assert_eq!(*wanted, read("bent.png"));
}

#[test]
fn a_control_map_directs_places_and_neutral_ones_change_nothing() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let map = |name: &str, right: [u8; 4]| {
        let half = |x, _| Rgba(if x < SIZE.0 / 2 { [128, 127, 128, right[3]] } else { right });
        RgbaImage::from_fn(SIZE.0, SIZE.1, half).save(at(name)).expect("it can be written");
    };
    picture(SIZE.0, SIZE.1).save(at("in.png")).expect("as above");
    let styled = |style: &str, control: &str| {
        let run = [style, "in.png", "out.png", "--control", control, "--force"];
        let plain = [style, "in.png", "out.png", "--force"];
        succeeds(&mut apply(folder.path(), if control.is_empty() { &plain } else { &run }));
        image::open(at("out.png")).expect("a picture was written").to_rgb8()
    };
    // Nobody has painted the alpha of an opaque file.
    map("neutral.png", [127, 128, 127, 255]);
    map("no_lines.png", [128, 128, 0, 255]);
    map("faint.png", [128, 128, 128, 0]);
    for style in ["cartoon", "watercolor"] {
        assert_eq!(styled(style, ""), styled(style, "neutral.png"), "{style}");
    }
    let (plain, directed) = (styled("cartoon", ""), styled("cartoon", "no_lines.png"));
    let differing = |from: u32, to: u32| {
        let places = (0..SIZE.1).flat_map(|y| (from..to).map(move |x| (x, y)));
        places.filter(|(x, y)| plain.get_pixel(*x, *y) != directed.get_pixel(*x, *y)).count()
    };
    assert_eq!(differing(0, SIZE.0 / 2 - 16), 0, "the left half is not directed");
    assert!(differing(SIZE.0 / 2 + 4, SIZE.0) > 20, "the right half has its lines");
    assert_ne!(styled("watercolor", ""), styled("watercolor", "faint.png"));
    for (style, file, words) in [
        ("gaussian", "neutral.png", &["--control", "follows no control map"][..]),
        ("cartoon", "small.png", &["small.png", "50x40", "control maps of the picture's size"]),
    ] {
        RgbaImage::new(50, 40).save(at("small.png")).expect("as above");
        fails(&mut apply(folder.path(), &[style, "in.png", "none.png", "--control", file]), 2, words);
        assert!(!at("none.png").exists());
    }
}

#[test]
fn flow_maps_of_frames_belong_to_their_frames() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for frame in 1..=2 {
        picture(SIZE.0, SIZE.1).save(at(&format!("in.{frame:04}.png"))).expect("it can be written");
    }
    flow().save(at("flow.0001.png")).expect("as above");
    let run = ["oil_paint", "in.####.png", "out.####.png", "--flow", "flow.####.png"];
    fails(&mut apply(folder.path(), &run), 2, &["flow.0002.png", "flow maps of the frames 2 are missing"]);
    RgbaImage::from_pixel(SIZE.0, SIZE.1, Rgba([128, 128, 0, 0]))
        .save(at("flow.0002.png"))
        .expect("as above");
    succeeds(&mut apply(folder.path(), &run));
    let read = |name: &str| fs::read(at(name)).expect("a picture was written");
    assert_ne!(read("out.0001.png"), read("out.0002.png"));
    // Nothing is painted in the second.
    succeeds(&mut apply(folder.path(), &["oil_paint", "in.0002.png", "plain.png"]));
    assert_eq!(read("out.0002.png"), read("plain.png"));
}

#[test]
fn flow_maps_that_cannot_be_used_say_why() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(SIZE.0, SIZE.1).save(at("in.png")).expect("the picture can be written");
    flow().save(at("flow.png")).expect("as above");
    RgbaImage::new(50, 40).save(at("small.png")).expect("as above");
    image::GrayImage::new(SIZE.0, SIZE.1).save(at("grey.png")).expect("as above");
    for (style, map, words) in [
        ("flow_dog", "flow.png", &["--flow", "follows no flow map"][..]),
        ("oil_paint", "small.png", &["small.png", "50x40", "flow maps of the picture's size"]),
        ("oil_paint", "grey.png", &["grey.png", "is grey"]),
        ("oil_paint", "none.png", &["none.png"]),
    ] {
        fails(&mut apply(folder.path(), &[style, "in.png", "out.png", "--flow", map]), 2, words);
        assert!(!at("out.png").exists(), "{map}");
    }
}

#[test]
fn jobs_for_farms_name_flow_maps_by_whole_paths() {
    let folder = folder();
    picture(SIZE.0, SIZE.1).save(folder.path().join("in.0001.png")).expect("the picture can be written");
    let mut command = isophote();
    command.current_dir(folder.path()).args(["farm", "openjd", "--", "apply", "oil_paint"]);
    let job = succeeds(command.args(["in.####.png", "out.####.png", "--flow", "maps/flow.####.png"])).0;
    // Backslashes of Windows are doubled in JSON.
    assert!(job.replace("//", "/").contains("/maps/flow.####.png"), "{job}");
}
