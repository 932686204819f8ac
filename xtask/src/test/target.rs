//! `cargo xtask test --target`: the tests on other machines than this one, emulated, and what can be said of systems that are
//! not there.

use crate::error::Result;

mod aarch64;
mod check;
mod running;
#[cfg(unix)]
mod windows;

/// Machines other than this one.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum Target {
    /// 64-bit ARM with Linux, in QEMU
    Aarch64,
    /// Windows, in Wine
    #[cfg(unix)]
    Windows,
    /// Only types: the library, the plugin and the program for macOS on ARM and for Windows by Microsoft's compiler
    Check,
}

/// Runs the tests of a target whose names contain the filter; without one all.
///
/// # Errors
/// Things that are missing, and the programs that fail.
pub fn run(target: Target, filter: Option<&str>) -> Result<()> {
    match target {
        Target::Aarch64 => aarch64::run(filter),
        #[cfg(unix)]
        Target::Windows => windows::run(filter),
        Target::Check => check::run(),
    }
}
