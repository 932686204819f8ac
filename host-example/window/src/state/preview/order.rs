//! Orders of previews: which look, how large, which part.

use std::sync::Arc;

use egui::ColorImage;

use super::picture::Picture;
use crate::state::document::reduce;
use crate::state::look::EditedLook;
use isophote_files::error::Result;
use isophote_loader::process::Part;

/// Factor by which small previews are computed finer than they are seen: enough for fine hatching to be as grey as it
/// is in the whole picture made small.
pub const FINENESS: u32 = 3;

/// A preview to be made.
#[derive(Clone, Debug)]
pub struct Order {
    /// The look.
    pub look: Arc<EditedLook>,
    /// Pixels across and down of the whole picture as it is seen, at most those of the frame.
    pub size: (u32, u32),
    /// The pixels of it that are seen.
    pub part: Part,
    /// Factor by which it is computed finer than it is seen, so that thin lines are as pale as those of the whole
    /// picture made small; no finer than the frame is.
    pub fineness: u32,
}

impl Order {
    /// All of the picture.
    pub fn whole(look: Arc<EditedLook>, size: (u32, u32), fineness: u32) -> Self {
        Self { look, size, part: reduce::whole(size), fineness }
    }
}

impl PartialEq for Order {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.look, &other.look)
            && (self.size, self.part, self.fineness) == (other.size, other.part, other.fineness)
    }
}

/// One preview that is wanted.
#[derive(Clone, Debug)]
pub struct Task {
    /// Its number, which no other has.
    pub serial: u64,
    /// Picture that it is of.
    pub picture: Arc<Picture>,
    /// Order to be made.
    pub order: Order,
}

/// Result of a task.
pub type Done = (u64, Result<ColorImage>);
