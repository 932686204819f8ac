//! Rendering: the frame's plan, run over bands of rows that keep memory bounded.

use super::describe::{MASK, SOURCE, guide_clip};
use super::effects::Effect;
use super::faults;
use super::frame::{Bounds, Frame};
use super::host::{Host, Outcome, Properties};
use super::image::{Alpha, Beyond, Clip, Fetched};
use super::instance::{self, Moment, Prepared};
use super::interface::*;
use super::memory::LEAST_ROWS;
use super::settings::Settings;
use super::threads::FrameThreads;
use isophote::engine::cpu::{Control, CpuExecutor, Threads};
use isophote::engine::{Error as EngineError, Image, Rect};
use isophote::graph::GraphInput;
use isophote::kernels::shared::host_colour::has_light;
use isophote::kernels::shared::host_colour::scalar::beyond_coverage;
use isophote::request::Guides;
use isophote::{ColourSpace, Error};
use std::ffi::CStr;
use std::sync::Mutex;

/// One field of an interlaced picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Field {
    /// 0 for the rows 0, 2, 4, ..., 1 for the others; counted upwards.
    parity: i32,
}

/// Everything that one render action was given.
struct Job<'h> {
    host: &'h Host,
    instance: Handle,
    frame: Frame,
    settings: Settings,
    /// Whether the settings leave the picture as it is.
    identity: bool,
    source: Fetched<'h>,
    output: Fetched<'h>,
    mask: Option<Fetched<'h>>,
    guides: Vec<(GraphInput, Fetched<'h>)>,
    field: Option<Field>,
}

/// Renders the window that the arguments name.
///
/// # Errors
/// Failed without an output, image format for one of an unknown depth, and memory.
pub fn render(effect: &Effect, host: &Host, instance: Handle, in_args: Handle) -> Outcome {
    let args = host.set(in_args);
    let moment = Moment::of(args);
    let output = instance::output(host, instance)?.image(moment.time)?.ok_or(kOfxStatFailed)?;
    let window = args.ints::<4>(kOfxImageEffectPropRenderWindow).unwrap_or(output.bounds);
    let window = intersection(window, output.bounds);
    if window[0] >= window[2] || window[1] >= window[3] || host.aborted(instance) {
        return Ok(kOfxStatOK);
    }
    let clip = Clip::of(host, instance, SOURCE);
    let source = clip.map(|clip| clip.image(moment.time)).transpose()?.flatten();
    let (Some(clip), Some(source)) = (clip, source) else {
        return clear(host, &output, window).map(|()| kOfxStatOK);
    };
    let aspect = source.aspect.unwrap_or_else(|| clip.aspect());
    let mut settings = Settings::read(effect, host, instance, moment.time)?;
    let defined = instance::defined(host, instance, &clip, moment.time, &settings)?;
    let frame = Frame::new(host, defined, moment.scale, aspect, Some(source.bounds))
        .ok_or(kOfxStatFailed)?
        .in_project(instance::extent(host, instance).map(|[_, top]| top), moment.time);
    if let Some(name) = clip.properties.string(kOfxImageClipPropColourspace, 0) {
        settings.space = settings.space_of(&name);
    }
    if source.channels == 1 {
        // A single channel is coverage, whatever space the colours are in.
        settings.space = ColourSpace::Srgb;
    }
    let mask = if settings.mask_apply { fetch(host, instance, MASK, moment.time)? } else { None };
    let guides = fetch_guides(effect, host, instance, moment.time)?;
    let field = Field::of(args);
    let identity = settings.is_identity(frame.scale);
    let job = Job { host, instance, frame, settings, identity, source, output, mask, guides, field };
    let done = faults::failure(effect).map_or_else(|| job.run(window), |error| Err(Stop::Error(error)));
    report(host, instance, done)
}

impl Field {
    /// The field that the arguments name, if any.
    fn of(args: Properties<'_>) -> Option<Self> {
        match args.string(kOfxImageEffectPropFieldToRender, 0)?.as_c_str() {
            f if f == kOfxImageFieldLower => Some(Self { parity: 0 }),
            f if f == kOfxImageFieldUpper => Some(Self { parity: 1 }),
            _ => None,
        }
    }
}

/// The image of a clip, where there is one.
fn fetch<'h>(host: &'h Host, instance: Handle, name: &CStr, time: f64) -> Outcome<Option<Fetched<'h>>> {
    Clip::of(host, instance, name).map_or(Ok(None), |clip| clip.image(time))
}

/// The guides of an effect that have an image.
fn fetch_guides<'h>(
    effect: &Effect,
    host: &'h Host,
    instance: Handle,
    time: f64,
) -> Outcome<Vec<(GraphInput, Fetched<'h>)>> {
    let mut guides = Vec::new();
    for guide in &effect.guides {
        if let Some(name) = guide_clip(*guide)
            && let Some(image) = fetch(host, instance, name, time)?
            && (*guide != GraphInput::Normal || image.channels >= 3)
        {
            guides.push((*guide, image));
        }
    }
    Ok(guides)
}

/// The status of a render, with a message on the effect when it failed.
fn report(host: &Host, instance: Handle, done: Result<(), Stop>) -> Outcome {
    match done {
        Ok(()) => {
            host.clear_message(instance);
            Ok(kOfxStatOK)
        }
        Err(Stop::Aborted) => Ok(kOfxStatOK),
        Err(Stop::Status(status)) => {
            if status == kOfxStatErrMemory {
                host.show_message(instance, "There is not enough memory for a picture of this size.");
            }
            Err(status)
        }
        Err(Stop::Error(error)) => {
            host.show_message(instance, &error.to_string());
            Err(match error {
                Error::Engine(EngineError::Memory(_)) => kOfxStatErrMemory,
                _ => kOfxStatFailed,
            })
        }
    }
}

/// Why a frame was not finished.
enum Stop {
    /// The user no longer wants it.
    Aborted,
    Status(OfxStatus),
    Error(Error),
}

impl From<OfxStatus> for Stop {
    fn from(status: OfxStatus) -> Self {
        Self::Status(status)
    }
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        match error {
            Error::Engine(EngineError::Cancelled) => Self::Aborted,
            other => Self::Error(other),
        }
    }
}

fn intersection(a: Bounds, b: Bounds) -> Bounds {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]
}

/// Gives a premultiplied pixel the coverage of another, of which it takes the colour where it has none of its own. Its
/// light beyond coverage stays.
fn recover(pixel: &mut [f32], source: &[f32]) {
    let ([r, g, b, now], kept) = ([pixel[0], pixel[1], pixel[2], pixel[3]], source[3]);
    let light = beyond_coverage([r, g, b, now]);
    let under = beyond_coverage([source[0], source[1], source[2], kept]);
    for c in 0..3 {
        let covered = if now > 0.0 { (pixel[c] - light[c]) * (kept / now) } else { source[c] - under[c] };
        pixel[c] = covered + light[c];
    }
}

/// Writes transparent black.
fn clear(host: &Host, output: &Fetched<'_>, window: Bounds) -> Outcome<()> {
    let frame = Frame::new(host, None, [1.0; 2], 1.0, Some(output.bounds)).ok_or(kOfxStatErrImageFormat)?;
    let channels = if output.channels == 1 { 1 } else { 4 };
    let black = Image::with_window(frame.inside(window), channels).map_err(|_| kOfxStatErrMemory)?;
    output.write(&frame, black)
}

impl Job<'_> {
    fn run(&self, window: Bounds) -> Result<(), Stop> {
        let inside = self.frame.inside(window);
        if self.frame.outside(inside) != window || inside.is_empty() {
            // Outside its picture an effect has nothing to show.
            clear(self.host, &self.output, window)?;
        }
        if inside.is_empty() {
            return Ok(());
        }
        if self.identity {
            for band in bands(inside, LEAST_ROWS) {
                let copy = self.read(GraphInput::Color, &self.source, band)?;
                self.write(copy)?;
            }
            return Ok(());
        }
        let has = |guide| self.guides.iter().any(|(g, _)| *g == guide);
        let guides =
            Guides { normal: has(GraphInput::Normal), depth: has(GraphInput::Depth), ..Guides::default() };
        let prepared = Prepared::new(&self.settings, &self.frame, !self.is_straight(), guides)?;
        let threads = FrameThreads::of(self.host);
        // Hosts need not expect the question from two threads at once.
        let instance = Mutex::new(Instance(self.instance));
        let aborted = || instance.lock().is_ok_and(|instance| self.host.aborted(instance.0));
        let control = Control { cancelled: Some(&aborted), progress: None };
        // The plan for light beyond coverage, where a band has any.
        let mut emissive = None;
        let mut executor = CpuExecutor::new();
        for band in bands(inside, prepared.band_rows(inside)) {
            let images = self.inputs(&prepared, band, threads.threads())?;
            let named: Vec<(&str, &Image)> = images.iter().map(|(i, image)| (i.id(), image)).collect();
            let region = prepared.plan_window(band);
            let light = prepared.planned.request().premultiplied
                && images.iter().any(|(i, image)| *i == GraphInput::Color && has_light(image.data()));
            if light && emissive.is_none() {
                emissive = Some(prepared.emissive(&self.settings)?);
            }
            let planned = emissive.as_ref().filter(|_| light).unwrap_or(&prepared.planned);
            let results = executor
                .run(planned.plan(), &named, region, threads.threads(), control)
                .map_err(Error::from)?;
            drop(images);
            if band.y1 == inside.y1 {
                // What it kept for the next band.
                executor = CpuExecutor::new();
            }
            let result = results.into_iter().next().ok_or(kOfxStatFailed)?;
            let result = self.to_host(&prepared, result, band, threads.threads())?;
            self.write(self.finished(result, band)?)?;
        }
        Ok(())
    }

    /// Whether colour is not multiplied by alpha in the source and the output.
    fn is_straight(&self) -> bool {
        self.source.alpha == Alpha::Unpremultiplied
    }

    /// What the plan reads to compute `band`, in the plan's pixels.
    fn inputs(
        &self,
        prepared: &Prepared,
        band: Rect,
        threads: &dyn Threads,
    ) -> Result<Vec<(GraphInput, Image)>, Stop> {
        let windows = prepared.windows(band);
        let mut images = Vec::new();
        for port in prepared.planned.plan().inputs() {
            let window = windows[port.image.index()];
            let Some(input) = GraphInput::from_id(&port.name) else { continue };
            let given = match input {
                GraphInput::Color => Some(&self.source),
                guide => self.guides.iter().find(|(g, _)| *g == guide).map(|(_, image)| image),
            };
            let Some(image) = given.filter(|_| !window.is_empty()) else { continue };
            let mut pixels = self.read(input, image, prepared.host_window(window))?;
            if let Some(square) = prepared.square {
                if input == GraphInput::Color && self.is_straight() {
                    multiply(&mut pixels);
                }
                pixels = square.to_square(pixels, window, input, threads).map_err(Error::from)?;
            }
            images.push((input, pixels));
        }
        Ok(images)
    }

    /// The plan's result in the host's pixels of `band`.
    fn to_host(
        &self,
        prepared: &Prepared,
        result: Image,
        band: Rect,
        threads: &dyn Threads,
    ) -> Result<Image, Stop> {
        let Some(square) = prepared.square else { return Ok(result) };
        let mut result = square.to_host(result, band, threads).map_err(Error::from)?;
        if self.is_straight() && result.channels() == 4 {
            divide(&mut result);
        }
        Ok(result)
    }

    /// The pixels of `window` of an input, as they enter the plan.
    fn read(&self, input: GraphInput, image: &Fetched<'_>, window: Rect) -> Outcome<Image> {
        let Some(field) = self.field else {
            return Ok(self.opaque(input, image, image.read(&self.frame, window, input, Beyond::Edge)?));
        };
        // Rows of the other field take the next of this one, as hosts that double the lines have it. Then
        // a picture of both fields and one of doubled lines come out alike.
        let whole = Rect::of_size(self.frame.size()[0], self.frame.size()[1]);
        let grown = Rect { y0: window.y0 - 1, y1: window.y1 + 1, ..window }.intersection(&whole);
        let both = image.read(&self.frame, grown, input, Beyond::Edge)?;
        let mut one = both.crop(window).map_err(|_| kOfxStatErrMemory)?;
        for y in window.y0..window.y1 {
            let up = self.frame.picture[3] - 1 - y;
            if up.rem_euclid(2) != field.parity {
                // The partner is above for the lower field's odd rows, and below for the upper's even ones.
                let partner = if field.parity == 0 { y + 1 } else { y - 1 };
                let other = if partner == y + 1 { y - 1 } else { y + 1 };
                let from = if (grown.y0..grown.y1).contains(&partner) { partner } else { other };
                if (grown.y0..grown.y1).contains(&from) {
                    one.row_mut(y).copy_from_slice(both.row(from));
                }
            }
        }
        Ok(self.opaque(input, image, one))
    }

    fn opaque(&self, input: GraphInput, image: &Fetched<'_>, mut pixels: Image) -> Image {
        if input == GraphInput::Color && image.alpha == Alpha::Opaque && !self.identity {
            pixels.data_mut().chunks_exact_mut(4).for_each(|p| p[3] = 1.0);
        }
        pixels
    }

    /// The filter's result with the source's alpha, unless alpha is filtered too, and under the mask.
    fn finished(&self, result: Image, band: Rect) -> Outcome<Image> {
        let keep_alpha = !self.settings.process_alpha && self.source.alpha != Alpha::Opaque;
        if !keep_alpha && self.mask.is_none() {
            return Ok(result);
        }
        let source = self.read(GraphInput::Color, &self.source, band)?;
        let mut image = if result.channels() == 4 { result } else { spread(&result)? };
        let premultiplied = self.source.alpha == Alpha::Premultiplied;
        if keep_alpha {
            for (pixel, source) in image.data_mut().chunks_exact_mut(4).zip(source.data().chunks_exact(4)) {
                if premultiplied && pixel[3] != source[3] {
                    recover(pixel, source);
                }
                pixel[3] = source[3];
            }
        }
        if let Some(mask) = &self.mask {
            let mask = mask.read_mask(&self.frame, band)?;
            let pixels = image.data_mut().chunks_exact_mut(4).zip(source.data().chunks_exact(4));
            for ((pixel, source), amount) in pixels.zip(mask) {
                let amount = amount.clamp(0.0, 1.0);
                for (v, s) in pixel.iter_mut().zip(source) {
                    // Exact at both ends.
                    *v = *v * amount + *s * (1.0 - amount);
                }
            }
        }
        Ok(image)
    }

    /// Writes what was computed: all rows, or those of the field.
    fn write(&self, image: Image) -> Outcome<()> {
        let Some(field) = self.field else { return self.output.write(&self.frame, image) };
        let window = image.window();
        for y in window.y0..window.y1 {
            if (self.frame.picture[3] - 1 - y).rem_euclid(2) == field.parity {
                let row = image.crop(Rect { y0: y, y1: y + 1, ..window }).map_err(|_| kOfxStatErrMemory)?;
                self.output.write(&self.frame, row)?;
            }
        }
        Ok(())
    }
}

/// Colour times alpha.
fn multiply(image: &mut Image) {
    for pixel in image.data_mut().chunks_exact_mut(4) {
        let alpha = pixel[3];
        pixel[..3].iter_mut().for_each(|v| *v *= alpha);
    }
}

/// Colour over alpha, where there is any.
fn divide(image: &mut Image) {
    for pixel in image.data_mut().chunks_exact_mut(4).filter(|pixel| pixel[3] > 0.0) {
        let alpha = pixel[3];
        pixel[..3].iter_mut().for_each(|v| *v /= alpha);
    }
}

/// The host's word for the instance, for the one question that other threads ask about it.
struct Instance(Handle);

// SAFETY: the handle is never followed here, and the standard lets any thread ask whether to stop.
unsafe impl Send for Instance {}

/// Lines as opaque grey.
fn spread(lines: &Image) -> Outcome<Image> {
    let mut image = Image::with_window(lines.window(), 4).map_err(|_| kOfxStatErrMemory)?;
    for (pixel, v) in image.data_mut().chunks_exact_mut(4).zip(lines.data()) {
        pixel.copy_from_slice(&[*v, *v, *v, 1.0]);
    }
    Ok(image)
}

/// Bands of `rows` rows, from the top.
fn bands(window: Rect, rows: i32) -> impl Iterator<Item = Rect> {
    (window.y0..window.y1).step_by(rows.max(1) as usize).map(move |y0| Rect {
        y0,
        y1: (y0 + rows).min(window.y1),
        ..window
    })
}
