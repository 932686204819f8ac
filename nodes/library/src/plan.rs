//! Plans of graphs: the request for a picture, the plan that answers it, its program for one region, and sequences of
//! frames.

mod describe;
pub mod lowered;
pub mod planned;
pub mod request;
pub mod sequence;
