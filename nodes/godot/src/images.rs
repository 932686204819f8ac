//! Images of the frame at hand and of those before it, by their names.

use crate::device::Device;
use crate::error::Error;
use godot::builtin::Rid;
use godot::classes::rendering_device::DataFormat;

/// Image that is needed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Needed {
    pub(crate) name: String,
    /// Frames before the one at hand that it is read of.
    pub(crate) depth: usize,
    /// Width and height.
    pub(crate) size: [u32; 2],
    pub(crate) format: DataFormat,
}

/// All images of the frame at hand that later frames read, or that the viewport's pictures are written to.
#[derive(Debug, Default)]
pub(crate) struct Images {
    /// Each with the frame at hand first, then the frame before it, and so on.
    rings: Vec<(Needed, Vec<Rid>)>,
}

impl Images {
    /// The image of a name, so many frames before the one at hand.
    pub(crate) fn before(&self, name: &str, frames: usize) -> Option<Rid> {
        self.rings.iter().find(|(image, _)| image.name == name)?.1.get(frames).copied()
    }

    /// Makes room for these images, and gives all others back.
    ///
    /// # Errors
    /// [`Error::Device`] where memory does not suffice.
    pub(crate) fn hold(&mut self, device: &mut Device, needed: &[Needed]) -> Result<(), Error> {
        let (kept, gone) =
            std::mem::take(&mut self.rings).into_iter().partition(|(image, _)| needed.contains(image));
        self.rings = kept;
        device.free(Vec::from_iter(gone).into_iter().flat_map(|(_, ids): (Needed, Vec<Rid>)| ids));
        for image in needed {
            if !self.rings.iter().any(|(kept, _)| kept == image) {
                let ids = (0..=image.depth).map(|_| device.texture(image.size, image.format));
                let ids = ids.collect::<Result<Vec<Rid>, Error>>()?;
                self.rings.push((image.clone(), ids));
            }
        }
        Ok(())
    }

    /// The next frame begins: the frame at hand is the one before it.
    pub(crate) fn advance(&mut self) {
        self.rings.iter_mut().for_each(|(_, ids)| ids.rotate_right(1));
    }

    /// Number of frames after which all images stand where they do now.
    pub(crate) fn turns(&self) -> usize {
        self.rings.iter().map(|(_, ids)| ids.len()).fold(1, |turns, length| {
            (turns..).step_by(turns).find(|n| n.is_multiple_of(length)).unwrap_or(turns)
        })
    }
}
