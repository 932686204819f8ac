//! Properties that an instance sets: whether it may be rendered in tiles, and which controls have an effect at the
//! moment. Both depend on its values, so that they are said when it is created and when values change.

use super::clips::{MASK, SOURCE, is_connected};
use super::effects::{Effect, Form, Target};
use super::host::{Host, Outcome};
use super::image::Clip;
use super::instance::Moment;
use super::known::{Known, connected_guides};
use super::look_effect::can_be_steady;
use super::looks;
use super::motion::MotionFrom;
use super::settings::{Settings, animated};
use isophote::engine::plan::Pass;
use isophote::engine::{ImageId, Plan, Rect};
use isophote::frames::Frames;
use isophote::request::Guides;
use isophote::spec::{Param, animates_marks};
use isophote::{Graph, Planned, Request, Value};
use isophote_abi::openfx::*;
use std::collections::HashMap;
use std::ffi::CStr;
use std::ptr::null_mut;

/// Side of the picture that plans are compared for.
const SIDE: u32 = 1024;
/// Number of the frame that plans are compared for: marks that are held, however long, are others than those that stay.
const FRAME: i64 = 1 << 20;

/// Tells the host everything of a new instance, which may have the values of a saved project.
pub fn created(effect: &Effect, host: &Host, instance: Handle) -> Outcome {
    // Some hosts have no values yet; the descriptor's word and all controls then stand.
    if let Ok(settings) = refresh(effect, host, instance, 0.0, true) {
        notice(host, instance, &settings, false);
        tell(host, instance, &settings);
    }
    Ok(kOfxStatOK)
}

/// Tells the host what has become other, by what changed.
///
/// The user, and the host in the user's place (a paste, an undo, a script), may change anything. A clip that is
/// connected changes which controls have an effect and, where it stands for an estimate, whether tiles may be rendered. Another time changes values that are animated: nothing
/// is looked at where there are none, and whether tiles may be rendered holds for all times.
///
/// # Errors
/// Failed, when the host has no parameters.
pub fn changed(effect: &'static Effect, host: &Host, instance: Handle, in_args: Handle) -> Outcome {
    if host.is_editing(instance) {
        return Ok(kOfxStatOK);
    }
    let args = host.set(in_args);
    let time = Moment::of(args).time;
    let reason = args.string(kOfxPropChangeReason, 0);
    let is_for = |wanted: &CStr| reason.as_deref() == Some(wanted);
    let of_time = is_for(kOfxChangeTime);
    if of_time && animated(effect, host, instance)?.is_empty() {
        return Ok(kOfxStatOK);
    }
    let what = args.string(kOfxPropType, 0);
    let of_clip = what.is_some_and(|what| what.as_c_str() == kOfxTypeClip);
    let by_user = is_for(kOfxChangeUserEdited);
    if by_user && !of_clip {
        looks::edited(effect, host, instance, &args.string(kOfxPropName, 0).unwrap_or_default(), time)?;
    }
    // A clip of motion makes an estimate, which takes whole pictures, needless.
    let tiles = !of_time && (effect.temporal || !of_clip);
    let settings = refresh(effect, host, instance, time, tiles)?;
    if settings.card.is_none() {
        host.card_computes(instance);
    }
    if by_user {
        notice(host, instance, &settings, true);
    }
    if by_user && effect.form == Form::Look {
        host.clear_failure(instance);
        tell(host, instance, &settings);
    }
    Ok(kOfxStatOK)
}

/// Tells the user of a host of single frames that nothing can be steadied by others. `aloud`: even if that stops the user.
fn notice(host: &Host, instance: Handle, settings: &Settings, aloud: bool) {
    if host.temporal {
        return;
    }
    if settings.graph.frames() == [0, 0] {
        host.withdraw_notice(instance);
    } else if !host.background {
        host.give_notice(instance, ONE_FRAME, aloud);
    }
}

/// Tells the user why an instance shows no look, or what of it is left out.
fn tell(host: &Host, instance: Handle, settings: &Settings) {
    if let Some(fault) = &settings.look.fault {
        return host.show_failure(instance, fault);
    }
    // Another file may leave other rules out.
    host.rules_are_followed(instance);
    if let Some(left_out) = &settings.look.left_out {
        host.warn_of_rules(instance, left_out);
    }
}

const ONE_FRAME: &str = "This host gives effects one frame at a time. Steadiness needs the frames around it and has no effect here.";

/// Tells the host which controls have an effect and, where `tiles`, whether tiles may be rendered.
fn refresh(effect: &Effect, host: &Host, instance: Handle, time: f64, tiles: bool) -> Outcome<Settings> {
    let settings = Settings::read(effect, host, instance, time)?;
    if tiles {
        let local = is_local_at_all_times(effect, host, instance, &settings)?;
        host.effect(instance).set_int(kOfxImageEffectPropSupportsTiles, local.into());
    }
    if host.background {
        return Ok(settings);
    }
    let scene = Surroundings::of(effect, host, instance, &settings);
    let plan = |graph: &Graph| {
        let Surroundings { guides, frames, .. } = scene;
        Planned::new(graph, Request { guides, frames, frame: FRAME, ..Request::new(SIDE, SIDE) })
    };
    let now = plan(&settings.graph).map_err(|_| kOfxStatFailed)?;
    let params = host.params(instance)?;
    for control in &effect.controls {
        let has_effect = match control.target {
            Target::Param(node, param) => others(&settings, node, param).any(|graph| {
                // What cannot be planned is at least not the same.
                plan(&graph).map_or(true, |other| !are_same(now.plan(), other.plan()))
            }),
            Target::ProcessAlpha => has_alpha(host, instance),
            Target::MaskApply => is_connected(host, instance, MASK),
            Target::MaskFrom | Target::MaskInvert => {
                settings.mask.is_some() && is_connected(host, instance, MASK)
            }
            // Where nothing moves, steadiness is grey until this is another.
            Target::MotionFrom => {
                host.temporal && (settings.graph.frames() != [0, 0] || scene.frames == Frames::NONE)
            }
            Target::MotionConvention => scene.reads_vectors && settings.graph.frames() != [0, 0],
            Target::Card | Target::Precision => settings.card.is_some(),
            Target::File | Target::Reload => settings.look.is_file,
            Target::Own(param) => {
                !animates_marks(param) || (scene.frames != Frames::NONE && can_be_steady(&settings.graph))
            }
            Target::LinesOutput
            | Target::WorkingSpace
            | Target::ReferenceHeight
            | Target::Look
            | Target::Shown
            | Target::TimesRead
            | Target::ComputeOn => true,
        };
        enable(host, params, &control.name, has_effect);
    }
    Ok(settings)
}

/// Surroundings of a picture that its controls need to have an effect.
#[derive(Clone, Copy)]
struct Surroundings {
    guides: Guides,
    frames: Frames,
    /// True where motion is read from clips.
    reads_vectors: bool,
}

impl Surroundings {
    /// By what is connected. One neighbour shows what all show, and vectors what an estimate shows, with less to plan.
    fn of(effect: &Effect, host: &Host, instance: Handle, settings: &Settings) -> Self {
        let guides = connected_guides(effect, host, instance);
        let has_clip = guides.motion || guides.motion_forward;
        let is_estimated = settings.motion_from.is_estimated(has_clip);
        let moves = host.temporal && (is_estimated || has_clip);
        Self {
            guides: Guides { motion: moves, motion_forward: moves, ..guides },
            frames: if moves { Frames::around(1, 0) } else { Frames::NONE },
            reads_vectors: moves && has_clip && settings.motion_from != MotionFrom::Flow,
        }
    }
}

/// True where a tile needs only the pixels around it, whatever values animated controls take.
fn is_local_at_all_times(
    effect: &Effect,
    host: &Host,
    instance: Handle,
    settings: &Settings,
) -> Outcome<bool> {
    if !Known::is_local_for(effect, host, instance, settings)? {
        return Ok(false);
    }
    let animated = animated(effect, host, instance)?;
    let mut graphs = animated.into_iter().flat_map(|(node, param)| others(settings, node, param));
    let has = connected_guides(effect, host, instance);
    let is_local = |graph: &Graph| Known::of(graph, settings.motion_from, has, host.temporal)?.is_local();
    Ok(graphs.all(|graph| is_local(&graph).unwrap_or(false)))
}

/// The graph with other values of a parameter: all that differ in kind, and numbers from end to end.
fn others(settings: &Settings, node: usize, param: &'static Param) -> impl Iterator<Item = Graph> {
    let id = settings.ids[node];
    let current = settings.graph.value(id, param.id).ok();
    let ends = [param.slider, param.range].concat().into_iter().map(f64::from);
    let numbers: Vec<f64> = match param.default {
        Value::Choice(_) => (0..param.options.len()).map(|index| index as f64).collect(),
        Value::Bool(_) | Value::Color(_) => vec![0.0, 1.0],
        Value::Float(_) | Value::Int(_) => {
            ends.chain([f64::midpoint(param.slider[0].into(), param.slider[1].into())]).collect()
        }
    };
    let values = numbers.into_iter().map(|number| param.nearest([number; 4]));
    values.filter(move |value| Some(*value) != current).filter_map(move |value| {
        let mut graph = settings.graph.clone();
        graph.set(id, param.id, value).ok().map(|()| graph)
    })
}

/// True where two plans compute the same, as far as it is needed.
fn are_same(a: &Plan, b: &Plan) -> bool {
    let same = |((a, a_images), (b, b_images)): (&Work, &Work)| {
        std::ptr::eq(a.kernel, b.kernel)
            && a.params == b.params
            && a.inputs.len() == b.inputs.len()
            && a_images == b_images
            && a.supports == b.supports
    };
    let (a, b) = (Needed::of(a), Needed::of(b));
    a.ports == b.ports && a.passes.len() == b.passes.len() && a.passes.iter().zip(&b.passes).all(same)
}

/// A pass, with its inputs and its outputs as they are counted.
type Work<'p> = (&'p Pass, Vec<usize>);

/// Part of a plan that is needed, its images counted without the others.
struct Needed<'p> {
    /// Inputs, then outputs.
    ports: Vec<(&'p str, usize)>,
    passes: Vec<Work<'p>>,
}

impl<'p> Needed<'p> {
    fn of(plan: &'p Plan) -> Self {
        let windows = plan.windows(Rect::of_size(SIDE, SIDE));
        let is_needed = |image: &ImageId| !windows[image.index()].is_empty();
        let mut numbers = HashMap::new();
        let mut number = |image: &ImageId| {
            let next = numbers.len();
            *numbers.entry(image.index()).or_insert(next)
        };
        let inputs = plan.inputs().iter().filter(|port| is_needed(&port.image));
        let mut ports: Vec<_> = inputs.map(|port| (port.name.as_str(), number(&port.image))).collect();
        let passes = plan.passes().iter().filter(|pass| is_needed(&pass.outputs[0]));
        let passes =
            passes.map(|pass| (pass, pass.inputs.iter().chain(&pass.outputs).map(&mut number).collect()));
        let passes = passes.collect();
        ports.extend(plan.outputs().iter().map(|port| (port.name.as_str(), number(&port.image))));
        Self { ports, passes }
    }
}

/// True where the source has, or may have, an alpha of its own.
fn has_alpha(host: &Host, instance: Handle) -> bool {
    let Some(source) = Clip::of(host, instance, SOURCE).filter(|clip| !clip.is_open()) else { return true };
    let says = |property, value: &CStr| source.properties.string(property, 0).as_deref() == Some(value);
    !(says(kOfxImageEffectPropComponents, kOfxImageComponentRGB)
        || says(kOfxImageEffectPropComponents, kOfxImageComponentAlpha)
        || says(kOfxImageEffectPropPreMultiplication, kOfxImageOpaque))
}

/// Lets a control be used, or greys it.
fn enable(host: &Host, params: Handle, name: &CStr, on: bool) {
    let Some(get) = host.parameters.paramGetHandle else { return };
    let (mut param, mut set) = (null_mut(), null_mut());
    // SAFETY: a set that the host gave, a string with a closing zero, and places for the answers.
    let status = unsafe { get(params, name.as_ptr(), &raw mut param, &raw mut set) };
    let set = host.set(set);
    if status == kOfxStatOK && set.int(kOfxParamPropEnabled, 0).unwrap_or(1) != i32::from(on) {
        set.set_int(kOfxParamPropEnabled, on.into());
    }
}
