//! Backend that a graph runs on.

use clap::ValueEnum;

use super::card::Card;
use isophote_files::error::{AtPlace, Result};
use isophote_loader::abi::ISOPHOTE_ERROR_NO_DEVICE;
use isophote_loader::{Device, Library};

/// Backend that a graph runs on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// A graphics card if there is one, otherwise the CPU.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// The best graphics device there is, software drivers included.
    Gpu,
}

impl Backend {
    /// True where a program that has a graphics device anyway shall compute styles on the CPU instead; `is_software` says that
    /// the device's driver computes there itself, and more slowly than the library.
    pub const fn is_cpu(self, is_software: bool) -> bool {
        match self {
            Self::Auto => is_software,
            Self::Cpu => true,
            Self::Gpu => false,
        }
    }

    /// The library's own device, or the CPU.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when there is no such device.
    pub fn card(self, library: &Library) -> Result<Card<Device>> {
        let place = "--backend";
        let device = match self {
            Self::Cpu => None,
            Self::Gpu => Some(library.device(None).map_err(|e| e.at(place, "use --backend cpu"))?),
            // A driver that computes on the CPU is slower there than the library itself.
            Self::Auto => match library.device(Some("gpu")) {
                Ok(device) => Some(device),
                Err(refused) if refused.status() == Some(ISOPHOTE_ERROR_NO_DEVICE) => None,
                Err(refused) => return Err(refused.at(place, "use --backend cpu")),
            },
        };
        Ok(Card::new(device, self == Self::Gpu))
    }
}
