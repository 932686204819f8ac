//! `cargo xtask header`: writes `include/isophote.h` from the Rust declarations.
//!
//! The header is committed, so that nobody needs this tool to use the library; `--check` compares
//! instead of writing, and fails when the two have drifted apart.

use crate::error::Result;
use crate::tools::{build, program, run as run_command};

/// Options of `cargo xtask header`.
#[derive(clap::Args)]
pub struct Options {
    /// Compare with the committed header instead of writing it
    #[arg(long)]
    pub check: bool,
}

/// Writes or checks the header.
///
/// # Errors
/// When the header cannot be made or, checking, is stale.
pub fn run(options: &Options) -> Result<()> {
    build("debug", &["isophote-header"])?;
    run_command(program("isophote-header", "debug").args(options.check.then_some("--check")))
}
