//! Cryptomattes that `render` writes, as `apply` and its masks read them.

use std::fs;
use std::path::Path;

use crate::support::mattes::mask_of;
use crate::support::{fails, folder, isophote, succeeds};
use exr::prelude::read_first_flat_layer_from_file;

/// Pixels across and down.
const WIDE: usize = 96;
const HIGH: usize = 64;

/// Two tiles beside each other, of which the nearer one hides a part of the other, in two materials.
fn save_scene(folder: &Path) {
    let tile = |name: &str, material: &str, [x, y, z]: [f32; 3], first: usize| {
        let corners = [[0.0, 0.0], [1.3, 0.2], [1.1, 1.4], [-0.2, 1.2]];
        let corners = corners.map(|[u, v]| format!("v {} {} {z}\n", x + u, y + v)).concat();
        let [a, b, c, d] = [0, 1, 2, 3].map(|corner| first + corner);
        format!("o {name}\nusemtl {material}\n{corners}f {a} {b} {c} {d}\n")
    };
    let near = tile("near/tile", "red", [0.0, 0.0, 0.2], 1);
    let far = tile("far tile", "blue, dark", [0.7, 0.4, 0.0], 5);
    fs::write(folder.join("tiles.obj"), format!("mtllib tiles.mtl\n{near}{far}")).expect("a writable folder");
    let materials = "newmtl red\nKd 0.8 0.1 0.1\nnewmtl blue, dark\nKd 0.1 0.1 0.5\n";
    fs::write(folder.join("tiles.mtl"), materials).expect("a writable folder");
}

fn render(folder: &Path, out: &str, more: &[&str]) {
    let mut command = isophote();
    let size = format!("{WIDE}x{HIGH}");
    command.current_dir(folder).args(["render", "tiles.obj", out, "--size", &size, "--force"]);
    succeeds(command.args(["--background", "transparent", "--no-ground"]).args(more));
}

/// Channels of a picture by their names.
fn channels(file: &Path) -> Vec<(String, Vec<f32>)> {
    let image = read_first_flat_layer_from_file(file).expect("an EXR file");
    let list = image.layer_data.channel_data.list.into_iter();
    list.map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect())).collect()
}

#[test]
fn rendered_things_are_found_by_their_names() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_scene(folder.path());
    render(folder.path(), "tiles.exr", &["--cryptomatte"]);
    let mask = |text: &str| mask_of(&at("tiles.exr"), text, false).expect("a mask");
    let [near, far] = [mask("cryptomatte:near/*"), mask("cryptomatte:far tile")];
    let all = mask("cryptomatte:*");
    let channels = channels(&at("tiles.exr"));
    let channel = |name: &str| &channels.iter().find(|(known, _)| known == name).expect("a channel").1;
    let (alpha, ids) = (channel("A"), channel("id"));
    let [mut edges, mut off, mut between] = [0.0f32; 3];
    for pixel in 0..WIDE * HIGH {
        assert!((near[pixel] + far[pixel] - all[pixel]).abs() < 1e-6, "the tiles share all that is covered");
        // What lies in the middle of a pixel is among its things.
        match ids[pixel] {
            1.0 => assert!(near[pixel] > 0.0, "{pixel}"),
            2.0 => assert!(far[pixel] > 0.0, "{pixel}"),
            _ => assert!(all[pixel] < 1.0, "{pixel}"),
        }
        if alpha[pixel] > 0.0 && alpha[pixel] < 1.0 {
            edges += 1.0;
            off += all[pixel] - alpha[pixel];
            // Four samples of the colour, sixteen of the things.
            assert!((all[pixel] - alpha[pixel]).abs() < 0.45, "{} for {}", all[pixel], alpha[pixel]);
        }
        between += f32::from(near[pixel] > 0.0 && far[pixel] > 0.0);
    }
    assert!(edges > 50.0 && (off / edges).abs() < 0.03, "{off} of {edges}");
    assert!(between > 5.0, "pixels on the border belong to both: {between}");
    // Each material is that of one tile; a comma in a name has a backslash.
    assert_eq!(mask("material:red"), near);
    assert_eq!(mask(r"material:blue\, dark"), far);
}

#[test]
fn other_layers_and_frames_stay_as_they_are() {
    let folder = folder();
    save_scene(folder.path());
    let all = ["--turntable", "--frames", "3"];
    render(folder.path(), "plain.####.exr", &all);
    render(folder.path(), "matte.####.exr", &[&all[..], &["--cryptomatte"]].concat());
    for frame in 1..=3 {
        let [plain, matte] =
            ["plain", "matte"].map(|name| channels(&folder.path().join(format!("{name}.{frame:04}.exr"))));
        let (mattes, others): (Vec<_>, Vec<_>) =
            matte.into_iter().partition(|(name, _)| name.starts_with("crypto_"));
        assert!(others == plain, "frame {frame}");
        assert_eq!(mattes.len(), 2 * 2 * 4);
    }
}

#[test]
fn styles_keep_rendered_mattes_and_rules_follow_them() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_scene(folder.path());
    render(folder.path(), "tiles.exr", &["--cryptomatte", "--style", "cartoon"]);
    assert!(mask_of(&at("tiles.exr"), "cryptomatte:*", false).is_ok_and(|mask| mask.contains(&1.0)));
    render(folder.path(), "tiles.exr", &["--cryptomatte"]);
    let styled = |rules: &str| {
        let preset = format!(r#"{{"style": "watercolor", "objects": [{rules}]}}"#);
        fs::write(at("rules.json"), preset).expect("a writable folder");
        let mut command = isophote();
        let arguments = ["apply", "--preset", "rules.json", "tiles.exr", "out.exr", "--force"];
        succeeds(command.current_dir(folder.path()).args(arguments).args(["--backend", "cpu"]));
        channels(&at("out.exr"))
    };
    let ruled = styled(r#"{"match": "material:red", "medium": 4}"#);
    assert!(ruled != styled(""));
    assert!(ruled.iter().any(|(name, _)| name == "crypto_material01.A"), "layers that are not read stay");
}

#[test]
fn only_exr_files_hold_cryptomattes() {
    let folder = folder();
    save_scene(folder.path());
    let mut command = isophote();
    command.current_dir(folder.path()).args(["render", "tiles.obj", "out.png", "--cryptomatte"]);
    fails(&mut command, 2, &["--cryptomatte", ".exr"]);
    assert!(!folder.path().join("out.png").exists());
}
