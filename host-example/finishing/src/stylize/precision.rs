//! Precision in which graphics devices compute.

use clap::ValueEnum;

use super::style::Style;
use isophote_files::error::{AtPlace, Result};
use isophote_loader::abi::{
    ISOPHOTE_PRECISION_EXACT, ISOPHOTE_PRECISION_FAST, ISOPHOTE_PRECISION_HALF, IsophotePrecision,
};

/// Precision in which graphics devices compute a style; the CPU always computes exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Precision {
    /// The same as the CPU.
    #[default]
    Exact,
    /// Colours in 16 bits: half the memory, and no difference that the eye sees.
    Half,
    /// As half, and faster still: the card itself blends colours between pixels.
    Fast,
}

impl Precision {
    /// The library's number for it.
    const fn number(self) -> IsophotePrecision {
        match self {
            Self::Exact => ISOPHOTE_PRECISION_EXACT,
            Self::Half => ISOPHOTE_PRECISION_HALF,
            Self::Fast => ISOPHOTE_PRECISION_FAST,
        }
    }

    /// As options have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Half => "half",
            Self::Fast => "fast",
        }
    }

    /// Lets graphics devices compute a style so.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when the library computes exactly alone.
    pub fn apply(self, style: &Style) -> Result<()> {
        if self == Self::Exact {
            return Ok(());
        }
        let set = style.graph.set_precision(self.number());
        set.map_err(|e| e.at("--precision", "use the library that comes with this program"))
    }
}
