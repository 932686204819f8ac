//! Declarations of nodes: their ports and parameters, the types of values and choices, and the scope in which a node
//! describes its passes.

pub mod choice;
pub(crate) mod direction;
pub mod param;
pub(crate) mod ports;
pub mod spec;
pub(crate) mod time;
pub mod value;
