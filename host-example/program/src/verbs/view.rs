//! `isophote view`: the artist's window.

use std::path::{Path, PathBuf};

use clap::Args;

use super::shared::{LengthArgs, PrecisionArgs, parse_size};
use isophote_files::error::{AtPlace, Result};
use isophote_finishing::apply::backend::Backend;
use isophote_finishing::staging::{ReadingArgs, StagingArgs};
use isophote_finishing::stylize::style::{Setting, Style};
use isophote_loader::Library;
use isophote_window::jobs::document::{self, Document};
use isophote_window::state::document::kind::Kind;
use isophote_window::state::look::{EditedLook, PLAIN};
use isophote_window::state::scenery::{Lighting, Scenery, Staging};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;

/// The look of a window that was never open.
const FIRST: &str = "cartoon";

/// Options of `view`.
#[derive(Args, Debug)]
#[command(after_help = isophote_window::keys())]
pub struct ViewArgs {
    /// A scene (.gltf, .glb or .obj), a picture (PNG, JPEG, TIFF, WebP, HDR or EXR), a sequence (shot.####.exr) or a video.
    /// Without one the window asks what to open.
    file: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArgs,
    #[command(flatten)]
    staging: StagingArgs,
    /// A style for the keys 1, 2, ...: none, a style, a look, or a preset or graph file (.json). May be repeated
    /// [default: none and every node of the group styles].
    #[arg(long, value_name = "STYLE")]
    style: Vec<PathBuf>,
    /// Sets a parameter of the styles that have it. May be repeated.
    #[arg(long, value_name = "ID=VALUE")]
    set: Vec<Setting>,
    #[command(flatten)]
    lengths: LengthArgs,
    /// Processor that looks are computed on. Where the graphics driver computes on the CPU itself, auto leaves pictures to
    /// the library, which is faster there.
    #[arg(long, value_enum, default_value_t)]
    backend: Backend,
    #[command(flatten)]
    precision: PrecisionArgs,
    /// Size of the window in pixels [default: what it was last, at first 1440x900].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Closes the window after so many frames.
    #[arg(long, value_name = "N")]
    frames: Option<u32>,
    /// Prints the adapter and the precision, and the frames and milliseconds of each style, when the window is closed.
    #[arg(long)]
    report: bool,
}

/// Runs the verb until the window is closed.
///
/// # Errors
/// [`isophote_files::error::Error::Input`] for scenes and styles that cannot be shown,
/// [`isophote_files::error::Error::Failure`] without a display or a graphics device.
pub fn run(args: &ViewArgs) -> Result<()> {
    let library = Library::open()?;
    let looks = looks(&library, args)?;
    let (settings, problem) = Settings::read();
    let last = settings.look.clone().unwrap_or_else(|| FIRST.into());
    let last = Some(last).filter(|_| args.style.is_empty());
    let mut session = Session::new(library, looks, settings)?;
    problem.iter().for_each(|problem| session.notes.complain(problem));
    session.looks.prepare(&args.set, args.lengths.lengths);
    session.record.limit = args.frames;
    (session.precision, session.backend) = (args.precision.precision, args.backend);
    session.resume(last.as_deref());
    let document = match &args.file {
        Some(path) => open(&mut session, path, args)?,
        None => None,
    };
    isophote_window::show(session, document, args.size, args.report)
}

/// Opens what was named, before there is a window; returns the document where that is pictures.
fn open(session: &mut Session, path: &Path, args: &ViewArgs) -> Result<Option<Document>> {
    let document = Document::open(path, &document::Options::default())?;
    if document.kind() != Kind::Scene {
        session.show_playback(document.playback()?);
        return Ok(Some(document));
    }
    let scene = args.reading.load(path)?;
    let staging = Staging {
        framing: args.staging.framing(),
        camera: args.staging.find_camera(&scene)?,
        lighting: Lighting {
            sun: args.staging.light,
            exposure: args.staging.exposure,
            background: args.staging.read_background()?,
            surroundings: args.staging.surroundings(),
        },
        ground: args.staging.has_ground(&scene),
        reading: args.reading.clone(),
    };
    let (width, height) = args.size.or(session.settings.window).unwrap_or((16, 10));
    let scenery = Scenery::new(scene, staging, width as f32 / height as f32);
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    session.show_scene(scenery, Some(path.to_owned()), name);
    Ok(None)
}

/// The looks of the keys, checked to be usable.
fn looks(library: &Library, args: &ViewArgs) -> Result<Vec<EditedLook>> {
    let mut names = args.style.clone();
    if names.is_empty() {
        names.push(PLAIN.into());
        let catalogue = library.catalogue().map_err(|e| e.at("the library", "install it again"))?;
        names.extend(catalogue.nodes.iter().filter(|n| n.group == "styles").map(|n| n.id.into()));
    }
    let looks: Vec<EditedLook> =
        names.iter().map(|name| EditedLook::open(library, name)).collect::<Result<_>>()?;
    let styles: Vec<Style> =
        looks.iter().filter_map(|look| look.style(library).transpose()).collect::<Result<_>>()?;
    styles.iter().try_for_each(|style| args.precision.precision.apply(style))?;
    for setting in &args.set {
        let mut refusals = styles.iter().map(|style| style.set(setting));
        if let Some(refusal) = refusals.next().filter(|_| !refusals.any(|r| r.is_ok())) {
            refusal?;
        }
    }
    Ok(looks)
}
