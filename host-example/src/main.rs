//! The sample host: renders glTF and OBJ scenes with wgpu.

use std::process::ExitCode;

use clap::Parser;
use isophote_host::cli::{Cli, Command};
use isophote_host::render_verb;

fn main() -> ExitCode {
    // The parser itself ends the program with 2 for bad usage.
    let result = match Cli::parse().command {
        Command::Render(args) => render_verb::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
