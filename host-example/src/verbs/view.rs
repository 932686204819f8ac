//! `isophote view`: a window that renders a scene and stylizes every frame.

use clap::Args;

use super::shared::{LengthArgs, SceneArgs, parse_size};
use super::staging::StagingArgs;
use crate::error::Result;
use crate::loader::Library;
use crate::stylize::style::Setting;
use crate::view;
use crate::view::viewer::{Options, Viewer, usable_styles};

/// Options of `view`.
#[derive(Args, Debug)]
#[command(after_help = view::KEYS)]
pub struct ViewArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    staging: StagingArgs,
    /// A style for the keys 1, 2, ...: none, the id of a node, a look, or a graph file or preset (.json). May be repeated
    /// [default: none and every node of the group styles].
    #[arg(long, value_name = "STYLE")]
    style: Vec<String>,
    /// Sets a parameter of the styles that have it. May be repeated.
    #[arg(long, value_name = "ID=VALUE")]
    set: Vec<Setting>,
    #[command(flatten)]
    lengths: LengthArgs,
    /// Size of the window in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    size: (u32, u32),
    /// Closes the window after so many frames.
    #[arg(long, value_name = "N")]
    frames: Option<u32>,
    /// Prints the adapter, and the frames and milliseconds of each style, when the window is closed.
    #[arg(long)]
    report: bool,
}

/// Runs the verb until the window is closed.
///
/// # Errors
/// [`crate::error::Error::Input`] for scenes and styles that cannot be shown,
/// [`crate::error::Error::Failure`] without a display or a graphics device.
pub fn run(args: &ViewArgs) -> Result<()> {
    let library = Library::open()?;
    let styles = usable_styles(&library, &args.style, &args.set)?;
    let scene = args.scene.load()?;
    let options = Options {
        name: args.scene.name(),
        styles,
        settings: args.set.clone(),
        lengths: args.lengths.lengths,
        size: args.size,
        framing: args.staging.framing(),
        camera: args.staging.camera(&scene)?,
        light: args.staging.light(),
        background: args.staging.background()?,
        ground: args.staging.ground(&scene),
        frames: args.frames,
    };
    view::show(Viewer::new(library, scene, options), args.report)
}
