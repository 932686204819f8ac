//! The command line, declared once for parser and help.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::apply::{Bytes, GuideChoice};
use crate::stylize::style::Setting;

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
    /// Applies a node, graph or preset to a picture or a sequence of frames.
    Apply(ApplyArgs),
    /// Opens a window that renders a scene and stylizes every frame.
    View(ViewArgs),
    /// Puts pictures side by side with their names, to be looked at.
    Sheet(SheetArgs),
    /// Saves, shows and checks presets: styles with their parameters as JSON files.
    Preset(PresetArgs),
    /// Makes jobs for render farms.
    Farm {
        /// What to do.
        #[command(subcommand)]
        command: FarmCommand,
    },
    /// Lists the nodes, or the parameters of one.
    Nodes(NodesArgs),
    /// Measures how fast the nodes are.
    Bench(BenchArgs),
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
    /// How frames are stylized: none, the id of a node, or a graph file or preset (.json).
    #[arg(long, default_value = "none")]
    pub style: String,
    /// Sets a parameter of the style; node.id=value for one node of a graph. May be repeated.
    #[arg(long, value_name = "ID=VALUE")]
    pub set: Vec<Setting>,
}

/// Options of `view`.
#[derive(Args, Debug)]
pub struct ViewArgs {
    /// The scene: .gltf, .glb or .obj.
    pub scene: PathBuf,
    /// A style for the keys 1, 2, ...: none, the id of a node or a graph file (.json); may be given several
    /// times. Without it: none and every node of the group styles.
    #[arg(long, value_name = "STYLE")]
    pub style: Vec<String>,
    /// Sets a parameter of the styles; may be given several times.
    #[arg(long, value_name = "ID=VALUE")]
    pub set: Vec<Setting>,
    /// Size of the window in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Image that colours an OBJ without textures.
    #[arg(long, value_name = "FILE")]
    pub texture: Option<PathBuf>,
    /// Closes after so many frames.
    #[arg(long, value_name = "N")]
    pub frames: Option<u32>,
    /// Prints adapter, frames and milliseconds of each style when the window is closed.
    #[arg(long)]
    pub report: bool,
}

/// What `farm` does.
#[derive(Debug, Subcommand)]
pub enum FarmCommand {
    /// Writes an Open Job Description template (jobtemplate-2023-09) of an apply command.
    Openjd(OpenJdArgs),
}

/// Options of `farm openjd`.
#[derive(Args, Debug)]
pub struct OpenJdArgs {
    /// The template: .json; on standard output without.
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Name of the job.
    #[arg(long)]
    pub name: Option<String>,
    /// Frames of a task, by the extension TASK_CHUNKING; one without.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub chunk: Option<u32>,
    /// The command: apply with its arguments, after --.
    #[arg(last = true, required = true)]
    pub command: Vec<String>,
}

/// Options of `apply`.
#[derive(Args, Debug)]
pub struct ApplyArgs {
    /// The id of a node, or a graph file or preset (.json); left out with --preset.
    pub style: PathBuf,
    /// The picture: PNG, JPEG, TIFF, WebP, HDR or EXR; shot.####.exr, shot.@@@@.exr or shot.%04d.exr for a sequence.
    pub input: PathBuf,
    /// The result: .png, .jpg, .tif or .exr; may be the same file. Of a sequence with a place for the number too.
    #[arg(required_unless_present = "preset")]
    pub output: Option<PathBuf>,
    /// A preset file with the style and its parameters.
    #[arg(long, value_name = "FILE")]
    pub preset: Option<PathBuf>,
    /// Frames of the sequence, such as 1001-1100x2,1200; without it all that are on disk.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub frames: Option<String>,
    /// What to do when frames of the sequence have no file.
    #[arg(long, value_enum, default_value_t = OnMissing::Fail)]
    pub on_missing: OnMissing,
    /// Most memory, such as 4GiB; decides how many frames are in flight. At most 4GiB without.
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<Bytes>,
    /// Leaves results alone that are there already and whole.
    #[arg(long)]
    pub skip_existing: bool,
    /// Says what would be done, and does nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Prints a line of JSON for every frame.
    #[arg(long)]
    pub json: bool,
    /// Sets a parameter; node.id=value for one node of a graph. May be repeated.
    #[arg(long, value_name = "ID=VALUE")]
    pub set: Vec<Setting>,
    /// Where the work is done; auto takes a graphics card if there is one, otherwise the CPU.
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    pub backend: Backend,
    /// What the numbers of the picture mean, and the result's; without it sRGB for files of integers, what
    /// its chromaticities say or else linear for EXR, linear for other floats.
    #[arg(long, value_enum)]
    pub space: Option<Space>,
    /// The layer of an EXR file that is read and replaced; without it the main one.
    #[arg(long, value_name = "LAYER")]
    pub layer: Option<String>,
    /// The view of an EXR file with several; without it all views are filtered, each by itself.
    #[arg(long, value_name = "VIEW")]
    pub view: Option<String>,
    /// The channel of an EXR file that is the layer's alpha, or none; without it the layer's A.
    #[arg(long, value_name = "CHANNEL")]
    pub alpha: Option<String>,
    /// Adds the result to the EXR file as a new layer, and leaves the one that was read as it was.
    #[arg(long, value_name = "NEWLAYER")]
    pub into: Option<String>,
    /// The layer of an EXR file that is a guide: normal=LAYER, depth=LAYER or object_id=LAYER; =none for
    /// no such guide. Without it guides are found by names such as N, normal, Z, depth, P and id. May be repeated.
    #[arg(long, value_name = "GUIDE=LAYER")]
    pub guide: Vec<GuideChoice>,
    /// Threads on the CPU; 0 for one per core.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1024))]
    pub threads: u32,
}

/// Options of `sheet`. Pictures are shown as displays show them: light is encoded for sRGB, and what is brighter
/// than white is white.
#[derive(Args, Debug)]
pub struct SheetArgs {
    /// The sheet: .png.
    pub sheet: PathBuf,
    /// The pictures, in the order of the sheet; all views of EXR files.
    #[arg(required = true)]
    pub pictures: Vec<PathBuf>,
    /// Pictures in a row; without it up to four.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub columns: Option<u32>,
    /// Width of each picture in pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = 640, value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub width: u32,
    /// What stands under a picture instead of its name; may be given for each, in their order.
    #[arg(long, value_name = "TEXT")]
    pub label: Vec<String>,
}

/// Options of `preset`.
#[derive(Args, Debug)]
pub struct PresetArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: PresetCommand,
}

/// What can be done to presets. Parameters in them may have keyframes instead of a value:
/// `"sigma_d": {"1001": 2, "1050": 6}`, with `"between": "step"` for values that hold until the next key.
#[derive(Debug, Subcommand)]
pub enum PresetCommand {
    /// Writes a style with its parameters to a file.
    Save {
        /// The id of a node, a graph file or another preset.
        style: String,
        /// The file: .json.
        file: PathBuf,
        /// Sets a parameter; node.id=value for one node of a graph. May be repeated.
        #[arg(long, value_name = "ID=VALUE")]
        set: Vec<Setting>,
        /// Writes the parameters that are not set too, so that other defaults would change nothing.
        #[arg(long)]
        all: bool,
        /// Replaces the file if there is one.
        #[arg(long)]
        force: bool,
    },
    /// Prints the parameters of a preset.
    Show {
        /// The preset.
        file: PathBuf,
        /// With the values at this frame instead of keyframes.
        #[arg(long, value_name = "N", allow_negative_numbers = true)]
        frame: Option<i64>,
    },
    /// Tells whether presets can be used as they are, and what is wrong with those that cannot.
    Check {
        /// The presets.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
}

/// What becomes of a run when frames are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OnMissing {
    /// It does not start.
    Fail,
    /// The other frames are done.
    Skip,
}

/// Where a graph runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// A graphics card if there is one, otherwise the CPU.
    Auto,
    /// The CPU.
    Cpu,
    /// The best graphics device there is, software drivers included.
    Gpu,
}

/// What the numbers of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Space {
    /// Gamma-encoded sRGB.
    Srgb,
    /// Linear light, Rec.709 primaries.
    #[value(alias = "rec709")]
    Linear,
    /// ACEScg: linear light, AP1 primaries.
    Acescg,
    /// Linear light, P3 primaries, white D65.
    #[value(alias = "linear-p3")]
    P3,
    /// Linear light, Rec.2020 primaries.
    #[value(alias = "linear-rec2020")]
    Rec2020,
}

/// Options of `nodes`.
#[derive(Args, Debug)]
pub struct NodesArgs {
    /// A node, to be shown with its parameters.
    pub node: Option<String>,
    /// Everything, as JSON.
    #[arg(long)]
    pub json: bool,
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

/// Options of `bench`. Times are medians of warm runs and leave out reading and writing of pixels.
#[derive(Args, Debug)]
pub struct BenchArgs {
    /// Everything, as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where to measure; on both without.
    #[arg(long, value_enum)]
    pub backend: Option<BenchBackend>,
    /// Size of the picture in pixels; without it 1280x720 and 1920x1080.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// Only this node, with other values than the defaults where they follow, such as
    /// oriented_bilateral,iterations=1. May be repeated.
    #[arg(long, value_name = "ID[,PARAM=VALUE]...")]
    pub node: Vec<String>,
    /// Also writes what is measured to this file, for --compare.
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// Sets every time against that of a run saved before: x0.50 is twice as fast. Load of the machine
    /// changes times as much as code does, so that both runs should find it idle.
    #[arg(long, value_name = "FILE")]
    pub compare: Option<PathBuf>,
    /// Instead finishes a sequence of so many EXR frames (half floats, ZIP) on the CPU, from file to file, and
    /// sets the time against that of filtering alone; cartoon at 1920x1080 without --node and --size.
    #[arg(long, value_name = "FRAMES", conflicts_with_all = ["save", "compare", "markdown", "backend"],
        value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub sequence: Option<u32>,
    /// Prints a table in Markdown, beside what other programs take for the like where that was measured.
    #[arg(long, conflicts_with = "json")]
    pub markdown: bool,
    /// Runs whose median counts, after one that does not.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub runs: u32,
}

/// What `bench` measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BenchBackend {
    /// The CPU, against its own peak.
    Cpu,
    /// The best graphics device there is.
    Gpu,
}
