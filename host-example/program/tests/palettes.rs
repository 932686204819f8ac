//! Colours of files as those of styles: `--palette`, the verb `colours`, and the button of the window.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use isophote_finishing::stylize::palette;
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::look::EditedLook;
use isophote_window::state::outcome::{Dialog, Opened, Outcome};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::state::work::Request;
use isophote_window::widgets;

use crate::support::{self, cube, fails, folder, isophote, succeeds, video_folder};

const THREE: [[u8; 3]; 3] = [[16, 32, 48], [176, 64, 40], [240, 232, 216]];
const GPL: &str = "GIMP Palette\nName: Three\n#\n16 32 48\n176 64 40\n240 232 216\tPaper\n";

/// The program in a folder with a picture, `in.png`, and palettes of three colours.
fn program(folder: &Path, words: &[&str]) -> std::process::Command {
    if !folder.join("in.png").exists() {
        let shades = image::RgbImage::from_fn(64, 48, |x, y| match y {
            ..36 => image::Rgb([x as u8 * 4, x as u8 * 4, x as u8 * 4 + (y % 4) as u8]),
            _ => image::Rgb([170 + (x % 8) as u8, 70, 50]),
        });
        shades.save(folder.join("in.png")).unwrap();
        fs::write(folder.join("three.gpl"), GPL).unwrap();
        fs::write(folder.join("three.hex"), "102030\nb04028\nf0e8d8\n").unwrap();
        let strip = image::RgbImage::from_fn(6, 2, |x, _| image::Rgb(THREE[x as usize / 2]));
        strip.save(folder.join("three.png")).unwrap();
    }
    let mut command = isophote();
    command.current_dir(folder).args(words);
    if words[0] == "apply" {
        command.args(["--backend", "cpu", "--lengths", "pixels", "--force"]);
    }
    command
}

fn colours(folder: &Path, name: &str) -> BTreeSet<[u8; 3]> {
    image::open(folder.join(name)).unwrap().to_rgb8().pixels().map(|p| p.0).collect()
}

#[test]
fn results_have_exactly_the_colours_of_the_file() {
    let folder = folder();
    let folder = folder.path();
    let graph = r#"{ "format": "isophote-graph", "version": 1, "output": "flat", "nodes": [
        { "name": "soft", "node": "gaussian", "inputs": { "color": "@color" } },
        { "name": "flat", "node": "palette", "inputs": { "color": "soft" } } ] }"#;
    fs::write(folder.join("graph.json"), graph).unwrap();
    // Its node's name is taken.
    let soft = r#"{ "format": "isophote-graph", "version": 1, "output": "palette", "nodes": [
        { "name": "palette", "node": "gaussian", "inputs": { "color": "@color" } } ] }"#;
    fs::write(folder.join("soft.json"), soft).unwrap();
    fs::write(folder.join("layers.json"), r#"[{ "style": "cartoon" }, { "style": "palette" }]"#).unwrap();
    let cases: [&[&str]; 8] = [
        &["palette", "in.png", "out.png", "--palette", "three.gpl"],
        &["palette", "in.png", "out.png", "--palette", "three.hex", "--set", "dither=bayer"],
        &["palette", "in.png", "out.png", "--palette", "three.png"],
        &["graph.json", "in.png", "out.png", "--palette", "three.gpl"],
        &["--layered", "layers.json", "in.png", "out.png", "--palette", "three.gpl"],
        &["cartoon", "in.png", "out.png", "--palette", "three.gpl", "--set", "line_width=3"],
        &["ink", "in.png", "out.png", "--palette", "three.gpl", "--set", "palette.dither=bayer"],
        &["soft.json", "in.png", "out.png", "--palette", "three.gpl"],
    ];
    for case in cases {
        let (_, warnings) = succeeds(&mut program(folder, &[&["apply"], case].concat()));
        assert_eq!((colours(folder, "out.png"), warnings.as_str()), (BTreeSet::from(THREE), ""), "{case:?}");
    }
    // What is set by hand comes after.
    let by_hand = ["--set", "color_1=#000000", "--set", "count=2"];
    succeeds(&mut program(folder, &[&["apply"], cases[0], &by_hand].concat()));
    assert_eq!(colours(folder, "out.png"), BTreeSet::from([[0; 3], THREE[1]]));
}

#[test]
fn what_a_mask_leaves_out_keeps_its_colours() {
    let folder = folder();
    let folder = folder.path();
    let run = ["apply", "cartoon", "in.png", "out.png", "--palette", "three.gpl", "--mask", "mask.png"];
    let mut command = program(folder, &run);
    let mask = image::GrayImage::from_fn(64, 48, |x, _| image::Luma([if x < 32 { 255 } else { 0 }]));
    mask.save(folder.join("mask.png")).unwrap();
    succeeds(&mut command);
    let [before, after] = ["in.png", "out.png"].map(|name| image::open(folder.join(name)).unwrap().to_rgb8());
    for (x, y, pixel) in after.enumerate_pixels() {
        let is_kept = pixel == before.get_pixel(x, y);
        assert!(if x < 32 { THREE.contains(&pixel.0) } else { is_kept }, "{x} {y}: {pixel:?}");
    }
}

#[test]
fn all_frames_have_the_colours_of_the_file() {
    let Some(folder) = video_folder() else { return };
    let folder = folder.path();
    let mut command =
        program(folder, &["apply", "palette", "in.####.png", "out.####.png", "--palette", "three.gpl"]);
    for frame in 1..=3 {
        fs::copy(folder.join("in.png"), folder.join(format!("in.{frame:04}.png"))).unwrap();
    }
    succeeds(&mut command);
    for frame in 1..=3 {
        assert_eq!(colours(folder, &format!("out.{frame:04}.png")), BTreeSet::from(THREE), "{frame}");
    }
    let film = ["apply", "gaussian", "in.####.png", "film.mkv", "--set", "sigma=0"];
    succeeds(&mut program(folder, &film));
    let of_film = ["apply", "palette", "film.mkv", "of_film.####.png", "--palette", "three.gpl"];
    succeeds(&mut program(folder, &of_film));
    for frame in 1..=3 {
        assert_eq!(colours(folder, &format!("of_film.{frame:04}.png")), BTreeSet::from(THREE), "{frame}");
    }
}

#[test]
fn presets_and_scenes_take_palettes_as_well() {
    let folder = folder();
    let folder = folder.path();
    let save = ["preset", "save", "palette", "mine.json", "--palette", "three.gpl", "--set", "fit=0.25"];
    succeeds(&mut program(folder, &save));
    let preset = fs::read_to_string(folder.join("mine.json")).unwrap();
    for words in [r##""color_3": "#f0e8d8""##, r#""palette": "own""#, r#""count": 3"#, r#""fit": 0.25"#] {
        assert!(preset.contains(words), "{preset}");
    }
    succeeds(&mut program(folder, &["apply", "mine.json", "in.png", "out.png"]));
    assert_eq!(colours(folder, "out.png"), BTreeSet::from(THREE));
    cube(folder);
    let render = ["render", "cube.gltf", "cube.png", "--size", "48x32", "--style", "palette"];
    succeeds(&mut program(folder, &[&render[..], &["--palette", "three.gpl", "--backend", "cpu"]].concat()));
    let found = colours(folder, "cube.png");
    assert!(found.len() > 1 && found.is_subset(&BTreeSet::from(THREE)), "{found:?}");
}

#[test]
fn colours_of_a_picture_are_printed_and_kept() {
    let folder = folder();
    let folder = folder.path();
    let (printed, _) = succeeds(&mut program(folder, &["colours", "in.png", "own.gpl", "--count", "5"]));
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines.len(), 5, "{printed}");
    for name in ["own.hex", "own.json"] {
        let (again, _) = succeeds(&mut program(folder, &["colours", "own.gpl", name]));
        assert_eq!(again, printed);
        assert_eq!(succeeds(&mut program(folder, &["colours", name])).0, printed);
    }
    // A picture by itself gives what is kept of it.
    let mut results = Vec::new();
    for file in ["own.gpl", "in.png"] {
        let apply = ["apply", "palette", "in.png", "out.png", "--palette", file, "--palette-count", "5"];
        succeeds(&mut program(folder, &apply));
        results.push(fs::read(folder.join("out.png")).unwrap());
    }
    assert!(results[0] == results[1]);
    let (strip, _) = succeeds(&mut program(folder, &["colours", "three.png"]));
    assert_eq!(strip, "#102030\n#b04028\n#f0e8d8\n");
    let (quiet, _) = succeeds(&mut program(folder, &["colours", "three.png", "--quiet"]));
    assert_eq!(quiet, "");
}

#[test]
fn palettes_that_ship_are_named_by_their_ids_for_every_style() {
    let folder = folder();
    let folder = folder.path();
    succeeds(&mut program(folder, &["apply", "palette", "in.png", "set.png", "--set", "palette=terminal"]));
    succeeds(&mut program(folder, &["apply", "palette", "in.png", "named.png", "--palette", "terminal"]));
    assert!(fs::read(folder.join("set.png")).unwrap() == fs::read(folder.join("named.png")).unwrap());
    succeeds(&mut program(folder, &["apply", "cartoon", "in.png", "cartoon.png", "--palette", "blueprint"]));
    assert_eq!(colours(folder, "cartoon.png").len(), 2);
    // Of a file of that name it is the one that counts, in this folder and on a farm.
    fs::copy(folder.join("three.gpl"), folder.join("terminal")).unwrap();
    for (name, is_own) in [("terminal", false), ("./terminal", true)] {
        succeeds(&mut program(folder, &["apply", "palette", "in.png", "file.png", "--palette", name]));
        assert_eq!(colours(folder, "file.png") == BTreeSet::from(THREE), is_own, "{name}");
        fs::copy(folder.join("in.png"), folder.join("in.0001.png")).unwrap();
        let job =
            ["farm", "openjd", "--", "apply", "palette", "in.####.png", "out.####.png", "--palette", name];
        let (job, _) = succeeds(&mut program(folder, &job));
        assert_eq!(job.contains("--palette=terminal\""), !is_own, "{job}");
    }
}

#[test]
fn larger_palettes_are_reduced_with_a_sentence() {
    let folder = folder();
    let folder = folder.path();
    let many: String = (0..64).map(|i| format!("{:06x}\n", i * 0x03_0507)).collect();
    fs::write(folder.join("many.hex"), many).unwrap();
    let apply = ["apply", "palette", "in.png", "out.png", "--palette", "many.hex"];
    let (_, warnings) = succeeds(&mut program(folder, &apply));
    assert_eq!(warnings, "warning: many.hex: has 64 colours, and 16 of them are taken\n");
    assert!(colours(folder, "out.png").len() <= 16);
    let (all, warnings) = succeeds(&mut program(folder, &["colours", "many.hex"]));
    assert_eq!((all.lines().count(), warnings.as_str()), (64, ""));
}

#[test]
fn what_cannot_be_is_refused_with_advice() {
    let folder = folder();
    let folder = folder.path();
    fs::write(folder.join("words.txt"), "red and blue").unwrap();
    let cases: [(&[&str], &[&str]); 9] = [
        (
            &["apply", "flow_dog", "in.png", "out.png", "--palette", "three.gpl"],
            &["--palette: the style flow_dog draws with no palette", "choose the style palette"],
        ),
        (
            &["apply", "palette", "in.png", "out.png", "--palette", "greens"],
            &[
                "--palette greens: is no file and no palette that ships",
                "choose from comic, gouache, handheld",
            ],
        ),
        (
            &["apply", "palette", "in.png", "out.png", "--palette", "handheld", "--palette-count", "3"],
            &["--palette-count 3: handheld is a palette that ships", "leave it out"],
        ),
        (&["apply", "palette", "in.png", "out.png", "--palette", "none.gpl"], &["none.gpl: cannot be read"]),
        (&["apply", "palette", "in.png", "out.png", "--palette", "words.txt"], &["line 1, 'red'"]),
        (
            &["apply", "palette", "in.png", "out.png", "--palette", "three.gpl", "--palette-count", "40"],
            &["at most; give a number from 2 to 16"],
        ),
        (&["apply", "palette", "in.png", "three.png", "--palette", "three.png"], &["three.png"]),
        (&["colours", "in.png", "own.ase"], &["own.ase", "name a .gpl, .hex or .json file"]),
        (&["colours", "in.png", "three.gpl"], &["three.gpl", "--force"]),
    ];
    for (words, said) in cases {
        fails(&mut program(folder, words), 2, said);
    }
    assert!(!folder.join("out.png").exists() && fs::read_to_string(folder.join("three.gpl")).unwrap() == GPL);
    let render = ["render", "none.gltf", "a.png", "--palette", "three.gpl"];
    fails(&mut program(folder, &render), 2, &["the style none has no parameters"]);
}

#[test]
fn the_window_takes_colours_from_a_file_as_one_step() {
    let folder = folder();
    program(folder.path(), &["colours", "in.png"]);
    let library = Library::from_file(support::library()).unwrap();
    let looks = ["none", "palette", "cartoon"].map(|name| EditedLook::open(&library, name.as_ref()).unwrap());
    let session = Session::new(library.clone(), looks.into(), Settings::default()).unwrap();
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1200.0, 2000.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    let document = Document::open(&folder.path().join("in.png"), &Options::default());
    harness.state_mut().show_playback(document.unwrap().playback().unwrap());
    harness.state_mut().choose(1);
    harness.run_ok();
    harness.get_by_label("Colours from a file…").click();
    harness.run_ok();
    assert_eq!(harness.state_mut().work.take_requests(), [Request::Choose(Dialog::Palette)]);
    let palette = palette::read(&library, &folder.path().join("three.gpl"), None).unwrap();
    let session = harness.state_mut();
    let before = session.look().clone();
    session.take_over(Outcome::Opened(Opened::Palette(palette.clone())));
    let value = |session: &Session, id: &str| {
        let parameter = session.looks.parameters().iter().find(|p| p.name == id).unwrap().clone();
        session.look().value(&parameter)
    };
    assert_eq!(value(session, "palette"), Value::Choice("own".into()));
    assert_eq!(value(session, "count"), Value::Int(3));
    for (id, [r, g, b]) in ["color_1", "color_2", "color_3"].into_iter().zip(THREE) {
        let [r, g, b] = [r, g, b].map(|v| f32::from(v) / 255.0);
        assert_eq!(value(session, id), Value::Color([r, g, b, 1.0]), "{id}");
    }
    session.undo();
    assert_eq!(*session.look(), before);
    // Another look may be shown when the file has been read.
    session.choose(2);
    session.take_over(Outcome::Opened(Opened::Palette(palette)));
    harness.run_ok();
    harness.get_by_label_contains("draws with no palette");
    assert!(harness.query_by_label("Colours from a file…").is_none());
}
