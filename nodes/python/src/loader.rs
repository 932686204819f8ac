//! Safe types over the library's table.
//!
//! What hosts share is the sample host's own, taken as it is; what images are differs: here they are arrays of NumPy.

#[path = "../../../host-example/src/loader/catalogue.rs"]
pub mod catalogue;
#[path = "../../../include/rust/mod.rs"]
pub mod contract;
#[path = "../../../host-example/src/loader/device.rs"]
pub mod device;
#[path = "../../../host-example/src/loader/graph.rs"]
pub mod graph;
#[path = "../../../host-example/src/loader/library.rs"]
mod library;
#[path = "../../../host-example/src/loader/open.rs"]
mod open;
mod process;
mod refusal;
mod sequence;
#[path = "../../../host-example/src/loader/text.rs"]
mod text;

pub use catalogue::Catalogue;
pub use device::Device;
pub use graph::Graph;
pub use library::Library;
pub use process::{Call, DeviceHandle, GraphHandle, Input, Report};
pub use refusal::{Answer, Refusal};
pub use sequence::{Footage, Sequence};
