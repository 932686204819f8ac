//! Actions by which hosts ask an instance before they render: regions, clip preferences, identity.

use super::clips::{MASK, OUTPUT, SOURCE, is_connected};
use super::colours;
use super::effects::{Effect, Form, Target};
use super::frame::{Frame, bounded, is_endless};
use super::host::{Host, Outcome, Properties};
use super::image::{Beyond, Clip};
use super::known::{Known, clip_of};
use super::neighbours::Lasting;
use super::prepared::{Prepared, Quality};
use super::settings::{Settings, animated};
use isophote::engine::plan::Port;
use isophote::engine::{Plan, Rect};
use isophote::graph::GraphInput;
use isophote::spec::animates_marks;
use isophote_abi::openfx::*;
use std::collections::BTreeMap;
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

/// The region of definition of the source, as far as it can be computed. An effect that looks at the whole picture
/// takes the project for it where the clip has no bounds; `None` where the host names none either.
///
/// # Errors
/// Failed, when the graph cannot be planned.
pub fn defined(
    effect: &Effect,
    host: &Host,
    instance: Handle,
    time: f64,
    settings: &Settings,
) -> Outcome<Option<OfxRectD>> {
    let clip = Clip::of(host, instance, SOURCE);
    let Some(region) = clip.and_then(|clip| clip.defined(time)) else { return Ok(None) };
    if !is_endless(&region) || Known::is_local_for(effect, host, instance, settings)? {
        return Ok(Some(region));
    }
    let project = extent(host, instance).map(|[x2, y2]| OfxRectD { x1: 0.0, y1: 0.0, x2, y2 });
    Ok(project.map(|project| bounded(&region, &project)))
}

/// Right and top end of the project (canonical); it begins at 0.
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
            defined(effect, host, instance, moment.time, &settings)?
        }
        None => source.defined(moment.time),
    };
    let Some(OfxRectD { x1, y1, x2, y2 }) = region else { return Ok(kOfxStatReplyDefault) };
    let answered = host.set(out_args).set_doubles(kOfxImageEffectPropRegionOfDefinition, &[x1, y1, x2, y2]);
    Ok(if answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// Regions that a region needs of each clip: as much around it as the plan's passes read.
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
    let defined = defined(effect, host, instance, moment.time, &settings)?;
    let frame = Frame::new(host, defined, moment.scale, source.aspect(), None)
        .map(|frame| frame.in_project(extent(host, instance).map(|[_, top]| top), moment.time))
        .map(|frame| frame.for_reference(settings.reference_height));
    let wanted = args.doubles::<4>(kOfxImageEffectPropRegionOfInterest).map(|[x1, y1, x2, y2]| OfxRectD {
        x1,
        y1,
        x2,
        y2,
    });
    let (Some(frame), Some(wanted)) = (frame, wanted) else { return Ok(kOfxStatReplyDefault) };
    let Some(bounds) = frame.pixels(&wanted) else { return Ok(kOfxStatReplyDefault) };
    let region = frame.inside(bounds);
    if region.is_empty() || settings.is_identity(frame.length_scale()) {
        return Ok(kOfxStatReplyDefault);
    }
    // The first and last line of a field have neighbours in the other field.
    let order = source.properties.string(kOfxImageClipPropFieldOrder, 0);
    let fields = order.is_some_and(|order| order.as_c_str() != kOfxImageFieldNone);
    let mut interest = Interest { answer, frame, fields, rects: BTreeMap::new() };
    let space = colours::working(settings.space);
    // Hosts do not say here whether a draft is wanted.
    let qualities = [Quality::Full, Quality::Draft];
    let connected = Known::connected(effect, host, instance, &settings)?;
    for (mut known, quality) in connected.into_iter().flat_map(|known| qualities.map(|q| (known.clone(), q)))
    {
        known.limit_to_source(host, instance, moment.time);
        let prepared = Prepared::new(&known, space, &frame, true, quality).map_err(|_| kOfxStatFailed)?;
        for (input, window) in read_for(&prepared, frame.size(), region) {
            let clip = clip_of(&settings, host, instance, input);
            let window = window.union(&region);
            // A tile is wanted whole, where it does not reach over all that is read: those of generators have no end.
            let is_tiled = Beyond::of_guide(input) == Beyond::Tiled;
            let tile = clip.filter(|_| is_tiled).and_then(|name| Clip::of(host, instance, name));
            let tile = tile.and_then(|clip| frame.around(&clip.defined(moment.time)?));
            let window = window.union(&tile.filter(|tile| !tile.contains(&window)).unwrap_or_default());
            clip.into_iter().for_each(|clip| interest.add(clip, window));
        }
    }
    if is_connected(host, instance, MASK) {
        interest.add(MASK, region);
    }
    Ok(if interest.answered() { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// The host's pixels that are read of each input for a region of the frame: for the region, and for what other frames and
/// tiles share with it.
fn read_for(prepared: &Prepared, size: [u32; 2], region: Rect) -> Vec<(GraphInput, Rect)> {
    let plan = prepared.planned.plan();
    let mut all = inputs(prepared, plan, &prepared.windows(region));
    for segment in Lasting::parts(prepared, size, region).into_iter().filter_map(|part| part.segment) {
        if let Some(lasting) = Lasting::of(prepared, segment) {
            let (part, windows) = lasting.part(plan);
            all.extend(inputs(prepared, &part, &windows));
            all.extend(inputs(prepared, plan, &prepared.windows(segment)));
        }
    }
    all
}

fn inputs(prepared: &Prepared, plan: &Plan, windows: &[Rect]) -> Vec<(GraphInput, Rect)> {
    let of = |port: &Port| {
        let window = prepared.host_window(windows[port.image.index()]);
        GraphInput::from_id(port.base()).map(|input| (input, window))
    };
    plan.inputs().iter().filter_map(of).collect()
}

/// The regions of interest, by clip.
struct Interest<'h> {
    answer: Properties<'h>,
    frame: Frame,
    fields: bool,
    rects: BTreeMap<&'static CStr, Rect>,
}

impl Interest<'_> {
    /// Notes that `rect` of the picture is needed of a clip, in one frame or another.
    fn add(&mut self, clip: &'static CStr, rect: Rect) {
        let all = self.rects.entry(clip).or_insert(rect);
        *all = all.union(&rect);
    }

    /// True where the host has taken any of them.
    fn answered(&self) -> bool {
        let mut answered = false;
        for (clip, rect) in &self.rects {
            let mut bounds = self.frame.outside(*rect);
            if self.fields {
                (bounds[1], bounds[3]) = (bounds[1] - 1, bounds[3] + 1);
            }
            let name = CString::new(format!("{ROI_PREFIX}{}", clip.to_string_lossy())).unwrap_or_default();
            answered |= self.answer.set_doubles(&name, &self.frame.canonical(bounds));
        }
        answered
    }
}

/// The result is premultiplied as the source is, and varies from frame to frame where marks move by themselves. Hosts that
/// manage colours are asked for pixels that are what the working space says.
///
/// # Errors
/// Failed, when the host has no parameters.
pub fn clip_preferences(effect: &Effect, host: &Host, instance: Handle, out_args: Handle) -> Outcome {
    let state = Clip::of(host, instance, SOURCE)
        .filter(|clip| !clip.is_open())
        .and_then(|clip| clip.properties.string(kOfxImageEffectPropPreMultiplication, 0));
    let answer = host.set(out_args);
    let mut answered = state.is_some_and(|state| answer.answer(kOfxImageEffectPropPreMultiplication, &state));
    if is_animated(effect, host, instance)? {
        answer.set_int(kOfxImageEffectFrameVarying, 1);
        answered = true;
    }
    let style = host.effect(instance).string(kOfxImageEffectPropColourManagementStyle, 0);
    if style.is_some_and(|style| style.as_c_str() != kOfxImageEffectColourManagementNone) {
        let settings = Settings::read(effect, host, instance, 0.0)?;
        let space = (!settings.as_is).then(|| colours::preferred(settings.space));
        answered |= space.is_some_and(|s| answer.answer(PREFERRED_COLOURSPACES_OF_SOURCE, s));
    }
    Ok(if answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// True where frames of one and the same picture may differ, at one time or another.
fn is_animated(effect: &Effect, host: &Host, instance: Handle) -> Outcome<bool> {
    if effect.form == Form::Look {
        let settings = Settings::read(effect, host, instance, 0.0)?;
        return Ok(settings.look.varies || settings.graph.is_animated());
    }
    let decides = effect.controls.iter().any(|control| match control.target {
        Target::Param(_, param) => animates_marks(param),
        _ => false,
    });
    if !decides {
        return Ok(false);
    }
    let at_all_times = animated(effect, host, instance)?.iter().any(|(_, param)| animates_marks(param));
    Ok(at_all_times || Settings::read(effect, host, instance, 0.0)?.graph.is_animated())
}

/// The result is in the source's colour space.
///
/// # Errors
/// None.
pub fn output_colourspace(host: &Host, out_args: Handle) -> Outcome {
    let answered = host.set(out_args).answer(kOfxImageClipPropColourspace, COLOURSPACE_OF_SOURCE);
    Ok(if answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// True where the result is the source as it is.
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
        .and_then(|c| Frame::new(host, c.defined(moment.time), moment.scale, c.aspect(), None))
        .map(|frame| frame.in_project(extent(host, instance).map(|[_, top]| top), moment.time))
        .map(|frame| frame.for_reference(settings.reference_height));
    let scale = frame.map_or(moment.scale[1] as f32, |frame| frame.length_scale());
    // A fault is told when a frame is rendered.
    if !settings.is_identity(scale) || settings.look.fault.is_some() {
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
