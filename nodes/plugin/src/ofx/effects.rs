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
use super::clips::{guides, guides_of};
use super::colours::{AS_IS, SPACES};
use super::look_effect::{FILE, FROM_FILE, LOOK, RELOAD, TIMES_READ, own_numbers, stand_in};
use super::mask::MASK_OPTIONS;
use super::motion::{MOTION_OPTIONS, estimate};
use super::shipped;
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
    /// Any graph: a look, a style, or what is in a file.
    Look,
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
    /// Look whose values the other controls are set to. It decides about no pixel itself.
    Look,
    /// Look or style that is shown, or that of the file.
    Shown,
    /// File with a preset or a graph.
    File,
    /// Reading of the file once more.
    Reload,
    /// Number of times that the user asked for that. Hidden.
    TimesRead,
    /// A number of the effect, and of none of its nodes.
    Own(&'static Param),
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
    Ok(planned.plan().support().sides().is_some_and(|sides| sides.iter().all(|halo| *halo < LARGE / 2)))
}

/// All effects, in the order of the catalogue, and that for looks.
pub static EFFECTS: LazyLock<Vec<Effect>> = LazyLock::new(|| {
    let of_nodes = isophote::registry::nodes().iter().filter_map(|node| Effect::of(node));
    of_nodes.chain(Effect::for_looks()).collect()
});

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

    /// The effect for looks, styles and graphs of all kinds.
    fn for_looks() -> Option<Self> {
        let identifier = format!("{PREFIX}look");
        let mut effect = Self {
            label: text("Isophote Look"),
            grouping: text("Isophote/Styles"),
            description: text(LOOKS_ABOUT),
            icons: [text(&format!("{identifier}.svg")), text(&format!("{identifier}.png"))],
            identifier: text(&identifier),
            form: Form::Look,
            nodes: Vec::new(),
            groups: Vec::new(),
            controls: Vec::new(),
            guides: guides().collect(),
            temporal: true,
            local: [true; 2],
        };
        let name = |name: &CStr| name.to_string_lossy().into_owned();
        effect.add(&name(LOOK), "Look", SHOWN_HINT, "", Target::Shown);
        effect.add(&name(FILE), "File", FILE_HINT, "", Target::File);
        effect.add(&name(RELOAD), "Reload", RELOAD_HINT, "", Target::Reload);
        effect.add(&name(TIMES_READ), "Times read", TIMES_READ_HINT, "", Target::TimesRead);
        effect.add_own_number(0);
        effect.add_common();
        effect.add_own_number(1);
        effect.controls.sort_by_key(|c| c.group);
        effect.find_local()?;
        Some(effect)
    }

    fn add_own_number(&mut self, at: usize) {
        if let Some(param) = own_numbers()[at] {
            self.add(param.id, param.label, &hint(param), param.group, Target::Own(param));
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
            guides: guides_of(nodes[0].id, |guide| reads(nodes[0], guide)),
            temporal: nodes.iter().any(|node| node.is_steady()),
            local: [true; 2],
            nodes,
        };
        effect.add_controls();
        effect.find_local()?;
        Some(effect)
    }

    /// Looks whether a tile needs only the pixels around it, at the default values.
    fn find_local(&mut self) -> Option<()> {
        let (mut graph, _) = self.graph(false).ok()?;
        let alone = is_local(&graph, Guides::default(), Frames::NONE).ok()?;
        self.local = [alone; 2];
        if graph.frames() != [0, 0] {
            estimate(&mut graph).ok()?;
            let [past, future] = graph.frames();
            self.local[1] = is_local(&graph, Guides::default(), Frames::around(past, future)).ok()?;
        }
        Some(())
    }

    /// True where a tile needs only the pixels around it, at the default values, in a host that gives neighbouring
    /// frames or in one that does not.
    pub fn is_local(&self, temporal: bool) -> bool {
        self.local[usize::from(temporal)]
    }

    fn add_controls(&mut self) {
        if self.form == Form::Colour && shipped::of_style(self.nodes[0].id).next().is_some() {
            self.add(&LOOK.to_string_lossy(), "Look", LOOK_HINT, "", Target::Look);
        }
        if self.form == Form::Lines {
            self.add(LINES_OUTPUT, "Show", LINES_HINT, "", Target::LinesOutput);
        }
        for (index, node) in self.nodes.clone().into_iter().enumerate() {
            for param in node.params() {
                let target = Target::Param(index, param);
                if param.group == MIX.group && node.has_mix() {
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
            for param in node.params().filter(|param| param.group == MIX.group) {
                let name = if index == 0 { param.id.to_owned() } else { format!("lines_{}", param.id) };
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
            Target::Look => shipped::options(c"Custom", shipped::of_style(self.nodes[0].id)),
            Target::Shown => shipped::options(FROM_FILE, shipped::all().iter()),
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
        if self.form == Form::Look {
            let graph = stand_in();
            let ids = (0..graph.len()).map(|index| graph.node(index)).collect::<isophote::Result<_>>()?;
            return Ok((graph, ids));
        }
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

const LOOKS_ABOUT: &str = "A look or a style that ships, or a preset or a graph of your own from a file.";
const LOOK_HINT: &str =
    "Sets the other controls to those of a look. They can be changed afterwards; then this says Custom.";
const SHOWN_HINT: &str = "Look or style that is shown. 'From file' shows the preset or graph under File.";
const FILE_HINT: &str = "Preset or graph (.json) that is shown where Look is 'From file'.";
const RELOAD_HINT: &str = "Reads the file once more, after it was changed.";
const TIMES_READ_HINT: &str = "Number of times that Reload was pressed.";
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
}
