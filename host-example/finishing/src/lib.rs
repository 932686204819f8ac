//! Finishing: styles on pictures, sequences and videos from file to file, and on frames that the renderer draws.
//!
//! | module | content |
//! |---|---|
//! | [`apply`] | pictures and sequences of pictures: tasks, memory, filters, masks, reports |
//! | [`carry`] | painted maps, carried along motion from key frames to the others |
//! | [`video`] | videos, frame by frame through ffmpeg |
//! | [`sheet`] | contact sheets |
//! | [`processor`] | styles on frames in main memory, computed on the CPU |
//! | [`read_back`] | the same on frames that are read back from a renderer |
//! | [`directed`] | rules of a preset for the things of a scene, on such frames |
//! | [`shot`] | frames of a scene, rendered and stylized |
//! | [`staging`] | options of scenes, as command lines have them |
//! | [`writing`] | options of files that are written, as command lines have them |
//! | [`naming`] | names of results that nobody names |
//! | [`stylize`] | styles, presets and looks, and what stylizes a frame on the renderer's device |

#![forbid(unsafe_code)]

pub mod apply;
pub mod carry;
pub mod directed;
pub mod naming;
mod options;
pub mod processor;
pub mod read_back;
pub mod sheet;
pub mod shot;
pub mod staging;
pub mod stylize;
pub mod video;
pub mod writing;
