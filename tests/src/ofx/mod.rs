//! A small OpenFX host: strict where the standard is strict, and able to behave like hosts that are not.
//!
//! It records what a plugin does against the standard ([`Host::no_faults`](host::Host::no_faults)) instead
//! of repairing it, and can refuse properties, lend images of any layout, leave functions out and free
//! strings early.

#![allow(unsafe_code, reason = "a host calls foreign code and is called by it")]

mod edits;
pub mod effect;
mod handles;
pub mod host;
pub mod objects;
pub mod picture;
pub mod plugin;
pub mod properties;
mod shapes;
pub mod state;
pub mod suites;
mod threads;
