//! `isophote sheet`: pictures side by side with their names under them.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use super::shared::{ForceArgs, QuietArgs};
use isophote_files::error::{Error, Result};
use isophote_files::files;
use isophote_files::limits;
use isophote_files::output;
use isophote_files::replacing::{Inputs, Made};
use isophote_finishing::sheet;

/// Options of `sheet`.
#[derive(Args, Debug)]
#[command(after_help = "Scene-linear pictures are encoded for sRGB; values above 1 are clipped.")]
pub struct SheetArgs {
    /// The contact sheet: .png.
    sheet: PathBuf,
    /// The pictures, from left to right and from top to bottom; of multi-view EXR files all views.
    #[arg(required = true)]
    pictures: Vec<PathBuf>,
    /// Pictures in a row [default: up to 4].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    columns: Option<u32>,
    /// Width of each picture in pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = 640, value_parser = clap::value_parser!(u32).range(16..=8192))]
    width: u32,
    /// Label of a picture instead of its name. May be repeated, in the order of the pictures.
    #[arg(long, value_name = "TEXT")]
    label: Vec<String>,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    quiet: QuietArgs,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for pictures that cannot be read, and sheets that are too large or cannot be written.
pub fn run(args: &SheetArgs) -> Result<()> {
    if !args.sheet.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return Err(Error::file(&args.sheet, "is not a kind of sheet that is written", "name a .png file"));
    }
    if args.label.len() > args.pictures.len() {
        let problem = format!("{} labels for {} pictures", args.label.len(), args.pictures.len());
        return Err(Error::input("--label", problem, "give one for each picture, in their order"));
    }
    let made = Made { from: None, to: &args.sheet };
    args.force.consent().check(&[made], false, || Ok(Inputs::of(&args.pictures)))?;
    let (existing, started) = (args.force.existing(), Instant::now());
    files::check_writable(&args.sheet, existing)?;
    limits::start_threads(0)?;
    let mut all = Vec::new();
    for (index, path) in args.pictures.iter().enumerate() {
        let label = args.label.get(index).cloned().unwrap_or_else(|| name(&args.pictures, path));
        all.extend(sheet::cells(path, &label, args.width)?);
    }
    // As many across as there are, up to four: before and after stand beside each other.
    let columns = args.columns.map_or(all.len().min(4), |columns| columns as usize);
    sheet::save(&args.sheet, existing, &all, columns, args.width)?;
    if args.quiet.quiet {
        return Ok(());
    }
    let (count, seconds) = (all.len(), started.elapsed().as_secs_f64());
    let pictures = if count == 1 { "picture" } else { "pictures" };
    output::print(&format!("{}: {count} {pictures}, {seconds:.1} s\n", args.sheet.display()))
}

/// The name of a file, with its folder where others have the same.
fn name(all: &[PathBuf], path: &Path) -> String {
    let alike = all.iter().filter(|other| other.file_name() == path.file_name()).count();
    let name = path.file_name().filter(|_| alike == 1).map_or(path.as_os_str(), |name| name);
    name.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_tell_files_of_one_name_apart() {
        let all = ["in/a.exr", "out/a.exr", "b.exr"].map(PathBuf::from);
        assert_eq!(all.each_ref().map(|path| name(&all, path)), ["in/a.exr", "out/a.exr", "b.exr"]);
    }
}
