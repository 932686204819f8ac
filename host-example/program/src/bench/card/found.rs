//! Findings about a card.

use serde::Serialize;

use super::twins::Twin;
use crate::bench::entry::Entry;
use crate::bench::throughput::Throughput;
use isophote_finishing::stylize::precision::Precision;

/// All that was measured.
#[derive(Debug, Default, Serialize)]
pub struct Card {
    /// Version of the library.
    pub version: String,
    /// Name of the adapter.
    pub adapter: String,
    /// Its driver.
    pub driver: String,
    /// Kind of the adapter.
    pub kind: String,
    /// Interface to the driver.
    pub backend: String,
    /// Operating system and machine.
    pub system: String,
    /// Threads of the CPU.
    pub threads: usize,
    /// Bytes read and written per second by a copy on the card.
    pub copied: f64,
    /// Nodes beside the CPU.
    pub twins: Vec<Twin>,
    /// Times that compiling takes.
    pub compiled: Vec<Compiled>,
    /// Nodes by size and precision.
    #[serde(skip)]
    pub entries: Vec<(Precision, Entry)>,
    /// Styles in loops.
    pub loops: Vec<Loop>,
    /// Sequences of frames.
    pub sequences: Vec<Sequence>,
    /// Problems that kept something from being measured.
    pub problems: Vec<String>,
}

/// Time that compiling all shaders of a node takes, in the driver's compiler included; drivers may remember shaders
/// from run to run.
#[derive(Debug, Serialize)]
pub struct Compiled {
    /// The node.
    pub node: String,
    /// The precision on the card.
    pub precision: &'static str,
    /// Time that it takes.
    pub seconds: f64,
}

/// A style on the same picture again and again.
#[derive(Debug, Serialize)]
pub struct Loop {
    /// The node.
    pub node: &'static str,
    /// The precision on the card.
    pub precision: &'static str,
    /// Size of the pictures in pixels.
    pub size: (u32, u32),
    /// Number of frames.
    pub frames: usize,
    /// The median of a frame.
    pub median_seconds: f64,
    /// Time that 99 of 100 frames do not exceed.
    pub most_seconds: f64,
}

/// A sequence of EXR frames from file to file.
#[derive(Debug, Serialize)]
pub struct Sequence {
    /// The node.
    pub node: &'static str,
    /// The precision on the card.
    pub precision: &'static str,
    /// Size of the pictures in pixels.
    pub size: (u32, u32),
    /// Throughput that was measured.
    pub measured: Throughput,
}
