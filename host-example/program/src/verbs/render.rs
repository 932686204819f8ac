//! `isophote render`: a scene to a sequence of pictures.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::material_args::MaterialArgs;
use super::shared::{
    ForceArgs, LengthArgs, PaletteArgs, PrecisionArgs, QuietArgs, SceneArgs, is_folder, of_any, parse_size,
};
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_files::frames::{FrameList, Pattern};
use isophote_files::identity::Identity;
use isophote_files::limits;
use isophote_files::replacing::{Consent, Inputs, Made};
use isophote_files::stop::Stop;
use isophote_finishing::apply::backend::Backend;
use isophote_finishing::apply::report::{Outcome, Report};
use isophote_finishing::apply::tasks::Task;
use isophote_finishing::directed::Directed;
use isophote_finishing::shot::{Look, Options, Shot};
use isophote_finishing::staging::{MotionArgs, StagingArgs};
use isophote_finishing::stylize::style::{Setting, Style};
use isophote_finishing::stylize::things;
use isophote_finishing::video::{self, Film};
use isophote_finishing::writing::{Depth, FileArgs};
use isophote_loader::Library;
use isophote_pictures::exr::OnUnknown;
use isophote_pictures::floats::{self, Header, Layer, Picture, Precision};
use isophote_pictures::read;
use isophote_render::targets::{Target, Targets};
use isophote_scene::Scene;

/// Options of `render`.
#[derive(Args, Clone, Debug)]
pub struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    staging: StagingArgs,
    /// The picture: .png; or .exr with the scene-linear colour and its light, normals, depth, object numbers, motion and rest
    /// positions. out.####.exr, out.@@@@.exr or out.%04d.exr for a sequence; .#### is added where it lacks. A video that
    /// ffmpeg writes, such as .mp4, .mov, .mkv or .webm, on black where the background is transparent. A folder, such as
    /// out/, gets a .png file with the scene's name.
    out: PathBuf,
    /// The folder of the picture, which is made where it is not there.
    #[arg(skip)]
    folder: Option<PathBuf>,
    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    size: (u32, u32),
    /// Number of frames, from 1; or a list of them, such as 1001-1100x2,1200. Of an animation, frame 1 is at --start:
    /// with 24 frames per second, 49-72 is its third second.
    #[arg(long, value_name = "N|LIST", default_value = "1", value_parser = FrameList::or_count, allow_hyphen_values = true)]
    frames: FrameList,
    /// Skips pictures, or the video, that are already complete.
    #[arg(long, conflicts_with = "force")]
    skip_existing: bool,
    #[command(flatten)]
    force: ForceArgs,
    /// Prints a line of JSON for every frame, as apply does.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    quiet: QuietArgs,
    #[command(flatten)]
    file: FileArgs,
    /// Options of ffmpeg's encoder for a video, such as "-c:v libx265 -crf 20".
    #[arg(long, value_name = "OPTIONS", allow_hyphen_values = true)]
    encode: Option<String>,
    /// Turns the camera once around the scene over all frames.
    #[arg(long, conflicts_with = "camera")]
    turntable: bool,
    #[command(flatten)]
    motion: MotionArgs,
    /// Frames per second of the animation, and of a video.
    #[arg(long, value_name = "N", default_value_t = 24.0)]
    fps: f32,
    /// Gives EXR files the exposure and tone mapping that the window shows, too.
    #[arg(long)]
    tone_mapped: bool,
    /// Leaves the colours of surfaces and their light out of EXR files, which then take about two thirds of the time where the
    /// graphics driver computes on the CPU.
    #[arg(long)]
    no_light: bool,
    /// Writes Cryptomattes of objects and materials into EXR files, of 16 samples a pixel: which things cover how much of it, by
    /// their names, for masks and for rules of presets.
    #[arg(long)]
    cryptomatte: bool,
    /// Style of the frames: none, a style, a look, or a preset or graph file (.json).
    #[arg(long, default_value = "none")]
    style: PathBuf,
    /// What to do with names in rules of a preset that nothing in the scene has.
    #[arg(long, value_enum, default_value_t)]
    on_unknown: OnUnknown,
    /// Sets a parameter of the style; node.id=value for one node of a graph. May be repeated.
    #[arg(long, value_name = "ID=VALUE")]
    set: Vec<Setting>,
    #[command(flatten)]
    palette: PaletteArgs,
    #[command(flatten)]
    materials: MaterialArgs,
    #[command(flatten)]
    lengths: LengthArgs,
    /// Processor that the style is computed on; the scene itself is drawn by the graphics driver.
    #[arg(long, value_enum, default_value_t)]
    backend: Backend,
    #[command(flatten)]
    precision: PrecisionArgs,
    /// Steadiness against flicker, from 0 to 1: frames are averaged with those before, along the scene's motion [default: what the style says].
    #[arg(long, value_name = "S")]
    steadiness: Option<f32>,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for bad input before anything is rendered, [`Error::Failure`] when the device fails.
pub fn run(args: &RenderArgs) -> Result<()> {
    if is_folder(&args.out) {
        return run(&args.within());
    }
    args.check()?;
    let library = args.is_stylized().then(Library::open).transpose()?;
    limits::start_threads(0)?;
    let style = match &library {
        Some(library) => Some((library, args.styles(library)?)),
        None => None,
    };
    let scene = args.scene.load()?;
    args.check_scene(&scene)?;
    let all = style
        .iter()
        .flat_map(|(_, (style, own))| std::iter::once(style).chain(own.iter().map(|(_, own)| own)));
    let materials = args.materials.open(&all.collect::<Vec<_>>())?;
    let options = Options { materials, ..args.options(&scene)? };
    let look = match style {
        Some((library, (style, own))) => {
            let place = (&scene, args.scene.scene.as_path());
            let directed = Directed::new(library, &style, own, place, args.on_unknown)?;
            Some(Look { library, style, directed })
        }
        None => None,
    };
    let mut shot = Shot::new(scene, look, options)?;
    files::sweep(&args.out);
    let stop = Stop::on_signals();
    let frames = args.frames.frames();
    if frames.len() == 1 {
        stop.ends_the_process("the picture");
    }
    let report = Report::new(frames.len(), frames.len() > 1, args.json);
    let report = report.quietly(args.quiet.quiet).of_result(&args.out, Some(args.size));
    let result = match video::becomes_video(&args.out) {
        true => args.film(&mut shot, &stop, &report),
        false => args.pictures(&mut shot, &stop, &report),
    };
    report.end(result.is_ok());
    result
}

impl RenderArgs {
    /// The style, and looks that rules of its preset give to things.
    fn styles(&self, library: &Library) -> Result<(Style, Vec<(usize, Style)>)> {
        let palette = self.palette.read(library)?;
        let mut style = Style::load_in(library, &self.style, palette.as_ref(), &self.set)?;
        let mut own = things::looks(library, palette.as_ref(), &style)?;
        let mut styles: Vec<&mut Style> =
            std::iter::once(&mut style).chain(own.iter_mut().map(|(_, style)| style)).collect();
        for style in &mut styles {
            self.lengths.apply(style);
            self.precision.precision.apply(style)?;
            style.warn_of_keys_beyond(self.frames.frames());
        }
        let steady =
            |style: &mut Style| self.steadiness.map_or(Ok(()), |steadiness| style.steady(steadiness));
        of_any(styles, steady)?;
        Ok((style, own))
    }

    /// The same with a picture in the folder that was named as the result.
    fn within(&self) -> Self {
        let name = Path::new(self.scene.scene.file_name().unwrap_or_default()).with_extension("png");
        Self { out: self.out.join(name), folder: Some(self.out.clone()), ..self.clone() }
    }

    /// Renders every frame to a file of its own.
    fn pictures(&self, shot: &mut Shot, stop: &Stop, report: &Report) -> Result<()> {
        let results = self.results()?;
        let count = results.len();
        for (done, (number, file)) in results.into_iter().enumerate() {
            if stop.is_requested() {
                let problem = format!("stopped after {done} of {count} frames");
                return Err(Error::failure(problem, self.consent().resuming()));
            }
            let is_there = self.skip_existing && read::is_whole(&file);
            let is_written = !is_there && {
                let picture = shot.draw(number, &mut |done| report.progress(done))?;
                let made = Made { from: None, to: &file };
                self.consent().write(made, read::is_whole, |existing| match floats::is_exr(&file) {
                    true => self.save_layers(shot, (&file, existing), &picture),
                    false => {
                        floats::save_png(&file, existing, &picture, self.file.depth == Some(Depth::Sixteen))
                    }
                })?
            };
            let outcome = if is_written { Outcome::Written(0) } else { Outcome::Skipped };
            report.frame(&self.task(number, file), &outcome);
        }
        Ok(())
    }

    /// Writes a frame with everything that is known of it into one file.
    fn save_layers(
        &self,
        shot: &mut Shot,
        (file, existing): (&Path, Existing),
        color: &Picture,
    ) -> Result<()> {
        let (names, usual): (&[&str], _) = match color.channels {
            1 => (&["Y"], Precision::Float),
            _ => (&["R", "G", "B", "A"], Precision::Half),
        };
        let precision = match self.file.depth {
            Some(Depth::Half) => Precision::Half,
            Some(Depth::Float) => Precision::Float,
            _ => usual,
        };
        let known = Layers::read(shot, self.cryptomatte)?;
        let named: Vec<Vec<&str>> =
            known.pictures.iter().map(|(_, names, _)| names.iter().map(String::as_str).collect()).collect();
        let mut layers = vec![Layer { picture: color, names, precision }];
        layers.extend(known.pictures.iter().zip(&named).map(|((picture, _, precision), names)| Layer {
            picture,
            names,
            precision: *precision,
        }));
        floats::save_layers(file, existing, &layers, known.header)
    }

    /// Numbers and files of the results; of a video there is one file for all.
    fn results(&self) -> Result<Vec<(i64, PathBuf)>> {
        let frames = self.frames.frames();
        let pattern = match Pattern::in_name(&self.out)? {
            _ if video::becomes_video(&self.out) => None,
            None if frames.len() == 1 => None,
            _ => Some(Pattern::or_added(&self.out)?),
        };
        let file = |number| pattern.as_ref().map_or_else(|| self.out.clone(), |pattern| pattern.file(number));
        Ok(frames.iter().map(|number| (*number, file(*number))).collect())
    }

    fn consent(&self) -> Consent {
        Consent { skip_existing: self.skip_existing, ..self.force.consent() }
    }

    /// Refuses results that are there already, or that are files which the command line names.
    fn check_results(&self) -> Result<()> {
        let results = self.results()?;
        let is_sequence = results.len() > 1 && !video::becomes_video(&self.out);
        let made: Vec<Made<'_>> = results.iter().map(|(_, file)| Made { from: None, to: file }).collect();
        let read = || {
            let named = [Some(self.scene.scene.clone()), self.scene.reading.texture.clone()];
            let palette = self.palette.file().map(Path::to_owned);
            let more = [self.staging.surroundings(), Some(self.style.clone()), palette];
            let materials = self.materials.files().map(|(_, file)| file.to_owned());
            Ok(Inputs::of(named.into_iter().chain(more).flatten().chain(materials)))
        };
        self.consent().check(&made, is_sequence, read)
    }

    /// Refuses results that are files which the scene was read from.
    fn check_scene(&self, scene: &Scene) -> Result<()> {
        let is_read = |file: &PathBuf| Identity::of(file).is_some_and(|file| scene.files.contains(&file));
        match self.results()?.into_iter().map(|(_, file)| file).find(is_read) {
            Some(file) => Err(Error::file(&file, "is read with the scene", "name another file")),
            None => Ok(()),
        }
    }

    /// Renders all frames into a video.
    fn film(&self, shot: &mut Shot, stop: &Stop, report: &Report) -> Result<()> {
        let frames = self.frames.frames();
        if self.skip_existing && self.out.is_file() {
            frames.iter().for_each(|n| report.frame(&self.task(*n, self.out.clone()), &Outcome::Skipped));
            return Ok(());
        }
        let make = |place: &Path| {
            let mut film = None::<Film<'_>>;
            for (done, &number) in frames.iter().enumerate() {
                if stop.is_requested() {
                    let problem = format!("stopped after {done} of {} frames", frames.len());
                    return Err(Error::failure(problem, "start again"));
                }
                let picture = shot.draw(number, &mut |done| report.progress(done))?;
                let unequal = || Error::failure("a picture has no pixels", "use another --size");
                let frame = video::shown(&picture).ok_or_else(unequal)?;
                let film = match &mut film {
                    Some(film) => film,
                    None => {
                        let pace = (f64::from(self.fps), 1.0);
                        let encode = self.file.encode(self.encode.as_deref());
                        film.insert(Film::start(&frame, pace, (&self.out, place), encode)?)
                    }
                };
                if !film.put(&frame)? {
                    break;
                }
                report.frame(&self.task(number, self.out.clone()), &Outcome::Written(0));
            }
            Film::end(film, &self.out)
        };
        let made = Made { from: None, to: &self.out };
        let write = |existing| files::write_by_path(&self.out, existing, make);
        self.consent().write(made, Path::is_file, write).map(drop).inspect_err(|_| report.nothing_written())
    }

    fn task(&self, number: i64, output: PathBuf) -> Task {
        Task { frame: Some(number), input: self.scene.scene.clone(), output }
    }

    fn is_stylized(&self) -> bool {
        self.style != Path::new("none")
    }

    /// Refuses what can be refused without a library, a scene or a device.
    fn check(&self) -> Result<()> {
        let is_video = video::becomes_video(&self.out) && self.out != Path::new("-");
        if !is_video {
            floats::check_extension(&self.out)?;
        }
        self.file.check(&self.out)?;
        if self.cryptomatte && !floats::is_exr(&self.out) {
            return Err(Error::input(
                "--cryptomatte",
                "is written into EXR files",
                "leave it out, or name an .exr file",
            ));
        }
        if self.encode.is_some() && !is_video {
            return Err(Error::input(
                "--encode",
                "is for videos",
                "leave it out, or name a video such as out.mp4",
            ));
        }
        if let Some(folder) = self.folder.as_ref().filter(|folder| !folder.is_dir()) {
            fs::create_dir_all(folder).map_err(|e| files::unwritable(folder, Some(e.kind()), e))?;
        }
        files::check_writable(&self.out, Existing::Replace)?;
        self.check_results()?;
        let steadiness = self.steadiness.map(|s| format!("--steadiness {s}"));
        let palette = self.palette.palette.as_ref().map(|file| format!("--palette {}", file.display()));
        let setting = self.set.first().map(|setting| format!("--set {setting}"));
        let material = self.materials.named().first().map(|(kind, _)| format!("--{}", kind.guide().id()));
        let setting = setting.or(palette).or(material).or(steadiness);
        if let (true, Some(setting)) = (!self.is_stylized(), setting) {
            return Err(Error::input(
                setting,
                "the style none has no parameters",
                "choose a style with --style",
            ));
        }
        if !self.fps.is_finite() || self.fps <= 0.0 || !self.motion.start.is_finite() {
            return Err(Error::input(
                "--fps, --start",
                "must be finite, and frames per second above 0",
                "use 24 and 0",
            ));
        }
        Ok(())
    }

    fn options(&self, scene: &Scene) -> Result<Options> {
        let is_exr = floats::is_exr(&self.out);
        let frames = self.frames.frames();
        let first = frames.iter().min().copied().unwrap_or(1);
        let last = frames.iter().max().copied().unwrap_or(1);
        Ok(Options {
            size: self.size,
            range: (first, last.abs_diff(first) + 1),
            turntable: self.turntable,
            framing: self.staging.framing(),
            camera: self.staging.find_camera(scene)?,
            light: self.staging.light,
            exposure: self.staging.exposure,
            background: self.staging.read_background()?,
            ground: self.staging.has_ground(scene),
            animation: self.motion.choose(&self.scene.scene, scene)?,
            start: self.motion.start,
            fps: self.fps,
            scene_referred: is_exr && !self.tone_mapped,
            rest_positions: is_exr,
            control: is_exr,
            // They are light of the scene.
            layers: is_exr && !self.tone_mapped && !self.no_light,
            backend: self.backend,
            materials: Vec::new(),
        })
    }
}

/// Guide, which the renderer knows of a pixel beside its colour: target, names of channels, precision.
type Guide = (fn(&Targets) -> Option<&Target>, &'static [&'static str], Precision);

/// Channels of colours of surfaces and of their light.
const ALBEDO: [&str; 4] = ["albedo.R", "albedo.G", "albedo.B", "albedo.A"];
const DIFFUSE: [&str; 4] = ["diffuse.R", "diffuse.G", "diffuse.B", "diffuse.A"];
const SPECULAR: [&str; 4] = ["specular.R", "specular.G", "specular.B", "specular.A"];
/// Channels of a control map.
const CONTROL: [&str; 4] = ["control.R", "control.G", "control.B", "control.A"];

/// Named as compositors and `apply` know them.
const GUIDES: [Guide; 8] = [
    (|targets| Some(&targets.normal), &["N.X", "N.Y", "N.Z"], Precision::Half),
    (|targets| Some(&targets.depth), &["Z"], Precision::Float),
    (|targets| Some(&targets.object_id), &["id"], Precision::Float),
    (|targets| targets.rest.as_ref(), &["Pref.X", "Pref.Y", "Pref.Z"], Precision::Float),
    (|targets| targets.control.as_ref(), &CONTROL, Precision::Half),
    (|targets| Some(&targets.layers.as_ref()?.albedo), &ALBEDO, Precision::Half),
    (|targets| Some(&targets.layers.as_ref()?.diffuse), &DIFFUSE, Precision::Half),
    (|targets| Some(&targets.layers.as_ref()?.specular), &SPECULAR, Precision::Half),
];

/// Motion from the frame before and to the frame that follows.
const BACKWARD: &[&str] = &["backward.u", "backward.v"];
const FORWARD: &[&str] = &["forward.u", "forward.v"];

/// A frame's layers beside its colour.
#[derive(Default)]
struct Layers {
    pictures: Vec<(Picture, Vec<String>, Precision)>,
    header: Header,
}

impl Layers {
    fn add(&mut self, picture: Picture, names: &[&str], precision: Precision) {
        self.pictures.push((picture, names.iter().map(|name| (*name).to_owned()).collect(), precision));
    }

    /// Everything that is known of the frame drawn last.
    fn read(shot: &mut Shot, with_mattes: bool) -> Result<Self> {
        let mut layers = Self::default();
        for (target, names, precision) in GUIDES {
            if let Some(picture) = shot.read(target)? {
                layers.add(picture, names, precision);
            }
        }
        let motion = shot.read(|targets| Some(&targets.motion))?;
        let forward = shot.read_motion_forward()?;
        for (motion, names) in [(motion, BACKWARD), (forward, FORWARD)] {
            if let Some(mut picture) = motion {
                // Compositors count rows from below.
                picture.data.iter_mut().skip(1).step_by(2).for_each(|v| *v = 0.0 - *v);
                layers.add(picture, names, Precision::Float);
            }
        }
        // After all else, since they move the picture by parts of a pixel.
        let mattes = if with_mattes { shot.read_mattes()? } else { Vec::new() };
        for matte in mattes {
            for (index, picture) in matte.layers.into_iter().enumerate() {
                let names = ["R", "G", "B", "A"].map(|channel| format!("{}{index:02}.{channel}", matte.name));
                layers.pictures.push((picture, names.into(), Precision::Float));
            }
            layers.header.texts.extend(matte.texts);
        }
        // A matrix column by column is the same for row vectors row by row.
        layers.header.world_to_camera = shot.view().map(|view| view.world_to_view.to_cols_array());
        Ok(layers)
    }
}
