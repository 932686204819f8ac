//! `cargo xtask gallery`: every node on pictures, as a page to look at.

use crate::error::Result;
use crate::scene;
use crate::setup::{self, VULKAN};
use crate::tools::{build_with_host, heading, host, program, run as run_command, target_dir};

/// The package that makes the page.
const PACKAGE: &str = "isophote-gallery";

/// Options of `cargo xtask gallery`: those of the program that makes the page.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct Options {
    /// --help lists what may be chosen
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<String>,
}

/// Builds the host, the library and the program, and makes the page.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&VULKAN])?;
    heading("build");
    build_with_host("debug", &[scene::PACKAGE, PACKAGE])?;
    let scene = scene::write(&target_dir("scene"))?;
    let mut gallery = program(PACKAGE, "debug");
    gallery.arg("--host").arg(host("debug").get_program()).arg("--scene").arg(scene);
    run_command(gallery.args(&options.arguments))
}
