//! `isophote apply`: a node or graph on a picture, without any scene.

mod convert;
mod exr;
mod frame;
mod jpeg;
mod primaries;
mod read;
pub mod sheet;
mod write;

pub use self::exr::GuideChoice;

use indicatif::{ProgressBar, ProgressStyle};

use self::exr::Selection;
use self::frame::Filter;
use self::write::Format;
use crate::cli::ApplyArgs;
use crate::error::{Error, Result};
use crate::loader::Library;
use crate::stylize::style::Style;

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for bad input before anything is computed, [`Error::Failure`] when the library or the device
/// fails. The output is written as a whole or not at all.
pub fn run(args: &ApplyArgs) -> Result<()> {
    let format = Format::of(&args.output)?;
    let library = Library::open()?;
    let style = Style::load(&library, &args.style, &args.set)?;
    let selection = selection(args, &style, format)?;
    let source = read::read(&args.input, &selection)?;
    crate::output::check_writable(&args.output)?;
    let mut filter = Filter::new(library, style, args.backend, args.space, args.threads)?;
    let bar = progress_bar();
    let mut progress = |done: f32| bar.set_position((done * 1000.0) as u64);
    let name = args.input.display().to_string();
    let filtered = filter.run(&name, &source, format, &mut progress)?;
    bar.finish_and_clear();
    if filtered.mended > 0 {
        eprintln!("warning: {name}: {} samples were NaN or infinite and were replaced", filtered.mended);
    }
    write::write(&args.output, format, filtered.results, source)
}

/// What is read of EXR files.
fn selection(args: &ApplyArgs, style: &Style, format: Format) -> Result<Selection> {
    if args.into.is_some() && format != Format::Exr {
        return Err(Error::input(
            "--into",
            "only EXR files hold several layers",
            "name a result that ends in .exr",
        ));
    }
    if let Some(bad) = args.into.as_deref().filter(|name| {
        name.is_empty() || name.split('.').any(str::is_empty) || name.contains(char::is_control)
    }) {
        return Err(Error::input(
            "--into",
            format!("'{}' is no name of a layer", bad.escape_default()),
            "name a layer such as cartoon",
        ));
    }
    Ok(Selection {
        layer: args.layer.clone(),
        view: args.view.clone(),
        alpha: args.alpha.clone(),
        into: args.into.clone(),
        guides: args.guide.clone(),
        wanted: frame::usable_guides(style)?,
    })
}

/// A bar on standard error; none where no terminal listens.
fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent} %") {
        bar.set_style(style);
    }
    bar
}
