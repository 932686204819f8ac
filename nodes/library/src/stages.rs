//! What styles are made of: the stages of the cartoon pipeline (§ 4.6) and its relatives, each with its
//! parameters.
//!
//! The technical parameters, under the heading `advanced`, hold the thesis' values under the thesis' names.
//! Under `look` stand the controls that an artist turns. Each of them scales or shifts one or two technical
//! values and is neutral at its default, so that defaults give exactly the thesis' values and whoever sets a
//! technical value gets that value. Every mapping is monotone.

pub(crate) mod abstraction;
pub(crate) mod lines;
pub(crate) mod marks;
pub mod optical_flow;
pub(crate) mod quantization;
pub(crate) mod steady;
pub(crate) mod tone;

/// Heading of the controls for artists.
pub(crate) const LOOK: &str = "look";
/// Heading of the technical parameters.
pub(crate) const ADVANCED: &str = "advanced";
