//! The values of an instance's controls at one time, as a graph. Read when they are needed and never
//! kept, since hosts change them without a word.

use super::card::{CARD, COMPUTE_ON, Card, PRECISION};
use super::colours::{self, SPACES};
use super::effects::{Control, Effect, Form, Target, USUAL_REFERENCE};
use super::host::{Host, Outcome};
use super::mask::{MaskFrom, MaskRule};
use super::motion::MotionFrom;
use isophote::spec::{Param, Unit};
use isophote::{Graph, NodeId, Value};
use isophote_abi::openfx::*;
use isophote_colour::Space;
use isophote_motion::Convention;
use std::ffi::{CStr, c_int};
use std::ptr::null_mut;

/// Settings of an instance.
#[derive(Debug)]
pub struct Settings {
    /// The effect's graph with its values.
    pub graph: Graph,
    /// Its nodes, in the order of the effect's.
    pub ids: Vec<NodeId>,
    /// Space of the pixels.
    pub space: Space,
    /// True where the user says so, whatever the host does.
    pub as_is: bool,
    /// Height of pictures at which lengths are meant; 0: any.
    pub reference_height: u32,
    /// True where alpha is filtered too.
    pub process_alpha: bool,
    /// Rule by which a mask is read; none where none counts.
    pub mask: Option<MaskRule>,
    /// Source of motion between frames.
    pub motion_from: MotionFrom,
    /// Meaning of the vectors of clips.
    pub convention: Convention,
    /// Graphics card that computes; none for the CPU.
    pub card: Option<Card>,
    /// Numbers that must be 0 for the values to leave the picture as it is: the least of those that do so at
    /// 0. The first is a plain number, the second a length in pixels of the full-size picture.
    least: [f32; 2],
}

/// Lengths below this share of a rendered pixel count as 0.
const LEAST_LENGTH: f32 = 0.01;

impl Settings {
    /// The values at `time`. What the host does not give keeps its default.
    ///
    /// # Errors
    /// Failed, when the host has no parameters or the graph refuses a value.
    pub fn read(effect: &Effect, host: &Host, instance: Handle, time: f64) -> Outcome<Self> {
        let values = Values { host, set: host.params(instance)?, time };
        let mut over = false;
        let (mut space, mut as_is) = (host.quirks.space, false);
        let mut reference_height = USUAL_REFERENCE;
        let mut process_alpha = false;
        let (mut motion_from, mut convention) = (MotionFrom::default(), Convention::OWN);
        for control in &effect.controls {
            let name = &control.name;
            match control.target {
                Target::LinesOutput => over = values.int(name) == Some(1),
                Target::WorkingSpace => {
                    if let Some(listed) = values.index(name).and_then(|i| SPACES.get(i)) {
                        (space, as_is) = (listed.unwrap_or(Space::Srgb), listed.is_none());
                    }
                }
                Target::ReferenceHeight => {
                    let height = values.int(name).and_then(|height| u32::try_from(height).ok());
                    reference_height = height.unwrap_or(reference_height);
                }
                Target::ProcessAlpha => process_alpha = values.bool(name).unwrap_or(process_alpha),
                Target::MotionFrom => {
                    motion_from = values.index(name).and_then(MotionFrom::at).unwrap_or_default();
                }
                Target::MotionConvention => {
                    let listed = values.index(name).and_then(|i| Convention::PRESETS.get(i));
                    convention = *listed.unwrap_or(&convention);
                }
                _ => {}
            }
        }
        let (mut graph, ids) = effect.graph(over).map_err(|_| kOfxStatFailed)?;
        let mut least = [f32::INFINITY; 2];
        // A graph may end before the last node, which then decides nothing.
        let shows_colour = effect.form == Form::Colour || (effect.form == Form::Lines && over);
        let last = if effect.form == Form::Lines && !over { 0 } else { ids.len() - 1 };
        for control in &effect.controls {
            let Target::Param(node, param) = control.target else { continue };
            let Some(value) = values.value(&control.name, param) else { continue };
            graph.set(ids[node], param.id, value).map_err(|_| kOfxStatFailed)?;
            // Lines alone are never the picture.
            if node == last && param.neutral_at_zero && shows_colour {
                let kind = usize::from(param.unit == Unit::Pixels);
                least[kind] = least[kind].min(value.form().numbers[0].abs() as f32);
            }
        }
        Ok(Self {
            graph,
            ids,
            space,
            as_is,
            reference_height,
            process_alpha,
            mask: mask(effect, &values),
            motion_from,
            convention,
            card: values.card(),
            least,
        })
    }

    /// Space of the pixels by the host's name of their colour space, which counts more than what they
    /// were said to be.
    pub fn space_of(&self, name: &CStr) -> Space {
        if self.as_is { self.space } else { colours::of_host(name, self.space) }
    }

    /// True where the values leave a picture that is rendered at `scale` as it is.
    pub fn is_identity(&self, scale: f32) -> bool {
        self.least[0] == 0.0 || self.least[1] * scale < LEAST_LENGTH
    }
}

/// Rule by which a mask is read, where one counts.
fn mask(effect: &Effect, values: &Values<'_>) -> Option<MaskRule> {
    let (mut applies, mut rule) = (!values.host.quirks.all_connected, MaskRule::default());
    for Control { name, target, .. } in &effect.controls {
        match target {
            Target::MaskApply => applies = values.bool(name).unwrap_or(applies),
            Target::MaskFrom => rule.from = values.index(name).and_then(MaskFrom::at).unwrap_or_default(),
            Target::MaskInvert => rule.inverted = values.bool(name).unwrap_or_default(),
            _ => {}
        }
    }
    applies.then_some(rule)
}

/// The parameters that have values of their own at different times, each with the position of its node.
///
/// # Errors
/// Failed, when the host has no parameters.
pub fn animated(effect: &Effect, host: &Host, instance: Handle) -> Outcome<Vec<(usize, &'static Param)>> {
    let values = Values { host, set: host.params(instance)?, time: 0.0 };
    let of_node = |control: &Control| match control.target {
        Target::Param(node, param) if values.is_animated(&control.name) => Some((node, param)),
        _ => None,
    };
    Ok(effect.controls.iter().filter_map(of_node).collect())
}

/// Parameters of an instance at a time.
struct Values<'h> {
    host: &'h Host,
    set: Handle,
    time: f64,
}

impl Values<'_> {
    fn handle(&self, name: &CStr) -> Option<Handle> {
        let get = self.host.parameters.paramGetHandle?;
        let mut param = null_mut();
        // SAFETY: a set that the host gave, a string with a closing zero, a place for the answer, and no
        // wish for the properties.
        let status = unsafe { get(self.set, name.as_ptr(), &raw mut param, null_mut()) };
        (status == kOfxStatOK && !param.is_null()).then_some(param)
    }

    fn is_animated(&self, name: &CStr) -> bool {
        let Some((param, count)) = self.handle(name).zip(self.host.parameters.paramGetNumKeys) else {
            return false;
        };
        let mut keys = 0;
        // SAFETY: a parameter that the host gave, and a place for the answer.
        unsafe { count(param, &raw mut keys) == kOfxStatOK && keys > 0 }
    }

    fn int(&self, name: &CStr) -> Option<c_int> {
        let (param, get) = (self.handle(name)?, self.host.parameters.paramGetValueAtTime?);
        let mut value: c_int = 0;
        // SAFETY: integers, booleans and choices are given through one pointer to an int.
        let status = unsafe { get(param, self.time, &raw mut value) };
        (status == kOfxStatOK).then_some(value)
    }

    /// The position of a choice's option.
    fn index(&self, name: &CStr) -> Option<usize> {
        usize::try_from(self.int(name)?).ok()
    }

    /// The graphics card, where the host has the controls and one is chosen.
    fn card(&self) -> Option<Card> {
        Card::of([COMPUTE_ON, CARD, PRECISION].map(|name| self.index(name).unwrap_or_default()))
    }

    fn bool(&self, name: &CStr) -> Option<bool> {
        Some(self.int(name)? != 0)
    }

    fn double(&self, name: &CStr) -> Option<f64> {
        let (param, get) = (self.handle(name)?, self.host.parameters.paramGetValueAtTime?);
        let mut value: f64 = 0.0;
        // SAFETY: doubles are given through one pointer to a double.
        let status = unsafe { get(param, self.time, &raw mut value) };
        (status == kOfxStatOK && !value.is_nan()).then_some(value)
    }

    fn color(&self, name: &CStr) -> Option<[f64; 4]> {
        let (param, get) = (self.handle(name)?, self.host.parameters.paramGetValueAtTime?);
        let mut value = [0.0_f64; 4];
        let [r, g, b, a] = &mut value;
        // SAFETY: colours with alpha are given through four pointers to doubles.
        let status = unsafe { get(param, self.time, &raw mut *r, &raw mut *g, &raw mut *b, &raw mut *a) };
        (status == kOfxStatOK && !value.iter().any(|v| v.is_nan())).then_some(value)
    }

    /// A value within the range of the parameter, which not every host keeps.
    fn value(&self, name: &CStr, param: &Param) -> Option<Value> {
        let numbers = match param.default {
            Value::Float(_) => [self.double(name)?, 0.0, 0.0, 0.0],
            Value::Int(_) | Value::Choice(_) => [self.int(name)?.into(), 0.0, 0.0, 0.0],
            Value::Bool(_) => [u8::from(self.bool(name)?).into(), 0.0, 0.0, 0.0],
            Value::Color(_) => self.color(name)?,
        };
        Some(param.nearest(numbers))
    }
}
