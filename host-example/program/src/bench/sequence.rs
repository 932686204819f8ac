//! A sequence of frames from file to file, against filtering alone.

use super::Subject;
use super::throughput::{Throughput, measure};
use isophote_files::error::{Error, Result};
use isophote_files::output;
use isophote_finishing::apply::backend::Backend;
use isophote_finishing::apply::filter::{Filter, MaskedStyle};
use isophote_finishing::apply::memory::{self, Bytes};
use isophote_finishing::apply::planner::Planner;
use isophote_finishing::stylize::preset::Lengths;
use isophote_finishing::stylize::style::Style;
use isophote_loader::Library;
use isophote_pictures::pixels::Pixels;

/// Measures every subject on so many frames that show `picture`, and prints what came out.
///
/// # Errors
/// For styles that do not fit, and when there is no room for the files.
pub fn run(subjects: &[Subject], picture: &Pixels, frames: u32, json: bool) -> Result<()> {
    let mut results = Vec::with_capacity(subjects.len());
    for subject in subjects {
        let library = Library::open()?;
        let looks = || {
            let mut style = Style::load(&library, &subject.node, &subject.settings)?;
            // As in the other tables.
            style.lengths = Lengths::Pixels;
            Ok::<_, Error>(vec![MaskedStyle::whole(style)])
        };
        let planner = Planner::new(library.clone(), looks()?)?;
        let mut filter = Filter::new(library.clone(), looks()?, Backend::Cpu, None, 0)?;
        let result = measure(std::slice::from_mut(&mut filter), planner, picture, frames, memory::usual().0)?;
        if !json {
            output::print(&text(subject, picture, &result))?;
        }
        results.push(serde_json::json!({ "node": subject.label, "sequence": result }));
    }
    if json {
        let text = serde_json::to_string_pretty(&results)
            .map_err(|e| Error::failure(e, "this is a mistake in the program; please report it"))?;
        output::print(&format!("{text}\n"))?;
    }
    Ok(())
}

fn text(subject: &Subject, picture: &Pixels, result: &Throughput) -> String {
    let frames = f64::from(result.frames);
    let memory = result.peak_bytes.map_or(String::new(), |peak| {
        format!("most memory            {} of {}\n", Bytes(peak), Bytes(result.bound_bytes))
    });
    format!(
        "{}: {} frames of {}x{}, half floats, ZIP\nfiltering alone        {:.3} s a frame\nfrom file to file      {:.3} s a frame, x{:.2}\n{memory}",
        subject.label,
        result.frames,
        picture.width(),
        picture.height(),
        result.filter_seconds / frames,
        result.seconds / frames,
        result.seconds / result.filter_seconds,
    )
}
