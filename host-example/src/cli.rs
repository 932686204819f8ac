//! The command line, declared once for parser and help.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Renders scenes and stylizes what it renders.
#[derive(Debug, Parser)]
#[command(name = "isophote", version, about)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Renders a glTF or OBJ scene to PNG or EXR frames.
    Render(RenderArgs),
}

/// Options of `render`.
#[derive(Args, Debug)]
pub struct RenderArgs {
    /// The scene: .gltf, .glb or .obj.
    pub scene: PathBuf,
    /// The picture: .png or .exr; with several frames, #### or an added .0001 stands for the number.
    pub out: PathBuf,
    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Number of frames.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub frames: u32,
    /// Turns the camera once around the scene over all frames.
    #[arg(long)]
    pub turntable: bool,
    /// Plays the file's animation, in a loop.
    #[arg(long)]
    pub animate: bool,
    /// Which animation plays, by name or by number from 0; the first if not given.
    #[arg(long, value_name = "NAME")]
    pub animation: Option<String>,
    /// Time of the first frame of the animation in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    pub start: f32,
    /// Frames per second of the animation.
    #[arg(long, value_name = "N", default_value_t = 24.0)]
    pub fps: f32,
    /// Degrees by which the default camera and turntables are turned to the right around the scene.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true)]
    pub azimuth: f32,
    /// Height of the default camera and turntables above the horizon in degrees, below 90.
    #[arg(long, value_name = "DEGREES", default_value_t = 16.0, allow_negative_numbers = true)]
    pub elevation: f32,
    /// Also writes normal, depth, object_id and motion of each frame as EXR into this folder.
    #[arg(long, value_name = "DIR")]
    pub aov: Option<PathBuf>,
    /// Image that colours an OBJ without textures.
    #[arg(long, value_name = "FILE")]
    pub texture: Option<PathBuf>,
    /// How frames are stylized.
    #[arg(long, default_value = "none")]
    pub style: String,
}

/// Most pixels of a picture that is rendered at once.
const MOST_PIXELS: u64 = 1 << 28;

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        Some((width.trim().parse().ok()?, height.trim().parse().ok()?))
    };
    match parse() {
        Some((width, height))
            if width > 0 && height > 0 && u64::from(width) * u64::from(height) <= MOST_PIXELS =>
        {
            Ok((width, height))
        }
        _ => Err("give width and height such as 1280x720, both at least 1".into()),
    }
}
