//! `isophote apply` from video to video.

use std::path::Path;

use super::{ApplyArgs, Files};
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_files::limits;
use isophote_files::replacing::Made;
use isophote_files::stop::Stop;
use isophote_finishing::apply::filter::Filter;
use isophote_finishing::apply::masks::MaskChoice;
use isophote_finishing::video;
use isophote_loader::Library;
use isophote_pictures::exr::MaskSource;

impl ApplyArgs {
    /// Filters a video.
    pub(super) fn run_on_video(&self, files: &Files<'_>) -> Result<()> {
        let wrong = |place: &str, problem: &str, fix: &str| Err(Error::input(place, problem, fix));
        if !video::is_video(files.input) || !video::becomes_video(&files.output) {
            return Err(unlike(files));
        }
        let others = [
            ("--frames", self.frames.is_some()),
            ("--dry-run", self.dry_run),
            ("--motion", self.motion.is_some() && !self.estimates_motion()),
            ("--into", self.into.is_some()),
            ("--output-space", self.output_space.is_some()),
        ];
        if let Some((option, _)) = others.iter().find(|(_, given)| *given) {
            return wrong(option, "is not for videos", "leave it out");
        }
        let choices = self.masks(&self.entries()?);
        let made = Made { from: Some(files.input), to: &files.output };
        if &*files.output != Path::new("-") {
            self.consent().check(&[made], false, || self.inputs(&choices, None))?;
        }
        if self.skip_existing && files.output.is_file() {
            return Ok(());
        }
        if &*files.output != Path::new("-") {
            self.make_folder()?;
            files::check_writable(&files.output, Existing::Replace)?;
            files::sweep(&files.output);
        }
        let library = Library::open()?;
        limits::start_threads(self.threads as usize)?;
        let looks = self.looks(&library, files.style, &self.entries()?)?;
        let is_file = |mask: &MaskChoice| matches!(mask.source, MaskSource::File(_));
        if !(self.mask_from.is_some() || choices.iter().all(is_file)) {
            return wrong(
                "--mask",
                "a video has no layers",
                "name files of masks, or EXR files by --mask-from",
            );
        }
        let masks = self.maps(&choices, &looks)?;
        masks.check(None)?;
        let mut filter = Filter::new(library, looks, self.backend, self.space, self.threads)?;
        let stop = Stop::on_signals();
        let (input, output, encode) = (files.input, &*files.output, self.encode.as_deref());
        let run = |existing| {
            let (on_error, json, quiet) = (self.on_error, self.json, self.quiet.quiet);
            let (masks, stop) = (&masks, &stop);
            let job = video::VideoJob { input, output, existing, encode, on_error, json, quiet, masks, stop };
            video::run(&job, &mut filter)
        };
        self.consent().write(made, Path::is_file, run).map(drop)
    }
}

/// The error of a video that is to become a picture, or of pictures that are to become a video.
fn unlike(files: &Files<'_>) -> Error {
    let (input, output) = (files.input.display(), files.output.display());
    let problem = "a video becomes a video, and pictures become pictures";
    let fix = if video::is_video(files.input) {
        format!(
            "name a video such as out.mp4, or out.apng or out.webp, which are animated; or take its frames out \
             first: `ffmpeg -i {input} frame.%04d.png`, and name frame.####.png and out.####.png"
        )
    } else {
        format!(
            "name pictures, such as out.png or out.####.png, and make a video of those: \
             `ffmpeg -i out.%04d.png {output}`"
        )
    };
    Error::input(&output, problem, fix)
}
