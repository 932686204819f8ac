//! Frames of a scene on their way from the device to looks on the CPU.

use std::sync::Arc;
use std::time::Instant;

use super::made::FrameState;
use super::origin::Origin;
use super::snapshot::{Snapshot, Snapshots};
use super::source::SceneSource;
use crate::jobs::worker::Wake;
use crate::state::document::frame::Frame;
use crate::state::look::EditedLook;
use crate::state::scenery::{OnScene, Scenery};
use crate::state::things::Sampled;
use isophote_files::error::Result;
use isophote_finishing::stylize::things;
use isophote_loader::Library;
use isophote_loader::catalogue::Kind;
use isophote_render::gpu::Gpu;

/// Frame of a scene in main memory.
pub struct SceneFrame {
    /// The frame.
    pub frame: Arc<Frame>,
    /// Things that samples of its pixels show, where these were drawn.
    pub sampled: Option<Arc<Sampled>>,
    /// State that it shows.
    pub state: FrameState,
    /// Origin of it.
    pub origin: Origin,
    /// Time at which it was rendered.
    pub since: Instant,
    /// Materials that it lies on.
    materials: Arc<[OnScene]>,
}

/// The last frame of a scene that was read back, and the next one.
pub struct SceneFrames {
    snapshots: Snapshots<FrameState>,
    next: Option<Next>,
    present: Option<SceneFrame>,
    needs: Option<([Option<EditedLook>; 3], Needs)>,
    /// Materials that frames are to lie on.
    materials: Arc<[OnScene]>,
}

/// The next frame, which is on its way.
struct Next {
    state: FrameState,
    origin: Origin,
    since: Instant,
    is_sampled: bool,
    materials: Arc<[OnScene]>,
}

/// Needs of looks beside the frame itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Needs {
    /// True where they read rest positions.
    pub rest_positions: bool,
    /// True where they read colours of surfaces or their light.
    pub light: bool,
    /// True where they read frames before.
    pub past: bool,
}

impl SceneFrames {
    /// No frames yet.
    ///
    /// # Errors
    /// As [`Snapshots::new`].
    pub fn new(wake: &Wake) -> Result<Self> {
        let (snapshots, materials) = (Snapshots::new(wake)?, Arc::default());
        Ok(Self { snapshots, next: None, present: None, needs: None, materials })
    }

    /// Lays the frames to come on materials.
    pub fn lie_on(&mut self, materials: &Arc<[OnScene]>) {
        if !Arc::ptr_eq(&self.materials, materials) {
            self.materials = Arc::clone(materials);
        }
    }

    /// Takes over the frame that has been read back.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when it cannot be read.
    pub fn collect(&mut self) -> Result<()> {
        let Some(frame) = self.snapshots.answer() else { return Ok(()) };
        let next = self.next.take();
        let Snapshot { frame, sampled } = frame?;
        let (frame, sampled) = (Arc::new(frame), sampled.map(Arc::new));
        self.present = next.map(|Next { state, origin, since, materials, .. }| SceneFrame {
            frame,
            sampled,
            state,
            origin,
            since,
            materials,
        });
        Ok(())
    }

    /// The last frame that was read back.
    pub fn present(&self) -> Option<&SceneFrame> {
        self.present.as_ref()
    }

    /// True while a frame is on its way.
    pub fn is_busy(&self) -> bool {
        self.next.is_some()
    }

    /// True where the last frame shows this, or the one that is on its way; with samples of its pixels, where these are wanted.
    pub fn shows(&self, state: &FrameState, is_sampled: bool) -> bool {
        let (shown, has_samples, materials) = match (&self.next, &self.present) {
            (Some(next), _) => (&next.state, next.is_sampled, &next.materials),
            (None, Some(present)) => (&present.state, present.sampled.is_some(), &present.materials),
            (None, None) => return false,
        };
        shown == state && (has_samples || !is_sampled) && Arc::ptr_eq(materials, &self.materials)
    }

    /// Reads back what was rendered last. Where samples of its pixels are wanted, these are drawn by [`SceneFrames::sample`].
    pub fn take(
        &mut self,
        gpu: &Gpu,
        source: &SceneSource,
        (state, origin): (FrameState, Origin),
        is_sampled: bool,
    ) {
        let materials = Arc::clone(&self.materials);
        self.next = Some(Next { state, origin, since: Instant::now(), is_sampled, materials });
        self.snapshots.take(gpu, source, (state, &self.materials), is_sampled);
    }

    /// True while samples are still to be drawn of the next frame.
    pub fn is_sampling(&self) -> bool {
        self.snapshots.is_sampling()
    }

    /// Draws some more of them.
    pub fn sample(&mut self, gpu: &Gpu, scene: (&mut SceneSource, &Scenery)) {
        self.snapshots.sample(gpu, scene);
    }

    /// Takes another frame for the next one where samples are still to be drawn of it.
    pub fn give_up(&mut self) {
        if self.is_sampling() {
            self.snapshots.give_up();
            self.next = None;
        }
    }

    /// Forgets all frames.
    pub fn forget(&mut self) {
        self.give_up();
        self.present = None;
    }

    /// Needs of looks; those that cannot be made need nothing.
    pub fn needs(&mut self, library: &Library, looks: [Option<&EditedLook>; 3]) -> Needs {
        if let Some((known, needs)) = &self.needs
            && known.iter().zip(looks).all(|(known, look)| known.as_ref() == look)
        {
            return *needs;
        }
        let mut needs = Needs::default();
        let styles = looks.into_iter().flatten().flat_map(|look| {
            let Ok(Some(style)) = look.style(library) else { return Vec::new() };
            let of_things = things::looks(library, None, &style).unwrap_or_default();
            std::iter::once(style).chain(of_things.into_iter().map(|(_, style)| style)).collect()
        });
        for style in styles {
            needs.past |= library.frames(&style.graph).is_ok_and(|frames| frames != [0, 0]);
            needs.light |= style.reads_light(library).is_ok_and(|reads| reads);
            needs.rest_positions |= style.can_use(Kind::Position).is_ok_and(|can| can);
        }
        self.needs = Some((looks.map(Option::<&EditedLook>::cloned), needs));
        needs
    }
}
