//! What a node says about itself, once: the catalogue, command lines, hosts and documents all walk
//! this declaration.

use isophote_engine::{Class, ImageId, PlanBuilder};

use crate::values::Value;

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
        }
    }

    /// Values a pixel.
    pub const fn channels(self) -> u32 {
        match self {
            Self::Color | Self::Tensor | Self::Normal => 4,
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

/// Unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// None.
    None,
    /// Pixels of the full-size picture; scaled with the host's render scale.
    Pixels,
    /// Share of something, 0..100.
    Percent,
    /// Degrees of angle.
    Degrees,
}

impl Unit {
    /// Name in the catalogue; empty for none.
    pub const fn id(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Pixels => "px",
            Self::Percent => "%",
            Self::Degrees => "deg",
        }
    }
}

/// One option of a choice.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Stable name.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
}

/// Type, default and ranges of a parameter.
#[derive(Clone, Copy, Debug)]
pub enum ParamKind {
    /// A number.
    Float {
        /// Default.
        default: f32,
        /// Hard range; values outside are refused.
        range: [f32; 2],
        /// Range of a slider.
        slider: [f32; 2],
    },
    /// A whole number.
    Int {
        /// Default.
        default: i32,
        /// Hard range.
        range: [i32; 2],
        /// Range of a slider.
        slider: [i32; 2],
    },
    /// On or off.
    Bool {
        /// Default.
        default: bool,
    },
    /// One of several.
    Choice {
        /// Index of the default.
        default: usize,
        /// All options; order is for people, ids are for ever.
        options: &'static [Choice],
    },
    /// RGBA, gamma-encoded sRGB, 0..=1.
    Color {
        /// Default.
        default: [f32; 4],
    },
}

/// One parameter of a node.
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Stable name.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
    /// One sentence, with the symbol and source in the thesis.
    pub doc: &'static str,
    /// Type, default and ranges.
    pub kind: ParamKind,
    /// Unit of a number.
    pub unit: Unit,
    /// Heading under which panels show it; empty for the node's own.
    pub group: &'static str,
    /// True when changing it may change the list of passes and not only uniform bytes.
    pub structural: bool,
    /// True when the node gives its picture back unchanged while this number is 0.
    pub neutral_at_zero: bool,
}

impl Param {
    const fn new(id: &'static str, label: &'static str, kind: ParamKind) -> Self {
        Self {
            id,
            label,
            doc: "",
            kind,
            unit: Unit::None,
            group: "",
            structural: false,
            neutral_at_zero: false,
        }
    }

    /// A number with its hard range, which is also its slider's until [`Param::slider`].
    pub const fn float(id: &'static str, label: &'static str, default: f32, range: [f32; 2]) -> Self {
        Self::new(id, label, ParamKind::Float { default, range, slider: range })
    }

    /// A whole number with its range.
    pub const fn int(id: &'static str, label: &'static str, default: i32, range: [i32; 2]) -> Self {
        Self::new(id, label, ParamKind::Int { default, range, slider: range })
    }

    /// On or off.
    pub const fn bool(id: &'static str, label: &'static str, default: bool) -> Self {
        Self::new(id, label, ParamKind::Bool { default })
    }

    /// One of several; structural until said otherwise, since choices usually pick a kernel.
    pub const fn choice(
        id: &'static str,
        label: &'static str,
        default: usize,
        options: &'static [Choice],
    ) -> Self {
        Self::new(id, label, ParamKind::Choice { default, options }).structural()
    }

    /// A colour.
    pub const fn color(id: &'static str, label: &'static str, default: [f32; 4]) -> Self {
        Self::new(id, label, ParamKind::Color { default })
    }

    /// The range of a slider, within the hard range.
    pub const fn slider(mut self, low: f32, high: f32) -> Self {
        match &mut self.kind {
            ParamKind::Float { slider, .. } => *slider = [low, high],
            ParamKind::Int { slider, .. } => *slider = [low as i32, high as i32],
            _ => {}
        }
        self
    }

    /// The sentence of documentation.
    pub const fn doc(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    /// Measured in pixels of the full-size picture.
    pub const fn pixels(mut self) -> Self {
        self.unit = Unit::Pixels;
        self
    }

    /// Measured in degrees.
    pub const fn degrees(mut self) -> Self {
        self.unit = Unit::Degrees;
        self
    }

    /// Shown under a heading.
    pub const fn group(mut self, group: &'static str) -> Self {
        self.group = group;
        self
    }

    /// Changing it may change the list of passes.
    pub const fn structural(mut self) -> Self {
        self.structural = true;
        self
    }

    /// At 0 the node gives its picture back unchanged.
    pub const fn neutral_at_zero(mut self) -> Self {
        self.neutral_at_zero = true;
        self
    }

    /// Changing it only changes uniform bytes.
    pub const fn uniform(mut self) -> Self {
        self.structural = false;
        self
    }

    /// The default as a value.
    pub const fn default_value(&self) -> Value {
        match self.kind {
            ParamKind::Float { default, .. } => Value::Float(default),
            ParamKind::Int { default, .. } => Value::Int(default),
            ParamKind::Bool { default } => Value::Bool(default),
            ParamKind::Choice { default, .. } => Value::Choice(default),
            ParamKind::Color { default } => Value::Color(default),
        }
    }
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
    /// What it reads.
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

impl NodeSpec {
    /// All parameters in the order of panels: the node's own, then `mix` where it applies.
    pub fn params(&self) -> impl Iterator<Item = &'static Param> + use<> {
        static COMMON: [Param; 1] = [MIX];
        let common: &'static [Param] = if self.has_mix() { &COMMON } else { &[] };
        self.own_params.iter().chain(common)
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
        self.inputs.iter().enumerate().find(|(_, p)| p.id == id)
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

    /// The id of the chosen option.
    pub fn choice(&self, id: &str) -> &'static str {
        match self.value(id) {
            (Value::Choice(index), Param { kind: ParamKind::Choice { options, .. }, .. }) => {
                options[index].id
            }
            (other, _) => panic!("{}.{id} is {other:?}, not a choice", self.spec.id),
        }
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
