//! `apply --mask` and `--layered`: where results are used, by files, layers and Cryptomattes.

use std::fs;
use std::path::{Path, PathBuf};

use exr::prelude::*;
use image::{GrayImage, Luma, Rgb, RgbImage, Rgba, RgbaImage};

use crate::support::mattes::*;
use crate::support::{IN_PIXELS, fails, folder, isophote, listing, picture, succeeds};

fn apply(folder: &Path, input: &str, output: &str, more: &[&str]) -> String {
    let mut command = isophote();
    command
        .current_dir(folder)
        .args(["apply", "gaussian", input, output, "--force", "--backend", "cpu"])
        .args(IN_PIXELS)
        .args(more);
    succeeds(&mut command).1
}

fn refused(folder: &Path, args: &[&str], words: &[&str]) {
    fails(isophote().current_dir(folder).args(["apply", "gaussian"]).args(args), 2, words);
    assert!(!listing(folder).iter().any(|name| name.starts_with("no.")));
}

#[test]
fn the_result_is_used_where_the_mask_is() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_usual(&at("in.exr"));
    apply(folder.path(), "in.exr", "all.exr", &[]);
    apply(folder.path(), "in.exr", "masked.exr", &["--mask", "cryptomatte:hero"]);
    apply(folder.path(), "in.exr", "inverted.exr", &["--mask", "cryptomatte:hero", "--invert"]);
    let [before, all, masked, inverted] =
        ["in.exr", "all.exr", "masked.exr", "inverted.exr"].map(|name| rgb(&at(name)));
    let mut tried = [0; 3];
    for (pixel, share) in coverage(&["hero"]).into_iter().enumerate() {
        let (inside, outside) = (masked[pixel], inverted[pixel]);
        match share {
            0.0 => assert_eq!((inside, outside), (before[pixel], all[pixel])),
            1.0 => assert_eq!((inside, outside), (all[pixel], before[pixel])),
            _ => {
                // Halves between the two.
                for c in 0..3 {
                    let (a, b) = (before[pixel][c], all[pixel][c]);
                    let between = (inside[c] - a) * (inside[c] - b) <= 1e-4;
                    assert!(between && (outside[c] - a) * (outside[c] - b) <= 1e-4, "{a} {b} {inside:?}");
                }
            }
        }
        tried[if share == 0.0 { 0 } else { 1 + usize::from(share < 1.0) }] += 1;
    }
    assert!(tried.iter().all(|count| *count >= 16), "{tried:?}");
    assert!(before.iter().zip(&all).filter(|(a, b)| a != b).count() > PIXELS / 2);
}

#[test]
fn graphs_are_masked_as_nodes_are() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_usual(&at("in.exr"));
    apply(folder.path(), "in.exr", "masked.exr", &["--mask", "cryptomatte:hero"]);
    let [before, masked] = ["in.exr", "masked.exr"].map(|name| rgb(&at(name)));
    // One that has no mask of its own is mixed in the same way.
    let graph = r#"{"format": "isophote-graph", "version": 1, "nodes": [
        {"name": "a", "node": "gaussian", "inputs": {"color": "@color"}}], "output": "a"}"#;
    fs::write(at("graph.json"), graph).expect("the folder is writable");
    let mut command = isophote();
    command.current_dir(folder.path()).args("apply graph.json in.exr graph.exr --backend cpu".split(' '));
    succeeds(command.args(["--mask", "cryptomatte:hero"]).args(IN_PIXELS));
    for (mixed, masked) in rgb(&at("graph.exr")).iter().zip(&masked) {
        for c in 0..3 {
            assert!((mixed[c] - masked[c]).abs() <= 2e-3 * (1.0 + masked[c]), "{mixed:?} {masked:?}");
        }
    }
    // What is no picture of colours is not laid over one.
    let args = ["apply", "flow_dog", "in.exr", "no.exr", "--mask", "cryptomatte:hero"];
    fails(isophote().current_dir(folder.path()).args(args), 2, &["flow_dog", "yields a scalar"]);
    refused(
        folder.path(),
        &["in.exr", "no.exr", "--mask", "cryptomatte:heroo"],
        &["in.exr", "did you mean hero?"],
    );
    let warned =
        apply(folder.path(), "in.exr", "none.exr", &["--mask", "cryptomatte:heroo", "--on-unknown", "empty"]);
    assert!(warned.contains("in.exr: has no 'heroo'"), "{warned}");
    assert_eq!(rgb(&at("none.exr")), before);
}

#[test]
fn layers_and_channels_are_masks() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    let plane =
        |scale: f32| FlatSamples::F32((0..PIXELS).map(|i| i as f32 * scale / PIXELS as f32).collect());
    let named = |name: &str, scale: f32| (name.to_owned(), plane(scale));
    let more = vec![named("matte.Y", 1.0), named("sets.R", 0.5), named("sets.G", 0.25), named("dust", 0.125)];
    save(&at, vec![("rgba", [colours(), more].concat(), vec![]), ("held", vec![named("Y", 2.0)], vec![])]);
    let mask = |text: &str| mask_of(&at, text, false);
    let expected = |scale: f32| {
        Ok((0..PIXELS).map(|i| (i as f32 * scale / PIXELS as f32).min(1.0)).collect::<Vec<f32>>())
    };
    for (name, scale) in
        [("matte", 1.0), ("matte.Y", 1.0), ("sets.G", 0.25), ("dust", 0.125), ("held", 2.0), ("held.Y", 2.0)]
    {
        assert_eq!(mask(name), expected(scale), "{name}");
    }
    assert!(mask("sets").is_err_and(|e| e.contains("several channels") && e.contains("sets.G, sets.R")));
    let error = mask("mat").expect_err("is no layer");
    assert!(["'mat'", "matte.Y", "dust", "held.Y", "mask.png"].iter().all(|w| error.contains(w)), "{error}");
    picture(24, 16).save(folder.path().join("in.png")).expect("the picture can be written");
    refused(folder.path(), &["in.png", "no.png", "--mask", "matte"], &["--mask", "no EXR file"]);
    refused(folder.path(), &["in.png", "no.png", "--invert"], &["--mask"]);
}

#[test]
fn files_are_masks() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (w, h) = (24, 16);
    picture(w, h).save(at("in.png")).expect("the picture can be written");
    let value = |x: u32, y: u32| (x * 10 + y % 3) as u8;
    GrayImage::from_fn(w, h, |x, y| Luma([value(x, y)]))
        .save(at("grey.png"))
        .expect("the mask can be written");
    RgbImage::from_fn(w, h, |x, y| Rgb([value(x, y); 3]))
        .save(at("rgb.tif"))
        .expect("the mask can be written");
    RgbImage::from_pixel(w, h, Rgb([255, 0, 0])).save(at("red.png")).expect("the mask can be written");
    RgbaImage::from_fn(w, h, |x, _| Rgba([255, 255, 255, (x * 9) as u8]))
        .save(at("alpha.png"))
        .expect("a mask");
    let plane = FlatSamples::F32(
        (0..PIXELS).map(|i| f32::from(value((i % 24) as u32, (i / 24) as u32)) / 255.0).collect(),
    );
    save(&at("one.exr"), vec![("", vec![("matte".to_owned(), plane.clone())], vec![])]);
    save(&at("two.exr"), vec![("", vec![("a".to_owned(), plane.clone()), ("b".to_owned(), plane)], vec![])]);
    let mask = |name: &str| mask_of(&at("in.png"), at(name).to_str().expect("a path"), false);
    let expected: Vec<f32> = (0..PIXELS as u32).map(|i| f32::from(value(i % 24, i / 24)) / 255.0).collect();
    for name in ["grey.png", "rgb.tif", "one.exr"] {
        assert_eq!(mask(name).as_ref(), Ok(&expected), "{name}");
    }
    assert_eq!(mask("red.png"), Ok(vec![0.2126; PIXELS]), "luminance");
    assert_eq!(mask("alpha.png"), Ok(vec![1.0; PIXELS]), "alpha does not count");
    assert!(mask("two.exr").is_err_and(|e| e.contains("channels a, b")));
    assert!(mask("gone.png").is_err_and(|e| e.contains("gone.png")));
    GrayImage::new(23, 16).save(at("small.png")).expect("the mask can be written");
    assert!(mask("small.png").is_err_and(|e| e.contains("23x16") && e.contains("24x16")));
    refused(folder.path(), &["in.png", "no.png", "--mask", "small.png"], &["small.png", "23x16"]);
    refused(folder.path(), &["in.png", "no.png", "--mask", "m.####.png"], &["one picture"]);
}

#[test]
fn each_frame_has_its_own_mask_or_all_have_the_same() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (w, h) = (24, 16);
    picture(w, h).save(at("in.png")).expect("the picture can be written");
    for frame in 1..=3 {
        picture(w, h).save(at(&format!("in.{frame:04}.png"))).expect("the picture can be written");
        let shown = |x: u32, _| Luma([if x / 8 == frame - 1 { 255 } else { 0 }]);
        GrayImage::from_fn(w, h, shown)
            .save(at(&format!("m.{frame:04}.png")))
            .expect("the mask can be written");
    }
    apply(folder.path(), "in.png", "all.png", &[]);
    apply(folder.path(), "in.####.png", "out.####.png", &["--mask", "m.####.png"]);
    apply(folder.path(), "in.####.png", "same.####.png", &["--mask", "m.0002.png"]);
    let open = |name: &str| image::open(at(name)).expect("a picture").into_rgb8();
    let (before, all) = (open("in.png"), open("all.png"));
    for frame in 1..=3 {
        for (name, column) in
            [(format!("out.{frame:04}.png"), frame - 1), (format!("same.{frame:04}.png"), 1)]
        {
            for (x, y, pixel) in open(&name).enumerate_pixels() {
                let expected = if x / 8 == column { &all } else { &before };
                assert_eq!(pixel, expected.get_pixel(x, y), "{name} {x} {y}");
            }
        }
    }
    fs::remove_file(at("m.0002.png")).expect("a file");
    let args = ["in.####.png", "no.####.png", "--mask", "m.####.png"];
    refused(folder.path(), &args, &["m.0002.png", "frames 2"]);
}

#[test]
fn layers_of_data_are_no_pictures() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    let layer = |name: &str| -> Vec<(String, FlatSamples)> {
        colours().into_iter().map(|(component, samples)| (format!("{name}.{component}"), samples)).collect()
    };
    let depth = vec![("Z".to_owned(), FlatSamples::F32(vec![1.0; PIXELS]))];
    let objects = matte("things", ["R", "G", "B", "A"]);
    let channels =
        [colours(), layer("N"), layer("P"), layer("things"), layer("diffuse"), depth, objects].concat();
    save(&at, vec![("", channels, attributes("1", "things", ("manifest", "{}")))]);
    for name in ["N", "P", "things", "things00"] {
        let words = [&format!("data in the layer '{name}'"), "choose from diffuse", "--force-layer"];
        refused(folder.path(), &["in.exr", "no.exr", "--layer", name], &words);
        apply(folder.path(), "in.exr", "out.exr", &["--layer", name, "--force-layer"]);
    }
    apply(folder.path(), "in.exr", "out.exr", &["--layer", "diffuse"]);
    refused(folder.path(), &["in.exr", "no.exr", "--force-layer"], &["--layer"]);
}

/// A picture with objects, and what is made of it.
struct Shot(tempfile::TempDir);

impl Shot {
    fn new() -> Self {
        let folder = folder();
        save_usual(&folder.path().join("in.exr"));
        Self(folder)
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, args: &[&str]) {
        succeeds(isophote().current_dir(self.0.path()).arg("apply").args(args));
    }

    /// The picture under one style.
    fn alone(&self, style: &str, output: &str, more: &[&str]) -> Vec<[f32; 3]> {
        self.run(&[&[style, "in.exr", output, "--backend", "cpu"], more].concat());
        rgb(&self.at(output))
    }

    /// The picture under a list of looks.
    fn layered(&self, looks: &str) -> Vec<[f32; 3]> {
        fs::write(self.at("looks.json"), looks).expect("the folder is writable");
        self.run(&["--layered", "looks.json", "in.exr", "out.exr", "--force", "--backend", "cpu"]);
        rgb(&self.at("out.exr"))
    }
}

#[test]
fn looks_are_laid_over_each_other() {
    let shot = Shot::new();
    let soft = shot.alone("gaussian", "soft.exr", &["--set", "sigma=3"]);
    let drawn = shot.alone("cartoon", "drawn.exr", &[]);
    let hero = coverage(&["hero"]);
    // Complementary masks: each single result inside its own, made from the picture and not from each other.
    let layered = shot.layered(
        r#"[{"style": "gaussian", "params": {"sigma": 3}, "mask": "cryptomatte:hero"},
            {"style": "cartoon", "mask": "cryptomatte:hero", "invert": true}]"#,
    );
    for (pixel, (out, share)) in layered.iter().zip(&hero).enumerate() {
        match *share {
            1.0 => assert_eq!(*out, soft[pixel], "{pixel}"),
            0.0 => assert_eq!(*out, drawn[pixel], "{pixel}"),
            _ => assert!(out.iter().all(|v| v.is_finite())),
        }
    }
    // One look by itself is what --mask gives.
    let one = shot.layered(r#"[{"style": "gaussian", "params": {"sigma": 3}, "mask": "cryptomatte:hero"}]"#);
    let same = shot.alone("gaussian", "same.exr", &["--set", "sigma=3", "--mask", "cryptomatte:hero"]);
    assert_eq!(one, same);
    // Over a whole look.
    let over = shot.layered(
        r#"[{"style": "cartoon"}, {"style": "gaussian", "params": {"sigma": 3}, "mask": "cryptomatte:hero"}]"#,
    );
    assert!((0..PIXELS).all(|at| hero[at] != 0.0 || over[at] == drawn[at]));
}

#[test]
fn later_looks_cover_earlier_ones() {
    let shot = Shot::new();
    let at = |name: &str| shot.at(name);
    let before = rgb(&at("in.exr"));
    let soft = shot.alone("gaussian", "soft.exr", &["--set", "sigma=3"]);
    let drawn = shot.alone("cartoon", "drawn.exr", &[]);
    // A preset's parameters give way; a mask file lies beside the looks.
    fs::create_dir(at("looks")).expect("a folder");
    fs::write(at("looks/soft.json"), r#"{"style": "gaussian", "parameters": {"sigma": 9}}"#)
        .expect("a preset");
    GrayImage::from_fn(24, 16, |x, _| Luma([if x < 12 { 255 } else { 0 }]))
        .save(at("looks/left.png"))
        .expect("a mask");
    fs::write(
        at("looks/looks.json"),
        r#"[{"style": "cartoon", "mask": "cryptomatte:*,bunny"},
            {"preset": "soft.json", "params": {"sigma": 3}, "mask": "left.png"}]"#,
    )
    .expect("the folder is writable");
    shot.run(&["--layered", "looks/looks.json", "in.exr", "beside.exr", "--backend", "cpu"]);
    let any = coverage(&["bunny", "hero", "props/barrel", "props/box", "a,b*"]);
    for (pixel, out) in rgb(&at("beside.exr")).iter().enumerate() {
        match (pixel % SIZE.0 < 12, any[pixel]) {
            (true, _) => assert_eq!(*out, soft[pixel]),
            (_, 1.0) => assert_eq!(*out, drawn[pixel]),
            (_, 0.0) => assert_eq!(*out, before[pixel]),
            _ => {}
        }
    }
}

#[test]
fn lists_of_looks_are_checked() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_usual(&at("in.exr"));
    let cannot = |text: &str, words: &[&str]| {
        fs::write(at("looks.json"), text).expect("the folder is writable");
        let args = ["apply", "--layered", "looks.json", "in.exr", "no.exr"];
        fails(isophote().current_dir(folder.path()).args(args), 2, words);
    };
    cannot("{}", &["looks.json", "no list of looks"]);
    cannot("[]", &["0 looks"]);
    cannot(r#"[{"style": "ink"}, {"mask": "a"}]"#, &["looks.json: look 2", "names no style"]);
    cannot(r#"[{"style": "ink", "masks": "a"}]"#, &["look 1", "unknown key 'masks'"]);
    cannot(r#"[{"style": "inc"}]"#, &["inc"]);
    cannot(r#"[{"style": "ink", "params": {"sigmaa": 1}}]"#, &["look 1", "sigmaa"]);
    cannot(r#"[{"style": "ink", "invert": true}]"#, &["look 1", "invert"]);
    cannot(r#"[{"style": "ink", "mask": "cryptomatte:"}]"#, &["look 1", "names no mask"]);
    cannot(r#"[{"style": "ink", "mask": "gone.png"}]"#, &["gone.png"]);
    cannot(
        r#"[{"style": "ink"}, {"style": "flow_dog", "mask": "cryptomatte:hero"}]"#,
        &["look 2", "yields a scalar"],
    );
    let both = ["apply", "--layered", "looks.json", "in.exr", "no.exr", "--mask", "a.png"];
    fails(isophote().current_dir(folder.path()).args(both), 2, &["--layered", "--mask"]);
}

#[test]
fn masks_may_be_in_other_files_than_pictures() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_usual(&at("ids.exr"));
    picture(24, 16).save(at("in.png")).expect("the picture can be written");
    apply(folder.path(), "in.png", "all.png", &[]);
    apply(folder.path(), "in.png", "out.png", &["--mask", "cryptomatte:hero", "--mask-from", "ids.exr"]);
    let [before, all, out] =
        ["in.png", "all.png", "out.png"].map(|name| image::open(at(name)).expect("a picture").into_rgb8());
    for ((x, y, pixel), share) in out.enumerate_pixels().zip(coverage(&["hero"])) {
        match share {
            1.0 => assert_eq!(pixel, all.get_pixel(x, y)),
            0.0 => assert_eq!(pixel, before.get_pixel(x, y)),
            _ => {}
        }
    }
    let refused = |mask: &str, from: &str, words: &[&str]| {
        refused(folder.path(), &["in.png", "no.png", "--mask", mask, "--mask-from", from], words);
    };
    refused("cryptomatte:heroo", "ids.exr", &["ids.exr", "did you mean hero?"]);
    refused("matte", "ids.exr", &["ids.exr", "no layer or channel 'matte'"]);
    refused("matte", "all.png", &["all.png", "no EXR file"]);
    refused("cryptomatte:hero", "gone.exr", &["gone.exr"]);
    picture(12, 16).save(at("in.png")).expect("the picture can be written");
    refused("cryptomatte:hero", "ids.exr", &["ids.exr", "24x16"]);
}

#[test]
fn frames_that_lack_a_thing_fail_by_themselves() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let listed = manifest(&["hero"]);
    for frame in 1..=3 {
        let things = if frame == 2 { vec![] } else { matte("crypto_object", ["R", "G", "B", "A"]) };
        let depth = vec![("crypto_object00.R".to_owned(), FlatSamples::F32(vec![0.0; PIXELS]))];
        let cover = vec![("crypto_object00.G".to_owned(), FlatSamples::F32(vec![0.0; PIXELS]))];
        let none = if frame == 2 { [depth, cover].concat() } else { vec![] };
        let known = if frame == 2 { "{}" } else { listed.as_str() };
        let texts = attributes("f834d0a", "crypto_object", ("manifest", known));
        save(&at(&format!("in.{frame:04}.exr")), vec![("", [colours(), things, none].concat(), texts)]);
    }
    let args = ["apply", "cartoon", "in.####.exr", "out.####.exr", "--mask", "cryptomatte:hero"];
    let run = |more: &[&str]| {
        let mut command = isophote();
        command
            .current_dir(folder.path())
            .args(args)
            .args(["--backend", "cpu", "--steadiness", "0.5"])
            .args(more);
        command
    };
    fails(&mut run(&[]), 2, &["in.0002.exr: has no 'hero'", "1 of 3 frames"]);
    let exists = |frame: u32| at(&format!("out.{frame:04}.exr")).is_file();
    assert_eq!([1, 2, 3].map(exists), [true, false, true]);
    // Its neighbours depend on its picture all the same.
    let bytes = |frame: u32| fs::read(at(&format!("out.{frame:04}.exr"))).expect("a result");
    let before = [bytes(1), bytes(3)];
    let (_, warned) = succeeds(&mut run(&["--on-unknown", "empty", "--force"]));
    assert!(warned.contains("in.0002.exr: has no 'hero'"), "{warned}");
    assert_eq!([bytes(1), bytes(3)], before);
    assert_eq!(rgb(&at("out.0002.exr")), rgb(&at("in.0002.exr")));
}
