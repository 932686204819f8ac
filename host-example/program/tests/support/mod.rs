//! The program and the library under test, and pictures and scenes to give them.

#[cfg(target_os = "linux")]
pub mod access;
pub mod mattes;
#[cfg(target_os = "linux")]
pub mod others;
#[cfg(target_os = "linux")]
pub mod places;
#[cfg(target_os = "linux")]
pub mod slurm;
pub mod video;
#[cfg(target_os = "linux")]
pub mod window;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use isophote_window::jobs::export::{Export, ExportJob};
use isophote_window::state::progress::State;
use tempfile::TempDir;

/// Lengths in pixels: of pictures as small as those here, relative ones come to nothing.
pub const IN_PIXELS: [&str; 2] = ["--lengths", "pixels"];

/// The dynamic library, built with the profile of the running test. `ISOPHOTE_LIBRARY` names another.
pub fn library() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| match std::env::var_os("ISOPHOTE_LIBRARY") {
        Some(path) => path.into(),
        None => build(),
    })
}

fn build() -> PathBuf {
    let profile = Path::new(env!("CARGO_BIN_EXE_isophote")).parent().expect("a program lies in a folder");
    let name = profile.file_name().and_then(|n| n.to_str()).expect("a profile has a name");
    let target = profile.parent().expect("a profile lies in a target folder");
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // The whole workspace, since a part of it would have other features and be compiled once more.
    cargo.args(["build", "--workspace", "--lib", "--bins", "--quiet", "--target-dir"]).arg(target);
    if name != "debug" {
        cargo.args(["--profile", name]);
    }
    let status = cargo.current_dir(root()).status().expect("cargo can be started");
    assert!(status.success(), "the dynamic library cannot be built: {status}");
    profile.join(libloading::library_filename("isophote"))
}

/// The repository's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The program, which finds the library.
pub fn isophote() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_isophote"));
    command.env("ISOPHOTE_LIBRARY", library());
    command
}

/// What a program said, with paths as they are written on all systems but Windows.
fn said(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    if cfg!(windows) { text.replace('\\', "/") } else { text.into_owned() }
}

/// Standard error as text.
pub fn errors(output: &Output) -> String {
    said(&output.stderr)
}

/// Runs the program to a good end; returns what it printed and what it warned of.
pub fn succeeds(command: &mut Command) -> (String, String) {
    let output = command.output().expect("the program can be started");
    assert!(output.status.success(), "{command:?}: {}\n{}", output.status, errors(&output));
    (said(&output.stdout), errors(&output))
}

/// Runs the program, which must end with this code and say why on one line that holds all of `words`.
pub fn fails(command: &mut Command, code: i32, words: &[&str]) {
    let output = command.output().expect("the program can be started");
    let text = errors(&output);
    assert_eq!(output.status.code(), Some(code), "{command:?}:\n{text}");
    let errors: Vec<&str> = text.lines().filter(|line| !line.starts_with("warning: ")).collect();
    assert_eq!(errors.len(), 1, "{command:?}:\n{text}");
    assert!(errors[0].starts_with("error: "), "{command:?}:\n{text}");
    for word in words {
        assert!(text.contains(word), "{command:?} does not say '{word}':\n{text}");
    }
    assert!(output.stdout.is_empty(), "{command:?} prints: {}", String::from_utf8_lossy(&output.stdout));
}

/// The program in a namespace whose folder `small` is a disk of 64 KiB, between lines of a shell; nothing where no disk may
/// be mounted.
#[cfg(target_os = "linux")]
pub fn on_a_small_disk(folder: &Path, [before, after]: [&str; 2], more: &[&str]) -> Option<Command> {
    let mount = "mount -t tmpfs -o size=64k none small || exit 99";
    let script = format!("{mount}\n{before}\n\"$0\" \"$@\"\ncode=$?\n{after}\nexit $code");
    let namespace = |program: &str| {
        let mut command = Command::new("unshare");
        command.current_dir(folder).env("ISOPHOTE_LIBRARY", library());
        command.args(["-rm", "sh", "-c", &script, program]);
        command
    };
    if !namespace("true").stderr(std::process::Stdio::null()).status().is_ok_and(|status| status.success()) {
        eprintln!("\n*** SKIPPED: no disk may be mounted here ***\n");
        return None;
    }
    let mut command = namespace(env!("CARGO_BIN_EXE_isophote"));
    command.args(more);
    Some(command)
}

/// A folder that goes away with the test.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

/// Folder for a test of videos; none where there is no ffmpeg.
pub fn video_folder() -> Option<TempDir> {
    has_ffmpeg().then(folder)
}

/// Names of everything in a folder, sorted.
pub fn listing(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A small picture with slow changes, edges and detail; opaque.
pub fn picture(width: u32, height: u32) -> image::RgbImage {
    image::RgbImage::from_fn(width, height, |x, y| {
        let (u, v) = (x as f32 - width as f32 * 0.4, y as f32 - height as f32 * 0.5);
        let disc = u.hypot(v) < height as f32 * 0.3;
        let wave = (20.0 * (x as f32 * 0.5 + y as f32 * 0.2).sin()) as i32;
        let tone = (x * 3 % 256) as i32;
        let channel = |add: i32| (tone / 3 + add + wave + if disc { 90 } else { 20 }).clamp(0, 255) as u8;
        image::Rgb([channel(10), channel(40), channel((y * 2 % 90) as i32)])
    })
}

/// Writes a glTF file of one coloured cube with its buffer beside it.
pub fn cube(folder: &Path) -> PathBuf {
    let mut bytes: Vec<u8> = Vec::new();
    let mut normals: Vec<u8> = Vec::new();
    for side in 0..6 {
        let (axis, sign) = (side / 2, if side % 2 == 0 { 1.0f32 } else { -1.0 });
        for [u, v] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0f32]] {
            let mut position = [0.0f32; 3];
            position[axis] = sign;
            position[(axis + 1) % 3] = u * sign;
            position[(axis + 2) % 3] = v;
            let mut normal = [0.0f32; 3];
            normal[axis] = sign;
            bytes.extend(position.iter().flat_map(|v| v.to_le_bytes()));
            normals.extend(normal.iter().flat_map(|v| v.to_le_bytes()));
        }
    }
    let length = bytes.len();
    bytes.extend(normals);
    fs::write(folder.join("cube.bin"), &bytes).expect("the folder is writable");
    let file = folder.join("cube.gltf");
    fs::write(&file, cube_json("cube.bin", length)).expect("the folder is writable");
    file
}

/// Two cubes of one mesh, the right one behind the left one, in the file `cube.gltf`, and a preset of these rules for things.
pub fn ruled_cubes(folder: &Path, rules: &str) {
    let file = cube(folder);
    let mut json: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&file).expect("it was written")).expect("JSON");
    let node =
        |name: &str, place: [f32; 3]| serde_json::json!({"name": name, "mesh": 0, "translation": place});
    json["nodes"] = [node("hero", [-0.6, 0.0, 0.5]), node("prop", [0.8, 0.3, -1.5])].into();
    json["scenes"][0]["nodes"] = [0, 1].into();
    json["materials"][0]["name"] = "skin".into();
    fs::write(&file, json.to_string()).expect("the folder is writable");
    let preset = format!(r#"{{"style": "cartoon", "objects": [{rules}]}}"#);
    fs::write(folder.join("rules.json"), preset).expect("the folder is writable");
}

/// The glTF text of the cube, with its buffer at `uri` and normals after `length` bytes.
pub fn cube_json(uri: &str, length: usize) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
"materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.9,0.3,0.1,1],"metallicFactor":0}}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1}},"material":0}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":36,"type":"VEC3","min":[-1,-1,-1],"max":[1,1,1]}},
{{"bufferView":1,"componentType":5126,"count":36,"type":"VEC3"}}],
"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{length}}},
{{"buffer":0,"byteOffset":{length},"byteLength":{length}}}],
"buffers":[{{"uri":"{uri}","byteLength":{}}}]}}"#,
        2 * length
    )
}

/// Writes the cube with values of a control map at its vertices, `value` of where each is, as the attribute `name`.
pub fn controlled_cube(folder: &Path, name: &str, value: impl Fn([f32; 3]) -> [f32; 4]) -> PathBuf {
    let json = fs::read_to_string(cube(folder)).expect("the cube was written");
    let mut json: serde_json::Value = serde_json::from_str(&json).expect("the cube is JSON");
    let mut bytes = fs::read(folder.join("cube.bin")).expect("the cube was written");
    let (length, half) = (bytes.len(), bytes.len() / 2);
    let numbers: Vec<f32> = bytes[..half].as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let values = numbers.as_chunks::<3>().0.iter().flat_map(|position| value(*position));
    bytes.extend(values.flat_map(f32::to_le_bytes));
    fs::write(folder.join("controlled.bin"), &bytes).expect("the folder is writable");
    let mut push = |list: &str, item| json[list].as_array_mut().expect("a list").push(item);
    let view = serde_json::json!({"buffer": 0, "byteOffset": length, "byteLength": bytes.len() - length});
    push("bufferViews", view);
    push(
        "accessors",
        serde_json::json!({"bufferView": 2, "componentType": 5126, "count": 36, "type": "VEC4"}),
    );
    json["meshes"][0]["primitives"][0]["attributes"][name] = 2.into();
    json["buffers"][0] = serde_json::json!({"uri": "controlled.bin", "byteLength": bytes.len()});
    let file = folder.join("controlled.gltf");
    fs::write(&file, json.to_string()).expect("the folder is writable");
    file
}

/// The folder of real scenes and pictures, where there is one.
pub fn assets() -> Option<PathBuf> {
    let folder = root().join("../shared/assets");
    folder.is_dir().then_some(folder)
}

/// True where ffmpeg is there; where it must be, its absence fails.
pub fn has_ffmpeg() -> bool {
    let is_there = |name: &str| Command::new(name).arg("-version").output().is_ok_and(|o| o.status.success());
    if is_there("ffmpeg") && is_there("ffprobe") {
        return true;
    }
    assert!(std::env::var("CI").is_err(), "ffmpeg is missing; install it");
    eprintln!("\n*** SKIPPED: videos need ffmpeg ***\n");
    false
}

/// A triangle that turns for ever.
pub fn turning_triangle(folder: &Path) -> PathBuf {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let values: [f32; 24] = [
        -1.0, -0.6, 0.0, 1.0, -0.6, 0.0, 0.0, 1.0, 0.0, // positions
        0.0, 1.0, 2.0, // times
        0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half, 0.0, 1.0, 0.0, 0.0, // rotations
    ];
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    fs::write(folder.join("triangle.bin"), &bytes).expect("the folder is writable");
    let json = r#"{
      "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
      "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
      "materials": [{ "doubleSided": true, "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.3, 0.1, 1] } }],
      "animations": [{ "channels": [{ "sampler": 0, "target": { "node": 0, "path": "rotation" } }],
                       "samplers": [{ "input": 1, "output": 2 }] }],
      "buffers": [{ "uri": "triangle.bin", "byteLength": 96 }],
      "bufferViews": [{ "buffer": 0, "byteOffset": 0, "byteLength": 36 },
                      { "buffer": 0, "byteOffset": 36, "byteLength": 12 },
                      { "buffer": 0, "byteOffset": 48, "byteLength": 48 }],
      "accessors": [
        { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -0.6, 0], "max": [1, 1, 0] },
        { "bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [2] },
        { "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC4" }]
    }"#;
    let path = folder.join("triangle.gltf");
    fs::write(&path, json).expect("the folder is writable");
    path
}

/// Exports by the program under test, to the end.
pub fn export(mut job: ExportJob) {
    job.program = Some(isophote().get_program().into());
    let export = Export::start(job).expect("it begins");
    let started = Instant::now();
    while export.poll().state == State::Running {
        assert!(started.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(export.poll().state, State::Done);
}
