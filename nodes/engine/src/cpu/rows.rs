//! Pictures that enter and leave a run by rows, so that none of them is in memory as a whole.

use crate::error::Result;
use crate::image::{Image, Rect};
use std::ops::Range;

/// Pictures that a run on the CPU reads and makes by rows ([`CpuExecutor::run_rows`](super::CpuExecutor::run_rows)). Each row is
/// asked for once, from the top to the bottom, and each part of a result handed on once.
pub trait Rows {
    /// Fills `rows` of `image` with those of the input of this name. The image holds the columns that
    /// [`Plan::windows`](crate::Plan::windows) names, and maybe other rows, which must stay.
    ///
    /// # Errors
    /// End the run.
    fn read(&mut self, name: &str, rows: Range<i32>, image: &mut Image) -> Result<()>;

    /// Takes `part` of `image`, which belongs to the result of this number ([`Plan::outputs`](crate::Plan::outputs)).
    ///
    /// # Errors
    /// End the run.
    fn write(&mut self, output: usize, part: Rect, image: &Image) -> Result<()>;
}
