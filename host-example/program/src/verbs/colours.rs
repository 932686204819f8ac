//! `isophote colours`: the colours of a picture or of a palette, to be kept and edited.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::shared::{ForceArgs, QuietArgs, warn_of};
use isophote_files::error::Result;
use isophote_files::files;
use isophote_files::output;
use isophote_files::replacing::{Inputs, Made};
use isophote_pictures::palette::{self, MOST, Wanted, hex};

/// Options of `colours`.
#[derive(Args, Debug)]
#[command(
    after_help = "What it writes is for --palette: `isophote apply palette photo.jpg --palette colours.gpl`."
)]
pub struct ColoursArgs {
    /// The picture or the palette: .gpl, .hex, .ase, .aco, .pal or .json.
    #[arg(value_hint = ValueHint::FilePath)]
    file: PathBuf,
    /// A palette with the colours: .gpl, .hex or .json.
    #[arg(value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,
    /// Number of colours [default: all of a palette or of a picture of few colours, else 8].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=64))]
    count: Option<u16>,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    quiet: QuietArgs,
}

/// Runs the verb.
///
/// # Errors
/// As [`palette::read`] and [`palette::write`].
pub fn run(args: &ColoursArgs) -> Result<()> {
    if let Some(to) = &args.output {
        palette::extension(to)?;
        let made = Made { from: Some(&args.file), to };
        args.force.consent().check(&[made], false, || Ok(Inputs::of([&args.file])))?;
        files::check_writable(to, args.force.existing())?;
    }
    let palette = palette::read(&args.file, Wanted { count: args.count.map(usize::from), most: MOST })?;
    warn_of(&args.file, &palette.notes);
    if let Some(to) = &args.output {
        palette::write(to, args.force.existing(), &palette)?;
    }
    if args.quiet.quiet {
        return Ok(());
    }
    output::print(&palette.colours.iter().map(|colour| format!("{}\n", hex(*colour))).collect::<String>())
}
