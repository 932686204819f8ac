//! Drawings that leave as drawings: lines alone, in pictures and layers, and curves in SVG files, as librsvg draws them.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use exr::prelude::read_first_flat_layer_from_file;
use image::RgbaImage;

use crate::support::{IN_PIXELS, fails, folder, isophote, root, succeeds};

/// A view of the demo scene.
fn scene() -> std::path::PathBuf {
    root().join("tests/data/scene.png")
}

fn apply(folder: &Path, style: &str, input: &Path, output: &str, more: &[&str]) -> String {
    let mut command = isophote();
    command.current_dir(folder).args(["apply", style]).arg(input).arg(output).args(["--backend", "cpu"]);
    succeeds(command.args(IN_PIXELS).args(more)).1
}

fn read(folder: &Path, name: &str) -> RgbaImage {
    image::open(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}")).to_rgba8()
}

/// An SVG file as librsvg draws it; nothing where that is not there and need not be.
fn drawn(folder: &Path, name: &str) -> Option<RgbaImage> {
    let png = format!("{name}.png");
    let output = Command::new("rsvg-convert").current_dir(folder).args([name, "-o", &png]).output();
    match output {
        Ok(output) => {
            assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
            Some(read(folder, &png))
        }
        Err(e) => {
            assert!(std::env::var("CI").is_err(), "rsvg-convert is missing: {e}");
            eprintln!("\n*** SKIPPED: drawing curves needs rsvg-convert ***\n");
            None
        }
    }
}

#[test]
fn pictures_of_a_palette_have_its_colours_to_the_byte() {
    let folder = folder();
    let own = ["palette=own", "count=3", "color_1=#102030", "color_2=#f0e8d8", "color_3=#b04028"];
    for dither in ["dither=none", "dither=bayer", "dither=noise"] {
        let more: Vec<&str> = own.iter().chain([&dither]).flat_map(|setting| ["--set", setting]).collect();
        apply(folder.path(), "palette", &scene(), "three.png", &[&more[..], &["--force"]].concat());
        let found: BTreeSet<[u8; 4]> = read(folder.path(), "three.png").pixels().map(|p| p.0).collect();
        let wanted = [[0x10, 0x20, 0x30, 255], [0xf0, 0xe8, 0xd8, 255], [0xb0, 0x40, 0x28, 255]];
        assert_eq!(found, BTreeSet::from(wanted), "{dither}");
    }
}

#[test]
fn lines_alone_laid_over_the_rest_give_the_picture() {
    let folder = folder();
    let cases: [(&str, &[&str], &str); 4] = [
        ("cartoon", &["--set", "sigma_a=0"], "line_color=#00000000"),
        ("cartoon", &["--set", "sigma_a=0", "--set", "line_on_dark=light"], "line_color=#00000000"),
        ("blueprint", &["--set", "grid=0"], "line_color=#ebf5ff00"),
        ("ink", &["--set", "style=pencil"], "line_color=#14141a00"),
    ];
    for (style, settings, without) in cases {
        let run = |output: &str, more: &[&str]| {
            let more = [settings, more, &["--force"]].concat();
            apply(folder.path(), style, &scene(), output, &more);
            read(folder.path(), output)
        };
        let line = match style {
            "ink" => "line_color=#14141a",
            "blueprint" => "line_color=#ebf5ff",
            _ => "line_color=#000000",
        };
        let whole = run("whole.png", &["--set", line]);
        let lines = run("lines.png", &["--set", line, "--set", "show=lines"]);
        let rest = run("rest.png", &["--set", without]);
        let mut covered = 0;
        for ((whole, line), rest) in whole.pixels().zip(lines.pixels()).zip(rest.pixels()) {
            let alpha = f32::from(line[3]) / 255.0;
            covered += usize::from(alpha > 0.9);
            for c in 0..3 {
                let over = f32::from(rest[c]) + alpha * (f32::from(line[c]) - f32::from(rest[c]));
                let apart = (over - f32::from(whole[c])).abs();
                assert!(apart <= 2.0, "{style} {settings:?}: {whole:?}, {line:?} over {rest:?}");
            }
        }
        let pixels = whole.width() as usize * whole.height() as usize;
        assert!(covered * 200 > pixels, "{style}: {covered} of {pixels} pixels are drawn");
    }
}

#[test]
fn lines_are_a_layer_of_an_exr_file() {
    let folder = folder();
    apply(folder.path(), "gaussian", &scene(), "in.exr", &[]);
    let more = ["--set", "show=lines", "--into", "lines"];
    apply(folder.path(), "cartoon", Path::new("in.exr"), "out.exr", &more);
    let file = |name: &str| read_first_flat_layer_from_file(folder.path().join(name)).expect("a whole file");
    let (before, after) = (file("in.exr"), file("out.exr"));
    let channel = |file: &exr::prelude::Image<_>, name: &str| -> Vec<f32> {
        let layer: &exr::prelude::Layer<exr::prelude::AnyChannels<exr::prelude::FlatSamples>> =
            &file.layer_data;
        let found = layer.channel_data.list.iter().find(|channel| channel.name == *name);
        found.unwrap_or_else(|| panic!("no {name}")).sample_data.values_as_f32().collect()
    };
    for name in ["R", "G", "B"] {
        assert_eq!(channel(&before, name), channel(&after, name), "{name} is another");
        // Black lines, multiplied by their coverage.
        assert!(channel(&after, &format!("lines.{name}")).iter().all(|v| *v < 1e-3));
    }
    let alpha = channel(&after, "lines.A");
    let drawn = alpha.iter().filter(|a| **a > 0.9).count();
    assert!(drawn * 200 > alpha.len() && alpha.contains(&0.0), "{drawn} of {}", alpha.len());
}

#[test]
fn curves_lie_where_lines_are() {
    let folder = folder();
    for style in ["cartoon", "ink", "blueprint"] {
        let lines = ["--set", "show=lines", "--force"];
        apply(folder.path(), style, &scene(), "lines.png", &lines);
        apply(folder.path(), style, &scene(), "lines.svg", &lines);
        let Some(curves) = drawn(folder.path(), "lines.svg") else { return };
        let pixels = read(folder.path(), "lines.png");
        assert_eq!(curves.dimensions(), pixels.dimensions());
        let is_line = |pixel: &image::Rgba<u8>| pixel[3] >= 128;
        let (mut both, mut either) = (0, 0);
        for (a, b) in curves.pixels().zip(pixels.pixels()) {
            both += usize::from(is_line(a) && is_line(b));
            either += usize::from(is_line(a) || is_line(b));
        }
        let share = both as f32 / either as f32;
        println!("{style}: intersection over union {share:.3}");
        assert!(share >= 0.9, "{style}: intersection over union {share}");
    }
}

#[test]
fn pictures_become_areas_of_one_colour() {
    let folder = folder();
    apply(folder.path(), "cartoon", &scene(), "flat.png", &[]);
    apply(folder.path(), "cartoon", &scene(), "flat.svg", &[]);
    let text = fs::read_to_string(folder.path().join("flat.svg")).expect("a text");
    let paths = text.matches("<path ").count();
    assert!((50..20_000).contains(&paths) && text.ends_with("</svg>\n"), "{paths} paths");
    let Some(curves) = drawn(folder.path(), "flat.svg") else { return };
    let pixels = read(folder.path(), "flat.png");
    let apart = |c: usize| -> f64 {
        let all = curves.pixels().zip(pixels.pixels());
        all.map(|(a, b)| f64::from(a[c].abs_diff(b[c]))).sum::<f64>()
            / f64::from(pixels.width() * pixels.height())
    };
    let apart = [0, 1, 2].map(apart);
    println!("mean difference of areas: {apart:.1?}");
    assert!(apart.iter().all(|apart| *apart < 12.0), "{apart:?}");
    assert!(curves.pixels().all(|pixel| pixel[3] == 255), "a gap shows between areas");
}

#[test]
fn what_svg_files_cannot_hold_is_refused() {
    let folder = folder();
    let refused = |more: &[&str], words: &[&str]| {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["apply", "cartoon"]).arg(scene()).arg("out.svg").args(more);
        fails(&mut command, 2, words);
        assert!(!folder.path().join("out.svg").exists());
    };
    refused(&["--output-space", "acescg"], &["--output-space", "SVG", ".png"]);
    refused(&["--depth", "16"], &["--depth"]);
    // What is whole is kept.
    apply(folder.path(), "cartoon", &scene(), "out.svg", &["--set", "show=lines"]);
    let before =
        fs::metadata(folder.path().join("out.svg")).and_then(|data| data.modified()).expect("a file");
    apply(folder.path(), "cartoon", &scene(), "out.svg", &["--skip-existing"]);
    let after = fs::metadata(folder.path().join("out.svg")).and_then(|data| data.modified()).expect("a file");
    assert_eq!(before, after, "a whole file was written again");
}
