//! Files, the frames of sequences, errors and limits: what all other crates of the host stand on.
//!
//! | module | content |
//! |---|---|
//! | [`desktop`] | error of desktops that give no window |
//! | [`error`] | error of the host, with the exit code of the program |
//! | [`files`] | files that are written whole or not at all |
//! | [`frames`] | patterns of file names and lists of frame numbers |
//! | [`identity`] | identity of a file, whatever its path |
//! | [`input`] | opening of files that are read |
//! | [`limits`] | memory and threads that the system may refuse |
//! | [`output`] | messages on standard output and standard error |
//! | [`patience`] | work that fails for a moment |
//! | [`replacing`] | consent to replace files |
//! | [`stop`] | early end of a run |

#![forbid(unsafe_code)]

pub mod desktop;
pub mod error;
pub mod files;
pub mod frames;
pub mod identity;
pub mod input;
pub mod limits;
mod list;
pub mod output;
pub mod patience;
mod place;
pub mod replacing;
pub mod stop;
mod temporary;
