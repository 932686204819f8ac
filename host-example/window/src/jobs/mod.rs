//! Work beside the window: threads and processes, and the channels on which their results come back.

pub(crate) mod background;
pub mod carrying;
mod dialogs;
pub mod document;
pub mod export;
mod exporting;
mod folder;
mod idle;
pub mod listing;
mod look_work;
pub mod maps;
mod opening;
pub mod preview;
mod reader;
mod reveal;
pub mod ruled;
pub mod stylizing;
mod watch;
pub(crate) mod worker;
