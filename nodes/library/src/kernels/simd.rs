//! How pixels, rows, lines and tiles are read and written fast by the CPU twins.

pub mod line_buffer;
pub mod line_taps;
pub mod moment_buffer;
pub mod neighbours;
pub mod pixels;
pub mod tile_copy;
pub mod upsampling;
pub mod window_sum;
