//! The effects: every node from colour to colour, the line filters and the pair of structure nodes,
//! each derived from the nodes' declarations. Nothing is written down per effect.
//!
//! An effect is a small graph. Its controls are the parameters of the graph's nodes (those of any but
//! the first node under a prefix, so that neither can ever take the other's name) and the few that an
//! image effect adds itself.

use super::clips::guides;
use super::colours::{AS_IS, SPACES};
use super::mask::MASK_OPTIONS;
use super::motion::{MOTION_OPTIONS, estimate};
use isophote::engine::Support;
use isophote::frames::Frames;
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote::spec::{ImageKind, NodeSpec, Param, Unit};
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
            grouping: text(&format!("Isophote/{}", shown.group)),
            description: text(&format!("{}\n\nThesis: section {}.", shown.doc, shown.section)),
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
            self.add(LINES_OUTPUT, "Output", LINES_HINT, "", Target::LinesOutput);
        }
        for (index, node) in self.nodes.clone().into_iter().enumerate() {
            for param in node.params() {
                let target = Target::Param(index, param);
                let hint = match param.unit {
                    Unit::Pixels => format!("{} In pixels of the full-size picture.", param.doc),
                    Unit::Percent => format!("{} In percent.", param.doc),
                    Unit::Degrees => format!("{} In degrees.", param.doc),
                    Unit::None => param.doc.to_owned(),
                };
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
        let mut label = id.to_owned();
        if let Some(first) = label.get_mut(0..1) {
            first.make_ascii_uppercase();
        }
        self.groups.push(Group { name, label: text(&label), open: id != "advanced" });
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

const LINES_HINT: &str = "The edge image alone, 1 = paper and 0 = line, or its lines over the picture.";
const SPACE_HINT: &str = "What the numbers of the pixels mean. Filters are tuned for gamma-encoded colour; linear \
                          pictures are encoded on the way in and decoded on the way out. 'As is' changes nothing.";
const HEIGHT_HINT: &str = "Height of pictures, in pixels, at which lengths are meant: with 1080 pictures of all sizes get the \
                           same look. 0: lengths are pixels of the full-size picture.";

/// The reference height of new instances, as the other faces have it.
pub const USUAL_REFERENCE: u32 = 1080;
const ALPHA_HINT: &str =
    "Filters alpha together with the colour. Off, the result has the alpha of the source.";
const MASK_HINT: &str = "Lets the mask decide where the effect shows.";
const MASK_FROM_HINT: &str = "What of the mask's picture says where the effect shows.";
const MASK_INVERT_HINT: &str = "Shows the effect where the mask is dark or transparent.";
const MOTION_HINT: &str = "Where the motion between frames comes from, along which they are steadied: the clips Motion \
                           and Motion forward, or an estimate from the pictures.";
const CONVENTION_HINT: &str = "What the vectors of the clips Motion and Motion forward mean. One of the clips is enough: \
                               it stands for the other direction, too.";

#[cfg(test)]
mod tests {
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
