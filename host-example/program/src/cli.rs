//! The command line: which verbs there are. Each verb's file declares its arguments.

use clap::{CommandFactory, Parser, Subcommand};

use crate::verbs::{
    apply, bench, carry, colours, documents, farm, info, materials, nodes, preset, render, sheet, view,
};
use isophote_files::error::Result;

const ABOUT: &str = "Turns pictures, sequences, videos and 3D scenes into cartoons, drawings and paintings.";
const AFTER_HELP: &str =
    "Nothing is overwritten unless --force is given. --in-place overwrites a picture with its own result.";

/// Four commands to begin with, under their heading.
const EXAMPLES: &str = "Examples:\n\
    \x20 isophote photo.jpg                           opens a picture, a sequence, a video or a scene in the window\n\
    \x20 isophote apply cartoon photo.jpg             writes photo.cartoon.jpg beside it\n\
    \x20 isophote apply look:noir_panel photos/ out/  stylizes the pictures of a folder into another\n\
    \x20 isophote preset list                         lists the looks, with a sentence on each";

/// Help of the program: examples come before anything else.
const HELP: &str = "\
{about-with-newline}
{before-help}{usage-heading} {usage}

{all-args}{after-help}";

/// Renders scenes and stylizes them; stylizes pictures and sequences of frames.
#[derive(Debug, Parser)]
#[command(
    name = "isophote",
    version,
    about = ABOUT,
    before_help = EXAMPLES,
    help_template = HELP,
    after_help = AFTER_HELP
)]
pub struct Cli {
    /// Command to carry out.
    #[command(subcommand)]
    command: Command,
}

/// The verbs.
#[derive(Debug, Subcommand)]
enum Command {
    /// Renders a glTF or OBJ scene to PNG or EXR frames.
    Render(Box<render::RenderArgs>),
    /// Gives a picture, a sequence of frames or a video a style.
    Apply(Box<apply::ApplyArgs>),
    /// Carries painted maps along the motion of a shot, from key frames to all others.
    Carry(carry::CarryArgs),
    /// Opens a picture, a sequence, a video or a scene in a window with all styles and their controls.
    View(view::ViewArgs),
    /// Puts pictures side by side on one contact sheet, with their names.
    Sheet(sheet::SheetArgs),
    /// Prints the colours of a picture or a palette, and writes them as a palette.
    Colours(colours::ColoursArgs),
    /// Lists the papers and hatchings that ship, and writes them as pictures.
    Materials(materials::MaterialsArgs),
    /// Saves, shows and checks presets: styles with their parameters as JSON files.
    Preset(preset::PresetArgs),
    /// Makes jobs for render farms.
    Farm(farm::FarmArgs),
    /// Tells all about a file: a picture, a video, a scene or a preset.
    Info(info::InfoArgs),
    /// Lists the styles and the filters that they are made of, or the parameters of one.
    Nodes(nodes::NodesArgs),
    /// Measures the speed of styles and filters.
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
            Command::Carry(args) => carry::run(args),
            Command::View(args) => view::run(args),
            Command::Sheet(args) => sheet::run(args),
            Command::Colours(args) => colours::run(args),
            Command::Materials(args) => materials::run(args),
            Command::Preset(args) => preset::run(args),
            Command::Farm(args) => farm::run(args),
            Command::Info(args) => info::run(args),
            Command::Nodes(args) => nodes::run(args),
            Command::Bench(args) => bench::run(args),
            Command::Documents(args) => documents::run(args, Self::command()),
        }
    }
}
