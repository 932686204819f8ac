//! `cargo xtask docs`: the documentation as a site, every command on it run.

use crate::error::Result;
use crate::packing;
use crate::python;
use crate::scene;
use crate::setup::{self, BLENDER, C_COMPILER, FFMPEG, PYTHON, VULKAN};
use crate::tools::{
    HandedOn, build, build_with_host, heading, host, program, run as run_command, target_dir,
};

/// The package that makes the site.
const PACKAGE: &str = "isophote-docs";

/// Builds the host, the library and the program, and makes the site.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &HandedOn) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &FFMPEG, &VULKAN, &PYTHON, &BLENDER])?;
    heading("build");
    build_with_host("debug", &[scene::PACKAGE, PACKAGE, packing::PACKAGE])?;
    let scene = scene::write(&target_dir("docs-scene"))?;
    let library = format!("{}isophote{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let documented = python::documented()?;
    heading("site");
    let mut docs = program(PACKAGE, "debug");
    docs.arg("--host").arg(host("debug").get_program()).arg("--scene").arg(scene);
    docs.arg("--library").arg(target_dir("debug").join(library));
    docs.arg("--packages").arg(documented.packages).arg("--wheels").arg(documented.wheels);
    if let Some(blender) = documented.blender {
        docs.arg("--blender").arg(blender);
    }
    run_command(docs.args(&options.arguments))
}

/// Checks the pages, and the links between them, without commands and pictures.
///
/// # Errors
/// What is wrong with them.
pub fn check() -> Result<()> {
    build("debug", &[PACKAGE])?;
    run_command(&mut program(PACKAGE, "debug"))
}
