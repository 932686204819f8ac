//! Histograms of what the stage shows, and what is known of its device.

use super::{Progress, Stage};
use crate::drawing::canvas::Shown;
use crate::drawing::shown::picture;
use crate::state::histogram::Histograms;
use crate::state::session::{Session, Which};
use crate::state::viewport::Area;
use isophote_example::kernels::Counts;
use isophote_files::error::Result;
use isophote_render::gpu::Gpu;

impl Stage {
    /// Histograms that were counted since the last call. Counts what is shown, where that is wanted and it is another picture
    /// than before.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device refuses.
    pub fn count(&mut self, session: &Session) -> Result<Option<Histograms>> {
        let counted = self.counter.answer().transpose()?;
        let is_wanted =
            session.settings.shows_histogram && !session.is_covered() && self.progress == Progress::Done;
        let made = self.made.clone().filter(|_| is_wanted);
        let state = made.map(|made| (made, session.viewport.exposure.exp2().to_bits()));
        if let (Some(source), Some(state)) = (self.sources.present(), state)
            && self.counter.wants(&state)
        {
            let [_, shown] = session.shown();
            let outputs = self.outputs(session);
            let pictures = [Which::Original, shown].map(|which| {
                let (view, numbers) = picture(source, &outputs, session.viewport.overlay, which);
                Shown { view, numbers, place: Area::default() }
            });
            self.counter.take(&self.gpu, pictures, state);
        }
        Ok(counted)
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Numbers of things made and uploaded on the device for looks.
    pub fn counts(&self) -> Counts {
        self.kernels.counts()
    }

    /// Most texels of a texture across.
    pub fn most_texels(&self) -> usize {
        self.gpu.device.limits().max_texture_dimension_2d as usize
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> String {
        self.gpu.adapter.get_info().name
    }
}
