//! What hosts ask of an instance before they render: regions, clip preferences, identity.

use super::describe::{MASK, OUTPUT, SOURCE, guide_clip};
use super::effects::Effect;
use super::frame::{Frame, bounded, is_endless};
use super::host::{Host, Outcome, Properties};
use super::image::Clip;
use super::interface::*;
use super::memory::{LEAST_ROWS, WORKING_MEMORY};
use super::pixel_aspect::SquarePixels;
use super::settings::Settings;
use isophote::engine::{Plan, Rect};
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote::{ColourSpace, Graph, Planned, Request};
use std::ffi::{CStr, CString};

/// Time and scale of an action.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    pub time: f64,
    pub scale: [f64; 2],
}

impl Moment {
    /// As the arguments say; full size at the start, where they say nothing.
    pub fn of(args: Properties<'_>) -> Self {
        let usable = |scale: &[f64; 2]| scale.iter().all(|s| s.is_finite() && *s > 0.0);
        Self {
            time: args.double(kOfxPropTime, 0).unwrap_or(0.0),
            scale: args.doubles(kOfxImageEffectPropRenderScale).filter(usable).unwrap_or([1.0; 2]),
        }
    }
}

/// The plan for a frame, over square pixels.
#[derive(Debug)]
pub struct Prepared {
    /// What is run.
    pub planned: Planned,
    /// Its pixels, where they are others than the host's. Colour is multiplied by alpha in them.
    pub square: Option<SquarePixels>,
}

impl Prepared {
    /// The plan for the values of an instance. `guides` are those that have a picture.
    ///
    /// # Errors
    /// Memory; failed, when the graph cannot be planned.
    pub fn new(
        settings: &Settings,
        frame: &Frame,
        premultiplied: bool,
        guides: Guides,
    ) -> isophote::Result<Self> {
        Self::of_graph(&settings.graph, settings.space, frame, premultiplied, guides)
    }

    fn of_graph(
        graph: &Graph,
        space: ColourSpace,
        frame: &Frame,
        premultiplied: bool,
        guides: Guides,
    ) -> isophote::Result<Self> {
        let plan = |[width, height]: [u32; 2], scale, premultiplied| {
            Planned::new(
                graph,
                Request {
                    scale,
                    space,
                    premultiplied,
                    guides,
                    origin: frame.origin(),
                    frame: frame.number,
                    ..Request::new(width, height)
                },
            )
        };
        let Some(mut square) = SquarePixels::of(frame) else {
            return Ok(Self { planned: plan(frame.size(), frame.scale, premultiplied)?, square: None });
        };
        let mut planned = plan(square.size(), square.scale, true)?;
        if least_memory(planned.plan()) > WORKING_MEMORY[1] {
            square = SquarePixels::as_many(frame);
            planned = plan(square.size(), square.scale, true)?;
        }
        Ok(Self { planned, square: Some(square) })
    }

    /// The same for pictures with light beyond their coverage. It reads no more of them.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn emissive(&self, settings: &Settings) -> isophote::Result<Planned> {
        Planned::new(&settings.graph, Request { emission: true, ..*self.planned.request() })
    }

    /// The part of the plan's result that `region` of the frame is made from.
    pub fn plan_window(&self, region: Rect) -> Rect {
        self.square.map_or(region, |square| square.square_window(region))
    }

    /// The part of each of the plan's images that `region` of the frame needs.
    pub fn windows(&self, region: Rect) -> Vec<Rect> {
        self.planned.plan().windows(self.plan_window(region))
    }

    /// The host's pixels that a part of an image is made from.
    pub fn host_window(&self, window: Rect) -> Rect {
        self.square.map_or(window, |square| square.host_window(window))
    }

    /// Rows of the host's in one band.
    pub fn band_rows(&self, region: Rect) -> i32 {
        let plan = self.planned.plan();
        let window = self.plan_window(region);
        let rows = plan.band_rows(window, WORKING_MEMORY, LEAST_ROWS);
        if self.square.is_none() {
            return rows;
        }
        let share = f64::from(rows) / f64::from(window.height().max(1));
        ((share * f64::from(region.height())) as i32).max(1)
    }
}

/// Bytes that the images of the whole picture take, in the bands that take least.
fn least_memory(plan: &Plan) -> u64 {
    let [width, height] = plan.size();
    let all = Rect::of_size(width, height);
    let rows = plan.band_rows(all, WORKING_MEMORY, LEAST_ROWS);
    let middle = (all.y1 - rows) / 2;
    plan.peak_bytes(&plan.windows(Rect { y0: middle, y1: middle + rows, ..all }))
}

/// The region of definition of a clip, as far as it can be computed. An effect that looks at the whole picture
/// takes the project for it where the clip has no bounds; `None` where the host names none either.
///
/// # Errors
/// Failed, when the graph cannot be planned.
pub fn defined(
    host: &Host,
    instance: Handle,
    clip: &Clip<'_>,
    time: f64,
    settings: &Settings,
) -> Outcome<Option<OfxRectD>> {
    let Some(region) = clip.defined(time) else { return Ok(None) };
    if !is_endless(&region) || settings.is_local()? {
        return Ok(Some(region));
    }
    let project = extent(host, instance).map(|[x2, y2]| OfxRectD { x1: 0.0, y1: 0.0, x2, y2 });
    Ok(project.map(|project| bounded(&region, &project)))
}

/// Where the project ends at the right and at the top (canonical); it begins at 0.
pub fn extent(host: &Host, instance: Handle) -> Option<[f64; 2]> {
    host.effect(instance).doubles::<2>(kOfxImageEffectPropProjectExtent)
}

/// The region of definition: the source's, whatever else is connected.
///
/// # Errors
/// Failed, when the host has no parameters; the host's default counts where the source has no region.
pub fn region_of_definition(
    effect: &Effect,
    host: &Host,
    instance: Handle,
    in_args: Handle,
    out_args: Handle,
) -> Outcome {
    let moment = Moment::of(host.set(in_args));
    let Some(source) = Clip::of(host, instance, SOURCE) else { return Ok(kOfxStatReplyDefault) };
    let region = match source.defined(moment.time).filter(is_endless) {
        Some(_) => {
            let settings = Settings::read(effect, host, instance, moment.time)?;
            defined(host, instance, &source, moment.time, &settings)?
        }
        None => source.defined(moment.time),
    };
    let Some(OfxRectD { x1, y1, x2, y2 }) = region else { return Ok(kOfxStatReplyDefault) };
    let answered = host.set(out_args).set_doubles(kOfxImageEffectPropRegionOfDefinition, &[x1, y1, x2, y2]);
    Ok(if answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// What a region needs of each clip: as much around it as the plan's passes read.
///
/// # Errors
/// Failed, when the graph cannot be planned.
pub fn regions_of_interest(
    effect: &Effect,
    host: &Host,
    instance: Handle,
    in_args: Handle,
    out_args: Handle,
) -> Outcome {
    let (args, answer) = (host.set(in_args), host.set(out_args));
    let moment = Moment::of(args);
    let Some(source) = Clip::of(host, instance, SOURCE) else { return Ok(kOfxStatReplyDefault) };
    let settings = Settings::read(effect, host, instance, moment.time)?;
    let defined = defined(host, instance, &source, moment.time, &settings)?;
    let frame = Frame::new(host, defined, moment.scale, source.aspect(), None)
        .map(|frame| frame.in_project(extent(host, instance).map(|[_, top]| top), moment.time));
    let wanted = args.doubles::<4>(kOfxImageEffectPropRegionOfInterest).map(|[x1, y1, x2, y2]| OfxRectD {
        x1,
        y1,
        x2,
        y2,
    });
    let (Some(frame), Some(wanted)) = (frame, wanted) else { return Ok(kOfxStatReplyDefault) };
    let Some(bounds) = frame.pixels(&wanted) else { return Ok(kOfxStatReplyDefault) };
    let region = frame.inside(bounds);
    if region.is_empty() || settings.is_identity(frame.scale) {
        return Ok(kOfxStatReplyDefault);
    }
    let guides = connected_guides(effect, host, instance);
    let prepared = Prepared::new(&settings, &frame, true, guides).map_err(|_| kOfxStatFailed)?;
    let windows = prepared.windows(region);
    // The first and last line of a field have neighbours in the other field.
    let order = source.properties.string(kOfxImageClipPropFieldOrder, 0);
    let fields = order.is_some_and(|order| order.as_c_str() != kOfxImageFieldNone);
    let mut interest = Interest { answer, frame, fields, answered: false };
    for port in prepared.planned.plan().inputs() {
        let window = prepared.host_window(windows[port.image.index()]).union(&region);
        match GraphInput::from_id(&port.name) {
            Some(GraphInput::Color) => interest.add(SOURCE, window),
            Some(guide) => guide_clip(guide).into_iter().for_each(|clip| interest.add(clip, window)),
            None => {}
        }
    }
    if is_connected(host, instance, MASK) {
        interest.add(MASK, region);
    }
    Ok(if interest.answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// Whether the instance has a clip of this name, and the host does not say that it is open.
pub fn is_connected(host: &Host, instance: Handle, name: &CStr) -> bool {
    Clip::of(host, instance, name).is_some_and(|clip| !clip.is_open())
}

/// The guides whose clips are connected.
pub fn connected_guides(effect: &Effect, host: &Host, instance: Handle) -> Guides {
    let connected = |guide| guide_clip(guide).is_some_and(|name| is_connected(host, instance, name));
    let has = |guide| effect.guides.contains(&guide) && connected(guide);
    Guides { normal: has(GraphInput::Normal), depth: has(GraphInput::Depth), ..Guides::default() }
}

/// The regions of interest that a host has been given.
struct Interest<'h> {
    answer: Properties<'h>,
    frame: Frame,
    fields: bool,
    answered: bool,
}

impl Interest<'_> {
    /// Answers that `rect` of the picture is needed of a clip.
    fn add(&mut self, clip: &CStr, rect: Rect) {
        let mut bounds = self.frame.outside(rect);
        if self.fields {
            (bounds[1], bounds[3]) = (bounds[1] - 1, bounds[3] + 1);
        }
        let name = CString::new(format!("{ROI_PREFIX}{}", clip.to_string_lossy())).unwrap_or_default();
        self.answered |= self.answer.set_doubles(&name, &self.frame.canonical(bounds));
    }
}

/// The result is premultiplied as the source is. Hosts that manage colours are asked for pixels that are
/// what the working space says.
///
/// # Errors
/// Failed, when the host has no parameters.
pub fn clip_preferences(effect: &Effect, host: &Host, instance: Handle, out_args: Handle) -> Outcome {
    let state = Clip::of(host, instance, SOURCE)
        .filter(|clip| !clip.is_open())
        .and_then(|clip| clip.properties.string(kOfxImageEffectPropPreMultiplication, 0));
    let answer = host.set(out_args);
    let mut answered = state.is_some_and(|state| answer.answer(kOfxImageEffectPropPreMultiplication, &state));
    let style = host.effect(instance).string(kOfxImageEffectPropColourManagementStyle, 0);
    if style.is_some_and(|style| style.as_c_str() != kOfxImageEffectColourManagementNone) {
        let settings = Settings::read(effect, host, instance, 0.0)?;
        let space = match settings.space {
            _ if settings.as_is => None,
            ColourSpace::Srgb => Some(c"ofx_display_sdr"),
            ColourSpace::Linear | ColourSpace::AcesCg => Some(c"ofx_scene_linear"),
        };
        answered |= space.is_some_and(|s| answer.answer(PREFERRED_COLOURSPACES_OF_SOURCE, s));
    }
    Ok(if answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// The result is in the source's colour space.
///
/// # Errors
/// None.
pub fn output_colourspace(host: &Host, out_args: Handle) -> Outcome {
    let answered = host.set(out_args).answer(kOfxImageClipPropColourspace, COLOURSPACE_OF_SOURCE);
    Ok(if answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// Whether the result is the source as it is.
///
/// # Errors
/// Failed, when the host has no parameters.
pub fn is_identity(
    effect: &Effect,
    host: &Host,
    instance: Handle,
    in_args: Handle,
    out_args: Handle,
) -> Outcome {
    let moment = Moment::of(host.set(in_args));
    let settings = Settings::read(effect, host, instance, moment.time)?;
    // The scale of the lengths, as when the frame is rendered.
    let frame = Clip::of(host, instance, SOURCE)
        .and_then(|c| Frame::new(host, c.defined(moment.time), moment.scale, c.aspect(), None));
    let scale = frame.map_or(moment.scale[1] as f32, |frame| frame.scale);
    if !settings.is_identity(scale) {
        return Ok(kOfxStatReplyDefault);
    }
    let answer = host.set(out_args);
    let answered = answer.answer(kOfxPropName, SOURCE);
    answer.set_doubles(kOfxPropTime, &[moment.time]);
    Ok(if answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// The clip that is written.
///
/// # Errors
/// Failed, when there is none.
pub fn output(host: &Host, instance: Handle) -> Outcome<Clip<'_>> {
    Clip::of(host, instance, OUTPUT).ok_or(kOfxStatFailed)
}

#[cfg(test)]
mod tests {
    use super::super::effects::{EFFECTS, Form};
    use super::*;

    #[test]
    fn an_8k_frame_of_any_pixels_fits_into_4_gib() {
        let guides = Guides { normal: true, depth: true, ..Guides::default() };
        for par in [0.5, 1.0667, 2.0, 20.0] {
            let picture = [0, 0, 7680, 4320];
            let frame = Frame {
                picture,
                ratio: [1.0 / par, 1.0],
                scale: 1.0 / par.min(1.0) as f32,
                top: None,
                number: 0,
            };
            let whole = Rect::of_size(7680, 4320);
            let bytes = |window: Rect| window.area() * 16;
            for effect in EFFECTS.iter() {
                for over in [false, true] {
                    if over && effect.form != Form::Lines {
                        continue;
                    }
                    let (graph, _) = effect.graph(over).unwrap();
                    let prepared =
                        Prepared::of_graph(&graph, ColourSpace::Linear, &frame, true, guides).unwrap();
                    let rows = prepared.band_rows(whole);
                    let middle = (4320 - rows) / 2;
                    let band = Rect { y0: middle, y1: middle + rows, ..whole };
                    let (plan, windows) = (prepared.planned.plan(), prepared.windows(band));
                    // The host's pixels of a guide or the colour are gone when the last are resampled.
                    let read = plan.inputs().iter().map(|port| windows[port.image.index()]);
                    let read = read.map(|w| bytes(w) + 2 * bytes(prepared.host_window(w))).sum::<u64>();
                    let most = 2 * bytes(whole) + plan.peak_bytes(&windows).max(read);
                    let gib = most as f64 / (1_u64 << 30) as f64;
                    assert!(most <= 4 << 30, "{:?} at {par}: {gib:.2} GiB", effect.identifier);
                }
            }
        }
    }
}
