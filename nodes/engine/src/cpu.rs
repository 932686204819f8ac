//! The CPU executor: bands of rows in parallel, SIMD as the machine has it, exact tiles.
//!
//! Every output pixel is computed by the same arithmetic wherever its tile begins and whichever
//! thread takes its band, so a tile equals the same tile cut from the full frame bit for bit.

mod bands;
mod control;
mod executor;
mod images;
mod rows;
mod strips;
mod threads;

pub use control::{Control, PassTime};
pub use executor::CpuExecutor;
#[cfg(feature = "gpu")]
pub(crate) use images::bind_inputs;
pub use rows::Rows;
pub use threads::{CallingThread, Pool, Threads};
