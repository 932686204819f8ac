//! Rendering: the frame's plan, run over bands of rows that keep memory bounded.

use super::blending::{Finish, spread};
use super::clips::{MASK, SOURCE};
use super::colours::Colours;
use super::effects::Effect;
use super::executors::Executors;
use super::faults;
use super::frame::{Bounds, Frame};
use super::host::{Host, Outcome, Properties};
use super::image::{Alpha, Clip, Fetched};
use super::inputs::{Field, Inputs, Read, fetch, fetch_guides};
use super::instance::{self, Moment};
use super::kept;
use super::made;
use super::mask::MaskRule;
use super::plans::{Bands, Plans, bands};
use super::prepared::{Prepared, Quality};
use super::segments::Part;
use super::settings::Settings;
use super::stop::Stop;
use super::threads::FrameThreads;
use crate::abi::images::AS_COMPUTED;
use crate::pixel_aspect::divide;
use crate::pool;
use isophote::Error;
use isophote::engine::cpu::{CallingThread, Control, Threads};
use isophote::engine::plan::LEAST_ROWS;
use isophote::engine::{Error as EngineError, Image, Rect};
use isophote::graph::GraphInput;
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
        threads: FrameThreads::of(host),
    };
    let fault = settings.look.fault.take();
    let action = RenderAction { inputs, settings, quality: Quality::of(args), output, mask };
    let done = faults::failure(effect).map_or_else(|| action.run(window), |error| Err(Stop::Error(error)));
    if matches!(done, Err(Stop::Error(Error::Engine(EngineError::Memory(_))))) {
        // What is kept for other frames may be what is missing.
        forget_caches();
    }
    done?;
    fault.map_or(Ok(()), |fault| Err(Stop::PassedOn(fault)))
}

/// Gives back what is kept from one render to the next.
pub fn forget_caches() {
    made::forget();
    kept::forget();
    pool::forget();
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

/// Writes transparent black.
fn clear(host: &Host, output: &Fetched<'_>, window: Bounds) -> Outcome<()> {
    let frame = Frame::new(host, None, [1.0; 2], 1.0, Some(output.bounds)).ok_or(kOfxStatErrImageFormat)?;
    let channels = if output.channels == 1 { 1 } else { 4 };
    let mut black = Image::with_window(frame.inside(window), channels).map_err(|_| kOfxStatErrMemory)?;
    output.write(&frame, &mut black, &CallingThread, AS_COMPUTED)
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
                pool::keep_image(self.write(self.inputs.read(band)?, Finish::default())?);
            }
            return Ok(());
        }
        let mut executors = Executors::new(host, *instance, self.settings.card);
        // Hosts need not expect the question from two threads at once.
        let instance = Mutex::new(Instance(*instance));
        let aborted = || instance.lock().is_ok_and(|instance| host.aborted(instance.0));
        let control = Control { cancelled: Some(&aborted), progress: None };
        let mut plans = Plans::new(&self.inputs, &self.settings, self.quality)?;
        let work = Bands { inside, threads: self.inputs.threads.threads(), control };
        while !self.run_parts(&mut plans, &mut executors, &work)? {}
        executors.keep_memory();
        Ok(())
    }

    /// Computes and writes part by part; false where the graphics card has failed, after which all is begun anew.
    fn run_parts(
        &self,
        plans: &mut Plans<'_, '_>,
        executors: &mut Executors<'_>,
        work: &Bands<'_>,
    ) -> Result<bool, Stop> {
        // What is kept for other frames is of the CPU.
        let parts = match executors.cpu() {
            Some(_) => plans.parts(work.inside),
            None => vec![Part::alone(work.inside)],
        };
        for part in parts {
            let work = Bands { inside: part.inside, ..*work };
            if let Some(result) = plans.find_result(part, executors, &work)? {
                let window = plans.prepared.plan_window(part.inside);
                let result = pool::part(&result, window, work.threads).map_err(|_| kOfxStatErrMemory)?;
                let result = self.to_host(&plans.prepared, result, part.inside, work.threads)?;
                pool::keep_image(self.write(result, self.finish(part.inside, None)?)?);
                continue;
            }
            if let Some(cpu) = executors.cpu() {
                plans.find_stages(part, cpu, &work)?;
            }
            if !self.run_bands(plans, executors, &work)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Computes and writes band by band; false where the graphics card has failed.
    fn run_bands(
        &self,
        plans: &mut Plans<'_, '_>,
        executors: &mut Executors<'_>,
        work: &Bands<'_>,
    ) -> Result<bool, Stop> {
        let inside = work.inside;
        for band in bands(inside, executors.band_rows(&plans.prepared, &plans.cut.plan, inside)) {
            let Some((result, images)) = plans.run(executors, &Bands { inside: band, ..*work })? else {
                return Ok(false);
            };
            let source = self.untouched(&plans.prepared, images);
            if band.y1 == inside.y1 {
                executors.purge();
            }
            let result = self.to_host(&plans.prepared, result, band, work.threads)?;
            executors.recycle(self.write(result, self.finish(band, source)?)?);
        }
        Ok(true)
    }

    /// The source as it was read for the plan, where that changed nothing of it. The memory of the other images is kept.
    fn untouched(&self, prepared: &Prepared, images: Vec<Read>) -> Option<Image> {
        let is_untouched = prepared.square.is_none() && self.inputs.colours.enter_as_they_are();
        let mut source = None;
        for read in images {
            if is_untouched && read.name == GraphInput::Color.id() {
                source = Some(read.pixels);
            } else {
                read.keep_memory();
            }
        }
        source
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

    /// What is left to do to the result of a band: alpha of the source, unless alpha is filtered too, and the mask. `source`
    /// holds what was read of the source, if that is at hand.
    fn finish(&self, band: Rect, source: Option<Image>) -> Outcome<Finish> {
        let keep_alpha = !self.settings.process_alpha && self.inputs.source.alpha != Alpha::Opaque;
        let mix = self.settings.look.mix;
        let blends = self.mask.is_some() || mix != 1.0;
        if !keep_alpha && !blends {
            source.into_iter().for_each(pool::keep_image);
            return Ok(Finish::default());
        }
        let source = match source.filter(|source| source.window().contains(&band)) {
            Some(source) => source,
            None => self.inputs.read(band)?,
        };
        let mask = self.mask.as_ref().map(|(rule, mask)| rule.read(mask, &self.inputs.frame, band));
        Ok(Finish {
            band,
            source: Some(source),
            alpha: keep_alpha.then_some(self.inputs.source.alpha == Alpha::Premultiplied),
            mix: blends.then_some(mix),
            amounts: mask.transpose()?,
        })
    }

    /// Finishes and writes what was computed: all rows, or those of the field. Gives its memory back.
    fn write(&self, image: Image, finish: Finish) -> Outcome<Image> {
        let mut image =
            if finish.source.is_some() && image.channels() != 4 { spread(&image)? } else { image };
        let (frame, threads) = (&self.inputs.frame, self.inputs.threads.threads());
        let window = image.window();
        if let Some(field) = self.inputs.field {
            for y in window.y0..window.y1 {
                if (frame.picture[3] - 1 - y).rem_euclid(2) == field.parity {
                    finish.row(y, image.row_mut(y));
                    let row = image.crop(Rect { y0: y, y1: y + 1, ..window });
                    let mut row = row.map_err(|_| kOfxStatErrMemory)?;
                    self.output.write(frame, &mut row, threads, AS_COMPUTED)?;
                }
            }
        } else {
            self.output.write(frame, &mut image, threads, &|y, row| finish.row(y, row))?;
        }
        finish.source.into_iter().for_each(pool::keep_image);
        Ok(image)
    }
}

/// The host's word for the instance, for the one question that other threads ask about it.
struct Instance(Handle);

// SAFETY: the handle is never followed here, and the standard lets any thread ask whether to stop.
unsafe impl Send for Instance {}
