//! Browsers.

use crate::error::Result;
use crate::packing;
use crate::setup::{self, C_COMPILER, VULKAN};
use crate::tools::{build_with_host, heading};
use crate::web;

/// Runs the tests in a browser whose names contain the filter; without one all.
///
/// # Errors
/// Things that are missing, and the first file of tests that fails.
pub fn run(filter: Option<&str>) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &VULKAN])?;
    heading("build");
    build_with_host("debug", &[packing::PACKAGE])?;
    web::test(filter)
}
