//! Fast ways in which the CPU twins read and write pixels, rows, lines and tiles. None of this has a
//! counterpart in a shader.
//!
//! The one that a kernel wants follows from what it reads for a pixel:
//!
//! * the pixel alone, or single others: [`pixels`];
//! * its eight neighbours: [`neighbours`], or [`around`] where no coverage counts;
//! * rows and columns around it: [`line_buffer`], or [`moment_buffer`] with squares of the colours;
//! * a row or a column, with symmetric weights: [`window_sum`];
//! * a straight line through it: [`line_taps`];
//! * a curved line through it: [`trace`](super::trace), over a [`tile_copy`](super::trace::tile_copy);
//! * a pixel of another frame, where motion leads: [`carrying`];
//! * the pixel of a coarser pyramid level: [`upsampling`];
//! * those of a finer one: [`children`].

pub mod around;
pub mod carrying;
pub mod children;
pub mod line_buffer;
pub mod line_taps;
pub mod moment_buffer;
pub mod neighbours;
pub mod pixels;
pub mod upsampling;
pub mod window_sum;
