//! `isophote apply`: a node or graph on a picture, without any scene.

mod convert;
mod exr_file;
mod jpeg;
mod read;
mod write;

use indicatif::{ProgressBar, ProgressStyle};

use self::read::{Family, Source};
use crate::cli::{ApplyArgs, Backend, Space};
use crate::error::Result;
use crate::loader::catalogue::Kind;
use crate::loader::contract::{
    ISOPHOTE_ALPHA_PREMULTIPLIED, ISOPHOTE_ALPHA_STRAIGHT, ISOPHOTE_NO_DEVICE, ISOPHOTE_SPACE_ACESCG,
    ISOPHOTE_SPACE_LINEAR, ISOPHOTE_SPACE_SRGB, IsophoteRequest,
};
use crate::loader::{Control, Device, Input, Library};
use crate::pixels::{Pixels, Precision};
use crate::stylize::style::Style;

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for bad input before anything is computed,
/// [`Error::Failure`](crate::error::Error::Failure) when the library or the device
/// fails. The output is written as a whole or not at all.
pub fn run(args: &ApplyArgs) -> Result<()> {
    let format = write::Format::of(&args.output)?;
    let library = Library::open()?;
    let Style { mut graph, kind, .. } = Style::load(&library, &args.style, &args.set)?;
    let source = read::read(&args.input)?;
    crate::output::check_writable(&args.output)?;
    let space = args.space.unwrap_or(match source.family {
        Family::Display => Space::Srgb,
        Family::Light => Space::Linear,
    });
    let device = device(&library, args.backend)?;
    let request = request(&library, args, &source, space)?;
    let mut result = target(&source, kind, format.family());
    let bar = progress_bar();
    let mut progress = |done: f32| bar.set_position((done * 1000.0) as u64);
    let mut control = Control { threads: args.threads, progress: Some(&mut progress), measured: None };
    let inputs = [Input { name: "color", pixels: &source.pixels }];
    let report = graph
        .process(device.as_ref(), &request, &inputs, &mut result, &mut control)
        .map_err(|e| e.at(args.input.display(), "choose another picture or style"))?;
    bar.finish_and_clear();
    if report.mended > 0 {
        eprintln!(
            "warning: {}: {} samples were NaN or infinite and were replaced",
            args.input.display(),
            report.mended
        );
    }
    let result = if kind == Kind::Color {
        convert::between(result, source.family, space, format.family())
    } else {
        result
    };
    write::write(&args.output, format, result, source)
}

/// The library's own device, or nothing for the CPU.
fn device(library: &Library, backend: Backend) -> Result<Option<Device>> {
    let place = "--backend";
    match backend {
        Backend::Cpu => Ok(None),
        Backend::Gpu => library.device(None).map(Some).map_err(|e| e.at(place, "use --backend cpu")),
        // A driver that computes on the CPU is slower there than the library itself.
        Backend::Auto => match library.device(Some("gpu")) {
            Ok(device) => Ok(Some(device)),
            Err(refused) if refused.status == ISOPHOTE_NO_DEVICE => Ok(None),
            Err(refused) => Err(refused.at(place, "use --backend cpu")),
        },
    }
}

fn request(library: &Library, args: &ApplyArgs, source: &Source, space: Space) -> Result<IsophoteRequest> {
    let size = (source.pixels.width(), source.pixels.height());
    let request = library.request(size).map_err(|e| e.at(args.input.display(), "use a smaller picture"))?;
    Ok(IsophoteRequest {
        space: match space {
            Space::Srgb => ISOPHOTE_SPACE_SRGB,
            Space::Linear => ISOPHOTE_SPACE_LINEAR,
            Space::Acescg => ISOPHOTE_SPACE_ACESCG,
        },
        alpha: match source.family {
            Family::Display => ISOPHOTE_ALPHA_STRAIGHT,
            Family::Light => ISOPHOTE_ALPHA_PREMULTIPLIED,
        },
        ..request
    })
}

/// Where the result goes: as precise as the source, or in floats when it is still to be converted.
fn target(source: &Source, kind: Kind, family: Family) -> Pixels {
    let pixels = &source.pixels;
    let channels = match kind {
        Kind::Color => pixels.channels().max(3),
        _ => 1,
    };
    let precision = if family == source.family { pixels.precision() } else { Precision::F32 };
    Pixels::zeroed(pixels.width(), pixels.height(), channels, precision)
}

/// A bar on standard error; none where no terminal listens.
fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent} %") {
        bar.set_style(style);
    }
    bar
}
