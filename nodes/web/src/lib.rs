//! The planner of the browser.
//!
//! A page has a graphics device of its own, WebGPU's. This crate says what a look comes to on it: textures, dispatches,
//! uniform bytes and shaders. It runs nothing, holds no kernel's CPU function, and is one module of WebAssembly that imports
//! nothing. `package/src/planner.js` calls it, `package/src/program.js` runs what it says.
//!
//! A call is a request as JSON (`ask.rs`), its answer JSON and bytes (`answer.rs`); `exports.rs` moves both.

mod answer;
mod ask;
mod catalogue;
mod exports;
mod look;
mod plans;

pub use answer::Answer;
pub use plans::Planner;
