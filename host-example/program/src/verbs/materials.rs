//! `isophote materials`: the papers and hatchings that ship, by name and as files.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use super::shared::{ForceArgs, QuietArgs};
use isophote_files::error::Result;
use isophote_files::{files, output};
use isophote_pictures::material::{Material, MaterialKind, Shipped};
use isophote_pictures::read::Source;
use isophote_pictures::write::{self, Format, Options};

/// Options of `materials`.
#[derive(Args, Debug)]
#[command(
    after_help = "`isophote apply watercolor photo.jpg --paper cold_press` takes them by name. Files are for other programs, and to \
                  be painted over: `--paper sheet.png` takes a picture of any size."
)]
pub struct MaterialsArgs {
    /// A folder to write all of them to, as PNG files that can be tiled.
    #[arg(value_hint = ValueHint::DirPath)]
    folder: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    quiet: QuietArgs,
}

/// Runs the verb.
///
/// # Errors
/// As [`write::write`], and for files that are there already.
pub fn run(args: &MaterialsArgs) -> Result<()> {
    if let Some(folder) = &args.folder {
        write_all(args, folder)?;
    }
    if args.quiet.quiet {
        return Ok(());
    }
    let of_kind = |kind: MaterialKind| {
        let line = |shipped: &Shipped| format!("  {:<12} {}\n", shipped.name, shipped.doc);
        format!("--{}\n{}", kind.guide().id(), kind.shipped().iter().map(line).collect::<String>())
    };
    output::print(&MaterialKind::ALL.map(of_kind).concat())
}

/// Writes all of them, each as a file of its name.
fn write_all(args: &MaterialsArgs, folder: &Path) -> Result<()> {
    let existing = args.force.existing();
    let path = |kind: MaterialKind, shipped: &Shipped| {
        folder.join(format!("{}_{}.png", kind.guide().id(), shipped.name))
    };
    let all = || {
        MaterialKind::ALL
            .into_iter()
            .flat_map(|kind| kind.shipped().iter().map(move |shipped| (kind, shipped)))
    };
    fs::create_dir_all(folder).map_err(|e| files::unwritable(folder, Some(e.kind()), e))?;
    for (kind, shipped) in all() {
        files::check_writable(&path(kind, shipped), existing)?;
    }
    for (kind, shipped) in all() {
        let material = Material::of(kind, shipped);
        let (pixels, meaning) = (material.pixels().clone(), material.meaning());
        let source = Source::alone(pixels.clone(), meaning.clone());
        let format = (Format::Png, Options::default());
        write::write(&path(kind, shipped), existing, format, vec![pixels], meaning, &source, None)?;
    }
    Ok(())
}
