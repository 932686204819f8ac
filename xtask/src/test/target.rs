//! `cargo xtask test --target`: what a whole run of the tests leaves out, as together it takes longer than that: the browser,
//! packages and documentation, other machines than this one, emulated, and what can be said of systems that are not there.

use crate::error::{Failure, Result};
use clap::ValueEnum;

mod aarch64;
mod bevy;
mod check;
mod godot;
mod packages;
mod running;
mod web;
#[cfg(unix)]
mod windows;

pub use packages::FILES as PACKED;

/// Parts of the tests that run by themselves.
#[derive(Clone, Copy, ValueEnum)]
pub enum Target {
    /// The page and the package for browsers, in a browser
    Web,
    /// What users install, unpacked and used; and the documentation, all of its commands run
    Packages,
    /// 64-bit ARM with Linux, in QEMU
    Aarch64,
    /// Windows, in Wine
    #[cfg(unix)]
    Windows,
    /// Cameras of Bevy, stylized by its plugin
    Bevy,
    /// Viewports of Godot, stylized by its extension; Godot 4.4 or newer must be there
    Godot,
    /// Only types: the library, the plugin and the program for macOS on ARM and for Windows by Microsoft's compiler
    Check,
}

/// Runs the tests of a target whose names contain the filter; without one all.
///
/// # Errors
/// Things that are missing, and the programs that fail.
pub fn run(target: Target, filter: Option<&str>) -> Result<()> {
    match target {
        Target::Web => web::run(filter),
        Target::Packages => packages::run(filter),
        Target::Aarch64 => aarch64::run(filter),
        #[cfg(unix)]
        Target::Windows => windows::run(filter),
        Target::Bevy => bevy::run(filter),
        Target::Godot => godot::run(),
        Target::Check => check::run(),
    }
}

/// Runs the tests of every target.
///
/// # Errors
/// The targets that fail, each with its reason.
pub fn run_all() -> Result<()> {
    let failed = Target::value_variants().iter().filter_map(|target| {
        let name = target.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
        println!("\n=== {name}");
        if matches!(target, Target::Godot) && godot::program().is_none() {
            println!("left out: Godot is not there");
            return None;
        }
        run(*target, None).err().map(|why| format!("{name}: {why}"))
    });
    let failed: Vec<String> = failed.collect();
    if failed.is_empty() { Ok(()) } else { Err(Failure(failed.join("; "))) }
}
