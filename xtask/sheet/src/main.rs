//! Contact sheet of the demo: the program's own, without compiling the rest of it.

#![forbid(unsafe_code)]

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use isophote_files::error::Result;
use isophote_files::files::Existing;
use isophote_files::output;
use isophote_finishing::sheet;

/// Puts pictures side by side on a contact sheet, with the names of their files.
#[derive(Debug, Parser)]
struct Options {
    /// The contact sheet: .png.
    sheet: PathBuf,
    /// The pictures, from left to right and from top to bottom.
    #[arg(required = true)]
    pictures: Vec<PathBuf>,
    /// Pictures in a row.
    #[arg(long)]
    columns: usize,
    /// Width of each picture in pixels.
    #[arg(long)]
    width: u32,
}

fn run(options: &Options) -> Result<()> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut all = Vec::new();
    for path in &options.pictures {
        all.extend(sheet::cells(path, &name(path), options.width)?);
    }
    sheet::save(&options.sheet, Existing::Replace, &all, options.columns, options.width)
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::complain(&error);
            ExitCode::from(error.exit_code())
        }
    }
}
