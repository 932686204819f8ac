//! What users install, and the documentation: archives, wheel and extension as they are packed, and the site with every command
//! that stands on it.

use super::running::run_programs;
use crate::error::Result;
use crate::setup::{self, C_COMPILER, PACKAGING, VULKAN};
use crate::test::programs;
use crate::tools::{cargo, cargo_command, heading, library_file};

/// Its files of tests, which say by themselves what else they need.
pub const FILES: [&str; 2] = ["dist", "docs"];

/// Runs those of its tests whose names contain the filter; without one all.
///
/// # Errors
/// Things that are missing, and the programs that fail.
pub fn run(filter: Option<&str>) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &VULKAN, &PACKAGING])?;
    heading("build");
    cargo(&["build", "--workspace", "--quiet"])?;
    let programs = programs::build(cargo_command(&["test", "--workspace", "--test", "tests"]))?;
    run_programs(programs, &FILES, filter, &[], |command| {
        command.env("ISOPHOTE_LIBRARY", library_file("debug")).env("ISOPHOTE_REQUIRE_GPU", "1");
    })
}
