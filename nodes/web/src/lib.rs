//! The planner of the browser.
//!
//! A page has a graphics device of its own, WebGPU's. This crate says what a look comes to on it: textures, dispatches,
//! uniform bytes and shaders. It runs nothing, holds no kernel's CPU function, and is one module of WebAssembly that imports
//! nothing. `package/src/planner.js` calls it, `package/src/program.js` runs what it says.
//!
//! With the feature `cpu` it is a second, larger module, which computes parts of pictures by itself: for pages without a
//! device, which load it when they need it (`package/src/processor.js`).
//!
//! A call is a request as JSON (`ask.rs`), its response JSON and bytes (`response.rs`); `exports.rs` moves both.

mod ask;
mod catalogue;
mod exports;
mod look;
mod parts;
mod plans;
#[cfg(feature = "cpu")]
mod processor;
mod response;

pub use plans::Planner;
pub use response::Response;
