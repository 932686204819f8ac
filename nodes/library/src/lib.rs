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

pub mod choice;
pub mod colour_space;
mod describe;
pub mod error;
pub mod frames;
pub mod graph;
pub mod guides;
mod json;
pub mod kernels;
mod lowered;
mod neighbours;
pub mod nodes;
pub mod param;
pub mod picture;
mod ports;
pub mod preset;
pub mod registry;
pub mod request;
pub mod sequence;
pub mod spec;
mod stages;
pub mod value;

pub use colour_space::ColourSpace;
pub use error::{Error, Result};
pub use graph::{Graph, NodeId};
pub use isophote_engine as engine;
pub use lowered::Lowered;
pub use picture::Request;
pub use request::Planned;
pub use stages::optical_flow;
pub use value::Value;

/// The example of the documentation's page for Rust, compiled with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../xtask/docs/pages/engines/rust.md")]
pub struct Page;
