//! `isophote info`: what is understood of a file.

use std::path::PathBuf;

use clap::Args;

use crate::info;
use isophote_files::error::Result;
use isophote_files::output;

/// Options of `info`.
#[derive(Args, Debug)]
#[command(
    after_help = "A picture, a frame or sequence (shot.####.exr), a video, a scene (.gltf, .glb, .obj), a preset or a graph (.json)."
)]
pub struct InfoArgs {
    /// The file.
    pub file: PathBuf,
    /// Prints JSON, whose names stay the same.
    #[arg(long)]
    pub json: bool,
}

/// Runs the verb.
///
/// # Errors
/// As [`info::of`].
pub fn run(args: &InfoArgs) -> Result<()> {
    let facts = info::of(&args.file)?;
    output::print(&if args.json { facts.json()? } else { facts.text() })
}
