//! Papers and hatchings: of files of any size, of those that ship, and what is refused.

use std::path::Path;
use std::process::Command;

use image::{GrayImage, Rgb, RgbImage};
use isophote_files::files::Existing;
use isophote_finishing::stylize::style::Style;
use isophote_loader::{Control, Input, Library};
use isophote_pictures::floats::{self, Picture};
use isophote_pictures::material::{self, MaterialKind};
use isophote_pictures::meaning::Meaning;
use isophote_pictures::pixels::{Pixels, Precision, Samples};
use rayon::prelude::*;

use crate::support::{self, fails, folder, isophote, listing, picture, succeeds};

/// A twentieth of 1080 lines.
const SIZE: (u32, u32) = (72, 54);

fn apply(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).arg("apply").args(arguments).args(["--backend", "cpu", "--force"]);
    command
}

/// Pixels of a file of bytes.
fn read(path: &Path) -> Vec<u8> {
    image::open(path).expect("a picture was written").to_rgb8().into_raw()
}

#[test]
fn a_file_of_any_size_is_tiled_as_large_as_on_1080_lines() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let input = picture(SIZE.0, SIZE.1);
    input.save(at("in.png")).expect("it can be written");
    let cell = |x: u32, y: u32| [200 + (x * 5 % 11) as u8 * 4, 250 - (y * 3 % 7) as u8 * 9, 240];
    RgbImage::from_fn(220, 140, |x, y| Rgb(cell(x / 20, y / 20))).save(at("paper.png")).expect("as above");
    succeeds(&mut apply(folder.path(), &["blueprint", "in.png", "out.png", "--paper", "paper.png"]));
    // As the library does it.
    let library = Library::from_file(support::library()).expect("the library");
    let mut style = Style::load(&library, "blueprint", &[]).expect("the style");
    let request = style.request(&library, SIZE).expect("the size is possible");
    let pixels =
        |channels, bytes| Pixels::new(SIZE.0, SIZE.1, channels, Samples::U8(bytes)).expect("as many");
    let color = pixels(3, input.into_raw());
    let tile = MaterialKind::Paper.open(&at("paper.png")).expect("a picture").scaled(
        [0.05; 2],
        &Meaning::display(),
        [i64::MAX; 2],
    );
    assert_eq!((tile.width(), tile.height()), (11, 7));
    let paper = material::tiled(&tile, SIZE, [0; 2]);
    let inputs = [Input { name: "color", pixels: &color }, Input { name: "paper", pixels: &paper }];
    let mut result = Pixels::zeroed(SIZE.0, SIZE.1, 3, Precision::U8);
    let mut control = Control::default();
    style.graph.process(None, &request, &inputs, &mut result, &mut control).expect("it can be computed");
    let Samples::U8(wanted) = result.samples() else { panic!("bytes were asked for") };
    let found = read(&at("out.png"));
    assert_eq!(*wanted, found);
    succeeds(&mut apply(folder.path(), &["blueprint", "in.png", "plain.png"]));
    let plain = read(&at("plain.png"));
    assert!(plain.iter().zip(&found).any(|(a, b)| a.abs_diff(*b) > 8));
}

#[test]
fn scene_linear_pictures_lie_on_paper_of_the_same_light() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let white = Picture { width: 72, height: 54, channels: 3, data: vec![1.0; 72 * 54 * 3] };
    let names = ["R", "G", "B"];
    floats::save_exr(
        &at("in.exr"),
        Existing::Replace,
        &white,
        &names,
        floats::Precision::Float,
        (None, None),
    )
    .expect("it can be written");
    RgbImage::from_pixel(9, 9, Rgb([188, 188, 188])).save(at("paper.png")).expect("as above");
    succeeds(&mut apply(folder.path(), &["watercolor", "in.exr", "out.exr", "--paper", "paper.png"]));
    let out = support::mattes::rgb(&at("out.exr"));
    let far = out.iter().flatten().map(|v| (v - 0.503).abs()).fold(0.0, f32::max);
    assert!(far < 0.02, "{far}");
}

#[test]
fn what_ships_is_taken_by_name_and_written_as_files() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(SIZE.0, SIZE.1).save(at("in.png")).expect("it can be written");
    let write = || {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["materials", "sheets"]);
        command
    };
    let (told, _) = succeeds(&mut write());
    assert_eq!(listing(&at("sheets")).len(), 12);
    fails(&mut write(), 2, &["sheets", "is there already", "--force"]);
    succeeds(write().arg("--force"));
    let runs = [("paper", "ink", "canvas"), ("hatching", "ink", "stipple"), ("paper", "watercolor", "washi")];
    runs.par_iter().for_each(|(kind, style, name)| {
        assert!(told.contains(name), "{told}");
        let (option, file) = (format!("--{kind}"), format!("sheets/{kind}_{name}.png"));
        let out = [format!("{kind}_{style}_name.png"), format!("{kind}_{style}_file.png")];
        for (out, material) in out.iter().zip([*name, &file]) {
            succeeds(&mut apply(folder.path(), &[style, "in.png", out, &option, material]));
        }
        assert_eq!(read(&at(&out[0])), read(&at(&out[1])), "{kind} {name}");
        let plain = format!("{kind}_{style}_plain.png");
        succeeds(&mut apply(folder.path(), &[style, "in.png", &plain]));
        assert_ne!(read(&at(&out[0])), read(&at(&plain)), "{kind} {name}");
    });
}

#[test]
fn rendered_frames_lie_on_materials_on_the_cpu_and_on_a_device() {
    let folder = folder();
    support::cube(folder.path());
    let rendered = |out: &str, options: &[&str]| {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["render", "cube.gltf", out, "--size", "160x120", "--style"]);
        succeeds(command.args(options));
        read(&folder.path().join(out))
    };
    for (style, material) in [("ink", ["--hatching", "pen"]), ("watercolor", ["--paper", "kraft"])] {
        let on = |backend: &str| {
            rendered(
                &format!("{style}_{backend}.png"),
                &[style, "--backend", backend, material[0], material[1]],
            )
        };
        let plain = rendered(&format!("{style}.png"), &[style, "--backend", "cpu"]);
        let distance = |a: &[u8], b: &[u8]| {
            a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
        };
        let (cpu, device) = (on("cpu"), on("gpu"));
        assert!(distance(&cpu, &device) < 0.5, "{style}: {}", distance(&cpu, &device));
        assert!(distance(&cpu, &plain) > 3.0, "{style}: {}", distance(&cpu, &plain));
    }
    let mut refused = isophote();
    let run = ["render", "cube.gltf", "none.png", "--style", "cartoon", "--paper", "kraft"];
    fails(refused.current_dir(folder.path()).args(run), 2, &["--paper", "no paper of its own"]);
}

#[test]
fn materials_that_cannot_be_used_say_why() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(SIZE.0, SIZE.1).save(at("in.png")).expect("it can be written");
    GrayImage::from_pixel(30, 20, image::Luma([255])).save(at("blank.png")).expect("as above");
    std::fs::write(at("text.png"), "no picture").expect("as above");
    for (style, option, name, words) in [
        ("cartoon", "--paper", "canvas", &["--paper", "has no paper of its own", "@paper"][..]),
        ("watercolor", "--hatching", "pen", &["--hatching", "has no hatching of its own"]),
        (
            "ink",
            "--paper",
            "canvass",
            &["canvass", "is no file", "cold_press, hot_press, laid, canvas, kraft, washi"],
        ),
        ("ink", "--hatching", "blank.png", &["blank.png", "has no marks"]),
        ("ink", "--hatching", "text.png", &["text.png"]),
    ] {
        fails(&mut apply(folder.path(), &[style, "in.png", "out.png", option, name]), 2, words);
        assert!(!at("out.png").exists(), "{name}");
    }
}
