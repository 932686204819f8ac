//! The project's chores, `cargo xtask <chore>`: one module for each.

mod error;
mod header;
mod scene;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// The project's chores.
#[derive(Parser)]
#[command(name = "xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Writes include/isophote.h from the Rust declarations
    Header(header::Options),
    /// Writes the demo scene (glTF) and the house (OBJ)
    Scene(scene::Options),
}

fn main() -> ExitCode {
    // Clap itself ends wrong usage with code 2.
    let outcome = match Cli::parse().chore {
        Chore::Header(options) => header::run(&options),
        Chore::Scene(options) => scene::run(&options),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("xtask: {failure}");
            ExitCode::FAILURE
        }
    }
}
