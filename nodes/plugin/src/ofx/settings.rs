//! The values of an instance's controls at one time, as a graph. Read when they are needed and never
//! kept, since hosts change them without a word.

use super::card::{CARD, COMPUTE_ON, Card, PRECISION};
use super::colours::{self, SPACES};
use super::effects::{Control, Effect, Form, Target, USUAL_REFERENCE};
use super::host::{Host, Outcome};
use super::look_effect;
use super::mask::{MaskFrom, MaskRule};
use super::motion::MotionFrom;
use super::values::Values;
use isophote::spec::{Param, Unit};
use isophote::{Graph, NodeId};
use isophote_abi::openfx::*;
use isophote_colour::Space;
use isophote_motion::Convention;
use std::ffi::CStr;

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
    /// Settings that the effect for looks alone has.
    pub look: OfLook,
    /// Numbers that must be 0 for the values to leave the picture as it is: the least of those that do so at
    /// 0. The first is a plain number, the second a length in pixels of the full-size picture.
    least: [f32; 2],
}

/// Settings of an instance that shows any graph.
#[derive(Debug)]
pub struct OfLook {
    /// Share of the result in the picture.
    pub mix: f32,
    /// True where values of the graph differ from frame to frame, which no control shows.
    pub varies: bool,
    /// True where the graph comes from a file.
    pub is_file: bool,
    /// Reason why the source is passed on as it is, and what to do, for people.
    pub fault: Option<String>,
    /// Rules for things that are not followed, and what to do, for people.
    pub left_out: Option<String>,
}

impl Default for OfLook {
    fn default() -> Self {
        Self { mix: 1.0, varies: false, is_file: false, fault: None, left_out: None }
    }
}

/// Lengths below this share of a rendered pixel count as 0.
const LEAST_LENGTH: f32 = 0.01;

impl Settings {
    /// The values at `time`. What the host does not give keeps its default.
    ///
    /// # Errors
    /// Failed, when the host has no parameters or the graph refuses a value.
    pub fn read(effect: &Effect, host: &Host, instance: Handle, time: f64) -> Outcome<Self> {
        let values = Values::of(host, instance, time)?;
        let (mut space, mut as_is) = (host.quirks.space, false);
        let (mut reference_height, mut over, mut process_alpha) = (USUAL_REFERENCE, false, false);
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
        let settings = Self {
            graph,
            ids,
            space,
            as_is,
            reference_height,
            process_alpha,
            mask: mask(effect, &values),
            motion_from,
            convention,
            card: card(&values),
            look: OfLook::default(),
            least,
        };
        Ok(if effect.form == Form::Look { settings.showing_look(instance, &values) } else { settings })
    }

    /// The same with the look of an instance.
    fn showing_look(self, instance: Handle, values: &Values<'_>) -> Self {
        let shown = look_effect::shown(values.host, instance, values);
        let mix = look_effect::mix(values);
        let is_source = shown.fault.is_some() || mix == 0.0;
        Self {
            graph: shown.graph,
            ids: Vec::new(),
            reference_height: if shown.in_pixels { 0 } else { self.reference_height },
            look: OfLook {
                mix,
                varies: shown.varies,
                is_file: shown.is_file,
                fault: shown.fault,
                left_out: shown.left_out,
            },
            least: if is_source { [0.0; 2] } else { [f32::INFINITY; 2] },
            ..self
        }
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
    let values = Values::of(host, instance, 0.0)?;
    let of_node = |control: &Control| match control.target {
        Target::Param(node, param) if values.is_animated(&control.name) => Some((node, param)),
        _ => None,
    };
    Ok(effect.controls.iter().filter_map(of_node).collect())
}

/// The graphics card, where the host has the controls and one is chosen.
fn card(values: &Values<'_>) -> Option<Card> {
    Card::of([COMPUTE_ON, CARD, PRECISION].map(|name| values.index(name).unwrap_or_default()))
}
