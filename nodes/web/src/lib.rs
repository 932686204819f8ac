//! The planner of the browser.
//!
//! A page has a graphics device of its own, WebGPU's. This crate says what a look comes to on it: textures, dispatches,
//! uniform bytes and shaders. It runs nothing, holds no kernel's CPU function, and is one module of WebAssembly that imports
//! nothing. `package/src/planner.js` calls it, `package/src/program.js` runs what it says.
//!
//! A call is a request as JSON (`ask.rs`), its response JSON and bytes (`response.rs`); `exports.rs` moves both.

mod ask;
mod catalogue;
mod exports;
mod look;
mod plans;
mod response;

pub use plans::Planner;
pub use response::Response;
