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

pub mod error;
pub mod graph;
mod json;
pub mod kernels;
mod look;
pub mod nodes;
mod ports;
pub mod registry;
pub mod request;
pub mod spec;
pub mod tensor_options;
pub mod values;

pub use error::{Error, Result};
pub use graph::{Graph, NodeId};
pub use isophote_engine as engine;
pub use request::{ColourSpace, Planned, Request};
pub use values::Value;

/// The README's example, compiled with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
pub struct Readme;
