//! Work on previews: the thread that makes them, and how one is made.

pub mod queue;
pub mod render;
