//! Drawing: everything of the window that lives on the graphics device.

mod canvas;
mod counter;
mod live_look;
mod made;
mod origin;
pub(crate) mod panel;
mod pictures;
mod probe;
mod processed;
mod scene_frames;
mod screen;
mod shown;
mod snapshot;
mod source;
mod sources;
pub(crate) mod stage;
