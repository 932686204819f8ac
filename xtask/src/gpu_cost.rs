//! `cargo xtask gpu-cost`: what the shaders cost on a graphics card that need not be there.
//!
//! The driver is RADV, from the same Debian package as the software rasteriser that tests run on. It is told to compile
//! for a card of one family without looking for any.

use crate::error::{Failure, Result};
use crate::setup::{VULKAN, ensure};
use crate::tools::{build, program, run as run_command};
use std::path::PathBuf;

/// Options of `cargo xtask gpu-cost`.
#[derive(clap::Args)]
pub struct Options {
    /// Compare with the committed table instead of writing it; pass where another driver is installed
    #[arg(long, conflicts_with = "kernel")]
    pub check: bool,

    /// Print the machine code of this kernel instead
    pub kernel: Option<String>,
}

/// The family of cards: RDNA 2, of which there are many.
const FAMILY: &str = "navi21";

/// Writes, checks or shows the costs.
///
/// # Errors
/// When they cannot be found out or, checking, are higher than the table says.
pub fn run(options: &Options) -> Result<()> {
    if !options.check {
        ensure(&[&VULKAN])?;
    }
    let Some(manifest) = manifest() else {
        let lacks = "this machine lacks Mesa's driver for AMD cards";
        if options.check {
            println!("costs of shaders are not compared: {lacks}");
            return Ok(());
        }
        return Err(Failure(format!("{lacks}; on Debian, run as root: apt-get install mesa-vulkan-drivers")));
    };
    build("debug", &["isophote-gpu-cost"])?;
    let mut command = program("isophote-gpu-cost", "debug");
    // The two names of one variable, of newer and of older loaders.
    command
        .env("VK_DRIVER_FILES", &manifest)
        .env("VK_ICD_FILENAMES", &manifest)
        .env("RADV_FORCE_FAMILY", FAMILY)
        .args(options.check.then_some("--check"))
        .args(options.kernel.as_deref());
    run_command(&mut command)
}

/// The driver's entry in the list of drivers, where Debian and its relatives have it.
fn manifest() -> Option<PathBuf> {
    let arch = std::env::consts::ARCH;
    let path = PathBuf::from(format!("/usr/share/vulkan/icd.d/radeon_icd.{arch}.json"));
    path.exists().then_some(path)
}
