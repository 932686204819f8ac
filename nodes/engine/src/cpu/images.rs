//! The images of a run: those of the caller, and those that passes write.

use crate::error::{Error, Result};
use crate::image::{Image, Rect, View};
use crate::plan::{ImageId, Plan};

/// The images of `inputs` by virtual image, after checking that each covers what `windows` names.
pub(crate) fn bind_inputs<'a>(
    plan: &Plan,
    inputs: &[(&str, &'a Image)],
    windows: &[Rect],
) -> Result<Vec<Option<&'a Image>>> {
    let mut borrowed = vec![None; plan.images().len()];
    for port in plan.inputs() {
        let needed = windows[port.image.index()];
        if needed.is_empty() {
            continue;
        }
        let Some((_, image)) = inputs.iter().find(|(name, _)| *name == port.name) else {
            return Err(Error::Input(format!("input image '{}' is missing", port.name)));
        };
        let channels = plan.desc(port.image).channels;
        if image.channels() != channels {
            return Err(Error::Input(format!(
                "input image '{}' has {} channels; {channels} are needed",
                port.name,
                image.channels()
            )));
        }
        if !image.window().contains(&needed) {
            return Err(Error::Input(format!(
                "input image '{}' covers {:?}; {needed:?} is needed",
                port.name,
                image.window()
            )));
        }
        borrowed[port.image.index()] = Some(*image);
    }
    Ok(borrowed)
}

/// The images of a run, by virtual image.
pub(super) struct Images<'a> {
    borrowed: Vec<Option<&'a Image>>,
    owned: Vec<Option<Image>>,
    /// The row down to which an owned image is computed, exclusive.
    filled: Vec<i32>,
}

impl<'a> Images<'a> {
    /// The caller's images, and none that are computed.
    ///
    /// # Errors
    /// As [`bind_inputs`].
    pub fn bind(plan: &Plan, inputs: &[(&str, &'a Image)], windows: &[Rect]) -> Result<Self> {
        let borrowed = bind_inputs(plan, inputs, windows)?;
        Ok(Self { borrowed, owned: vec![None; plan.images().len()], filled: tops(windows) })
    }

    /// No image of the caller's: those that enter are put here as they are read.
    pub fn none(plan: &Plan, windows: &[Rect]) -> Self {
        let none = vec![None; plan.images().len()];
        Self { borrowed: none, owned: vec![None; plan.images().len()], filled: tops(windows) }
    }

    /// The row down to which an image is computed, exclusive.
    pub fn filled(&self, id: ImageId) -> i32 {
        self.filled[id.index()]
    }

    /// View of what is computed of an image, for a pass to read.
    pub fn view(&self, plan: &Plan, id: ImageId) -> View<'_> {
        let full = plan.level_size(plan.desc(id).level);
        match &self.owned[id.index()] {
            Some(image) => View::down_to(image, full, self.filled(id)),
            None => View::new(self.image(id), full),
        }
    }

    /// An image of the caller's or a computed one, without pixels where it is neither.
    pub fn image(&self, id: ImageId) -> &Image {
        static EMPTY: Image = Image::EMPTY;
        self.borrowed[id.index()].or(self.owned[id.index()].as_ref()).unwrap_or(&EMPTY)
    }

    /// Takes the memory of a computed image out, if it has any.
    pub fn take(&mut self, id: ImageId) -> Option<Image> {
        self.owned[id.index()].take()
    }

    /// Puts an image back that is now computed down to row `filled`, exclusive.
    pub fn put(&mut self, id: ImageId, image: Image, filled: i32) {
        self.owned[id.index()] = Some(image);
        self.filled[id.index()] = filled;
    }

    /// The part of an image that leaves the run.
    ///
    /// # Errors
    /// [`Error::Geometry`] when the image does not hold it.
    pub fn finish(&mut self, id: ImageId, region: Rect) -> Result<Image> {
        match self.take(id) {
            Some(image) if image.window() == region => Ok(image),
            Some(image) => {
                let part = image.crop(region);
                self.owned[id.index()] = Some(image);
                part
            }
            None => self.image(id).crop(region),
        }
    }

    /// Gives the memory of what was computed to later runs.
    pub fn recycle(self, spare: &mut Vec<Image>) {
        spare.extend(self.owned.into_iter().flatten());
    }
}

/// The first row of each image.
fn tops(windows: &[Rect]) -> Vec<i32> {
    windows.iter().map(|w| w.y0).collect()
}
