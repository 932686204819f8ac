//! Rules of presets for things of scenes, while these are rendered.

use std::path::Path;
use std::process::Command;

use exr::prelude::read_first_flat_layer_from_file;

use crate::support::{fails, folder, isophote, ruled_cubes, succeeds};

/// Rules of all kinds: for a map, for a look and for colours of lines, by names of objects and of materials.
const RULES: &str = r##"{"match": "cryptomatte:hero", "lines": false, "detail": 4},
    {"match": "cryptomatte:p*", "look": {"style": "watercolor"}, "medium": 2},
    {"match": "material:skin", "line_color": "#c03018", "line_width": 2}"##;

fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = isophote();
    command.current_dir(folder).args(arguments.split_whitespace()).args(["--force", "--backend", "cpu"]);
    command
}

/// Renders the scene as a file, with more options.
fn render(folder: &Path, out: &str, more: &str) {
    succeeds(&mut command(folder, &format!("render cube.gltf {out} --size 96x64 {more}")));
}

fn channels(folder: &Path, name: &str) -> Vec<(String, Vec<f32>)> {
    let image = read_first_flat_layer_from_file(folder.join(name)).expect("an EXR file");
    let list = image.layer_data.channel_data.list;
    list.iter()
        .map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect()))
        .collect()
}

fn colours(folder: &Path, name: &str) -> Vec<(String, Vec<f32>)> {
    channels(folder, name)
        .into_iter()
        .filter(|(name, _)| ["R", "G", "B", "A"].contains(&name.as_str()))
        .collect()
}

/// Pixels of two pictures that are not alike.
fn apart(folder: &Path, [one, other]: [&str; 2]) -> usize {
    let (one, other) = (colours(folder, one), colours(folder, other));
    let pixel = |at: &usize| one.iter().zip(&other).any(|(a, b)| (a.1[*at] - b.1[*at]).abs() > 0.02);
    (0..one[0].1.len()).filter(pixel).count()
}

#[test]
fn scenes_follow_rules_as_files_of_them_do() {
    let folder = folder();
    let folder = folder.path();
    for rules in RULES.split(",\n").chain([RULES]) {
        ruled_cubes(folder, rules);
        render(folder, "plain.exr", "--cryptomatte");
        succeeds(&mut command(folder, "apply --preset rules.json plain.exr applied.exr"));
        render(folder, "ruled.exr", "--style rules.json");
        render(folder, "cartoon.exr", "--style cartoon");
        // Files hold normals as halves.
        let (same, other) =
            (apart(folder, ["ruled.exr", "applied.exr"]), apart(folder, ["ruled.exr", "cartoon.exr"]));
        assert!(same * 20 < other && other > 200, "{rules}: {same} as in a file, {other} without rules");
    }
}

#[test]
fn all_else_that_is_known_of_frames_stays() {
    let folder = folder();
    let folder = folder.path();
    ruled_cubes(folder, RULES);
    let turning = "--frames 2-3 --turntable --style rules.json --steadiness 0.5";
    render(folder, "ruled.####.exr", turning);
    render(folder, "cartoon.####.exr", &turning.replace("rules.json", "cartoon"));
    let known = |name: &str| -> Vec<_> {
        let colour = |name: &str| ["R", "G", "B", "A"].contains(&name);
        channels(folder, name).into_iter().filter(|(name, _)| !colour(name)).collect()
    };
    let names: Vec<String> = known("ruled.0003.exr").into_iter().map(|(name, _)| name).collect();
    assert!(names.contains(&"backward.u".to_owned()) && names.contains(&"id".to_owned()), "{names:?}");
    assert!(known("ruled.0003.exr") == known("cartoon.0003.exr"), "other guides");
    assert!(apart(folder, ["ruled.0003.exr", "cartoon.0003.exr"]) > 200);
}

#[test]
fn names_that_a_scene_does_not_have_are_refused() {
    let folder = folder();
    ruled_cubes(folder.path(), r#"{"match": "cryptomatte:heroo", "lines": false}"#);
    let mut command = command(folder.path(), "render cube.gltf ruled.png --size 96x64 --style rules.json");
    fails(&mut command, 2, &["cube.gltf", "did you mean hero?"]);
    assert!(!folder.path().join("ruled.png").exists());
    command.args(["--on-unknown", "empty"]);
    let (_, warnings) = succeeds(&mut command);
    assert!(warnings.contains("nothing of the name 'heroo'"), "{warnings}");
    assert!(folder.path().join("ruled.png").exists());
}
