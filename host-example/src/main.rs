//! The example: a scene, rendered and stylized frame by frame, in a window or into files.

#![forbid(unsafe_code)]

mod headless;
mod painter;
mod style;
mod window;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use isophote_files::error::Result;
use isophote_files::output;
use isophote_render::drivers;
use isophote_scene::Scene;

/// Renders a scene and stylizes every frame.
#[derive(Debug, Parser)]
#[command(version, about)]
struct Options {
    /// The scene: .gltf, .glb or .obj.
    scene: PathBuf,
    /// The style: the id of a node, a graph file (.json), or none.
    #[arg(long, default_value = "cartoon")]
    style: String,
    /// Writes frames as PNG files into this folder, and opens no window.
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Number of frames that are written; of several, the camera turns once around the scene.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "frames", value_parser = clap::value_parser!(u32).range(1..=9999))]
    count: u32,
    /// Size of the frames in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    size: (u32, u32),
}

/// Width and height such as `1280x720`.
fn size(text: &str) -> std::result::Result<(u32, u32), &'static str> {
    let numbers = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    numbers.filter(|(w, h)| *w > 0 && *h > 0).ok_or("write width and height such as 1280x720")
}

fn run(options: &Options) -> Result<()> {
    let scene = Scene::load(&options.scene, None)?;
    scene.warnings.iter().for_each(output::warn);
    match &options.frames {
        Some(folder) => headless::write(folder, options.count, options.size, scene, &options.style),
        None => window::show(options.size, scene, &options.style),
    }
}

fn main() -> ExitCode {
    drivers::keep_quiet();
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::complain(&error);
            ExitCode::from(error.exit_code())
        }
    }
}
