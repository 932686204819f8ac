//! Frames that `render` writes with their guides in one file, which `apply` reads.

use std::path::Path;

use crate::support::{self, IN_PIXELS, folder, isophote, listing, succeeds};
use exr::prelude::read_first_flat_layer_from_file;
use isophote_files::files::Existing;
use isophote_pictures::floats;

/// Everything of a rendered frame, in the order of EXR files.
const CHANNELS: [&str; 28] = [
    "A",
    "B",
    "G",
    "N.X",
    "N.Y",
    "N.Z",
    "Pref.X",
    "Pref.Y",
    "Pref.Z",
    "R",
    "Z",
    "albedo.A",
    "albedo.B",
    "albedo.G",
    "albedo.R",
    "backward.u",
    "backward.v",
    "diffuse.A",
    "diffuse.B",
    "diffuse.G",
    "diffuse.R",
    "forward.u",
    "forward.v",
    "id",
    "specular.A",
    "specular.B",
    "specular.G",
    "specular.R",
];

type Exr = exr::prelude::Image<exr::prelude::Layer<exr::prelude::AnyChannels<exr::prelude::FlatSamples>>>;

fn read(path: &Path) -> Exr {
    read_first_flat_layer_from_file(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn channel(image: &Exr, name: &str) -> Vec<f32> {
    let list = &image.layer_data.channel_data.list;
    let found = list.iter().find(|c| c.name.to_string() == name).unwrap_or_else(|| panic!("no {name}"));
    found.sample_data.values_as_f32().collect()
}

fn render(folder: &Path, out: &str, more: &[&str]) {
    let scene = support::cube(folder);
    let mut command = isophote();
    command
        .current_dir(folder)
        .arg("render")
        .arg(scene)
        .arg(out)
        .args(["--size", "96x64"])
        .args(IN_PIXELS)
        .args(more);
    succeeds(&mut command);
}

fn apply(folder: &Path, arguments: &[&str]) {
    let mut command = isophote();
    succeeds(
        command.current_dir(folder).arg("apply").args(arguments).args(IN_PIXELS).args(["--backend", "cpu"]),
    );
}

#[test]
fn a_frame_has_its_guides_under_names_that_compositors_know() {
    let folder = folder();
    render(folder.path(), "frame.exr", &[]);
    let frame = read(&folder.path().join("frame.exr"));
    let names: Vec<String> = frame.layer_data.channel_data.list.iter().map(|c| c.name.to_string()).collect();
    assert_eq!(names, CHANNELS);
    let get = |name: &str| channel(&frame, name);
    let (id, z) = (get("id"), get("Z"));
    let (normals, rest) = (["N.X", "N.Y", "N.Z"].map(get), ["Pref.X", "Pref.Y", "Pref.Z"].map(get));
    let camera = frame.layer_data.attributes.world_to_camera.expect("the file says where the camera is");
    let (mut shown, mut nearest, mut farthest) = (0, f32::MAX, 0.0f32);
    for at in 0..id.len() {
        let [n, p] = [&normals, &rest].map(|v| [v[0][at], v[1][at], v[2][at]]);
        if id[at] == 0.0 {
            assert_eq!((z[at], n), (0.0, [0.0; 3]), "the background at {at}");
            // Below the cube its shadow falls on the ground.
            assert!(p == [0.0; 3] || (-1.01..-1.0).contains(&p[1]), "the background at {at}: {p:?}");
            continue;
        }
        shown += 1;
        assert_eq!(id[at], 1.0);
        assert!((n.iter().map(|v| v * v).sum::<f32>() - 1.0).abs() < 2e-3, "{n:?} is no unit vector");
        // The cube does not move, so that it is where it was at rest: on one of its sides, and as far from the
        // camera as Z says.
        let side = p.iter().fold(0.0f32, |most, v| most.max(v.abs()));
        assert!((side - 1.0).abs() < 1e-4, "{p:?} is not on the cube");
        let depth = -(p[0] * camera[2] + p[1] * camera[6] + p[2] * camera[10] + camera[14]);
        assert!((z[at] - depth).abs() < 1e-3 * depth, "{} instead of {depth}", z[at]);
        (nearest, farthest) = (nearest.min(z[at]), farthest.max(z[at]));
    }
    assert!(shown > 500, "the cube covers {shown} pixels");
    assert!(farthest > nearest + 0.5, "all is {nearest} to {farthest} away");
    assert!(get("A").iter().all(|a| *a == 1.0));
}

#[test]
fn colours_are_scene_linear_unless_tone_mapped_ones_are_asked_for() {
    let folder = folder();
    render(folder.path(), "linear.exr", &[]);
    render(folder.path(), "mapped.exr", &["--tone-mapped"]);
    render(folder.path(), "mapped.png", &[]);
    let [linear, mapped] = ["linear.exr", "mapped.exr"].map(|name| read(&folder.path().join(name)));
    assert_ne!(channel(&linear, "R"), channel(&mapped, "R"));
    assert_eq!(channel(&linear, "Z"), channel(&mapped, "Z"));
    let png = image::open(folder.path().join("mapped.png")).expect("a picture was written").into_rgb8();
    for (name, at) in [("R", 0), ("G", 1), ("B", 2)] {
        for (pixel, value) in png.pixels().zip(channel(&mapped, name)) {
            let encoded =
                if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
            assert!(
                (encoded * 255.0 - f32::from(pixel[at])).abs() < 0.51,
                "{name}: {value} is {}",
                pixel[at]
            );
        }
    }
}

#[test]
fn frames_are_applied_with_their_guides() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    render(folder.path(), "shot.####.exr", &["--frames", "2", "--turntable"]);
    let stylized = ["--frames", "2", "--turntable", "--style", "blueprint", "--backend"];
    for backend in ["gpu", "cpu"] {
        render(folder.path(), &format!("{backend}.####.exr"), &[&stylized[..], &[backend]].concat());
    }
    apply(folder.path(), &["blueprint", "shot.####.exr", "theirs.####.exr"]);
    let none = ["--guide", "normal=none", "--guide", "depth=none", "--guide", "id=none"];
    apply(folder.path(), &[&["blueprint", "shot.####.exr", "blind.####.exr"], &none[..]].concat());
    for frame in ["0001", "0002"] {
        let [shot, ours, processed, theirs, blind] =
            ["shot", "gpu", "cpu", "theirs", "blind"].map(|name| read(&path(&format!("{name}.{frame}.exr"))));
        for name in ["R", "G", "B"] {
            assert_eq!(
                channel(&processed, name),
                channel(&theirs, name),
                "{name} of frame {frame} on the CPU"
            );
            let [ours, theirs, blind] = [&ours, &theirs, &blind].map(|image| channel(image, name));
            let far = |a: &[f32], b: &[f32]| a.iter().zip(b).filter(|(a, b)| (*a - *b).abs() > 0.01).count();
            // The file's colours are halves; the renderer's own go to the filter as floats.
            let apart = far(&ours, &theirs);
            assert!(apart * 1000 <= ours.len(), "{name} of frame {frame}: {apart} of {} differ", ours.len());
            let guided = far(&theirs, &blind);
            assert!(
                guided > 2 * apart && guided * 20 > ours.len(),
                "{name} of frame {frame}: guides change {guided} pixels"
            );
        }
        for name in CHANNELS.iter().filter(|name| !["R", "G", "B", "A"].contains(name)) {
            assert_eq!(channel(&shot, name), channel(&theirs, name), "{name} is left alone");
            assert_eq!(channel(&shot, name), channel(&ours, name), "{name} is written with a style too");
            assert_eq!(channel(&shot, name), channel(&processed, name), "{name} is written so as well");
        }
    }
}

#[test]
fn marks_stick_to_things_in_what_is_rendered_and_in_what_is_applied() {
    let folder = folder();
    render(folder.path(), "shot.exr", &[]);
    for backend in ["gpu", "cpu"] {
        let style = ["--style", "watercolor", "--set", "clouds=1", "--backend", backend];
        render(folder.path(), &format!("{backend}.exr"), &style);
    }
    apply(folder.path(), &["watercolor", "shot.exr", "theirs.exr", "--set", "clouds=1"]);
    let none = ["--guide", "rest_position=none"];
    apply(
        folder.path(),
        &[&["watercolor", "shot.exr", "blind.exr", "--set", "clouds=1"], &none[..]].concat(),
    );
    let [ours, processed, theirs, blind] = ["gpu", "cpu", "theirs", "blind"]
        .map(|name| channel(&read(&folder.path().join(format!("{name}.exr"))), "G"));
    let far = |a: &[f32], b: &[f32]| a.iter().zip(b).filter(|(a, b)| (*a - *b).abs() > 0.01).count();
    let (apart, anchored) = (far(&ours, &theirs), far(&theirs, &blind));
    assert!(apart * 100 <= ours.len(), "{apart} of {} differ", ours.len());
    let apart_on_cpu = far(&processed, &theirs);
    assert!(apart_on_cpu * 1000 <= ours.len(), "{apart_on_cpu} differ on the CPU");
    assert!(anchored > 4 * apart && anchored * 20 > ours.len(), "rest positions change {anchored} pixels");
}

#[test]
fn any_frames_of_a_sequence_are_rendered_as_in_the_whole() {
    let folder = folder();
    let names = |start: &str| -> Vec<String> {
        listing(folder.path()).into_iter().filter(|name| name.starts_with(start)).collect()
    };
    render(folder.path(), "all.%04d.exr", &["--frames", "1-5", "--turntable"]);
    assert_eq!(names("all."), ["0001", "0002", "0003", "0004", "0005"].map(|n| format!("all.{n}.exr")));
    render(folder.path(), "some.@@@.exr", &["--frames", "1-5x2", "--turntable"]);
    assert_eq!(names("some."), ["001", "003", "005"].map(|n| format!("some.{n}.exr")));
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect("the frame was written");
    for number in [1, 3, 5] {
        let [all, some] = [format!("all.{number:04}.exr"), format!("some.{number:03}.exr")];
        // Motion is from the frame before, also where that is not rendered.
        assert_eq!(bytes(&all), bytes(&some), "frame {number}");
    }
    let motion = channel(&read(&folder.path().join("all.0003.exr")), "backward.u");
    assert!(motion.iter().any(|v| v.abs() > 1.0), "a turning cube moves");
    // What is whole stays, what is not is rendered again.
    let whole = bytes("all.0002.exr");
    std::fs::write(folder.path().join("all.0001.exr"), b"kept only if it is whole").expect("writable");
    std::fs::write(folder.path().join("all.0004.exr"), &whole).expect("writable");
    render(folder.path(), "all.%04d.exr", &["--frames", "1-5", "--turntable", "--skip-existing"]);
    assert_eq!(bytes("all.0001.exr"), bytes("some.001.exr"));
    assert_eq!(bytes("all.0004.exr"), whole, "a whole picture was rendered again");
}

#[test]
fn layers_add_up_to_the_picture_and_shade_it_in_steps() {
    let folder = folder();
    render(folder.path(), "lit.exr", &["--background", "transparent", "--no-ground"]);
    let lit = read(&folder.path().join("lit.exr"));
    let mut seen = 0;
    for colour in ["R", "G", "B"] {
        let [albedo, diffuse, specular] =
            ["albedo", "diffuse", "specular"].map(|layer| channel(&lit, &format!("{layer}.{colour}")));
        for (index, all) in channel(&lit, colour).iter().enumerate() {
            let sum = diffuse[index] + specular[index];
            assert!((all - sum).abs() <= 0.003 * all + 1e-5, "{colour} of {index}: {all} and {sum}");
            seen += usize::from(albedo[index] > 0.1 && diffuse[index] > 0.0 && specular[index] > 0.0);
        }
    }
    assert!(seen > 1000, "{seen} are lit");
    // What is covered is so by all layers, and what is tone-mapped has no light of the scene.
    assert_eq!(channel(&lit, "A"), channel(&lit, "albedo.A"));
    for without in ["--tone-mapped", "--no-light"] {
        render(folder.path(), "dark.exr", &[without, "--force"]);
        let dark = read(&folder.path().join("dark.exr"));
        let names = dark.layer_data.channel_data.list.iter().map(|channel| channel.name.to_string());
        let light: Vec<String> = names.filter(|name| name.starts_with("albedo")).collect();
        assert!(light.is_empty(), "{without}: {light:?}");
    }

    // Without a word the layers are used: each side of a cube is one tone.
    let steps = ["--set", "color_1=#400000", "--set", "color_2=#004000", "--set", "color_3=#000040"];
    apply(folder.path(), &[&["toon_shading", "lit.exr", "steps.exr"], &steps[..]].concat());
    let none = ["--guide", "albedo=none", "--guide", "diffuse=none", "--guide", "specular=none"];
    apply(folder.path(), &[&["toon_shading", "lit.exr", "blind.exr"], &steps[..], &none[..]].concat());
    let shaded = |name: &str| {
        let image = read(&folder.path().join(name));
        ["R", "G", "B"].map(|colour| channel(&image, colour))
    };
    let [steps, blind] = ["steps.exr", "blind.exr"].map(shaded);
    assert_ne!(steps, blind);
    let tone = colour_of(64.0 / 255.0);
    let albedo = ["R", "G", "B"].map(|colour| channel(&lit, &format!("albedo.{colour}")));
    let (mut flat, mut covered) = (0, 0);
    for (index, alpha) in channel(&lit, "A").iter().enumerate().filter(|(_, alpha)| **alpha == 1.0) {
        covered += usize::from(*alpha == 1.0);
        let is_tone = |at: usize| (steps[at][index] - tone * albedo[at][index]).abs() < 0.002;
        flat += usize::from((0..3).any(is_tone));
    }
    assert!(flat * 10 > covered * 9, "{flat} of {covered} have a tone");
}

#[test]
fn a_cartoon_reads_the_light_of_a_file_where_it_is_asked_to() {
    let folder = folder();
    render(folder.path(), "lit.exr", &["--background", "transparent", "--no-ground"]);
    let none = ["--guide", "albedo=none", "--guide", "diffuse=none", "--guide", "specular=none"];
    let reds = |name: &str, more: &[&str]| {
        apply(folder.path(), &[&["cartoon", "lit.exr", name], more].concat());
        channel(&read(&folder.path().join(name)), "R")
    };
    let light = ["--set", "shading=light"];
    let [plain, plain_blind] = [reds("plain.exr", &[]), reds("plain-blind.exr", &none)];
    assert_eq!(plain, plain_blind);
    let [lit, blind] = [reds("cel.exr", &light), reds("blind.exr", &[&light[..], &none].concat())];
    assert_ne!(lit, blind);
    assert_ne!(blind, plain);
}

#[test]
fn scenes_are_shaded_by_their_own_light_while_they_are_rendered() {
    let folder = folder();
    let scene = ["--background", "transparent", "--no-ground"];
    let light = ["--style", "toon_shading", "--set", "color_1=#400000", "--set", "highlight=0.5"];
    render(folder.path(), "lit.exr", &scene);
    render(folder.path(), "rendered.exr", &[&scene[..], &light, &["--backend", "cpu"]].concat());
    apply(folder.path(), &[&["toon_shading", "lit.exr", "applied.exr"], &light[2..]].concat());
    let [rendered, applied] = ["rendered.exr", "applied.exr"].map(|name| read(&folder.path().join(name)));
    for channel_name in ["R", "G", "B", "A"] {
        assert_eq!(channel(&rendered, channel_name), channel(&applied, channel_name), "{channel_name}");
    }

    // What is tone-mapped has the light of what is: sides in the dark have the colour of the first step alone.
    let shown = |backend: &str| {
        let name = format!("{backend}.png");
        render(folder.path(), &name, &[&scene[..], &light, &["--backend", backend, "--no-light"]].concat());
        image::open(folder.path().join(name)).expect("a picture").to_rgb8().into_raw()
    };
    let (cpu, gpu) = (shown("cpu"), shown("gpu"));
    let apart = cpu.iter().zip(&gpu).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    assert!(apart * 1000 < cpu.len(), "{apart} of {} differ", cpu.len());
    let dark = |pixels: &[u8]| {
        pixels.as_chunks::<3>().0.iter().filter(|[r, g, b]| *r > 20 && *g == 0 && *b == 0).count()
    };
    assert!(dark(&cpu) > 100, "{} pixels are in the first step", dark(&cpu));
}

#[test]
fn light_of_files_of_its_own_counts_as_that_of_layers() {
    let folder = folder();
    render(folder.path(), "lit.exr", &["--background", "transparent", "--no-ground"]);
    let file = folder.path().join("lit.exr");
    let [layers, names] = [["albedo", "diffuse", "specular"], ["R", "G", "B"]];
    for layer in layers {
        let planes = names.map(|name| channel(&read(&file), &format!("{layer}.{name}")));
        let data = (0..planes[0].len()).flat_map(|at| [0, 1, 2].map(|c| planes[c][at])).collect();
        let picture = floats::Picture { width: 96, height: 64, channels: 3, data };
        let path = folder.path().join(format!("{layer}.exr"));
        floats::save_exr(&path, Existing::Replace, &picture, &names, floats::Precision::Float, (None, None))
            .expect("it can be written");
    }
    let reds = |name: &str, more: &[&str]| {
        let light = ["cartoon", "lit.exr", name, "--set", "shading=light"];
        apply(folder.path(), &[&light[..], more].concat());
        channel(&read(&folder.path().join(name)), "R")
    };
    let none = ["--guide", "albedo=none", "--guide", "diffuse=none", "--guide", "specular=none"];
    let files = ["--albedo", "albedo.exr", "--diffuse", "diffuse.exr", "--specular", "specular.exr"];
    let layered = reds("layers.exr", &[]);
    assert_eq!(reds("files.exr", &[&none[..], &files].concat()), layered);
    assert_ne!(reds("others.exr", &["--diffuse", "specular.exr"]), layered);
}

/// The light of a gamma-encoded number.
fn colour_of(encoded: f32) -> f32 {
    ((encoded + 0.055) / 1.055).powf(2.4)
}

#[test]
fn motion_to_the_next_frame_leads_where_its_own_leads_back() {
    let folder = folder();
    // So slowly that a face which is seen stays in sight.
    render(folder.path(), "all.%04d.exr", &["--frames", "4,5,60", "--turntable"]);
    let frame = |number: u32| read(&folder.path().join(format!("all.{number:04}.exr")));
    let (here, next) = (frame(4), frame(5));
    let [u, v, ids] = ["forward.u", "forward.v", "id"].map(|name| channel(&here, name));
    let [back_u, back_v, next_ids] = ["backward.u", "backward.v", "id"].map(|name| channel(&next, name));
    let (width, height) = (96, 64);
    let (mut seen, mut apart) = (0, 0);
    for (index, id) in ids.iter().enumerate().filter(|(_, id)| **id != 0.0) {
        let (x, y) = (index % width, index / width);
        // Files count rows from below.
        let to = (x as f32 + u[index], y as f32 - v[index]);
        let (x, y) = (to.0.round(), to.1.round());
        if x < 0.0 || y < 0.0 || x >= width as f32 || y >= height as f32 {
            continue;
        }
        let there = y as usize * width + x as usize;
        if next_ids[there] == *id {
            seen += 1;
            // A pixel's centre is up to half a pixel from where the point is, and a face may lie between.
            let way = (u[index] + back_u[there]).hypot(v[index] + back_v[there]);
            apart += usize::from(way > 0.5 + 0.1 * u[index].hypot(v[index]));
        }
    }
    assert!(u.iter().any(|v| v.abs() > 1.0), "a turning cube moves");
    assert!(seen > 500 && apart * 20 < seen, "{apart} of {seen} pixels lead elsewhere");
}
