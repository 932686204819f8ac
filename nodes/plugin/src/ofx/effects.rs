//! The effects: every node from colour to colour, the line filters and the pair of structure nodes,
//! each derived from the nodes' declarations. Nothing is written down per effect.
//!
//! An effect is a small graph. Its controls are the parameters of the graph's nodes (those of any but
//! the first node under a prefix, so that neither can ever take the other's name) and the few that an
//! image effect adds itself.

use super::card::{
    CARD, CARD_HINT, CARD_OPTIONS, COMPUTE_HINT, COMPUTE_ON, COMPUTE_OPTIONS, PRECISION, PRECISION_HINT,
    PRECISION_OPTIONS,
};
use super::clips::guides;
use super::colours::{AS_IS, SPACES};
use super::mask::MASK_OPTIONS;
use super::motion::{MOTION_OPTIONS, estimate};
use isophote::engine::Support;
use isophote::frames::Frames;
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote::spec::{ImageKind, MIX, NodeSpec, Param, Unit};
use isophote::{Graph, NodeId, Planned, Request};
use isophote_colour::Space;
use isophote_motion::Convention;
use std::ffi::{CStr, CString};
use std::sync::LazyLock;

/// Before the id of every effect: the reverse name of the project.
const PREFIX: &str = "org.isophote.";

/// Names of the controls of an effect's own.
pub const WORKING_SPACE: &CStr = c"working_space";
pub const PROCESS_ALPHA: &str = "process_alpha";
pub const MASK_APPLY: &str = "mask_apply";
pub const MASK_FROM: &str = "mask_from";
pub const MASK_INVERT: &str = "mask_invert";
pub const REFERENCE_HEIGHT: &str = "reference_height";
pub const LINES_OUTPUT: &str = "lines_output";
pub const MOTION_FROM: &str = "motion_from";
pub const MOTION_CONVENTION: &str = "motion_convention";

/// Connection of the nodes of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// One node from colour to colour.
    Colour,
    /// A node from colour to lines, and one that draws them over the picture.
    Lines,
    /// A node from colour to tensors, and one that shows them.
    Structure,
}

/// Results that an effect of lines can show.
pub const LINE_OUTPUTS: [&CStr; 2] = [c"Lines only", c"Lines over source"];

/// Choice that a control decides.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// A parameter of the node at this position.
    Param(usize, &'static Param),
    /// Lines alone, or over the picture.
    LinesOutput,
    /// Meaning of the pixels' numbers.
    WorkingSpace,
    /// Filtering of alpha too, instead of taking the source's.
    ProcessAlpha,
    /// Height of pictures at which lengths are meant.
    ReferenceHeight,
    /// Use of a connected mask. For hosts that call every clip connected.
    MaskApply,
    /// Part of the mask's pixels that counts.
    MaskFrom,
    /// Use of the mask the other way round.
    MaskInvert,
    /// Source of motion between frames.
    MotionFrom,
    /// Meaning of the vectors of a connected clip.
    MotionConvention,
    /// Device that computes: the CPU, or a graphics card.
    ComputeOn,
    /// Graphics card that is used.
    Card,
    /// Precision of numbers on a graphics card.
    Precision,
}

impl Target {
    /// True where it decides nothing where there is no clip but the source.
    pub fn is_of_clips(&self) -> bool {
        matches!(
            self,
            Self::MaskApply | Self::MaskFrom | Self::MaskInvert | Self::MotionFrom | Self::MotionConvention
        )
    }
}

/// A control that hosts show.
#[derive(Debug)]
pub struct Control {
    /// Stable name, fit for scripts.
    pub name: CString,
    /// For people.
    pub label: CString,
    /// One sentence or two.
    pub hint: CString,
    /// Position in [`Effect::groups`], when it stands under a heading.
    pub group: Option<usize>,
    /// Choice that it decides.
    pub target: Target,
    /// Labels of a choice's options.
    pub options: Vec<CString>,
}

/// A heading.
#[derive(Debug)]
pub struct Group {
    /// Stable name.
    pub name: CString,
    /// For people.
    pub label: CString,
    /// True where its controls show at first.
    pub open: bool,
}

/// One image effect.
#[derive(Debug)]
pub struct Effect {
    pub identifier: CString,
    pub label: CString,
    pub grouping: CString,
    pub description: CString,
    pub icons: [CString; 2],
    pub form: Form,
    pub nodes: Vec<&'static NodeSpec>,
    pub groups: Vec<Group>,
    pub controls: Vec<Control>,
    /// Guides that it takes as clips.
    pub guides: Vec<GraphInput>,
    /// True where it can look at neighbouring frames.
    pub temporal: bool,
    /// True where a tile needs only the pixels around it, at the default values: in hosts of one frame, and in others.
    local: [bool; 2],
}

/// Side of a picture that is larger than a tile, in pixels.
const LARGE: u32 = 8192;

/// True where a tile needs only the pixels around it. A pyramid up to one pixel reaches as far as its picture does,
/// which is far enough to be everything.
///
/// # Errors
/// The errors of planning.
pub fn is_local(graph: &Graph, guides: Guides, frames: Frames) -> isophote::Result<bool> {
    let planned = Planned::new(graph, Request { guides, frames, ..Request::new(LARGE, LARGE) })?;
    Ok(matches!(planned.plan().support(), Support::Pixels(halo) if halo < LARGE / 2))
}

/// All effects, in the order of the catalogue.
pub static EFFECTS: LazyLock<Vec<Effect>> =
    LazyLock::new(|| isophote::registry::nodes().iter().filter_map(|node| Effect::of(node)).collect());

/// A word with a capital first letter, as all labels have.
fn capital(word: &str) -> String {
    let mut label = word.to_owned();
    if let Some(first) = label.get_mut(0..1) {
        first.make_ascii_uppercase();
    }
    label
}

/// The hint of a parameter, with its unit.
fn hint(param: &Param) -> String {
    let unit = match param.unit {
        Unit::Pixels => " In pixels at the reference height.",
        Unit::Percent => " In per cent.",
        Unit::Degrees => " In degrees.",
        Unit::None => "",
    };
    [param.hint, unit].concat()
}

/// Text without what C strings and menus cannot hold.
fn text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

impl Effect {
    /// The effect that a node becomes, if it becomes one.
    fn of(node: &'static NodeSpec) -> Option<Self> {
        let from_colour = node.reads_colour_alone();
        let find = |id| isophote::registry::find(id).ok();
        match node.output.kind {
            ImageKind::Color if from_colour => Self::new(Form::Colour, vec![node], node),
            ImageKind::Scalar if from_colour => {
                Self::new(Form::Lines, vec![node, find("composite_lines")?], node)
            }
            ImageKind::Color if node.id == "tensor_view" => {
                Self::new(Form::Structure, vec![find("structure_tensor")?, node], node)
            }
            _ => None,
        }
    }

    fn new(form: Form, nodes: Vec<&'static NodeSpec>, shown: &NodeSpec) -> Option<Self> {
        let (id, label) = match form {
            Form::Structure => ("structure", "Structure"),
            _ => (shown.id, shown.label),
        };
        let identifier = format!("{PREFIX}{id}");
        let mut effect = Self {
            // Some hosts stumble over a hyphen in a label.
            label: text(&label.replace('-', " ")),
            grouping: text(&format!("Isophote/{}", capital(shown.group))),
            description: text(shown.hint),
            icons: [text(&format!("{identifier}.svg")), text(&format!("{identifier}.png"))],
            identifier: text(&identifier),
            form,
            groups: Vec::new(),
            controls: Vec::new(),
            // The second node, if there is one, works on what the first makes.
            guides: guides().filter(|guide| reads(nodes[0], *guide)).collect(),
            temporal: nodes.iter().any(|node| node.is_steady()),
            local: [true; 2],
            nodes,
        };
        effect.add_controls();
        let (mut graph, _) = effect.graph(false).ok()?;
        let alone = is_local(&graph, Guides::default(), Frames::NONE).ok()?;
        effect.local = [alone; 2];
        if graph.frames() != [0, 0] {
            estimate(&mut graph).ok()?;
            let [past, future] = graph.frames();
            effect.local[1] = is_local(&graph, Guides::default(), Frames::around(past, future)).ok()?;
        }
        Some(effect)
    }

    /// True where a tile needs only the pixels around it, at the default values, in a host that gives neighbouring
    /// frames or in one that does not.
    pub fn is_local(&self, temporal: bool) -> bool {
        self.local[usize::from(temporal)]
    }

    fn add_controls(&mut self) {
        if self.form == Form::Lines {
            self.add(LINES_OUTPUT, "Show", LINES_HINT, "", Target::LinesOutput);
        }
        for (index, node) in self.nodes.clone().into_iter().enumerate() {
            for param in node.params() {
                let target = Target::Param(index, param);
                if param.id == MIX.id {
                    continue;
                }
                let hint = hint(param);
                if index == 0 {
                    self.add(param.id, param.label, &hint, param.group, target);
                } else {
                    let (prefix, group) = if self.form == Form::Lines {
                        ("lines", "lines over source")
                    } else {
                        ("view", "view")
                    };
                    self.add(&format!("{prefix}_{}", param.id), param.label, &hint, group, target);
                }
            }
        }
        self.add_common();
    }

    /// Controls that stand at the end of a page, those of the nodes' results last, where hosts have them.
    fn add_common(&mut self) {
        if self.temporal {
            self.add(MOTION_FROM, "Motion from", MOTION_HINT, "time", Target::MotionFrom);
            self.add(
                MOTION_CONVENTION,
                "Motion convention",
                CONVENTION_HINT,
                "time",
                Target::MotionConvention,
            );
        }
        for (name, label, hint, target) in [
            (COMPUTE_ON, "Compute on", COMPUTE_HINT, Target::ComputeOn),
            (CARD, "Card", CARD_HINT, Target::Card),
            (PRECISION, "Card precision", PRECISION_HINT, Target::Precision),
        ] {
            self.add(&name.to_string_lossy(), label, hint, "computing", target);
        }
        self.add(
            &WORKING_SPACE.to_string_lossy(),
            "Working space",
            SPACE_HINT,
            "output",
            Target::WorkingSpace,
        );
        self.add(REFERENCE_HEIGHT, "Reference height", HEIGHT_HINT, "output", Target::ReferenceHeight);
        self.add(PROCESS_ALPHA, "Process alpha", ALPHA_HINT, "output", Target::ProcessAlpha);
        self.add(MASK_APPLY, "Apply mask", MASK_HINT, "output", Target::MaskApply);
        self.add(MASK_FROM, "Mask from", MASK_FROM_HINT, "output", Target::MaskFrom);
        self.add(MASK_INVERT, "Invert mask", MASK_INVERT_HINT, "output", Target::MaskInvert);
        for (index, node) in self.nodes.clone().into_iter().enumerate().filter(|(_, node)| node.has_mix()) {
            let name = if index == 0 { MIX.id.to_owned() } else { format!("lines_{}", MIX.id) };
            if let Some((_, param)) = node.param(MIX.id) {
                self.add(&name, param.label, &hint(param), param.group, Target::Param(index, param));
            }
        }
        // Under one heading, controls follow one another.
        self.controls.sort_by_key(|c| c.group);
    }

    fn add(&mut self, name: &str, label: &str, hint: &str, group: &str, target: Target) {
        let group = (!group.is_empty()).then(|| self.group(group));
        let options = match target {
            Target::Param(_, param) => param.options.iter().map(|o| text(o.label)).collect(),
            Target::LinesOutput => LINE_OUTPUTS.map(CStr::to_owned).to_vec(),
            Target::WorkingSpace => {
                SPACES.iter().map(|space| text(space.map_or(AS_IS, Space::label))).collect()
            }
            Target::MaskFrom => MASK_OPTIONS.map(CStr::to_owned).to_vec(),
            Target::MotionFrom => MOTION_OPTIONS.map(CStr::to_owned).to_vec(),
            Target::ComputeOn => COMPUTE_OPTIONS.map(CStr::to_owned).to_vec(),
            Target::Card => CARD_OPTIONS.map(CStr::to_owned).to_vec(),
            Target::Precision => PRECISION_OPTIONS.map(CStr::to_owned).to_vec(),
            Target::MotionConvention => Convention::PRESETS.iter().map(|c| text(c.label)).collect(),
            _ => Vec::new(),
        };
        let (name, label, hint) = (text(name), text(label), text(hint));
        self.controls.push(Control { name, label, hint, group, target, options });
    }

    /// Position of the heading, which is added when it is new.
    fn group(&mut self, id: &str) -> usize {
        let name = text(&format!("group_{}", id.replace(' ', "_")));
        if let Some(at) = self.groups.iter().position(|g| g.name == name) {
            return at;
        }
        self.groups.push(Group {
            name,
            label: text(&capital(id)),
            open: !["advanced", "computing"].contains(&id),
        });
        self.groups.len() - 1
    }

    /// The effect's graph, with default values, and its nodes. `over`: lines over the picture.
    ///
    /// # Errors
    /// None that a test would not have met.
    pub fn graph(&self, over: bool) -> isophote::Result<(Graph, Vec<NodeId>)> {
        let mut graph = Graph::new();
        let ids: Vec<NodeId> =
            self.nodes.iter().map(|node| graph.add(node.id, node.id)).collect::<isophote::Result<_>>()?;
        for (node, id) in self.nodes.iter().zip(&ids) {
            for input in [GraphInput::Color].into_iter().chain(guides()).filter(|input| reads(node, *input)) {
                graph.connect_input(input, *id, input.id())?;
            }
        }
        if let [first, second] = ids[..] {
            let port = self.nodes[1].inputs.iter().find(|p| p.kind == self.nodes[0].output.kind);
            if let Some(port) = port {
                graph.connect(first, second, port.id)?;
            }
        }
        let shown = if self.form == Form::Lines && !over { ids[0] } else { ids[ids.len() - 1] };
        graph.set_output(shown)?;
        Ok((graph, ids))
    }
}

/// True where a node has a port for an input of the graph.
fn reads(node: &NodeSpec, input: GraphInput) -> bool {
    node.ports().any(|port| port.id == input.id() && port.kind == input.kind())
}

const LINES_HINT: &str = "The lines alone, black on white, or the lines over the picture.";
const SPACE_HINT: &str = "Colour space of the pictures that come in and go out; the effect itself works in display colours. \
                          'As is' changes nothing.";
const HEIGHT_HINT: &str = "Height in pixels that sizes are meant for: 1080 gives pictures of every size the same look, \
                           0 takes sizes in pixels of the full picture.";
const ALPHA_HINT: &str =
    "Filters alpha together with the colour. Off, the result has the alpha of the source.";
const MASK_HINT: &str = "Lets the mask decide where the effect shows.";
const MASK_FROM_HINT: &str = "Part of the mask's picture that says where the effect shows.";
const MASK_INVERT_HINT: &str = "Shows the effect where the mask is dark or transparent.";
const MOTION_HINT: &str = "Source of the motion by which frames are steadied: the clips Motion and Motion forward, or an \
                           estimate from the pictures.";
const CONVENTION_HINT: &str = "Program that the motion vectors of the clips come from. One clip is enough: it also stands for \
                               the other direction.";

/// The reference height of new instances, as the other faces have it.
pub const USUAL_REFERENCE: u32 = 1080;

#[cfg(test)]
mod tests {
    use super::super::clips::{MASK, OUTPUT, SOURCE, guide_label};
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_node_from_colour_is_an_effect_once() {
        let ids: BTreeSet<&CStr> = EFFECTS.iter().map(|e| e.identifier.as_c_str()).collect();
        assert_eq!(ids.len(), EFFECTS.len());
        for node in isophote::registry::nodes() {
            if node.group == "styles" || (node.has_mix() && node.reads_colour_alone()) {
                assert!(ids.contains(text(&format!("{PREFIX}{}", node.id)).as_c_str()), "{}", node.id);
            }
        }
        assert!(ids.contains(c"org.isophote.structure"));
    }

    /// Hosts cut longer ones, or show them badly.
    #[test]
    fn labels_and_hints_are_short_and_no_two_controls_have_one_label() {
        for effect in EFFECTS.iter() {
            let id = effect.identifier.to_string_lossy();
            let short = |text: &CStr| {
                let shown = text.to_string_lossy();
                let good = shown.chars().count() < 20 && shown.starts_with(|c: char| c.is_uppercase());
                assert!(good, "{id}: label {shown:?}");
                shown.into_owned()
            };
            short(&effect.label);
            let description = effect.description.to_string_lossy();
            assert!(
                !description.contains(['`', '§']) && !description.contains("Fig."),
                "{id}: {description}"
            );
            effect.groups.iter().for_each(|group| drop(short(&group.label)));
            let mut known: BTreeSet<String> =
                effect.guides.iter().filter_map(|guide| guide_label(*guide)).map(short).collect();
            known.extend([SOURCE, OUTPUT, MASK].map(short));
            for control in &effect.controls {
                assert!(
                    known.insert(short(&control.label)),
                    "{id}: two controls are called {:?}",
                    control.label
                );
                let hint = control.hint.to_string_lossy();
                let fits = (10..160).contains(&hint.chars().count()) && hint.ends_with('.');
                assert!(fits && !hint.contains('`'), "{id}: {:?} says {hint:?}", control.label);
                let fits = |option: &CString| option.to_string_lossy().chars().count() < 20;
                assert!(control.options.iter().all(fits), "{id}: options {:?}", control.options);
            }
            let last = effect.controls.last().unwrap();
            let has_mix = effect.nodes.iter().any(|node| node.has_mix());
            assert_eq!(last.label.as_c_str() == c"Mix", has_mix, "{id}: {:?} is last", last.label);
        }
    }

    #[test]
    fn names_are_unique_and_fit_for_scripts() {
        for effect in EFFECTS.iter() {
            let names = effect.controls.iter().map(|c| &c.name).chain(effect.groups.iter().map(|g| &g.name));
            let mut known = BTreeSet::new();
            for name in names {
                let shown = name.to_string_lossy();
                let fit = shown.starts_with(|c: char| c.is_ascii_lowercase())
                    && shown.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
                assert!(fit && known.insert(name), "{:?}: {shown}", effect.identifier);
            }
            for control in &effect.controls {
                let distinct: BTreeSet<_> = control.options.iter().collect();
                assert_eq!(distinct.len(), control.options.len(), "{:?}", control.name);
            }
        }
    }
}
