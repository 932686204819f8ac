//! OpenEXR files, of which the picture alone is changed.
//!
//! The picture and its guides are chosen by the names of channels; [`isophote_exr_edit`] reads them and
//! writes the result, and keeps every other byte of the file.

mod among;
mod choose;
mod colour_layers;
mod cryptomatte;
mod fault;
mod file;
mod guide_list;
mod guides;
mod mask;
mod mattes;
mod meaning;
mod motion;
mod names;
mod offers;
mod picture;
mod whole_names;

pub use self::choose::Selection;
pub use self::cryptomatte::Made as MadeMatte;
pub use self::file::{ExrFile, Opened, is_whole, mask_of, motion_of};
pub use self::guide_list::Guide;
pub use self::guides::GuideChoice;
pub use self::mask::{MaskSource, OnUnknown, add};
pub use self::names::components;
pub use self::offers::{Layer, Offers};
pub use self::picture::{OwnPixels, Picture};
pub use self::whole_names::WholeNames;
pub use isophote_cryptomatte::{MATERIALS, OBJECTS};
pub use isophote_motion::Convention;
