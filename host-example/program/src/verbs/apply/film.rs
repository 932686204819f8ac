//! `isophote apply` from a sequence of pictures to a video.

use std::path::Path;

use super::{ApplyArgs, Files};
use isophote_files::error::{Error, Result};
use isophote_files::files;
use isophote_files::frames::Pattern;
use isophote_files::replacing::Made;
use isophote_files::stop::Stop;
use isophote_finishing::apply::filter::{Filter, Filtered};
use isophote_finishing::apply::reader::Reader;
use isophote_finishing::apply::report::{Outcome, Report};
use isophote_finishing::apply::square;
use isophote_finishing::apply::tasks::{Task, Tasks};
use isophote_finishing::video::{self, Film, OnError};
use isophote_pictures::convert::Conversion;
use isophote_pictures::display;
use isophote_pictures::meaning::Meaning;
use isophote_pictures::pixels::Pixels;
use isophote_pictures::write::Format;

/// Frames per second where nobody says how many, as `render` has it.
const RATE: f64 = 24.0;

impl ApplyArgs {
    /// True where pictures become a video.
    ///
    /// # Errors
    /// [`Error::Input`] for one picture, and for options that are of no use.
    pub(super) fn makes_film(&self, files: &Files<'_>) -> Result<bool> {
        let wrong = |option: &str, problem: &str| Err(Error::input(option, problem, "leave it out"));
        if self.on_error == OnError::Skip {
            return wrong("--on-error", "is for videos that are read");
        }
        if !video::becomes_video(&files.output) {
            if self.fps.is_some() {
                return wrong("--fps", "is for videos that are made of pictures");
            }
            return Ok(false);
        }
        if &*files.output == Path::new("-") {
            let fix = "name a video such as out.mp4";
            return Err(Error::input("-", "is for videos that are made of videos", fix));
        }
        if Pattern::new(files.input)?.is_none() {
            return Err(super::on_video::unlike(files));
        }
        let others = [
            ("--dry-run", self.dry_run),
            ("--into", self.into.is_some()),
            ("--output-space", self.output_space.is_some()),
        ];
        match others.iter().find(|(_, given)| *given) {
            Some((option, _)) => wrong(option, "is not for videos"),
            None => Ok(true),
        }
    }

    /// Filters all frames of a sequence into one video, which gets its name when it is whole.
    ///
    /// # Errors
    /// The problem with any of the frames; as [`Film::start`] and [`Film::end`].
    pub(super) fn film(
        &self,
        filter: &mut Filter,
        mut reader: Reader<'_>,
        tasks: &[Task],
        (report, stop): (&Report, &Stop),
    ) -> Result<()> {
        let first = &tasks[0];
        let output = &first.output;
        let make = |place: &Path| {
            let mut film = None::<Film<'_>>;
            for (done, task) in tasks.iter().enumerate() {
                if stop.is_requested() {
                    let problem = format!("stopped after {done} of {} frames", tasks.len());
                    return Err(Error::failure(problem, "start again"));
                }
                let window = reader.window(task)?;
                let name = task.input.display().to_string();
                let filtered = filter.run(&name, &window, None, Format::Png, &mut |_| {})?;
                let replaced = filtered.replaced;
                let aspect = window
                    .own
                    .source
                    .pictures
                    .first()
                    .map_or(1.0, |picture| square::aspect(&picture.meaning));
                let frame = shown(filtered)
                    .ok_or_else(|| Error::file(&task.input, "has no picture", "leave the frame out"))?;
                let frame = self.result.options().sized(output, frame, &Meaning::display())?;
                let film = match &mut film {
                    Some(film) => film,
                    None => {
                        let pace = (self.fps.unwrap_or(RATE), aspect);
                        let encode = self.result.file.encode(self.encode.as_deref());
                        film.insert(Film::start(&frame, pace, (output, place), encode)?)
                    }
                };
                if !film.put(&frame)? {
                    break;
                }
                report.frame(task, &Outcome::Written(replaced));
            }
            Film::end(film, output)
        };
        let write = |existing| files::write_by_path(output, existing, make);
        let made = Made { from: Some(&first.input), to: output };
        self.consent().write(made, Path::is_file, write).map(drop).inspect_err(|_| report.nothing_written())
    }

    /// The frames of a sequence that become a video.
    ///
    /// # Errors
    /// As [`Tasks::into_one`].
    pub(super) fn film_tasks(&self, files: &Files<'_>) -> Result<Tasks> {
        Tasks::into_one(files.input, &files.output, self.frames.as_ref(), self.on_missing)
    }
}

/// A result as displays show it.
fn shown(Filtered { results, meaning, .. }: Filtered) -> Option<Pixels> {
    let result = display::shown(results.into_iter().next()?, &meaning);
    let conversion = Conversion::between(&meaning, &Meaning::display());
    Some(conversion.map_or_else(|| result.clone(), |conversion| conversion.apply(&result).0))
}
