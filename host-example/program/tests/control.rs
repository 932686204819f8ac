//! Control maps that scenes bring as values of their vertices: what `render` writes and draws of them, and what `apply` makes
//! of its frames.

use std::fs;
use std::path::Path;

use crate::support::{IN_PIXELS, controlled_cube, cube, folder, isophote, succeeds};
use exr::prelude::read_first_flat_layer_from_file;

/// Channels of the layer as the file names them.
const LAYER: [&str; 4] = ["control.R", "control.G", "control.B", "control.A"];

fn run(folder: &Path, arguments: &[&str]) -> String {
    succeeds(isophote().current_dir(folder).args(arguments).args(IN_PIXELS).arg("--force")).0
}

fn render(folder: &Path, scene: &Path, out: &str, more: &[&str]) {
    let scene = scene.to_str().expect("a name in Unicode");
    let usual = ["render", scene, out, "--size", "96x64", "--no-ground"];
    run(folder, &[&usual[..], more].concat());
}

/// Channels of a picture by their names.
fn channels(file: &Path) -> Vec<(String, Vec<f32>)> {
    let image = read_first_flat_layer_from_file(file).expect("an EXR file");
    let list = image.layer_data.channel_data.list.into_iter();
    list.map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect())).collect()
}

#[test]
fn frames_hold_the_control_map_of_the_scene() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let plain = cube(folder.path());
    render(folder.path(), &plain, "plain.exr", &[]);
    for name in ["_CONTROL", "COLOR_1"] {
        // Where a point was at rest is in the file, too.
        let scene = controlled_cube(folder.path(), name, |[x, y, z]| {
            [0.5 + 0.25 * x, 0.5 + 0.25 * y, 0.5 + 0.25 * z, 0.125]
        });
        render(folder.path(), &scene, "frame.exr", &[]);
        let (plain, frame) = (channels(&at("plain.exr")), channels(&at("frame.exr")));
        let (layer, others): (Vec<_>, Vec<_>) =
            frame.into_iter().partition(|(name, _)| LAYER.contains(&name.as_str()));
        assert!(others == plain, "{name}: all else stays to the bit");
        let channel = |list: &[(String, Vec<f32>)], name: &str| {
            list.iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("no {name}")).1.clone()
        };
        let map = LAYER.map(|name| channel(&layer, name));
        let rest = ["Pref.X", "Pref.Y", "Pref.Z"].map(|name| channel(&others, name));
        let ids = channel(&others, "id");
        for at in 0..ids.len() {
            let found = [0, 1, 2, 3].map(|k| map[k][at]);
            let expected = match ids[at] {
                0.0 => [0.5; 4],
                _ => [0, 1, 2, 3].map(|k: usize| rest.get(k).map_or(0.125, |rest| 0.5 + 0.25 * rest[at])),
            };
            let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3);
            assert!(is_near, "{name}: {found:?} instead of {expected:?} at {at}");
        }
        assert!(ids.iter().filter(|id| **id > 0.0).count() > 500);
    }
}

#[test]
fn styles_follow_the_control_map_of_the_scene() {
    let folder = folder();
    let open = |name: &str| image::open(folder.path().join(name)).expect("a picture was written").into_rgb8();
    let plain = cube(folder.path());
    for backend in ["cpu", "gpu"] {
        let draw = |scene: &Path, out: &str| {
            render(folder.path(), scene, out, &["--style", "ink", "--backend", backend]);
        };
        draw(&plain, "plain.png");
        let neutral = controlled_cube(folder.path(), "_CONTROL", |_| [0.5; 4]);
        draw(&neutral, "neutral.png");
        assert_eq!(open("neutral.png"), open("plain.png"), "{backend}: 0.5 changes nothing");
        let without_lines = controlled_cube(folder.path(), "_CONTROL", |_| [0.5, 0.5, 0.0, 0.5]);
        draw(&without_lines, "directed.png");
        let ink = |name: &str| open(name).pixels().filter(|pixel| pixel.0[1] < 96).count();
        let [all, left] = [ink("plain.png"), ink("directed.png")];
        assert!(left < all, "{backend}: {left} dark pixels of {all} are left without lines");
    }
}

#[test]
fn apply_follows_the_control_map_of_a_rendered_frame() {
    let folder = folder();
    let bytes = |name: &str| fs::read(folder.path().join(name)).expect("a picture was written");
    let scene = controlled_cube(folder.path(), "_CONTROL", |[x, ..]| [0.5, 0.5, 0.5 - 0.5 * x, 0.5]);
    render(folder.path(), &scene, "frame.exr", &[]);
    let apply = |out: &str, more: &[&str]| {
        run(folder.path(), &[&["apply", "ink", "frame.exr", out, "--backend", "cpu"], more].concat())
    };
    let said = apply("directed.png", &[]);
    assert!(said.contains("control from control.R, control.G, control.B, control.A"), "{said}");
    apply("plain.png", &["--guide", "control=none"]);
    assert_ne!(bytes("directed.png"), bytes("plain.png"));
}

#[test]
fn info_says_that_a_scene_has_a_control_map() {
    let folder = folder();
    let scenes = [cube(folder.path()), controlled_cube(folder.path(), "_CONTROL", |_| [0.25; 4])];
    for (scene, has_map) in scenes.iter().zip([false, true]) {
        let (text, _) = succeeds(isophote().arg("info").arg(scene).arg("--json"));
        let told: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(told["control_map"], has_map);
    }
}
