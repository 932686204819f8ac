//! `cargo xtask bench`: the host's benchmark, built for speed.

use crate::error::Result;
use crate::tools::{build_with_host, host, run as run_command};

/// Options of `cargo xtask bench`.
#[derive(clap::Args)]
pub struct Options {
    /// Handed on to `isophote bench`, such as --backend cpu --size 1920x1080 --node cartoon --compare before.json;
    /// `cargo xtask bench -- --help` shows all of them
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<String>,
}

/// Builds the host and the library in the release profile and runs the benchmark.
///
/// # Errors
/// When the build or the benchmark fails.
pub fn run(options: &Options) -> Result<()> {
    build_with_host("release", &[])?;
    run_command(host("release").arg("bench").args(&options.arguments))
}
