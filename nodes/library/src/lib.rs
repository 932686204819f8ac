//! Structure-adaptive stylization filters as composable nodes.
//!
//! After J. E. Kyprianidis, *Structure Adaptive Stylization of Images and Video*. A [`graph::Graph`]
//! connects nodes of the [`registry`]; it is turned into a plan of passes that either executor of
//! [`isophote_engine`] runs, on the CPU or on a GPU.

#![forbid(unsafe_code)]
// Loops over lanes, channels and sides stay loops: adapters of iterators are calls in code for wide vectors.
#![allow(clippy::needless_range_loop)]
// Coefficients of polynomials lie near constants and are not them.
#![allow(clippy::approx_constant)]

pub mod colour_space;
pub mod declare;
pub mod error;
pub mod frames;
pub mod graph;
pub mod guides;
pub mod kernels;
pub mod nodes;
pub mod plan;
pub mod preset;
pub mod registry;
mod stages;
pub mod things;

pub use colour_space::ColourSpace;
pub use declare::value::Value;
pub use declare::{choice, param, spec, value};
pub use error::{Error, Result};
pub use graph::{Graph, NodeId};
pub use isophote_engine as engine;
pub use plan::lowered::Lowered;
pub use plan::planned::Planned;
pub use plan::request::Request;
pub use plan::{live, planned, request, sequence};
pub use stages::optical_flow;

/// The example of the README, compiled with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
