//! The nodes of the library with everything that they say about themselves.

use serde::Serialize;

use super::error::{Result, check};
use super::library::{Library, status_name};
use super::text;
use isophote_abi::{self as c, IsophoteNode, IsophoteParam, IsophotePort};

/// All nodes of the library.
#[derive(Clone, Debug, Serialize)]
pub struct Catalogue {
    /// The nodes, in the library's order.
    pub nodes: Vec<Node>,
}

/// A node.
#[derive(Clone, Debug, Serialize)]
pub struct Node {
    /// Stable name.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
    /// Group that it belongs to, such as `smoothing`.
    pub group: &'static str,
    /// One sentence in artists' words.
    pub hint: &'static str,
    /// All that is written about it: the hint, and documentation after an empty line.
    pub doc: &'static str,
    /// Sections of the thesis.
    pub section: &'static str,
    /// Ports that it reads.
    pub inputs: Vec<Port>,
    /// Port that it gives.
    pub output: Port,
    /// Its parameters.
    pub params: Vec<Param>,
}

/// An input or output.
#[derive(Clone, Debug, Serialize)]
pub struct Port {
    /// Stable name.
    pub id: &'static str,
    /// Kind of image that it takes or gives.
    pub kind: Kind,
    /// True where the node works without it.
    pub optional: bool,
    /// One sentence.
    pub doc: &'static str,
}

/// Kind of image that flows through a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// RGBA.
    Color,
    /// One channel.
    Scalar,
    /// A symmetric tensor.
    Tensor,
    /// View-space normals.
    Normal,
    /// Distances from the camera.
    Depth,
    /// Object numbers.
    ObjectId,
    /// A painted direction and its strength.
    Flow,
    /// Places of things in a neighbouring frame.
    Motion,
    /// Points in space.
    Position,
    /// What an artist wants of places.
    Control,
    /// Hatching in tones.
    Hatching,
    /// Things by the ids of their names.
    Cryptomatte,
    /// Something that this program does not know.
    Other,
}

impl Kind {
    pub(super) fn new(kind: c::IsophoteKind) -> Self {
        match kind {
            c::ISOPHOTE_KIND_COLOR => Self::Color,
            c::ISOPHOTE_KIND_SCALAR => Self::Scalar,
            c::ISOPHOTE_KIND_TENSOR => Self::Tensor,
            c::ISOPHOTE_KIND_NORMAL => Self::Normal,
            c::ISOPHOTE_KIND_DEPTH => Self::Depth,
            c::ISOPHOTE_KIND_OBJECT_ID => Self::ObjectId,
            c::ISOPHOTE_KIND_FLOW => Self::Flow,
            c::ISOPHOTE_KIND_MOTION => Self::Motion,
            c::ISOPHOTE_KIND_POSITION => Self::Position,
            c::ISOPHOTE_KIND_CONTROL => Self::Control,
            c::ISOPHOTE_KIND_HATCHING => Self::Hatching,
            c::ISOPHOTE_KIND_CRYPTOMATTE => Self::Cryptomatte,
            _ => Self::Other,
        }
    }

    /// True where it can be written to a picture file.
    pub const fn is_picture(self) -> bool {
        matches!(self, Self::Color | Self::Scalar)
    }

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Color => "colour",
            Self::Scalar => "scalar",
            Self::Tensor => "tensor",
            Self::Normal => "normal",
            Self::Depth => "depth",
            Self::ObjectId => "object id",
            Self::Flow => "flow map",
            Self::Motion => "motion",
            Self::Position => "position",
            Self::Control => "control map",
            Self::Hatching => "hatching",
            Self::Cryptomatte => "Cryptomatte",
            Self::Other => "something unknown",
        }
    }
}

/// A parameter.
#[derive(Clone, Debug, Serialize)]
pub struct Param {
    /// Stable name.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
    /// One sentence or two in artists' words, for panels.
    pub hint: &'static str,
    /// All that is written about it: the hint, and after an empty line documentation, where there is any.
    pub doc: &'static str,
    /// Heading under which panels show it; empty for the node's own.
    pub group: &'static str,
    /// `px` (scaled with the picture), `%`, `deg`, or empty.
    pub unit: &'static str,
    /// True where a change may change the passes of a plan.
    pub structural: bool,
    /// Type, default and ranges.
    #[serde(flatten)]
    pub kind: ParamKind,
}

/// Type of a parameter with its default and ranges.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ParamKind {
    /// One that this program does not know, of a later library; it keeps its default.
    Unknown {
        /// Its number in the contract.
        number: u32,
    },
    /// A number.
    Float {
        /// Default.
        default: f32,
        /// Hard range.
        range: [f32; 2],
        /// Range of a slider.
        slider: [f32; 2],
    },
    /// A whole number.
    Int {
        /// Default.
        default: i64,
        /// Hard range.
        range: [i64; 2],
        /// Range of a slider.
        slider: [i64; 2],
    },
    /// On or off.
    Bool {
        /// Default.
        default: bool,
    },
    /// One of several.
    Choice {
        /// Id of the default.
        default: &'static str,
        /// All options.
        options: Vec<Choice>,
    },
    /// RGBA, gamma-encoded sRGB, 0 to 1.
    Color {
        /// Default.
        default: [f32; 4],
    },
}

/// One option of a choice.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Choice {
    /// Stable name.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
}

/// Id of the parameter by which a style chooses between media.
const MEDIUM: &str = "style";

impl Node {
    /// Media that a style draws with beside the one that it has by itself, each with the parameter that chooses it. They are
    /// known as styles are.
    pub fn media(&self) -> impl Iterator<Item = (&Param, Choice)> {
        let is_medium = |param: &&Param| self.group == "styles" && param.id == MEDIUM;
        self.params.iter().filter(is_medium).flat_map(|param| {
            let ParamKind::Choice { default, options } = &param.kind else { return Vec::new() };
            options.iter().filter(|o| o.id != *default).map(|option| (param, *option)).collect()
        })
    }
}

impl Library {
    /// All nodes.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library fails.
    pub fn catalogue(&self) -> Result<Catalogue> {
        let mut catalogue = c::IsophoteCatalogue { nodes: std::ptr::null(), node_count: 0 };
        // SAFETY: `catalogue` may be written during the call.
        let status = unsafe { (self.api.catalogue)(&raw mut catalogue) };
        check(status, || format!("the catalogue: {}", status_name(self.api, status)))?;
        // SAFETY: the library's nodes live as long as it is loaded, which is until the process ends.
        let nodes = unsafe { text::slice(catalogue.nodes, catalogue.node_count) };
        // SAFETY: the nodes are the library's own.
        Ok(Catalogue { nodes: nodes.iter().map(|n| unsafe { node(n) }).collect() })
    }

    /// The node of an id.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is none, naming the nearest.
    pub fn find_node(&self, id: &str) -> Result<Node> {
        let id = text::argument(id)?;
        let mut found = std::ptr::null();
        let (status, message) = text::message(|error| {
            // SAFETY: the id ends with a zero; the other two may be written during the call.
            unsafe { (self.api.find_node)(id.as_ptr(), error, &raw mut found) }
        });
        check(status, || message)?;
        // SAFETY: success means that `found` points to a node of the library.
        Ok(unsafe { node(&*found) })
    }
}

/// # Safety
/// Everything that `node` points to is the library's and lives until the process ends.
pub(super) unsafe fn node(node: &IsophoteNode) -> Node {
    // SAFETY: as the caller promised.
    unsafe {
        let inputs = text::slice(node.inputs, node.input_count);
        let params = text::slice(node.params, node.param_count);
        Node {
            id: text::constant(node.id),
            label: text::constant(node.label),
            group: text::constant(node.group),
            hint: hint(text::constant(node.doc)),
            doc: text::constant(node.doc),
            section: text::constant(node.section),
            inputs: inputs.iter().map(|p| port(p)).collect(),
            output: port(&node.output),
            params: params.iter().map(|p| param(p)).collect(),
        }
    }
}

/// The first paragraph of a text.
fn hint(text: &str) -> &str {
    text.split_once("\n\n").map_or(text, |(hint, _)| hint)
}

/// # Safety
/// As [`node`].
unsafe fn port(port: &IsophotePort) -> Port {
    // SAFETY: as the caller promised.
    unsafe {
        Port {
            id: text::constant(port.id),
            kind: Kind::new(port.kind),
            optional: port.optional != 0,
            doc: text::constant(port.doc),
        }
    }
}

/// # Safety
/// As [`node`].
unsafe fn param(param: &IsophoteParam) -> Param {
    // SAFETY: as the caller promised.
    unsafe {
        Param {
            id: text::constant(param.id),
            label: text::constant(param.label),
            hint: hint(text::constant(param.doc)),
            doc: text::constant(param.doc),
            group: text::constant(param.group),
            unit: match param.unit {
                c::ISOPHOTE_UNIT_PIXELS => "px",
                c::ISOPHOTE_UNIT_PERCENT => "%",
                c::ISOPHOTE_UNIT_DEGREES => "deg",
                _ => "",
            },
            structural: param.structural != 0,
            kind: param_kind(param),
        }
    }
}

/// # Safety
/// As [`node`].
unsafe fn param_kind(param: &IsophoteParam) -> ParamKind {
    let range = [param.minimum, param.maximum];
    let slider = [param.slider_minimum, param.slider_maximum];
    let first = param.default_value[0];
    match param.kind {
        c::ISOPHOTE_PARAM_INT => ParamKind::Int {
            default: first as i64,
            range: range.map(|v| v as i64),
            slider: slider.map(|v| v as i64),
        },
        c::ISOPHOTE_PARAM_BOOL => ParamKind::Bool { default: first != 0.0 },
        c::ISOPHOTE_PARAM_CHOICE => {
            // SAFETY: as the caller promised.
            let options: Vec<Choice> = unsafe { text::slice(param.choices, param.choice_count) }
                .iter()
                // SAFETY: as the caller promised.
                .map(|o| unsafe { Choice { id: text::constant(o.id), label: text::constant(o.label) } })
                .collect();
            let default = options.get(first as usize).map_or("", |o| o.id);
            ParamKind::Choice { default, options }
        }
        c::ISOPHOTE_PARAM_COLOR => ParamKind::Color { default: param.default_value.map(|v| v as f32) },
        c::ISOPHOTE_PARAM_FLOAT => ParamKind::Float {
            default: first as f32,
            range: range.map(|v| v as f32),
            slider: slider.map(|v| v as f32),
        },
        number => ParamKind::Unknown { number },
    }
}

#[cfg(test)]
mod tests {
    use std::ptr::null;

    use super::*;

    #[test]
    fn a_kind_of_parameter_that_nobody_knows_is_called_unknown() {
        let text = c"later".as_ptr();
        let later = IsophoteParam {
            id: text,
            label: text,
            doc: text,
            group: text,
            kind: 99,
            unit: 99,
            structural: 0,
            choice_count: 0,
            choices: null(),
            default_value: [1.0; 4],
            minimum: 0.0,
            maximum: 2.0,
            slider_minimum: 0.0,
            slider_maximum: 2.0,
        };
        // SAFETY: the texts end with a zero and live for ever, and there is no list of options.
        let param = unsafe { param(&later) };
        assert!(matches!(param.kind, ParamKind::Unknown { number: 99 }), "{:?}", param.kind);
        assert!(Kind::new(99) == Kind::Other && Kind::Other.name() == "something unknown");
    }
}
