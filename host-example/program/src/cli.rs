//! The command line: which verbs there are. Each verb's file declares its arguments.

use clap::{CommandFactory, Parser, Subcommand};

use crate::verbs::{apply, bench, documents, farm, info, nodes, preset, render, sheet, view};
use isophote_files::error::Result;

const AFTER_HELP: &str = "Files that are there already stay unless --force is given, and no result takes the place of a file \
    that is read; a picture gives way to its own result with --in-place.";

/// Renders scenes and stylizes them; stylizes pictures and sequences of frames.
#[derive(Debug, Parser)]
#[command(name = "isophote", version, about, after_help = AFTER_HELP)]
pub struct Cli {
    /// Command to carry out.
    #[command(subcommand)]
    command: Command,
}

/// The verbs.
#[derive(Debug, Subcommand)]
enum Command {
    /// Renders a glTF or OBJ scene to PNG or EXR frames.
    Render(render::RenderArgs),
    /// Applies a node, graph or preset to a picture or a sequence of frames.
    Apply(Box<apply::ApplyArgs>),
    /// Opens a window that renders a scene and stylizes every frame.
    View(view::ViewArgs),
    /// Puts pictures side by side on one contact sheet, with their names.
    Sheet(sheet::SheetArgs),
    /// Saves, shows and checks presets: styles with their parameters as JSON files.
    Preset(preset::PresetArgs),
    /// Makes jobs for render farms.
    Farm(farm::FarmArgs),
    /// Prints what is understood of a file: a picture, a video, a scene, a preset.
    Info(info::InfoArgs),
    /// Lists the nodes, or the parameters of one.
    Nodes(nodes::NodesArgs),
    /// Measures how fast the nodes are.
    Bench(bench::BenchArgs),
    /// Writes the manual pages and the completions for shells.
    Documents(documents::DocumentsArgs),
}

impl Cli {
    /// Runs the verb.
    ///
    /// # Errors
    /// As the verb.
    pub fn run(&self) -> Result<()> {
        match &self.command {
            Command::Render(args) => render::run(args),
            Command::Apply(args) => apply::run(args),
            Command::View(args) => view::run(args),
            Command::Sheet(args) => sheet::run(args),
            Command::Preset(args) => preset::run(args),
            Command::Farm(args) => farm::run(args),
            Command::Info(args) => info::run(args),
            Command::Nodes(args) => nodes::run(args),
            Command::Bench(args) => bench::run(args),
            Command::Documents(args) => documents::run(args, Self::command()),
        }
    }
}
