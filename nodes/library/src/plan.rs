//! Plans of graphs: the request for a picture, the plan that answers it, its program for one region, live frames, and
//! sequences.

mod describe;
pub mod live;
pub mod lowered;
pub mod planned;
pub mod request;
pub mod sequence;
mod things;
