//! The stage where looks are computed on the CPU, as its driver would do more slowly, or since they have rules for things; and
//! what both ways have in common.

use std::time::{Duration, Instant};

use super::{Progress, Stage, overlay};
use crate::drawing::live_look::LiveLook;
use crate::drawing::made::{FrameState, Made};
use crate::drawing::origin::Origin;
use crate::drawing::processed::Subject;
use crate::drawing::scene_frames::{SceneFrame, SceneFrames};
use crate::drawing::shown::Output;
use crate::drawing::source::LookInput;
use crate::state::look::EditedLook;
use crate::state::materials::are_on_scene;
use crate::state::notes::Subject as About;
use crate::state::session::{Session, Which};
use isophote_files::error::{Error, Result};

/// Pixels of a picture while something moves.
const MOVING: f32 = 400_000.0;
/// Time between two frames of the window while looks are computed on the CPU for what plays.
const SHARED: Duration = Duration::from_millis(40);
/// Share of the whole picture's pixels across from which it is made at once, and none for the screen before.
const ALL_BUT_WHOLE: f32 = 0.8;

impl Stage {
    /// True where a processor draws what is open, or computes its looks, which takes its time.
    pub fn takes_its_time(&self, session: &Session) -> bool {
        self.is_software() || self.computes_on_cpu || self.is_on_cpu(session)
    }

    /// True where looks on what is open are computed on the CPU. On scenes those that read frames before are left to the device,
    /// which has them, unless they have rules or lie on materials: these are made frame by frame.
    pub(super) fn is_on_cpu(&self, session: &Session) -> bool {
        let is_left = session.open.scenery().is_some() && self.needs.past;
        session.open.has_picture()
            && (self.is_ruled || are_on_scene(session) || self.computes_on_cpu && !is_left)
    }

    /// True while something is on its way to the CPU, or being computed there.
    pub(super) fn is_busy_on_cpu(&self) -> bool {
        self.frames.is_busy() || self.progress().is_some()
    }

    /// Finds what looks need of a scene.
    pub(super) fn follow_needs(&mut self, session: &Session) -> Result<()> {
        self.is_ruled = session.follows_rules();
        if session.open.scenery().is_some() {
            let looks = looks(session)?;
            self.needs = self.frames.needs(&session.library, looks.each_ref().map(Option::as_ref));
        }
        Ok(())
    }

    /// Time at which the window is drawn next while time passes: what is computed on the CPU wants it, too.
    pub fn next_window(&self, session: &Session) -> Instant {
        let is_shared = self.is_on_cpu(session) && session.record.limit.is_none();
        if is_shared { self.drawn + SHARED } else { Instant::now() }
    }

    /// Follows the looks on what is open; returns what went wrong with them.
    pub(super) fn follow_on_cpu(&mut self, session: &Session) -> Result<Option<(About, Error)>> {
        let looks = looks(session)?;
        let looks = looks.each_ref().map(Option::as_ref);
        if let Err(problem) = self.frames.collect() {
            return Ok(Some((About::Other, problem)));
        }
        match session.open.scenery() {
            Some(scenery) => self.frames.lie_on(&scenery.materials),
            None => self.frames.forget(),
        }
        // What is covered is made when it is seen.
        let subject = subject(session, &self.frames, self.moves).filter(|_| !session.is_covered());
        match subject {
            Some(subject) => {
                let followed = self.processed.follow(looks, shown(session), &subject);
                Ok(followed.err().map(|problem| (About::Look, problem)))
            }
            None => {
                self.processed.wait();
                Ok(None)
            }
        }
    }

    /// Lets go of looks on the CPU, as long as they are computed on the device; returns what went wrong with them.
    pub(super) fn rest_on_cpu(&mut self) -> Option<(About, Error)> {
        self.processed.put_away();
        let collected = self.frames.collect();
        self.frames.forget();
        collected.err().map(|problem| (About::Other, problem))
    }

    /// True while a frame of a scene is drawn in parts, between which the window is drawn.
    pub fn is_sampling(&self) -> bool {
        self.frames.is_sampling()
    }

    /// Sentences about rules of looks that are for nothing in what is open, since the last call.
    pub fn news(&self) -> Vec<String> {
        self.processed.news()
    }

    /// Takes over that other pictures are to be shown, which are there already; renders the scene where it is another.
    pub(super) fn follow_results(&mut self, session: &Session, made: Option<Made>) -> Result<()> {
        let has_looks = has_looks(session)?;
        let state = made.as_ref().map(|made| (made.request, made.source, made.scene));
        if let Some(state) = state.filter(|state| state.2.is_some()) {
            self.render(session, state, has_looks)?;
        }
        if matches!(self.progress, Progress::Whole(_)) {
            return Ok(());
        }
        let shown = self.frames.present().map(|frame| frame.state);
        let made = made.map(|made| match shown.filter(|_| has_looks && made.scene.is_some()) {
            Some((request, source, scene)) => Made { request, source, scene, ..made },
            None => made,
        });
        // A look that is turned back to, or was never left, is there before it is told of.
        let is_told = session.record.present().is_some();
        let is_new = made != self.made || !is_told || session.record.limit.is_some();
        let is_there = self.processed.is_complete() || !has_looks;
        let is_news = made.is_some() && is_new && is_there;
        let spent = if has_looks { self.processed.spent() } else { Duration::ZERO };
        self.progress = if is_news { Progress::Whole(spent) } else { Progress::Done };
        if is_news {
            self.made = made;
        }
        Ok(())
    }

    /// Renders the scene in this state, and reads it back for looks.
    fn render(&mut self, session: &Session, state: FrameState, has_looks: bool) -> Result<()> {
        // While it moves, one sample of a pixel is enough.
        let is_sampled = self.is_ruled && !self.moves;
        let is_known = has_looks && self.frames.shows(&state, is_sampled);
        if !is_known {
            self.frames.give_up();
        }
        let is_late = self.processed.finishes() || self.frames.is_busy();
        let origin = self.sources.origin().cloned();
        let (Some(LookInput::Scene(source)), Some(scenery), Some(origin)) =
            (self.sources.present_mut(), session.open.scenery(), origin)
        else {
            return Ok(());
        };
        if is_known {
            self.frames.sample(&self.gpu, (source, scenery));
            return Ok(());
        }
        let is_there = !has_looks && self.rendered == Some(state);
        if is_there || has_looks && is_late {
            return Ok(());
        }
        if has_looks && self.needs.rest_positions && source.add_rest_positions() {
            self.looks.iter_mut().for_each(LiveLook::unbind);
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        source.encode(&mut encoder, scenery);
        self.gpu.queue.submit([encoder.finish()]);
        self.rendered = Some(state);
        if has_looks {
            self.frames.take(&self.gpu, source, (state, origin), is_sampled);
        }
        Ok(())
    }

    /// Revisions of the looks on what is open.
    pub(super) fn revisions(&self, session: &Session) -> [u64; 3] {
        match self.is_on_cpu(session) {
            true => [self.processed.revision(), 0, 0],
            false => self.looks.each_ref().map(LiveLook::revision),
        }
    }

    /// Pictures in the look, in what it is compared with and in what is shown instead, as far as they are of what is open.
    pub(super) fn outputs(&self, session: &Session) -> [Option<Output>; 3] {
        let Some(now) = Origin::of(session) else { return [const { None }; 3] };
        match self.is_on_cpu(session) {
            true => [0, 1, 2].map(|slot| self.processed.output(slot, &now)),
            false => self.looks.each_ref().map(|look| look.output(&now)),
        }
    }

    /// The share of a look on the CPU that is done, while one is computed.
    pub fn progress(&self) -> Option<f32> {
        self.processed.progress()
    }

    /// Work on what is shown that is not done, in words.
    pub fn doing(&self, session: &Session) -> Option<&'static str> {
        // A scene that moves is shown as soon as it can be.
        let is_at_rest = self.made.as_ref().is_some_and(|made| made.request.scale >= 1.0);
        let is_begun = matches!(self.progress, Progress::Wanted | Progress::Begun(_));
        let is_moved = self.moves && session.open.scenery().is_some();
        if (self.progress().is_some() || self.is_sampling()) && !is_moved {
            return Some("Stylizing");
        }
        if self.sources.is_busy() {
            return Some(if session.open.scenery().is_some() { "Preparing the scene" } else { "Opening" });
        }
        if self.looks.iter().any(LiveLook::is_busy) {
            return Some("Preparing the look");
        }
        (is_begun && is_at_rest && self.is_software() && !session.open.is_playing()).then_some("Stylizing")
    }
}

/// The picture that looks are wanted of.
fn subject<'s>(session: &'s Session, frames: &'s SceneFrames, moves: bool) -> Option<Subject<'s>> {
    if session.open.scenery().is_some() {
        let SceneFrame { frame, sampled, state: (request, ..), origin, since, .. } = frames.present()?;
        let things = session.open.things(sampled.clone());
        let sizes = vec![(frame.width, frame.height)];
        let (share, origin, since) = (request.scale, origin.clone(), *since);
        return Origin::of(session).is_some_and(|now| now.is_of_same(&origin)).then(|| Subject {
            frame,
            things,
            share,
            origin,
            sizes,
            moves,
            since,
        });
    }
    let (frame, share) = session.open.playback()?.frame(false)?;
    let sizes = sizes(session, (frame.width, frame.height), moves);
    let (origin, since) = (Origin::of(session)?, Instant::now());
    Some(Subject { frame, things: session.open.things(None), share, origin, sizes, moves, since })
}

/// The look, what it is compared with and what is shown instead, as far as they are not plain.
fn looks(session: &Session) -> Result<[Option<EditedLook>; 3]> {
    let compared = session.looks.compared.clone().unwrap_or_else(EditedLook::plain);
    let looks = [session.looks.seen().into_owned(), compared, overlay(session)?];
    Ok(looks.map(|look| Some(look).filter(|look| !look.is_plain())))
}

/// The looks that are shown now: of an original that is held up beside them they are kept.
fn shown(session: &Session) -> [bool; 3] {
    [Which::Look, Which::Compared, Which::Overlay].map(|which| session.shown().contains(&which))
}

/// True where any look is shown that is not plain.
fn has_looks(session: &Session) -> Result<bool> {
    Ok(looks(session)?.iter().zip(shown(session)).any(|(look, is_shown)| is_shown && look.is_some()))
}

/// Sizes at which a picture is wanted, one after the other: while something moves one that is soon there; as large as the
/// screen shows it; all of it.
fn sizes(session: &Session, whole: (u32, u32), moves: bool) -> Vec<(u32, u32)> {
    let nominal = session.nominal_size();
    let [_, half] = session.viewport.halves();
    let fit = (half.width / nominal.0 as f32).min(half.height / nominal.1 as f32);
    let screen = fit.min(session.viewport.scale(nominal)) * nominal.0 as f32 / whole.0 as f32;
    let moving = (MOVING / (whole.0 as f32 * whole.1 as f32)).sqrt();
    let sized =
        |share: f32| [whole.0, whole.1].map(|side| ((side as f32 * share).round() as u32).clamp(1, side));
    let first = if moves { screen.min(moving) } else { screen };
    let mut sizes = Vec::new();
    if first < ALL_BUT_WHOLE {
        let [width, height] = sized(first);
        sizes.push((width, height));
    }
    if !moves || sizes.is_empty() {
        sizes.push(whole);
    }
    sizes
}
