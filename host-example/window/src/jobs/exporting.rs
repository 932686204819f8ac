//! The export of what the window shows, by what is planned.

use std::path::{Path, PathBuf};

use super::export::{Export, ExportJob};
use crate::state::batch::Batch;
use crate::state::command;
use crate::state::document::kind::Kind;
use crate::state::materials;
use crate::state::outcome::Outcome;
use crate::state::plan::{Plan, What};
use crate::state::playback::Playback;
use crate::state::progress::State;
use crate::state::session::Session;
use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::preset;

/// An export, while there is one.
#[derive(Debug, Default)]
pub struct Exporting {
    export: Option<Export>,
}

impl Exporting {
    /// Begins to write what is shown, by another process, where something is planned.
    pub fn begin(&mut self, session: &Session) -> Option<Outcome> {
        let job = job(session, session.dialogs.plan.as_ref()?, session.open.file()?);
        let begun = job.and_then(Export::start).map(|export| self.export = Some(export));
        Some(Outcome::ExportBegun(begun))
    }

    /// Begins to use the look on several pictures, where they are chosen.
    pub fn begin_several(&mut self, session: &Session) -> Option<Outcome> {
        let job = several(session, session.dialogs.batch.as_ref()?);
        let begun = job.and_then(Export::start).map(|export| self.export = Some(export));
        Some(Outcome::ExportBegun(begun))
    }

    /// Progress of it; it is the last one when it has ended.
    pub fn progress(&mut self) -> Option<Outcome> {
        let progress = self.export.as_ref()?.poll();
        if progress.state != State::Running {
            self.export = None;
        }
        Some(Outcome::Export(progress))
    }

    /// Ends it, and removes what is not whole.
    pub fn cancel(&mut self) {
        self.export.iter_mut().for_each(Export::cancel);
    }

    /// Ends it; says whether it has ended, so that nothing of it is left.
    pub fn has_ended(&mut self) -> bool {
        self.cancel();
        self.export.as_ref().is_none_or(|export| export.poll().state != State::Running)
    }

    /// True while there is one.
    pub fn is_running(&self) -> bool {
        self.export.is_some()
    }
}

/// The export of a file that is open.
///
/// # Errors
/// [`isophote_files::error::Error::Input`] for looks that no preset can hold.
fn job(session: &Session, plan: &Plan, file: &Path) -> Result<ExportJob> {
    let mut job = ExportJob::new(
        plan.kind,
        file,
        Path::new(&plan.path),
        preset_of(session, session.open.has_things())?,
    );
    let is_turntable = plan.what == What::Turntable;
    (job.frames, job.turntable, job.rate) = (plan.frames(), is_turntable, plan.rate);
    job.maps = session.open.playback().and_then(Playback::painted);
    let mut words: Vec<String> = match session.open.playback() {
        Some(playback) => command::selection(playback),
        None => {
            let [width, height] = plan.size;
            let size = ["--size".to_owned(), format!("{width}x{height}")];
            size.into_iter().chain(command::staging(session, is_turntable)).collect()
        }
    };
    match plan.what {
        What::Animation => words.extend(command::animation(session)),
        What::Picture if session.open.playback().is_none() => words.extend(command::moment(session)),
        What::Picture | What::Turntable | What::Frames => {}
    }
    words.extend(materials::options(session));
    words.extend(command::precision(session));
    words.extend(plan.options().words());
    words.extend(unknown(session));
    job.arguments = words.into_iter().map(Into::into).collect();
    Ok(job)
}

/// The look on several pictures.
///
/// # Errors
/// As [`job`]; [`Error::Input`] without a picture.
fn several(session: &Session, batch: &Batch) -> Result<ExportJob> {
    let none = || Error::input("the export", "has no pictures", "choose some");
    let (first, more) = batch.pictures.split_first().ok_or_else(none)?;
    let is_exr = |file: &PathBuf| file.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    let preset = preset_of(session, batch.pictures.iter().any(is_exr))?;
    let mut job = ExportJob::new(Kind::Picture, first, Path::new(batch.folder.trim()), preset);
    job.more = more.to_vec();
    let words = [batch.options().words(), command::precision(session), unknown(session)].concat();
    job.arguments = words.into_iter().map(Into::into).collect();
    Ok(job)
}

/// The look that is shown as the text of a preset, with its rules for things where there may be any; nothing where it is none.
fn preset_of(session: &Session, has_things: bool) -> Result<Option<String>> {
    let look = session.look();
    if look.is_plain() {
        return Ok(None);
    }
    let mut preset = look.whole()?;
    if !has_things {
        preset.objects.clear();
    }
    preset::text(&preset).map(Some)
}

/// Options by which rules cover nothing where their things are not, as they do in the window.
fn unknown(session: &Session) -> Vec<String> {
    let words = ["--on-unknown", "empty"].map(str::to_owned);
    if session.look().has_rules() { words.into() } else { Vec::new() }
}
