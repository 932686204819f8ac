//! State of the window: plain values and what may be done with them. Nothing here has a thread or lives on the device.

pub mod browser;
pub mod chain;
pub mod command;
pub mod comparison;
pub mod demo;
pub mod document;
pub mod file_steps;
pub mod history;
pub mod leaving;
pub mod look;
pub mod notes;
pub mod outcome;
pub mod plan;
pub mod playback;
pub mod preview;
pub mod progress;
pub mod record;
pub mod samples;
pub mod saving;
pub mod scenery;
pub mod session;
pub mod settings;
pub mod value;
pub mod viewport;
