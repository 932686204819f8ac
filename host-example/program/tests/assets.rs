//! Real scenes, where there are any: each renders and can be stylized.

use std::path::{Path, PathBuf};

use image::RgbImage;

use crate::support::{IN_PIXELS, assets, folder, isophote, succeeds};

/// Renders plain and as cartoon at 320x180; returns what was warned of and the plain picture.
fn looks_right(folder: &Path, scene: &Path, more: &[&str]) -> (String, RgbImage) {
    let name = scene.file_stem().and_then(|n| n.to_str()).expect("a file name");
    let render = |style: &str| {
        // EXR, so that what is not a number is seen.
        let out = folder.join(format!("{name}.{style}.exr"));
        let mut command = isophote();
        command
            .arg("render")
            .arg(scene)
            .arg(&out)
            .args(["--force", "--size", "320x180", "--style", style])
            .args(IN_PIXELS)
            .args(more);
        let (_, warnings) = succeeds(&mut command);
        let read = exr::prelude::read_first_flat_layer_from_file(&out).expect("an EXR file");
        let list = &read.layer_data.channel_data.list;
        let plane = |wanted: &str| -> Vec<f32> {
            let channel = list.iter().find(|c| c.name.to_string() == wanted).expect("a channel");
            channel.sample_data.values_as_f32().collect()
        };
        let planes = ["R", "G", "B"].map(plane);
        for plane in &planes {
            assert!(plane.iter().all(|v| v.is_finite()), "{name} ({style}) has what is not a number");
        }
        let byte = |v: f32| (isophote_pictures::transfer::srgb_encode(v.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8;
        let picture = RgbImage::from_fn(320, 180, |x, y| {
            let at = (y * 320 + x) as usize;
            image::Rgb([0, 1, 2].map(|channel: usize| byte(planes[channel][at])))
        });
        (warnings, picture)
    };
    let (warnings, plain) = render("none");
    let (_, cartoon) = render("cartoon");
    // More than the backdrop: some share of the picture is far from the corner's colour.
    let corner = *plain.get_pixel(0, 0);
    let far = |a: &image::Rgb<u8>, b: &image::Rgb<u8>| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 24);
    let scene_pixels = plain.pixels().filter(|p| far(p, &corner)).count();
    assert!(scene_pixels > 320 * 180 / 50, "{name} is blank: {scene_pixels} pixels show anything");
    let changed = plain.pixels().zip(cartoon.pixels()).filter(|(a, b)| far(a, b)).count();
    assert!(changed > 320 * 180 / 200, "the style changes {changed} pixels of {name}");
    (warnings, plain)
}

fn asset(path: &str) -> Option<PathBuf> {
    let Some(folder) = assets() else {
        eprintln!("\n*** SKIPPED: there are no assets beside the repository ***\n");
        return None;
    };
    let file = folder.join(path);
    assert!(file.is_file(), "{} is missing", file.display());
    Some(file)
}

#[test]
fn gltf_scenes() {
    let folder = folder();
    for path in
        ["FlightHelmet/FlightHelmet.gltf", "MorphStressTest.gltf", "CornellBox.glb", "gltf_primitives.glb"]
    {
        let Some(file) = asset(&format!("gltf/{path}")) else { return };
        looks_right(folder.path(), &file, &[]);
    }
}

#[test]
fn the_fox_runs() {
    let folder = folder();
    let Some(file) = asset("gltf/Fox.glb") else { return };
    let frame = |start: &str| looks_right(folder.path(), &file, &["--animation", "Run", "--start", start]).1;
    assert_ne!(frame("0.1"), frame("0.35"), "the fox stands still");
}

#[test]
fn obj_scenes() {
    let folder = folder();
    let Some(spot) = asset("obj/spot/spot_triangulated.obj") else { return };
    for path in ["teapot.obj", "stanford-bunny.obj"] {
        let Some(file) = asset(&format!("obj/{path}")) else { return };
        looks_right(folder.path(), &file, &[]);
    }
    let Some(texture) = asset("obj/spot/spot_texture.png") else { return };
    let texture = texture.to_str().expect("a path that is text");
    let (_, painted) = looks_right(folder.path(), &spot, &["--texture", texture]);
    let (_, bare) = looks_right(folder.path(), &spot, &[]);
    assert_ne!(painted, bare, "the texture does not show");
}

#[test]
fn layers_that_are_left_out_are_named() {
    let folder = folder();
    let Some(file) = asset("gltf/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf") else { return };
    let (warnings, _) = looks_right(folder.path(), &file, &[]);
    assert!(
        warnings.lines().count() > 0 && warnings.lines().all(|l| l.starts_with("warning: ")),
        "{warnings}"
    );
    assert!(warnings.contains("KHR_materials_anisotropy"), "{warnings}");
    assert!(!warnings.contains(".ktx2"), "its textures are read: {warnings}");
}
