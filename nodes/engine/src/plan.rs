//! A plan: what to run, not how.
//!
//! Nodes describe passes over virtual images; equal passes are recorded once, so that two nodes
//! which need the same structure tensor share it without knowing of each other. Everything that
//! both executors must agree on is decided here, once.

mod builder;
mod keys;
mod memory;
mod parts;
mod regions;
mod shared;

pub use builder::PlanBuilder;
pub use memory::{LEAST_ROWS, WORKING_MEMORY};
pub use parts::{Class, ImageDesc, ImageId, Kept, Lifetimes, Pass, Plan, Port, Support};
pub use shared::Shared;
