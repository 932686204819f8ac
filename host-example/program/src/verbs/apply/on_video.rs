//! `isophote apply` from a video to a video, or to pictures of its frames.

use std::path::{Path, PathBuf};

use super::{ApplyArgs, Files};
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_files::frames::Pattern;
use isophote_files::limits;
use isophote_files::replacing::Made;
use isophote_files::stop::Stop;
use isophote_finishing::apply::filter::Filter;
use isophote_finishing::apply::masks::MaskChoice;
use isophote_finishing::video::{self, Numbered};
use isophote_loader::Library;
use isophote_pictures::exr::MaskSource;
use isophote_pictures::write::Format;

impl ApplyArgs {
    /// The pictures that the frames of a video become.
    fn numbered<'a>(&'a self, pattern: &'a Pattern, files: &Files<'_>) -> Result<Numbered<'a>> {
        let format = Format::of(&files.output)?;
        format.check_space(self.output_space)?;
        let least = self.frames.iter().flat_map(|list| list.frames()).min();
        if least.is_some_and(|least| *least < 1) {
            return Err(Error::input("--frames", "the first frame of a video is 1", "name frames from 1"));
        }
        let (options, frames) = (self.result.options(), self.frames.as_ref());
        Ok(Numbered { pattern, format, options, frames, consent: self.consent() })
    }

    /// Refuses options that are of no use for a video, or for pictures of one.
    fn check_options(&self, is_video: bool) -> Result<()> {
        let wrong = |place: &str, problem: &str| Err(Error::input(place, problem, "leave it out"));
        let others = [
            ("--frames", self.frames.is_some() && is_video),
            ("--fps", self.fps.is_some()),
            ("--dry-run", self.dry_run),
            ("--motion", self.motion.is_some() && !self.estimates_motion()),
            ("--into", self.into.is_some()),
            ("--output-space", self.output_space.is_some() && is_video),
        ];
        match others.iter().find(|(_, given)| *given) {
            Some((option, _)) => wrong(option, "is not for videos"),
            None if self.encode.is_some() && !is_video => wrong("--encode", "is for results that are videos"),
            None => Ok(()),
        }
    }

    /// Makes sure that the results may be written and can be, and says whether there is nothing left to be done.
    fn is_done(
        &self,
        files: &Files<'_>,
        pictures: Option<&Numbered<'_>>,
        choices: &[MaskChoice],
    ) -> Result<bool> {
        let output = &*files.output;
        if output == Path::new("-") {
            return Ok(false);
        }
        let there = pictures.map_or_else(|| vec![output.to_path_buf()], there);
        let results: Vec<_> = there.iter().map(|to| Made { from: Some(files.input), to }).collect();
        self.consent().check(&results, pictures.is_some(), || self.inputs(choices, None))?;
        if self.skip_existing && pictures.is_none() && output.is_file() {
            return Ok(true);
        }
        let first = pictures.map_or_else(|| output.to_path_buf(), |all| all.pattern.file(1));
        self.make_folder()?;
        files::check_writable(&first, Existing::Replace)?;
        files::sweep(&first);
        Ok(false)
    }

    /// Filters a video.
    pub(super) fn run_on_video(&self, files: &Files<'_>) -> Result<()> {
        let pattern = match video::becomes_video(&files.output) {
            true => None,
            false => Some(Pattern::in_name(&files.output)?.ok_or_else(|| unlike(files))?),
        };
        let pictures = pattern.as_ref().map(|pattern| self.numbered(pattern, files)).transpose()?;
        let is_video = pictures.is_none();
        self.check_options(is_video)?;
        self.result.check(files.input, &files.output)?;
        let entries = self.entries()?;
        let mut choices = self.masks(&entries);
        if self.is_done(files, pictures.as_ref(), &choices)? {
            return Ok(());
        }
        let library = Library::open()?;
        limits::start_threads(self.threads as usize)?;
        let looks = self.looks(&library, files.style, &self.written(&library, entries)?)?;
        choices.extend(self.things(&looks)?);
        let is_file = |mask: &MaskChoice| matches!(mask.source, MaskSource::File(_));
        if !(self.mask_from.is_some() || choices.iter().all(is_file)) {
            let fix = "name files of masks, or EXR files by --mask-from";
            return Err(Error::input("the masks", "a video has no layers", fix));
        }
        let masks = self.maps(&choices, &looks)?;
        masks.check(None)?;
        let filter = Filter::new(library, looks, self.backend, self.space, self.threads)?;
        let mut filter = filter.into_space(self.output_space).precisely(self.result.is_precise());
        let stop = Stop::on_signals();
        let (input, output) = (files.input, &*files.output);
        let (encode, resize) = (self.result.file.encode(self.encode.as_deref()), self.result.resize);
        let mut run = |existing| {
            let (on_error, json, quiet) = (self.on_error, self.json, self.quiet.quiet);
            let (masks, stop) = (&masks, &stop);
            let job = video::VideoJob {
                input,
                output,
                pictures,
                existing,
                encode,
                resize,
                on_error,
                json,
                quiet,
                masks,
                stop,
            };
            video::run(&job, &mut filter)
        };
        if !is_video {
            // Each picture asks for itself.
            return run(Existing::Keep);
        }
        let made = Made { from: Some(input), to: output };
        self.consent().write(made, Path::is_file, run).map(drop)
    }
}

/// Results that are there already.
fn there(all: &Numbered<'_>) -> Vec<PathBuf> {
    let frames = all.pattern.on_disk().unwrap_or_default();
    let is_made = |frame: &i64| *frame >= 1 && all.frames.is_none_or(|list| list.frames().contains(frame));
    frames.into_iter().filter(is_made).map(|frame| all.pattern.file(frame)).collect()
}

/// The error of a video that is to become one picture, or of one picture that is to become a video.
pub(super) fn unlike(files: &Files<'_>) -> Error {
    let output = files.output.display();
    if !video::is_video(files.input) {
        let problem = "is a video, which is made of numbered pictures or of another video";
        let fix =
            "name a sequence such as shot.####.png to be read, or a picture such as out.png to be written";
        return Error::input(output, problem, fix);
    }
    let problem = "is one picture, and a video has many";
    let name = files.output.with_extension("");
    let name = name.file_name().unwrap_or_default().to_string_lossy();
    let extension = files.output.extension().unwrap_or_default().to_string_lossy();
    let fix = format!(
        "name {name}.####.{extension} for one picture of each frame, or a video such as out.mp4; out.apng and out.webp \
         are animated"
    );
    Error::input(output, problem, fix)
}
