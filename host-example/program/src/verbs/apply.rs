//! `isophote apply`: a node, graph or preset on a picture or a sequence of frames, without any scene.

mod film;
mod guiding;
mod on_video;
mod several;
mod styled;

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use super::painted::PaintedArgs;
use super::shared::{ForceArgs, LengthArgs, PaletteArgs, PrecisionArgs, QuietArgs, parse_rate};
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_files::frames::FrameList;
use isophote_files::identity::is_same;
use isophote_files::limits::{self, Threads};
use isophote_files::output;
use isophote_files::stop::Stop;
use isophote_finishing::apply::backend::Backend;
use isophote_finishing::apply::dry_run::DryRun;
use isophote_finishing::apply::filter::{Filter, MaskedStyle};
use isophote_finishing::apply::masks::MaskChoice;
use isophote_finishing::apply::memory::{self, Budget, Bytes, Needs, too_large};
use isophote_finishing::apply::planner::Planner;
use isophote_finishing::apply::reader::{FrameSource, Reader};
use isophote_finishing::apply::report::{self, Outcome, Report};
use isophote_finishing::apply::sequence::Run;
use isophote_finishing::apply::tasks::{OnMissing, Task, Tasks};
use isophote_finishing::stylize::style::Setting;
use isophote_finishing::video::{self, OnError};
use isophote_finishing::writing::ResultArgs;
use isophote_loader::Library;
use isophote_pictures::exr::{Convention, GuideChoice, MaskSource, OnUnknown, Selection};
use isophote_pictures::read::{self, Opened};
use isophote_pictures::space::{self, Space};
use isophote_pictures::write::Format;

/// Options of `apply`.
#[derive(Args, Debug)]
pub struct ApplyArgs {
    /// The style: a name that `isophote nodes` lists, such as cartoon; a look that `isophote preset list` lists, such as
    /// look:copperplate; or a preset or graph file (.json). Left out where --preset or --layered is given.
    #[arg(value_hint = ValueHint::FilePath)]
    pub style: PathBuf,
    /// The picture: PNG, JPEG, TIFF, WebP, HDR or EXR. A sequence: shot.####.exr, shot.@@@@.exr, shot.%04d.exr, shot.$F4.exr or
    /// shot.<UDIM>.exr; one # alone for any number of digits. A file of exactly this name comes first. A video
    /// that ffmpeg reads, such as .mp4, .mov, .mkv, .webm or .gif, or an animated .png or .webp; or - for YUV4MPEG on
    /// standard input. A folder of pictures where the results go to a folder.
    #[allow(rustdoc::invalid_html_tags, reason = "read in a terminal")]
    #[arg(required_unless_present_any = ["preset", "layered", "to"], value_hint = ValueHint::AnyPath)]
    pub input: Option<PathBuf>,
    /// The result: .png, .jpg, .tif, .exr, or .svg for curves around areas of one colour, for a sequence with #### as well;
    /// for a video another one, - for YUV4MPEG on standard output, or pictures of its frames, such as out.####.png, numbered from 1. A sequence becomes a video where one
    /// is named, such as out.mp4. A folder, such as out/, gets files of the same names. [default: a file beside the picture with the style
    /// in its name, such as photo.cartoon.png; with --in-place the picture itself]
    #[arg(value_hint = ValueHint::AnyPath)]
    pub output: Option<PathBuf>,
    /// More pictures, where the results go to a folder: the last, or that of --to.
    #[arg(value_hint = ValueHint::FilePath)]
    pub more: Vec<PathBuf>,
    /// A folder for the results instead of a result: every picture that is named, and those of every folder, get a file of
    /// the same name in it (.png for .webp, .exr for .hdr). It is made where it is not there. A picture that fails does not
    /// keep the others from being done.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub to: Option<PathBuf>,
    /// A preset with the style and its parameters, or a look.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub preset: Option<PathBuf>,
    /// A JSON file with a list of looks instead of a style, each made from the picture and laid over those before where its mask
    /// is: [{"style": "watercolor"}, {"preset": "hero.json", "params": {"sigma": 2}, "mask": "cryptomatte:hero", "invert": false}].
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with_all = ["preset", "set", "mask"])]
    pub layered: Option<PathBuf>,
    /// Frames of the sequence, such as 1001-1100x2,1200 [default: all that are on disk]; of a video that becomes pictures, whose
    /// first is 1, all.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub frames: Option<FrameList>,
    /// Treatment of frames that are missing in the sequence.
    #[arg(long, value_enum, default_value_t = OnMissing::Fail)]
    pub on_missing: OnMissing,
    /// Limit of memory, such as 8GiB, which decides how many frames are worked on at once. On the CPU a larger picture is filtered
    /// by rows, which takes longer; one that needs more even so is refused [default: half of what is free in the machine or the
    /// container; 4GiB where that is unknown].
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<Bytes>,
    /// Skips results that are already complete, so that an interrupted run goes on.
    #[arg(long, conflicts_with_all = ["force", "in_place"])]
    pub skip_existing: bool,
    /// Overwrites the pictures with their results.
    #[arg(long)]
    pub in_place: bool,
    /// Treatment of results that are there.
    #[command(flatten)]
    pub force: ForceArgs,
    /// Prints what would be done, and does nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Prints a line of JSON for every frame, and for a single picture one for every percent that is done.
    #[arg(long)]
    pub json: bool,
    /// Silence on what goes well.
    #[command(flatten)]
    pub quiet: QuietArgs,
    /// Sets a parameter; node.id=value for one node of a graph. May be repeated.
    #[arg(long, value_name = "ID=VALUE")]
    pub set: Vec<Setting>,
    /// Colours that the style draws with.
    #[command(flatten)]
    pub palette: PaletteArgs,
    /// Meaning of lengths of parameters.
    #[command(flatten)]
    pub lengths: LengthArgs,
    /// Precision on graphics devices.
    #[command(flatten)]
    pub precision: PrecisionArgs,
    /// Part of the computer that does the work.
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    pub backend: Backend,
    /// Colour space of the picture [default: what the file says by its ICC profile, chunks of PNG, chromaticities or
    /// colorInteropID; else sRGB for integers, linear Rec.709 for floats].
    #[arg(long, value_parser = space::parser())]
    pub space: Option<Space>,
    /// Colour space of the result [default: the picture's where files of one kind are made of each other, sRGB for pictures
    /// that are made of light, linear Rec.709 for EXR files of others].
    #[arg(long, value_parser = space::parser())]
    pub output_space: Option<Space>,
    /// The layer of an EXR file that is read and replaced [default: the main layer].
    #[arg(long, value_name = "LAYER")]
    pub layer: Option<String>,
    /// Reads and replaces the layer even where its name says that it holds data, such as N, Z, P or a Cryptomatte.
    #[arg(long, requires = "layer")]
    pub force_layer: bool,
    /// The view of a multi-view EXR file [default: all views, each filtered by itself].
    #[arg(long, value_name = "VIEW")]
    pub view: Option<String>,
    /// The channel of an EXR file that is the layer's alpha, or none [default: the layer's A].
    #[arg(long, value_name = "CHANNEL")]
    pub alpha: Option<String>,
    /// Adds the result to the EXR file as a new layer of this name, and keeps the layer that was read.
    #[arg(long, value_name = "NEWLAYER")]
    pub into: Option<String>,
    /// The layer of an EXR file that guides the filter: normal=LAYER, depth=LAYER, object_id=LAYER, motion=LAYER,
    /// motion_forward=LAYER, rest_position=LAYER, albedo=LAYER, diffuse=LAYER, specular=LAYER, flow=LAYER or control=LAYER, or none instead of
    /// a layer; normal=A,B,C names its channels. Without it guides are found by the names that renderers give them, such as N, Z,
    /// depth, P, id, IndexOB, Vector, velocity, Pref, albedo, DiffCol, diffuse, specular, flow_map and control; where there is no id, the Cryptomatte of objects stands for it, which is
    /// object_id=cryptomatte, or `object_id=cryptomatte[LAYER]` for another. May be repeated.
    #[arg(long, value_name = "GUIDE=LAYER")]
    pub guide: Vec<GuideChoice>,
    /// The mask of the result, which is used where it is white: a file such as mask.png, one for each frame (mask.####.exr), a layer
    /// or channel of the EXR file, or things of its Cryptomatte: `cryptomatte:hero,props/*` or
    /// `material:skin`, or `id:3` for numbers of its object ids. A star in a name stands for any letters, ? for one, and a backslash makes
    /// either ordinary. Files of colours count by luminance; alpha never counts.
    #[arg(long, value_name = "MASK", value_hint = ValueHint::FilePath)]
    pub mask: Option<MaskSource>,
    /// EXR files that have the mask's layer or Cryptomatte, such as ids.####.exr [default: the input].
    #[arg(long, value_name = "FILES", value_hint = ValueHint::FilePath)]
    pub mask_from: Option<PathBuf>,
    /// Inverts the mask: the result is used where it is black.
    #[arg(long, requires = "mask")]
    pub invert: bool,
    /// Names in the mask that a frame does not have: fail, or take them for empty.
    #[arg(long, value_enum, default_value_t = OnUnknown::Fail)]
    pub on_unknown: OnUnknown,
    #[command(flatten)]
    pub painted: PaintedArgs,
    /// Steadiness of a sequence against flicker, from 0 to 1: neighbouring frames are averaged along the motion. Needs motion vectors in the EXR files, or --motion [default: what the style says].
    #[arg(long, value_name = "S")]
    pub steadiness: Option<f32>,
    /// EXR files with motion vectors, one for each frame: mv.####.exr; or estimate, for optical flow of the pictures.
    #[arg(long, value_name = "FILES", value_hint = ValueHint::FilePath)]
    pub motion: Option<PathBuf>,
    /// Meaning of motion vectors: isophote, arnold, blender, renderman, vray or unreal, and after commas what
    /// differs, of units=pixels|normalised|ndc, y=up|down, direction=backward|forward, sign=1|-1, centre=NUMBER and
    /// scale=NUMBER [default: what the name of their layer says].
    #[arg(long, value_name = "NAME")]
    pub motion_convention: Option<Convention>,
    /// Files that are written.
    #[command(flatten)]
    pub result: ResultArgs,
    /// Options of ffmpeg's encoder for a video, such as "-c:v libx265 -crf 20" [default: what loses little in its container, and
    /// keeps alpha and exact red, green and blue where that can].
    #[arg(long, value_name = "OPTIONS", allow_hyphen_values = true)]
    pub encode: Option<String>,
    /// Frames per second of a video that is made of pictures [default: 24].
    #[arg(long, value_name = "N", value_parser = parse_rate)]
    pub fps: Option<f64>,
    /// Treatment of a video that is damaged or cut short.
    #[arg(long, value_enum, default_value_t = OnError::Fail)]
    pub on_error: OnError,
    /// Threads on the CPU; 0 for one per core.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1024))]
    pub threads: u32,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for bad input, before anything is computed where it can be known then; [`Error::Failure`]
/// when the library or the device fails. Each output is written as a whole or not at all.
pub fn run(args: &ApplyArgs) -> Result<()> {
    let files = args.files()?;
    if video::is_video(files.input) {
        return args.run_on_video(&files);
    }
    let is_film = args.makes_film(&files)?;
    let tasks = args.tasks()?;
    if is_film && args.skip_existing && files.output.is_file() {
        return Ok(());
    }
    let format = if is_film { Format::Png } else { Format::of(&tasks.ready[0].output)? };
    format.check_space(args.output_space)?;
    tasks.ready.iter().try_for_each(|task| args.result.check(&task.input, &task.output))?;
    let library = Library::open()?;
    let threads = limits::start_threads(args.threads as usize)?;
    let written = args.written(&library, args.entries()?)?;
    let looks = args.looks(&library, files.style, &written)?;
    tasks.warn_of_keys_beyond(&looks);
    let choices = [args.masks(&written.entries), args.things(&looks)?].concat();
    let masks = args.maps(&choices, &looks)?;
    masks.check(Some(&tasks))?;
    let selection = args.selection(&library, &looks, &choices, format)?;
    let motion = args.motion_files(&tasks, &selection)?;
    let opened = args.open_first(&tasks, &selection)?;
    let own = args.looks(&library, files.style, &written)?;
    let planner = Planner::new(library.clone(), own)?.with_painted(args.painted.guides_of(&looks));
    args.check_results(&tasks, &planner, &choices)?;
    let guides = args.guides_found(&tasks, &selection, opened.as_ref(), &planner)?;
    let filter = args.filter(&library, looks)?;
    let most = args.memory.unwrap_or_else(memory::usual);
    let keeps_samples = args.keeps_samples(format, is_film);
    let mut planner = planner.within(most.0).on_card(filter.is_on_card()).keeping_samples(keeps_samples);
    let needs = args.needs(&mut planner, &tasks, opened.as_ref(), most)?;
    if args.dry_run {
        args.print_plan((&tasks, &selection, most), &mut planner, needs)?;
        return output::print(&guides);
    }
    let stop = Stop::on_signals();
    if !tasks.are_several() {
        stop.ends_the_process("the picture");
    }
    let report = args.report(&tasks).of_result(&files.output, args.size(opened.as_ref()));
    let is_parallel = tasks.are_several() && !is_film && threads == Threads::Several;
    let mut filters = filters(filter, is_parallel, || args.looks(&library, files.style, &written))?;
    let budget = Budget::new(most.0, filters.len());
    let (frames, motion) = (tasks.sequence.as_ref(), motion.as_ref());
    let (selection, masks, budget) = (&selection, &masks, &budget);
    let frame_source = FrameSource { frames, motion, selection, masks, budget };
    let (options, consent) = (args.result.options(), args.consent());
    let run = Run { tasks: &tasks.ready, consent, options, threads, report: &report, stop: &stop };
    let reader = Reader::new(frame_source, planner, &tasks.ready, opened);
    let result = match is_film {
        true => args.film(&mut filters[0], reader, &tasks.ready, (&report, &stop)),
        false => run.all(&mut filters, reader),
    };
    let counts = report.end(result.is_ok());
    result?;
    counts.check(files.input, &tasks, args.consent())?;
    output::print(&guides)
}

/// The filter alone, or as many like it as are best side by side.
fn filters(
    filter: Filter,
    is_parallel: bool,
    looks: impl Fn() -> Result<Vec<MaskedStyle>>,
) -> Result<Vec<Filter>> {
    let mut filters = vec![filter];
    while is_parallel && filters.len() < filters[0].best_count()? {
        filters.push(filters[0].beside(looks()?)?);
    }
    Ok(filters)
}

/// The files that the command line names.
pub struct Files<'a> {
    /// Style: a file or the name of a node or look.
    pub style: &'a Path,
    /// Path that is read.
    pub input: &'a Path,
    /// Path that is written.
    pub output: Cow<'a, Path>,
}

impl ApplyArgs {
    /// The filter of pictures.
    fn filter(&self, library: &Library, looks: Vec<MaskedStyle>) -> Result<Filter> {
        let backend = if self.dry_run { Backend::Cpu } else { self.backend };
        let filter = Filter::new(library.clone(), looks, backend, self.space, self.threads)?;
        Ok(filter.into_space(self.output_space).precisely(self.result.is_precise()))
    }

    /// True where nothing asks for other samples in results than pictures have.
    fn keeps_samples(&self, format: Format, is_film: bool) -> bool {
        let is_changed = self.space.is_some() || self.output_space.is_some() || self.result.is_precise();
        !is_changed && !is_film && format != Format::Exr
    }

    /// Size of the result of a picture, where that is known.
    fn size(&self, opened: Option<&Opened>) -> Option<(u32, u32)> {
        let size = opened.and_then(Opened::size)?;
        Some(self.result.resize.and_then(|resize| resize.of(size).ok()).unwrap_or(size))
    }

    /// Report of a run, with the frames that are missing.
    fn report(&self, tasks: &Tasks) -> Report {
        let is_listed = tasks.are_several() && !tasks.is_sequence();
        let report = if is_listed {
            Report::listing(tasks.count(), self.json)
        } else {
            Report::new(tasks.count(), tasks.is_sequence(), self.json)
        };
        let report = report.quietly(self.quiet.quiet);
        for task in &tasks.missing {
            report.frame(task, &Outcome::Missing);
        }
        report
    }

    /// Prints what would be done within so much memory.
    ///
    /// # Errors
    /// As [`DryRun::print`]; the error of a run of which something would fail.
    fn print_plan(
        &self,
        (tasks, selection, most): (&Tasks, &Selection, Bytes),
        planner: &mut Planner,
        needs: Option<Needs>,
    ) -> Result<()> {
        let (skip_existing, json) = (self.skip_existing, self.json);
        let run = DryRun { tasks, selection, most, skip_existing, json };
        let refused = run.print(planner, needs)?;
        report::check_failed(self.files()?.input, refused, tasks, self.consent())
    }

    /// Memory that the first picture needs, where that can be known: no more than there is.
    fn needs(
        &self,
        planner: &mut Planner,
        tasks: &Tasks,
        opened: Option<&Opened>,
        most: Bytes,
    ) -> Result<Option<Needs>> {
        let first = &tasks.ready[0];
        let needs = match opened {
            Some(opened) => planner.needs(&first.input, first.frame, opened)?,
            None => None,
        };
        if tasks.are_several() && !tasks.is_sequence() {
            // Each of them is measured by itself when its turn comes.
            return Ok(needs);
        }
        let span = planner.span(first.frame)?;
        if let Some(needs) = needs.map(|needs| needs.of(span)).filter(|needs| needs.total() > most.0) {
            return Err(too_large(&first.input, span, needs, most));
        }
        let is_in_place = |task: &Task| is_same(&task.input, &task.output);
        if span > 1 && self.in_place && self.into.is_none() && tasks.ready.iter().any(is_in_place) {
            return Err(Error::file(
                &self.files()?.output,
                "would take the place of frames that others depend on",
                "name another folder for the results, or leave --steadiness out",
            ));
        }
        Ok(needs)
    }

    /// The frames that are read and written.
    ///
    /// # Errors
    /// As [`Tasks::find`]; [`Error::Input`] for an output that is a folder.
    fn tasks(&self) -> Result<Tasks> {
        let tasks = match self.pictures()? {
            Some(pictures) => Tasks::of_pictures(pictures),
            None => {
                let files = self.files()?;
                if video::becomes_video(&files.output) {
                    self.film_tasks(&files)?
                } else {
                    Tasks::find(files.input, &files.output, self.frames.as_ref(), self.on_missing)?
                }
            }
        };
        match tasks.ready.iter().find(|task| task.output.is_dir()) {
            Some(task) => Err(Error::file(&task.output, "is a folder", "name a file, or the folder by --to")),
            None => Ok(tasks),
        }
    }

    /// Numbers of the frames, for jobs that split them.
    ///
    /// # Errors
    /// As [`Tasks::find`]; [`Error::Input`] when the input is no sequence.
    pub fn frame_numbers(&self) -> Result<Vec<i64>> {
        let tasks = self.tasks()?;
        let files = self.files()?;
        if !tasks.is_sequence() {
            return Err(Error::file(files.input, "is no sequence", "write shot.####.exr"));
        }
        if video::becomes_video(&files.output) {
            let fix = "name pictures such as out.####.exr";
            return Err(Error::file(&files.output, "is one video, which no jobs can share", fix));
        }
        Ok(tasks.ready.iter().filter_map(|task| task.frame).collect())
    }

    /// Opens the first input and makes sure that the first output can be written.
    fn open_first(&self, tasks: &Tasks, selection: &Selection) -> Result<Option<Opened>> {
        let first = &tasks.ready[0];
        let opened = match read::open(&first.input, selection) {
            // A picture that cannot be read is reported before a folder that cannot be written.
            Err(error) if !tasks.are_several() && !self.skip_existing => return Err(error),
            opened => opened.ok(),
        };
        if self.dry_run && self.named()?.folder.is_some_and(|folder| !folder.exists()) {
            return Ok(opened);
        }
        if self.dry_run {
            files::check(&first.output, Existing::Replace)?;
        } else {
            self.make_folder()?;
            files::check_writable(&first.output, Existing::Replace)?;
            files::sweep(&first.output);
        }
        Ok(opened)
    }

    /// Selection of what is read of EXR files.
    fn selection(
        &self,
        library: &Library,
        looks: &[MaskedStyle],
        masks: &[MaskChoice],
        format: Format,
    ) -> Result<Selection> {
        if self.into.is_some() && format != Format::Exr {
            return Err(Error::input(
                "--into",
                "only EXR files hold several layers",
                "name a result that ends in .exr",
            ));
        }
        let is_bad = |name: &&str| {
            name.is_empty() || name.split('.').any(str::is_empty) || name.contains(char::is_control)
        };
        if let Some(bad) = self.into.as_deref().filter(is_bad) {
            return Err(Error::input(
                "--into",
                format!("'{}' is no name of a layer", bad.escape_default()),
                "name a layer such as cartoon",
            ));
        }
        Ok(Selection {
            layer: self.layer.clone(),
            force: self.force_layer,
            view: self.view.clone(),
            alpha: self.alpha.clone(),
            into: self.into.clone(),
            guides: self.guide.clone(),
            wanted: self.wanted(library, looks)?,
            convention: self.motion_convention,
            // What lies in other files is not looked for in the picture's.
            masks: masks
                .iter()
                .map(|mask| self.mask_from.clone().map_or(mask.source.clone(), MaskSource::File))
                .collect(),
            rules: looks.iter().map(|look| look.style.objects.len()).sum(),
            on_unknown: self.on_unknown,
        })
    }
}
