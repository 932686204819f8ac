//! What a node says about itself, once: the catalogue, command lines, hosts and documents all walk
//! this declaration.

use crate::choice::Selectable;
pub use crate::param::{Param, Unit};
use crate::value::Value;
use isophote_engine::{Class, ImageId, PlanBuilder};

/// What flows through a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImageKind {
    /// RGBA, gamma-encoded, not premultiplied, inside a graph.
    Color,
    /// One channel.
    Scalar,
    /// A symmetric 2x2 tensor (E, F, G, w), w = validity.
    Tensor,
    /// View-space normal x, y, z in -1..1 and validity.
    Normal,
    /// Distance from the camera, one channel, scene units; 0 or less where there is nothing.
    Depth,
    /// A number per object, one channel; 0 where there is nothing.
    ObjectId,
    /// A painted direction, x and y in red and green, 0.5 for none, and its strength in alpha. Its values are data,
    /// which no colour space changes and nothing multiplies.
    Flow,
}

impl ImageKind {
    /// Name in the catalogue.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Color => "color",
            Self::Scalar => "scalar",
            Self::Tensor => "tensor",
            Self::Normal => "normal",
            Self::Depth => "depth",
            Self::ObjectId => "object_id",
            Self::Flow => "flow",
        }
    }

    /// Values a pixel.
    pub const fn channels(self) -> u32 {
        match self {
            Self::Color | Self::Tensor | Self::Normal | Self::Flow => 4,
            Self::Scalar | Self::Depth | Self::ObjectId => 1,
        }
    }

    /// Precision needed.
    pub const fn class(self) -> Class {
        if matches!(self, Self::Color) { Class::Colour } else { Class::Field }
    }
}

/// An input or output of a node.
#[derive(Clone, Copy, Debug)]
pub struct Port {
    /// Stable name.
    pub id: &'static str,
    /// What it takes or gives.
    pub kind: ImageKind,
    /// True when the node works without it.
    pub optional: bool,
    /// One sentence.
    pub doc: &'static str,
}

/// Everything a node says about itself, and how it describes its work.
#[derive(Debug)]
pub struct NodeSpec {
    /// Stable name: the stem of its file.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
    /// `structure`, `smoothing`, `lines`, `painting`, `coherence`, `colour` or `styles`.
    pub group: &'static str,
    /// One paragraph.
    pub doc: &'static str,
    /// Sections of the thesis, such as "3.4".
    pub section: &'static str,
    /// What it reads; see [`NodeSpec::ports`].
    pub inputs: &'static [Port],
    /// What it gives.
    pub output: Port,
    /// Its own parameters; see [`NodeSpec::params`].
    pub own_params: &'static [Param],
    /// Describes the passes of the node and returns its output.
    pub build: fn(&mut Scope<'_>) -> ImageId,
}

/// `mix`, which every node from colour to colour has.
pub const MIX: Param = Param::float("mix", "Mix", 1.0, [0.0, 1.0])
    .doc("Blend with the input: 0 leaves the picture as it was, 1 shows the filter alone.")
    .group("output")
    .structural()
    .neutral_at_zero();

/// `hold` of nodes that draw by noise.
pub(crate) const HOLD: Param = Param::int("hold", "Hold", 0, [0, 1000])
    .slider(0.0, 24.0)
    .group("time")
    .doc("Frames that hand-drawn noise lasts: 1 draws it anew in each frame, 0 keeps it for ever.");

/// How much of a node's result is used; every node from colour to colour has it.
pub const MASK: Port = Port {
    id: "mask",
    kind: ImageKind::Scalar,
    optional: true,
    doc: "How much of the result is used, 0..=1, times `mix`; all of it when open.",
};

/// What an artist painted for a node to follow; every node from colour to colour has it.
pub const FLOW: Port = Port {
    id: "flow",
    kind: ImageKind::Flow,
    optional: true,
    doc: "A flow map (see `flow_map`) that bends the orientation which the node follows, if it follows any.",
};

impl NodeSpec {
    /// All parameters in the order of panels: the node's own, then `mix` where it applies.
    pub fn params(&self) -> impl Iterator<Item = &'static Param> + use<> {
        static COMMON: [Param; 1] = [MIX];
        let common: &'static [Param] = if self.has_mix() { &COMMON } else { &[] };
        self.own_params.iter().chain(common)
    }

    /// All inputs: the node's own, then `mask` and `flow` where they apply.
    pub fn ports(&self) -> impl Iterator<Item = &'static Port> + use<> {
        static COMMON: [Port; 2] = [MASK, FLOW];
        let common: &'static [Port] = if self.has_mix() { &COMMON } else { &[] };
        self.inputs.iter().chain(common)
    }

    /// True for filters, which smooth the light of a picture beyond its coverage as a picture of its own. What other
    /// nodes draw is no light, and they let it pass.
    pub fn filters_light(&self) -> bool {
        self.has_mix() && matches!(self.group, "smoothing" | "painting" | "coherence")
    }

    /// True for nodes that read a colour and need nothing else: those that are effects by themselves.
    pub fn reads_colour_alone(&self) -> bool {
        self.inputs.iter().any(|p| p.kind == ImageKind::Color)
            && self.inputs.iter().all(|p| p.optional || p.kind == ImageKind::Color)
    }

    /// True for nodes from colour to colour.
    pub fn has_mix(&self) -> bool {
        self.output.kind == ImageKind::Color && self.inputs.iter().any(|p| p.kind == ImageKind::Color)
    }

    /// Position and declaration of a parameter.
    pub fn param(&self, id: &str) -> Option<(usize, &'static Param)> {
        self.params().enumerate().find(|(_, p)| p.id == id)
    }

    /// Position and declaration of an input.
    pub fn input(&self, id: &str) -> Option<(usize, &'static Port)> {
        self.ports().enumerate().find(|(_, p)| p.id == id)
    }
}

/// What a node sees while it describes its work: its parameter values, its connected inputs and the
/// plan to add passes to.
///
/// Asking for a parameter or port that the node did not declare is a mistake in the node and panics;
/// every node is planned in the tests.
pub struct Scope<'a> {
    /// The plan under construction.
    pub plan: &'a mut PlanBuilder,
    pub(crate) spec: &'static NodeSpec,
    pub(crate) values: &'a [Value],
    pub(crate) inputs: &'a [Option<ImageId>],
    pub(crate) scale: f32,
    pub(crate) origin: [f32; 2],
    pub(crate) frame: i64,
}

impl Scope<'_> {
    fn value(&self, id: &str) -> (Value, &'static Param) {
        match self.spec.param(id) {
            Some((index, param)) => (self.values[index], param),
            None => panic!("{} has no parameter '{id}'", self.spec.id),
        }
    }

    /// A number; lengths in pixels come scaled to the size that is rendered.
    pub fn float(&self, id: &str) -> f32 {
        match self.value(id) {
            (Value::Float(v), Param { unit: Unit::Pixels, .. }) => v * self.scale,
            (Value::Float(v), _) => v,
            (other, _) => panic!("{}.{id} is {other:?}, not a number", self.spec.id),
        }
    }

    /// A whole number.
    pub fn int(&self, id: &str) -> i32 {
        match self.value(id).0 {
            Value::Int(v) => v,
            other => panic!("{}.{id} is {other:?}, not a whole number", self.spec.id),
        }
    }

    /// On or off.
    pub fn bool(&self, id: &str) -> bool {
        match self.value(id).0 {
            Value::Bool(v) => v,
            other => panic!("{}.{id} is {other:?}, not a switch", self.spec.id),
        }
    }

    /// The chosen option.
    pub fn option<T: Selectable>(&self, id: &str) -> T {
        let (value, param) = self.value(id);
        param.option(value)
    }

    /// A colour, gamma-encoded RGBA.
    pub fn color(&self, id: &str) -> [f32; 4] {
        match self.value(id).0 {
            Value::Color(v) => v,
            other => panic!("{}.{id} is {other:?}, not a colour", self.spec.id),
        }
    }

    /// How large the rendered picture is against the full-size one.
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Where the picture stands in the canonical one, in pixels of the rendered size: what marks are anchored to.
    pub fn origin(&self) -> [f32; 2] {
        self.origin
    }

    /// `seed` for the frame that is rendered: renewed every `hold` frames, the same for ever for 0.
    pub fn renewed(&self, seed: u32) -> u32 {
        match self.int(HOLD.id) {
            0 => seed,
            hold => {
                seed.wrapping_add((self.frame.div_euclid(i64::from(hold)) as u32).wrapping_mul(0x9e37_79b9))
            }
        }
    }

    /// An optional input, when connected.
    pub fn input(&self, id: &str) -> Option<ImageId> {
        match self.spec.input(id) {
            Some((index, _)) => self.inputs[index],
            None => panic!("{} has no input '{id}'", self.spec.id),
        }
    }

    /// A required input; the graph has made sure that it is connected.
    pub fn required(&self, id: &str) -> ImageId {
        match self.input(id) {
            Some(image) => image,
            None => panic!("{}.{id} is not connected", self.spec.id),
        }
    }
}
