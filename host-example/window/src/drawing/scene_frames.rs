//! Frames of a scene on their way from the device to looks on the CPU.

use std::sync::Arc;
use std::time::Instant;

use super::made::FrameState;
use super::origin::Origin;
use super::snapshot::Snapshots;
use super::source::SceneSource;
use crate::jobs::worker::Wake;
use crate::state::document::frame::Frame;
use crate::state::look::EditedLook;
use isophote_files::error::Result;
use isophote_loader::Library;
use isophote_loader::catalogue::Kind;
use isophote_render::gpu::Gpu;

/// Frame of a scene in main memory.
pub struct SceneFrame {
    /// The frame.
    pub frame: Arc<Frame>,
    /// State that it shows.
    pub state: FrameState,
    /// Origin of it.
    pub origin: Origin,
    /// Time at which it was rendered.
    pub since: Instant,
}

/// The last frame of a scene that was read back, and the next one.
pub struct SceneFrames {
    snapshots: Snapshots<FrameState>,
    next: Option<(FrameState, Origin, Instant)>,
    present: Option<SceneFrame>,
    needs: Option<([Option<EditedLook>; 3], Needs)>,
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
        Ok(Self { snapshots: Snapshots::new(wake)?, next: None, present: None, needs: None })
    }

    /// Takes over the frame that has been read back.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when it cannot be read.
    pub fn collect(&mut self) -> Result<()> {
        let Some(frame) = self.snapshots.answer() else { return Ok(()) };
        let next = self.next.take();
        let frame = Arc::new(frame?);
        self.present = next.map(|(state, origin, since)| SceneFrame { frame, state, origin, since });
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

    /// True where the last frame shows this, or the one that is on its way.
    pub fn shows(&self, state: &FrameState) -> bool {
        match &self.next {
            Some((next, ..)) => next == state,
            None => self.present.as_ref().is_some_and(|frame| frame.state == *state),
        }
    }

    /// Reads back what was rendered last.
    pub fn take(&mut self, gpu: &Gpu, source: &SceneSource, state: FrameState, origin: Origin) {
        self.next = Some((state, origin, Instant::now()));
        self.snapshots.take(gpu, source, state);
    }

    /// Forgets all frames.
    pub fn forget(&mut self) {
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
        let styles = looks.into_iter().flatten().filter_map(|look| look.style(library).ok().flatten());
        for style in styles {
            needs.past |= library.frames(&style.graph).is_ok_and(|frames| frames != [0, 0]);
            needs.light |= style.reads_light(library).is_ok_and(|reads| reads);
            needs.rest_positions |= style.can_use(Kind::Position).is_ok_and(|can| can);
        }
        self.needs = Some((looks.map(Option::<&EditedLook>::cloned), needs));
        needs
    }
}
