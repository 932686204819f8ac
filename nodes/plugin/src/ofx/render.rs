//! Rendering: the frame's plan, run over bands of rows that keep memory bounded.

use super::clips::{MASK, SOURCE};
use super::colours::{Colours, working};
use super::effects::Effect;
use super::executors::{Executors, Work};
use super::faults;
use super::frame::{Bounds, Frame};
use super::host::{Host, Outcome, Properties};
use super::image::{Alpha, Clip, Fetched};
use super::inputs::{Field, Gathered, Inputs, Named, fetch, fetch_guides};
use super::instance::{self, Moment};
use super::known::Known;
use super::mask::MaskRule;
use super::prepared::{Prepared, Quality};
use super::settings::Settings;
use super::stop::Stop;
use super::threads::FrameThreads;
use crate::pixel_aspect::divide;
use isophote::engine::cpu::{Control, Threads};
use isophote::engine::plan::LEAST_ROWS;
use isophote::engine::{Error as EngineError, Image, Rect};
use isophote::graph::GraphInput;
use isophote::kernels::shared::host_colour::has_light;
use isophote::kernels::shared::host_colour::scalar::beyond_coverage;
use isophote::{Error, Planned};
use isophote_abi::openfx::*;
use isophote_colour::Space;
use std::sync::Mutex;

/// Everything that one render action was given.
struct RenderAction<'h> {
    inputs: Inputs<'h>,
    settings: Settings,
    quality: Quality,
    output: Fetched<'h>,
    mask: Option<(MaskRule, Fetched<'h>)>,
}

/// Renders the window that the arguments name.
///
/// # Errors
/// Failed without an output, image format for one of an unknown depth, and memory.
pub fn render(effect: &Effect, host: &Host, instance: Handle, in_args: Handle) -> Outcome {
    report(host, instance, attempt(effect, host, instance, host.set(in_args)))
}

fn attempt(effect: &Effect, host: &Host, instance: Handle, args: Properties<'_>) -> Result<(), Stop> {
    let moment = Moment::of(args);
    let output = instance::output(host, instance)?.fetch(moment.time)?.ok_or(kOfxStatFailed)?;
    let window = args.ints::<4>(kOfxImageEffectPropRenderWindow).unwrap_or(output.bounds);
    let window = intersection(window, output.bounds);
    if window[0] >= window[2] || window[1] >= window[3] || host.aborted(instance) {
        return Err(Stop::Aborted);
    }
    let clip = Clip::of(host, instance, SOURCE);
    let source = clip.map(|clip| clip.image(moment.time)).transpose()?.flatten();
    let (Some(clip), Some(source)) = (clip, source) else {
        return Ok(clear(host, &output, window)?);
    };
    let aspect = source.aspect.unwrap_or_else(|| clip.aspect());
    let mut settings = Settings::read(effect, host, instance, moment.time)?;
    let defined = instance::defined(effect, host, instance, moment.time, &settings)?;
    let frame = Frame::new(host, defined, moment.scale, aspect, Some(source.bounds))
        .ok_or(kOfxStatFailed)?
        .in_project(instance::extent(host, instance).map(|[_, top]| top), moment.time)
        .for_reference(settings.reference_height);
    if let Some(name) = clip.properties.string(kOfxImageClipPropColourspace, 0) {
        settings.space = settings.space_of(&name);
    }
    if source.channels == 1 {
        // A single channel is coverage, whatever space the colours are in.
        settings.space = Space::Srgb;
    }
    let mask = match settings.mask {
        Some(rule) => fetch(host, instance, &frame, MASK, moment.time)?.map(|image| (rule, image)),
        None => None,
    };
    let wants_motion = host.temporal && settings.graph.frames() != [0, 0];
    let inputs = Inputs {
        host,
        instance,
        time: moment.time,
        frame,
        field: Field::of(args),
        colours: Colours::of(settings.space, source.alpha != Alpha::Unpremultiplied),
        source,
        guides: fetch_guides(effect, host, instance, &frame, moment.time, wants_motion)?,
        convention: settings.convention,
        identity: settings.is_identity(frame.length_scale()),
    };
    let fault = settings.look.fault.take();
    let action = RenderAction { inputs, settings, quality: Quality::of(args), output, mask };
    faults::failure(effect).map_or_else(|| action.run(window), |error| Err(Stop::Error(error)))?;
    fault.map_or(Ok(()), |fault| Err(Stop::PassedOn(fault)))
}

/// The status of a render, with a message on the effect when it failed.
fn report(host: &Host, instance: Handle, done: Result<(), Stop>) -> Outcome {
    match done {
        Ok(()) => {
            host.clear_failure(instance);
            Ok(kOfxStatOK)
        }
        Err(Stop::Aborted) => Ok(kOfxStatOK),
        Err(Stop::PassedOn(reason)) => {
            host.show_failure(instance, &reason);
            Ok(kOfxStatOK)
        }
        Err(Stop::Status(status)) => {
            if let Some(message) = message_of(status) {
                host.show_failure(instance, message);
            }
            Err(status)
        }
        Err(Stop::Error(error)) => {
            host.show_failure(instance, &error.to_string());
            Err(match error {
                Error::Engine(EngineError::Memory(_)) => kOfxStatErrMemory,
                _ => kOfxStatFailed,
            })
        }
    }
}

/// Text for people about a status that a render ended with, and what they can do about it.
fn message_of(status: OfxStatus) -> Option<&'static str> {
    match status {
        s if s == kOfxStatErrMemory => Some(
            "There is not enough memory for a frame of this size. Use a proxy, or let the host render fewer frames at once.",
        ),
        s if s == kOfxStatErrImageFormat => Some(
            "The source or the result has pixels that Isophote does not know. Give it RGBA, RGB or Alpha of 8 or 16 \
             bits, half or float.",
        ),
        _ => None,
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

impl RenderAction<'_> {
    fn run(&self, window: Bounds) -> Result<(), Stop> {
        let Inputs { host, instance, frame, .. } = &self.inputs;
        let inside = frame.inside(window);
        if frame.outside(inside) != window || inside.is_empty() {
            // Outside its picture an effect has nothing to show.
            clear(host, &self.output, window)?;
        }
        if inside.is_empty() {
            return Ok(());
        }
        if self.inputs.identity {
            for band in bands(inside, LEAST_ROWS) {
                self.write(self.inputs.read(band)?)?;
            }
            return Ok(());
        }
        let threads = FrameThreads::of(host);
        let mut executors = Executors::new(host, *instance, self.settings.card);
        // Hosts need not expect the question from two threads at once.
        let instance = Mutex::new(Instance(*instance));
        let aborted = || instance.lock().is_ok_and(|instance| host.aborted(instance.0));
        let control = Control { cancelled: Some(&aborted), progress: None };
        let mut plans = Plans::new(self)?;
        let mut rows = executors.band_rows(&plans.prepared, inside);
        let mut next = inside.y0;
        while next < inside.y1 {
            let band = Rect { y0: next, y1: next.saturating_add(rows).min(inside.y1), ..inside };
            let images = plans.gather(self, band, threads.threads())?;
            let region = plans.prepared.plan_window(band);
            let planned = plans.planned(&images)?;
            let named: Vec<(&str, &Image)> = images.iter().map(|(name, image)| (&name[..], image)).collect();
            let work = Work { plan: planned.plan(), images: &named, region, control };
            let Some(results) = executors.run(&work, threads.threads())? else {
                rows = executors.band_rows(&plans.prepared, inside);
                next = inside.y0;
                continue;
            };
            drop(images);
            if band.y1 == inside.y1 {
                executors.purge();
            }
            let result = results.into_iter().next().ok_or(kOfxStatFailed)?;
            let result = self.to_host(&plans.prepared, result, band, threads.threads())?;
            self.write(self.finished(result, band)?)?;
            next = band.y1;
        }
        Ok(())
    }

    /// The plan's result in the host's pixels and colours of `band`.
    fn to_host(
        &self,
        prepared: &Prepared,
        mut result: Image,
        band: Rect,
        threads: &dyn Threads,
    ) -> Result<Image, Stop> {
        if let Some(square) = prepared.square {
            result = square.to_host(result, band, threads).map_err(Error::from)?;
            if self.inputs.is_straight() && result.channels() == 4 {
                divide(&mut result);
            }
        }
        self.inputs.colours.leave(&mut result, threads);
        Ok(result)
    }

    /// The filter's result with the source's alpha, unless alpha is filtered too, and under the mask.
    fn finished(&self, result: Image, band: Rect) -> Outcome<Image> {
        let keep_alpha = !self.settings.process_alpha && self.inputs.source.alpha != Alpha::Opaque;
        let mix = self.settings.look.mix;
        if !keep_alpha && self.mask.is_none() && mix == 1.0 {
            return Ok(result);
        }
        let source = self.inputs.read(band)?;
        let mut image = if result.channels() == 4 { result } else { spread(&result)? };
        let premultiplied = self.inputs.source.alpha == Alpha::Premultiplied;
        if keep_alpha {
            for (pixel, source) in image.data_mut().chunks_exact_mut(4).zip(source.data().chunks_exact(4)) {
                if premultiplied && pixel[3] != source[3] {
                    recover(pixel, source);
                }
                pixel[3] = source[3];
            }
        }
        if self.mask.is_some() || mix != 1.0 {
            let mask = self.mask.as_ref().map(|(rule, mask)| rule.read(mask, &self.inputs.frame, band));
            let mask = mask.transpose()?;
            let pixels = image.data_mut().chunks_exact_mut(4).zip(source.data().chunks_exact(4));
            for (at, (pixel, source)) in pixels.enumerate() {
                let amount = mask.as_ref().map_or(1.0, |mask| mask[at]) * mix;
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
        let Some(field) = self.inputs.field else { return self.output.write(&self.inputs.frame, image) };
        let window = image.window();
        for y in window.y0..window.y1 {
            if (self.inputs.frame.picture[3] - 1 - y).rem_euclid(2) == field.parity {
                let row = image.crop(Rect { y0: y, y1: y + 1, ..window }).map_err(|_| kOfxStatErrMemory)?;
                self.output.write(&self.inputs.frame, row)?;
            }
        }
        Ok(())
    }
}

/// The plans of a frame.
struct Plans {
    known: Known,
    prepared: Prepared,
    /// The one for light beyond coverage, once a band has any.
    emissive: Option<Planned>,
}

impl Plans {
    fn new(action: &RenderAction<'_>) -> Result<Self, Stop> {
        let (inputs, settings) = (&action.inputs, &action.settings);
        let has = inputs.available();
        let mut known = Known::of(&settings.graph, settings.motion_from, has, inputs.host.temporal)?;
        known.limit_to_source(inputs.host, inputs.instance, inputs.time);
        let prepared = Self::prepared(&known, action)?;
        Ok(Self { known, prepared, emissive: None })
    }

    fn prepared(known: &Known, action: &RenderAction<'_>) -> isophote::Result<Prepared> {
        let RenderAction { inputs, settings, quality, .. } = action;
        Prepared::new(known, working(settings.space), &inputs.frame, !inputs.is_straight(), *quality)
    }

    /// Images that a band is computed from. Frames are known up to the first that lacks an image.
    fn gather(
        &mut self,
        action: &RenderAction<'_>,
        band: Rect,
        threads: &dyn Threads,
    ) -> Result<Named, Stop> {
        loop {
            match action.inputs.gather(&self.prepared, band, threads)? {
                Gathered::All(images) => return Ok(images),
                Gathered::Without(missing) => {
                    self.known.forget_from(missing);
                    self.prepared = Self::prepared(&self.known, action)?;
                    self.emissive = None;
                }
            }
        }
    }

    /// The plan for what was read.
    fn planned(&mut self, images: &Named) -> Result<&Planned, Stop> {
        let color = images.iter().find(|(name, _)| name == GraphInput::Color.id());
        let premultiplied = self.prepared.planned.request().premultiplied;
        if !(premultiplied && color.is_some_and(|(_, image)| has_light(image.data()))) {
            return Ok(&self.prepared.planned);
        }
        if self.emissive.is_none() {
            self.emissive = Some(self.prepared.emissive(&self.known)?);
        }
        Ok(self.emissive.as_ref().unwrap_or(&self.prepared.planned))
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
