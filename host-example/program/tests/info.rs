//! Facts in files: `info` tells it, and `apply` goes by it: windows, the shape of pixels, the kind of alpha.

use std::fs;
use std::path::Path;
use std::process::Command;

use image::{GenericImageView, RgbaImage};
use isophote_exr_edit::{Plane, create};
use isophote_pictures::exr::Selection;
use isophote_pictures::meaning::Alpha;
use isophote_pictures::read::{self, Source};
use serde_json::{Value, json};
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

use crate::support::{IN_PIXELS, fails, folder, has_ffmpeg, isophote, picture, root, succeeds};

fn source(path: &Path) -> Source {
    read::read(path, &Selection::default()).expect("a picture")
}

fn apply(folder: &Path, input: &Path, output: &str, set: &str) {
    let mut command = isophote();
    command.current_dir(folder).args(["apply", "gaussian"]).arg(input).arg(output);
    succeeds(command.args(["--backend", "cpu", "--set", set]).args(IN_PIXELS));
}

fn info(path: &Path) -> Value {
    let (text, _) = succeeds(isophote().arg("info").arg(path).arg("--json"));
    serde_json::from_str(&text).expect("JSON")
}

fn scene() -> std::path::PathBuf {
    root().join("tests/data/cases/gltf_transmission")
}

/// Standard deviations across and down of what is left of a point.
fn spread(source: &Source) -> [f64; 2] {
    let pixels = &source.pictures[0].pixels;
    let (width, channels) = (pixels.width() as usize, pixels.channels() as usize);
    let values: Vec<f64> = pixels.to_f32().iter().step_by(channels).map(|v| f64::from(*v)).collect();
    let sum: f64 = values.iter().sum();
    let moment = |place: &dyn Fn(usize) -> f64| {
        let mean = values.iter().enumerate().map(|(at, v)| v * place(at)).sum::<f64>() / sum;
        let squares = values.iter().enumerate().map(|(at, v)| v * (place(at) - mean).powi(2));
        (squares.sum::<f64>() / sum).sqrt()
    };
    [moment(&|at| (at % width) as f64), moment(&|at| (at / width) as f64)]
}

#[test]
fn cases_of_pixels_that_are_not_square_have_round_marks_that_say_so() {
    let folder = folder();
    let case = root().join("tests/data/cases/pixel_aspect/imp2.exr");
    // The point is as wide as two square pixels, and filtered as it is encoded.
    for (name, most) in [("out.exr", 0.03), ("out.tif", 0.03), ("out.png", 0.1), ("out.jpg", 0.2)] {
        apply(folder.path(), &case, name, "sigma=8");
        let out = folder.path().join(name);
        let source = source(&out);
        let [x, y] = spread(&source);
        assert!((x / 3.96 - 1.0).abs() < most && (y / 7.91 - 1.0).abs() < most, "{name}: {x} {y}");
        if name != "out.jpg" {
            assert_eq!(source.pictures[0].meaning.pixel_aspect, 2.0, "{name}");
            assert_eq!(info(&out)["pixel_aspect"], 2.0, "{name}");
        }
    }
    // There and back through other kinds of files.
    apply(folder.path(), Path::new("out.png"), "again.exr", "sigma=1");
    assert_eq!(info(&folder.path().join("again.exr"))["pixel_aspect"], 2.0);
    // JFIF, of which no unit is said.
    let bytes = fs::read(folder.path().join("out.jpg")).expect("the picture");
    assert!(bytes.windows(10).any(|b| *b == [b'J', b'F', b'I', b'F', 0, 1, 2, 0, 39, 16]));
}

/// A file of 3 by 2 pixels, all 1, in a display window of 6 by 4 from -1, -1.
fn windows(path: &Path, channels: &[&str]) {
    let plane = |name: &&str| ((*name).to_owned(), Plane::Float(vec![1.0; 6]));
    let channels = channels.iter().map(plane).collect();
    let picture = create::Picture { width: 3, height: 2, channels, ..create::Picture::default() };
    let mut bytes = std::io::Cursor::new(Vec::new());
    create::write(&picture, &mut bytes).expect("the picture can be written");
    let mut bytes = bytes.into_inner();
    let name = b"displayWindow\0box2i\0\x10\0\0\0";
    let at = bytes.windows(name.len()).position(|b| b == name).expect("a window") + name.len();
    for (place, side) in [-1_i32, -1, 4, 2].into_iter().enumerate() {
        bytes[at + 4 * place..][..4].copy_from_slice(&side.to_le_bytes());
    }
    fs::write(path, bytes).expect("the folder is writable");
}

#[test]
fn other_files_than_exr_show_the_display_window() {
    let folder = folder();
    for (channels, alpha) in [(&["A", "B", "G", "R"][..], 0), (&["B", "G", "R"][..], 255)] {
        let path = folder.path().join("in.exr");
        windows(&path, channels);
        for name in ["out.png", "out.tif"] {
            succeeds(
                isophote()
                    .current_dir(folder.path())
                    .args(["apply", "gaussian", "in.exr", name, "--force", "--backend", "cpu"])
                    .args(["--set", "sigma=1"])
                    .args(IN_PIXELS),
            );
            let source = source(&folder.path().join(name));
            let pixels = &source.pictures[0].pixels;
            assert_eq!((pixels.width(), pixels.height()), (6, 4), "{name}");
            let numbers = pixels.to_f32();
            let pixel = |x: usize, y: usize| &numbers[(y * 6 + x) * channels.len()..][..channels.len()];
            assert!(pixel(1, 1).iter().all(|v| (v - 1.0).abs() < 0.01), "{name}: {:?}", pixel(1, 1));
            assert!(pixel(0, 0).iter().all(|v| *v == 0.0) && pixel(5, 3).iter().all(|v| *v == 0.0), "{name}");
        }
        let shown = image::open(folder.path().join("out.png")).expect("a picture");
        assert_eq!(shown.get_pixel(0, 0).0[3], alpha);
        let told = info(&path);
        assert_eq!(told["data_window"], json!({"x": 0, "y": 0, "width": 3, "height": 2}));
        assert_eq!(told["display_window"], json!({"x": -1, "y": -1, "width": 6, "height": 4}));
    }
}

/// A TIFF of 8 bits, all of one colour.
fn tiff_of(path: &Path, colour: [u8; 4], extra: u16) {
    let mut file = fs::File::create(path).expect("the folder is writable");
    let mut encoder = TiffEncoder::new(&mut file).expect("a file");
    let mut image = encoder.new_image::<colortype::RGBA8>(16, 16).expect("a picture");
    image.encoder().write_tag(Tag::ExtraSamples, extra).expect("a tag");
    image.write_data(&colour.repeat(256)).expect("the picture can be written");
}

#[test]
fn the_kind_of_alpha_is_kept_or_said() {
    let folder = folder();
    for (extra, colour, alpha, straight) in [
        (1, [100, 50, 25, 128], Alpha::Premultiplied, [199, 100, 50, 128]),
        (2, [200, 100, 50, 128], Alpha::Straight, [200, 100, 50, 128]),
    ] {
        let path = folder.path().join(format!("in{extra}.tif"));
        tiff_of(&path, colour, extra);
        let near = |a: &[u8], b: [u8; 4]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1);
        let (tif, png) = (format!("out{extra}.tif"), format!("out{extra}.png"));
        apply(folder.path(), &path, &tif, "sigma=2");
        apply(folder.path(), &path, &png, "sigma=2");
        let source = source(&folder.path().join(tif));
        assert_eq!(source.pictures[0].meaning.alpha, alpha);
        assert!(near(&source.pictures[0].pixels.bytes()[..4], colour), "{extra}");
        let shown = image::open(folder.path().join(png)).expect("a picture").into_rgba8();
        assert!(near(&shown.get_pixel(8, 8).0, straight), "{extra}: {:?}", shown.get_pixel(8, 8));
        assert_eq!(info(&path)["alpha"], if extra == 1 { "premultiplied" } else { "straight" });
    }
}

#[test]
fn pictures_tell_their_size_colours_layers_and_guides() {
    let folder = folder();
    let path = folder.path().join("plain.1.png");
    picture(20, 10).save(&path).expect("the picture can be written");
    let told = info(&path);
    assert_eq!(
        (&told["kind"], &told["format"], &told["size"]),
        (&"picture".into(), &"PNG".into(), &json!([20, 10]))
    );
    assert_eq!((&told["colours"], &told["transfer"]), (&"assumed".into(), &"sRGB".into()));
    assert_eq!((&told["sequence"], &told["warnings"]), (&Value::Null, &json!([])));
    fs::copy(&path, folder.path().join("plain.3.png")).expect("the folder is writable");
    let told = info(&folder.path().join("plain.#.png"));
    assert_eq!(told["frames"], json!({"first": 1, "last": 3, "count": 2, "missing": 1}));
    let case = root().join("tests/data/cases/exr_color_interop/c_ap1id.exr");
    let told = info(&case);
    assert_eq!(told["primaries"]["name"], "AP1");
    assert_ne!(told["colours"], "assumed");
    let plane = |name: &str| (name.to_owned(), Plane::Float(vec![1.0; 6]));
    let names = ["B", "G", "R", "N.X", "N.Y", "N.Z", "Z", "diffuse.R", "diffuse.G", "diffuse.B"];
    let mut channels: Vec<(String, Plane)> = names.map(plane).into();
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    let picture = create::Picture { width: 3, height: 2, channels, ..create::Picture::default() };
    let path = folder.path().join("layers.exr");
    create::write(&picture, &mut fs::File::create(&path).expect("a file"))
        .expect("the picture can be written");
    let told = info(&path);
    let names = |list: &Value| -> Vec<String> {
        let name = |item: &Value| item["name"].as_str().unwrap_or_default().to_owned();
        list.as_array().expect("a list").iter().map(name).collect()
    };
    assert_eq!(names(&told["guides"]), ["normal", "depth", "diffuse"]);
    assert!(names(&told["layers"]).contains(&"diffuse".to_owned()), "{}", told["layers"]);
    assert_eq!(told["motion"], false);
    let (text, _) = succeeds(isophote().arg("info").arg(&path));
    for words in
        ["size            3x2", "guides          normal, channels N.X, N.Y, N.Z", "warnings        none"]
    {
        assert!(text.contains(words), "'{words}' is missing:\n{text}");
    }
}

#[test]
fn scenes_videos_and_presets_tell_what_they_hold() {
    let folder = folder();
    let file = fs::read_dir(scene()).expect("the case").flatten().map(|entry| entry.path());
    let file = file.filter(|path| path.extension().is_some_and(|e| e == "gltf" || e == "glb")).min();
    let told = info(&file.expect("a scene"));
    assert_eq!((&told["kind"], &told["format"]), (&"scene".into(), &"glTF 2.0".into()));
    let extensions = told["extensions"].as_array().expect("a list");
    assert!(extensions.contains(&json!({"name": "KHR_materials_transmission", "understood": true})));
    assert!(told["triangles"].as_u64().is_some_and(|count| count > 0));
    let preset = folder.path().join("dusk.json");
    fs::write(&preset, r#"{"style": "cartoon", "params": {"posterize": 6}}"#)
        .expect("the folder is writable");
    let told = info(&preset);
    if told["warnings"] == json!([]) {
        assert_eq!(
            (&told["kind"], &told["style"], &told["nodes"]),
            (&"preset".into(), &"cartoon".into(), &json!(["cartoon"]))
        );
    }
    if has_ffmpeg() {
        let video = folder.path().join("a.mp4");
        let made = Command::new("ffmpeg")
            .args([
                "-v",
                "error",
                "-f",
                "lavfi",
                "-i",
                "testsrc=size=64x48:rate=25:duration=1",
                "-pix_fmt",
                "yuv420p",
            ])
            .arg(&video)
            .status();
        assert!(made.is_ok_and(|status| status.success()));
        let told = info(&video);
        assert_eq!(
            (&told["kind"], &told["size"], &told["frames"]),
            (&"video".into(), &json!([64, 48]), &json!(25))
        );
        assert_eq!(told["frames_per_second"], 25.0);
    }
}

#[test]
fn warnings_are_told_once() {
    let folder = folder();
    let told = |file: &Path, words: &str| {
        for json in [true, false] {
            let mut command = isophote();
            let (text, errors) =
                succeeds(command.arg("info").arg(file).args(Some("--json").filter(|_| json)));
            assert_eq!((text.matches(words).count(), errors.as_str()), (1, ""), "{text}");
        }
        assert_eq!(info(file)["warnings"].as_array().map(Vec::len), Some(1));
    };
    let case = root().join("tests/data/cases/exr_color_interop/c_srgbid.exr");
    let name = b"colorInteropID\0string\0";
    let mut bytes = fs::read(case).expect("the case");
    let at = bytes.windows(name.len()).position(|b| b == name).expect("an id") + name.len() + 4;
    bytes[at..at + 2].copy_from_slice(b"zz");
    for number in [1, 2] {
        fs::write(folder.path().join(format!("a.{number}.exr")), &bytes).expect("the folder is writable");
    }
    told(&folder.path().join("a.1.exr"), "is not known");
    told(&folder.path().join("a.#.exr"), "is not known");
    if has_ffmpeg() {
        told(&root().join("tests/data/cases/video_interlaced/inter.mp4"), "is interlaced");
    }
}

#[test]
fn files_that_are_missing_or_damaged_are_told() {
    let folder = folder();
    let file = |name: &str| {
        let path = folder.path().join(name);
        fs::write(&path, "no such thing").expect("the folder is writable");
        path
    };
    for name in ["a.png", "a.exr", "a.gltf", "a.obj", "a.json"] {
        fails(isophote().arg("info").arg(folder.path().join(format!("none.{name}"))), 2, &[name]);
        fails(isophote().arg("info").arg(file(name)), 2, &[name]);
    }
    let mut cut = Vec::new();
    let whole = RgbaImage::new(9, 9);
    whole.write_to(&mut std::io::Cursor::new(&mut cut), image::ImageFormat::Png).expect("a picture");
    cut.truncate(50);
    let path = folder.path().join("cut.png");
    fs::write(&path, cut).expect("the folder is writable");
    fails(isophote().args(["info", "--json"]).arg(&path), 2, &["cut.png", "is damaged"]);
    fails(isophote().arg("info").arg(folder.path()), 2, &["is a folder"]);
    fails(isophote().args(["info", "-"]), 2, &["stands for a stream"]);
}
