//! Shots from the sample host, `isophote render`, kept on disk for as long as its program stays the same.

use super::read;
use super::shot::Shot;
use crate::{library, png};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

/// Frames of a shot.
pub const FRAMES: usize = 10;

/// Size of the frames in pixels, as the tables of the experiments have it.
pub const SIZE: [u32; 2] = [640, 360];

/// Size of the frames where no table is asked for and half as many pixels show what holds.
const SMALL: [u32; 2] = [416, 234];

/// The size of the tables where they are asked for, and else the smaller one.
pub fn size() -> [u32; 2] {
    if std::env::var_os("ISOPHOTE_TABLES").is_some() { SIZE } else { SMALL }
}

/// Scene and options that are rendered.
#[derive(Clone, Debug, Hash)]
pub struct ShotOptions {
    /// Of the shot.
    pub name: &'static str,
    /// glTF file; none for the demo scene.
    pub scene: Option<PathBuf>,
    /// Of the frames, in pixels.
    pub size: [u32; 2],
    /// Options of `isophote render` beside those for size and frames.
    pub options: Vec<&'static str>,
}

/// The demo scene along its camera's path, 24 frames a second, from the middle of the path, where the camera is
/// fastest: at its ends it rests.
///
/// # Errors
/// As [`shoot`].
pub fn demo(size: [u32; 2]) -> Result<Shot, String> {
    let options = vec!["--animate", "--fps", "24", "--start", "1.8"];
    shoot(&ShotOptions { name: "demo", scene: None, size, options })
}

/// The running fox before a camera at rest, 24 frames a second; `None` where the assets are not beside the checkout.
///
/// # Errors
/// As [`shoot`].
pub fn fox(size: [u32; 2]) -> Option<Result<Shot, String>> {
    let scene = png::assets()?.join("gltf/Fox.glb");
    let options = vec!["--animation", "Run", "--fps", "24"];
    scene.is_file().then(|| shoot(&ShotOptions { name: "fox", scene: Some(scene), size, options }))
}

/// Renders [`FRAMES`] frames, or reads those that the same program rendered before.
///
/// # Errors
/// The error of the program, or the problem with its files.
pub fn shoot(take: &ShotOptions) -> Result<Shot, String> {
    // Builds the programs too.
    library::path();
    let mut hash = DefaultHasher::new();
    (take, FRAMES, modified(&program("isophote"))?).hash(&mut hash);
    match &take.scene {
        Some(file) => modified(file)?.hash(&mut hash),
        None => modified(&program("isophote-demo-scene"))?.hash(&mut hash),
    }
    let shelf = png::results().join("rendered_shots");
    fs::create_dir_all(&shelf).map_err(|e| format!("{}: {e}", shelf.display()))?;
    let [width, height] = take.size;
    let name = format!("{}-{width}x{height}", take.name);
    let folder = shelf.join(format!("{name}-{:016x}", hash.finish()));
    if !folder.is_dir() {
        sweep(&shelf, &name);
        render(take, &shelf, &folder)?;
    }
    let frames = (1..=FRAMES).map(|number| read::frame(&folder.join(format!("{number:04}.exr"))));
    Ok(Shot { name: take.name.into(), frames: frames.collect::<Result<_, _>>()?, is_static: false })
}

/// A program of the workspace, of the profile of the running test.
fn program(name: &str) -> PathBuf {
    // target/<profile>/deps/<test>
    let test = std::env::current_exe().unwrap_or_default();
    let profile = test.parent().and_then(Path::parent).unwrap_or(Path::new(""));
    profile.join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

fn modified(file: &Path) -> Result<SystemTime, String> {
    let time = fs::metadata(file).and_then(|data| data.modified());
    time.map_err(|e| format!("{}: {e}", file.display()))
}

/// Removes what other programs rendered of a take: each is tens of megabytes.
fn sweep(shelf: &Path, name: &str) {
    for entry in fs::read_dir(shelf).into_iter().flatten().flatten() {
        let is_of_take = entry.file_name().to_string_lossy().rsplit_once('-').is_some_and(|(n, _)| n == name);
        if is_of_take {
            // What another test reads just now goes with the next sweep.
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// Renders into a folder that gets its name only when it is whole.
fn render(take: &ShotOptions, shelf: &Path, folder: &Path) -> Result<(), String> {
    let fault = |e: std::io::Error| format!("{}: {e}", shelf.display());
    let work = tempfile::tempdir_in(shelf).map_err(fault)?;
    let scene = match &take.scene {
        Some(file) => file.clone(),
        None => {
            run(Command::new(program("isophote-demo-scene")).arg(work.path().join("scene")))?;
            work.path().join("scene/city.gltf")
        }
    };
    let frames = work.path().join("frames");
    fs::create_dir(&frames).map_err(fault)?;
    let [width, height] = take.size;
    let mut command = Command::new(program("isophote"));
    command.arg("render").arg(scene).arg(frames.join("####.exr"));
    command.args(["--size", &format!("{width}x{height}"), "--frames", &FRAMES.to_string()]);
    run(command.arg("--tone-mapped").args(&take.options))?;
    match fs::rename(&frames, folder) {
        // Another test was faster.
        Err(_) if folder.is_dir() => Ok(()),
        other => other.map_err(fault),
    }
}

/// Runs a program to a good end.
fn run(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    if output.status.success() {
        return Ok(());
    }
    Err(format!("{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr)))
}
