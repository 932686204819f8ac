//! Arguments of `apply` that name files, and the part of each in a run: one list for everything that has to find or
//! to spare them.

use std::collections::BTreeSet;
use std::path::Path;

use super::apply::ApplyArgs;
use isophote_files::error::Result;
use isophote_files::replacing::{Consent, Inputs, Made};
use isophote_finishing::apply::masks::MaskChoice;
use isophote_finishing::apply::planner::Planner;
use isophote_finishing::apply::tasks::{Task, Tasks};
use isophote_finishing::stylize::style;
use isophote_finishing::video;
use isophote_pictures::exr::MaskSource;
use isophote_pictures::material::MaterialKind;

/// The word for motion that is estimated.
pub const ESTIMATE: &str = "estimate";

/// Part that a file has in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// It says what is done, and is read once.
    Style,
    /// It is a picture or belongs to one, or a pattern of such for each frame; it is read.
    Frames,
    /// It is written.
    Result,
}

/// A file, or a pattern of files, that an argument names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place<'a> {
    /// Id of the argument.
    pub id: &'static str,
    /// Part of the file in a run.
    pub part: Part,
    /// The path as it was written.
    pub path: &'a Path,
}

impl ApplyArgs {
    /// All files that the command line names. A new argument that takes a path belongs into this list.
    ///
    /// # Errors
    /// As [`ApplyArgs::files`].
    pub fn places(&self) -> Result<Vec<Place<'_>>> {
        let named = self.named()?;
        let styled = match (&self.preset, &self.layered) {
            (Some(_), _) => "preset",
            (None, _) => "style",
        };
        // With a preset the input is the first of the arguments without a name.
        let is_moved = self.preset.is_some() || self.layered.is_some();
        let [first, second] = if is_moved { ["style", "input"] } else { ["input", "output"] };
        let ids = [first, second].into_iter().chain(std::iter::repeat("more"));
        let inputs = named.inputs.iter().zip(ids).map(|(path, id)| (id, Part::Frames, Some(*path)));
        let mask = self.mask.as_ref().and_then(|mask| match mask {
            MaskSource::File(path) => Some(path.as_path()),
            MaskSource::Layer(_) | MaskSource::Mattes(_) | MaskSource::Ids(_) => None,
        });
        let material = |wanted: MaterialKind| {
            self.painted.materials.files().find(|(kind, _)| *kind == wanted).map(|(_, path)| path)
        };
        let others = [
            (
                styled,
                Part::Style,
                Some(named.style).filter(|style| self.layered.is_none() && style::is_file(style)),
            ),
            ("layered", Part::Style, self.layered.as_deref()),
            ("palette", Part::Style, self.palette.file()),
            (second, Part::Result, named.output.or(named.folder.filter(|_| self.to.is_none()))),
            ("to", Part::Result, self.to.as_deref()),
            ("mask", Part::Frames, mask),
            ("mask_from", Part::Frames, self.mask_from.as_deref()),
            ("paper", Part::Style, material(MaterialKind::Paper)),
            ("hatching", Part::Style, material(MaterialKind::Hatching)),
            ("motion", Part::Frames, self.motion.as_deref().filter(|_| !self.estimates_motion())),
        ];
        let maps = self.painted.paths().into_iter();
        let maps = maps.map(|(painted, path)| (painted.guide.id(), Part::Frames, Some(path)));
        // Standard input and output have no path.
        let is_path = |path: &&Path| *path != Path::new("-");
        let place =
            |(id, part, path): (_, _, Option<_>)| Some(Place { id, part, path: path.filter(is_path)? });
        Ok(inputs.chain(others).chain(maps).filter_map(place).collect())
    }

    /// True where motion is to be found in the pictures themselves.
    pub fn estimates_motion(&self) -> bool {
        self.motion.as_deref() == Some(Path::new(ESTIMATE))
    }

    /// Consent to replace files.
    pub fn consent(&self) -> Consent {
        Consent { in_place: self.in_place, skip_existing: self.skip_existing, ..self.force.consent() }
    }

    /// Files that a run reads: for these frames, or for all that are on disk. `masks` are those of all looks.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for patterns with several places for a number.
    pub fn inputs(&self, masks: &[MaskChoice], frames: Option<&BTreeSet<i64>>) -> Result<Inputs> {
        let mut inputs = Inputs::default();
        for Place { part, path, .. } in self.places()? {
            match part {
                Part::Style => inputs.add(path),
                Part::Frames => inputs.add_frames(path, frames)?,
                Part::Result => {}
            }
        }
        for mask in masks {
            if let MaskSource::File(path) = &mask.source {
                inputs.add_frames(path, frames)?;
            }
        }
        Ok(inputs)
    }

    /// Refuses a run whose results would replace files without consent.
    ///
    /// # Errors
    /// As [`Consent::check`].
    pub fn check_results(&self, tasks: &Tasks, planner: &Planner, masks: &[MaskChoice]) -> Result<()> {
        let mut made: Vec<Made<'_>> = tasks.ready.iter().map(Task::made).collect();
        // All frames of a video are in one file.
        made.dedup_by_key(|made| made.to);
        self.consent().check(&made, tasks.are_several() && !video::becomes_video(made[0].to), || {
            let mut frames = BTreeSet::new();
            for task in &tasks.ready {
                let Some(number) = task.frame else { continue };
                let [past, future] = planner.frames(task.frame)?;
                frames.extend(number.saturating_sub(past)..=number.saturating_add(future));
            }
            self.inputs(masks, Some(&frames))
        })
    }
}
