//! `cargo xtask gallery`: every node on pictures, as a page to look at.

use crate::error::Result;
use crate::scene;
use crate::setup::{self, VULKAN};
use crate::tools::{HandedOn, build_with_host, heading, host, program, run as run_command, target_dir};

/// The package that makes the page.
const PACKAGE: &str = "isophote-gallery";

/// Builds the host, the library and the program, and makes the page.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &HandedOn) -> Result<()> {
    setup::ensure(&[&VULKAN])?;
    heading("build");
    build_with_host("debug", &[scene::PACKAGE, PACKAGE])?;
    let scene = scene::write(&target_dir("scene"))?;
    let mut gallery = program(PACKAGE, "debug");
    gallery.arg("--host").arg(host("debug").get_program()).arg("--scene").arg(scene);
    run_command(gallery.args(&options.arguments))
}
