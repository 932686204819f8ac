//! Declaration of a node, once: the catalogue, command lines, hosts and documents all walk
//! this declaration.

use crate::declare::choice::Selectable;
pub(crate) use crate::declare::direction::{CENTRE, IMPORTANCE};
use crate::declare::param::paragraphs;
pub use crate::declare::param::{Param, Unit};
pub use crate::declare::time::animates_marks;
pub(crate) use crate::declare::time::{HOLD, RENEWAL, STEADINESS, WINDOW};
use crate::declare::value::Value;
use crate::frames::Frames;
use isophote_engine::{Class, ImageId, PlanBuilder};

/// Kind of image that flows through a port.
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
    /// From where a point is to where it is in another frame, x right and y down, pixels of the picture; not finite
    /// where that is unknown.
    Motion,
    /// Point x, y, z of the undeformed object, scene units, and validity.
    Position,
    /// What an artist wants of places, 0.5 in each channel for no change. Its values are data as those of a flow map.
    Control,
    /// Hatching in up to four tones, a channel each: 1 is paper, 0 is ink. Its values are data as those of a flow map.
    Hatching,
    /// The two things that cover most of a pixel: the id of the one's name, its share, and those of the other.
    Cryptomatte,
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
            Self::Control => "control",
            Self::Hatching => "hatching",
            Self::Cryptomatte => "cryptomatte",
            Self::Flow => "flow",
            Self::Motion => "motion",
            Self::Position => "rest_position",
        }
    }

    /// Values a pixel.
    pub const fn channels(self) -> u32 {
        match self {
            Self::Color
            | Self::Tensor
            | Self::Normal
            | Self::Control
            | Self::Hatching
            | Self::Cryptomatte
            | Self::Flow
            | Self::Position => 4,
            Self::Motion => 2,
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
    /// Kind of image that it takes or gives.
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
    /// `structure`, `smoothing`, `lines`, `painting`, `coherence`, `colour`, `time` or `styles`.
    pub group: &'static str,
    /// One sentence in artists' words, which lists and panels show.
    pub hint: &'static str,
    /// One paragraph of documentation, with symbols and equations.
    pub doc: &'static str,
    /// Sections of the thesis, such as "3.4".
    pub section: &'static str,
    /// Inputs; see [`NodeSpec::ports`].
    pub inputs: &'static [Port],
    /// Output.
    pub output: Port,
    /// Its own parameters; see [`NodeSpec::params`].
    pub own_params: &'static [Param],
    /// Describes the passes of the node and returns its output.
    pub build: fn(&mut Scope<'_>) -> ImageId,
}

/// `mix`, which every node from colour to colour has.
pub const MIX: Param = Param::float("mix", "Mix", 1.0, [0.0, 1.0])
    .hint("Blends the result with the picture: 0 leaves the picture as it was, 1 shows the result alone.")
    .group("output")
    .structural()
    .neutral_at_zero();

/// Share of a node's result that is used; every node from colour to colour has it.
pub const MASK: Port = Port {
    id: "mask",
    kind: ImageKind::Scalar,
    optional: true,
    doc: "How much of the result is used, 0..=1, times `mix`; all of it when open.",
};

/// Map that an artist painted for a node to follow; every node from colour to colour has it.
pub const FLOW: Port = Port {
    id: "flow",
    kind: ImageKind::Flow,
    optional: true,
    doc: "A flow map (see `flow_map`) that bends the orientation which the node follows, if it follows any.",
};

/// Map by which an artist directs places of a picture; every style has it, and nodes that list it.
pub const CONTROL: Port = Port {
    id: "control",
    kind: ImageKind::Control,
    optional: true,
    doc: "A control map, of which 0.5 changes nothing: red is detail, green the width of lines, blue their amount, 0 for none, \
          and alpha the strength of marks and paint, as far as the node has any. Each is a factor of 1/4 to 4.",
};

/// Knowledge that a node which is steady over time has of its frames.
const TIME_PORTS: [Port; 4] = [
    Port {
        id: "motion",
        kind: ImageKind::Motion,
        optional: true,
        doc: "Pixels from where a point is to where it was in the frame before; without it the frames before count for \
              nothing.",
    },
    Port {
        id: "motion_forward",
        kind: ImageKind::Motion,
        optional: true,
        doc: "Pixels from where a point is to where it will be in the next frame; without it the frames that follow count \
              for nothing.",
    },
    Port {
        id: "depth",
        kind: ImageKind::Depth,
        optional: true,
        doc: "Distance from the camera: neighbouring frames count where it agrees.",
    },
    Port {
        id: "object_id",
        kind: ImageKind::ObjectId,
        optional: true,
        doc: "Object numbers: neighbouring frames count where they agree.",
    },
];

/// Id of the parameter by which a style chooses between media.
const MEDIUM: &str = "style";

impl NodeSpec {
    /// All that is written about it: the hint, an empty line, and the documentation.
    pub fn text(&self) -> String {
        paragraphs(self.hint, self.doc)
    }

    /// The parameter by which a style chooses what is drawn with, where it has one: its options are known as styles are.
    pub fn medium(&self) -> Option<&'static Param> {
        self.own_params.iter().find(|param| self.group == "styles" && param.id == MEDIUM)
    }

    /// All parameters in the order of panels: the node's own, then `importance` and `mix` where they apply.
    pub fn params(&self) -> impl Iterator<Item = &'static Param> + use<> {
        static COMMON: [Param; 1] = [MIX];
        let common: &'static [Param] = if self.has_mix() { &COMMON } else { &[] };
        static DIRECTION: [Param; 2] = [IMPORTANCE, CENTRE];
        // Styles without a tolerance bring detail back by places, and lose none.
        let loses_detail = self.group == "styles" && self.own_params.iter().any(|p| p.id == "sigma_r");
        let direction: &'static [Param] = if loses_detail { &DIRECTION } else { &[] };
        self.own_params.iter().chain(direction).chain(common)
    }

    /// All inputs: the node's own, then `mask`, `flow`, those of the group `time`, and `control`, where they apply.
    pub fn ports(&self) -> impl Iterator<Item = &'static Port> + use<> {
        static COMMON: [Port; 2] = [MASK, FLOW];
        static TIME: [Port; 4] = TIME_PORTS;
        let common: &'static [Port] = if self.has_mix() { &COMMON } else { &[] };
        let time: &'static [Port] = if self.is_steady() { &TIME } else { &[] };
        let own = self.inputs;
        let new = move |port: &&Port| own.iter().all(|p| p.id != port.id);
        static DIRECTION: [Port; 1] = [CONTROL];
        let direction: &'static [Port] = if self.group == "styles" { &DIRECTION } else { &[] };
        own.iter().chain(common).chain(time.iter().filter(new)).chain(direction)
    }

    /// True for nodes that carry what they have found from frame to frame.
    pub fn is_steady(&self) -> bool {
        self.own_params.iter().any(|p| p.id == STEADINESS.id)
    }

    /// True for nodes that find motion between neighbouring frames.
    pub(crate) fn makes_motion(&self) -> bool {
        self.output.kind == ImageKind::Motion
    }

    /// Frames before and after its own that a node of these values reads.
    pub(crate) fn window(&self, values: &[Value]) -> i32 {
        if self.makes_motion() {
            return 1;
        }
        let value = |id| self.param(id).map(|(index, _)| values[index]);
        match (value(STEADINESS.id), value(WINDOW.id)) {
            (Some(Value::Float(steadiness)), Some(Value::Int(window))) if steadiness > 0.0 => window,
            _ => 0,
        }
    }

    /// Frames before its own whose motion a node of these values reads to carry marks.
    pub(crate) fn mark_window(&self, values: &[Value]) -> i32 {
        let value = |id| self.param(id).map(|(index, _)| values[index]);
        match (value(STEADINESS.id), value(RENEWAL.id)) {
            (Some(Value::Float(steadiness)), Some(Value::Int(renewal))) if steadiness > 0.0 => {
                (even(renewal) - 2).max(0)
            }
            _ => 0,
        }
    }

    /// True for a node of these values whose marks are drawn anew as time goes by.
    pub(crate) fn redraws(&self, values: &[Value]) -> bool {
        let hold = self.param(HOLD.id).map(|(index, _)| values[index]);
        matches!(hold, Some(Value::Int(hold)) if hold > 0)
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

/// `renewal` as a number of frames that has a half.
fn even(renewal: i32) -> i32 {
    renewal - renewal % 2
}

/// Scope in which a node describes its work: its parameter values, its connected inputs and the
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
    /// Longest motion that counts, pixels of the picture that is rendered.
    pub(crate) max_motion: f32,
    pub(crate) around: Around<'a>,
}

/// The inputs of a node at neighbouring frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around<'a> {
    /// By frame, then by port.
    pub inputs: &'a [Option<ImageId>],
    /// The frame of the first of them, counted from the one that is computed.
    pub first: i32,
    /// Knowledge of other frames.
    pub frames: Frames,
    /// The first number of the stages that the node keeps.
    pub stage: u32,
    /// True where motion that carries marks enters the graph.
    pub is_carrying: bool,
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

    /// Size of the rendered picture against the full-size one.
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

    /// Frames around the one that is described whose images there are, counted from it, the nearest first, as far as
    /// `window` to each side.
    pub(crate) fn neighbours(&self, window: i32) -> impl Iterator<Item = i32> + use<> {
        let (home, frames) = (self.plan.frame(), self.around.frames);
        (1..=window).flat_map(|n| [-n, n]).filter(move |offset| frames.has(home + offset))
    }

    /// Frames for which motion carries marks, an even number, and the number of the frame that is described; none where
    /// they stay on the screen, as those of nodes without this parameter do.
    pub(crate) fn renewal(&self) -> Option<(i32, i64)> {
        self.around.is_carrying.then(|| (even(self.int(RENEWAL.id)), self.frame))
    }

    /// The motion of the frame so many before the one that is described, where that is known.
    pub(crate) fn motion_before(&self, step: i32) -> Option<ImageId> {
        let at = self.plan.frame() - step;
        let (port, _) = self.spec.input("motion")?;
        if step == 0 {
            return self.inputs[port];
        }
        let row = usize::try_from(at - self.around.first).ok()?;
        self.around.frames.has(at).then(|| self.around.inputs[row * self.inputs.len() + port])?
    }

    /// True when the host hands in the stages of the frame so far from the one that is described.
    pub(crate) fn is_handed(&self, offset: i32) -> bool {
        self.around.frames.is_handed(self.plan.frame() + offset)
    }

    /// Describes something of the frame so far from the one that is described, with that one's inputs.
    pub(crate) fn at<T>(&mut self, offset: i32, describe: impl FnOnce(&mut Scope<'_>) -> T) -> T {
        let home = self.plan.frame();
        let ports = self.inputs.len();
        let first = (home + offset - self.around.first) as usize * ports;
        let inputs = &self.around.inputs[first..first + ports];
        self.plan.set_frame(home + offset);
        let frame = self.frame + i64::from(offset);
        let result = describe(&mut Scope {
            plan: &mut *self.plan,
            spec: self.spec,
            values: self.values,
            inputs,
            scale: self.scale,
            origin: self.origin,
            frame,
            max_motion: self.max_motion,
            around: self.around,
        });
        self.plan.set_frame(home);
        result
    }

    /// Keeps an image of the frame that is described for the frames that carry it: the node's stage `index`. Returns
    /// the stage's number in the plan.
    pub(crate) fn keep(&mut self, index: usize, image: ImageId) -> u32 {
        let stage = self.around.stage + index as u32;
        let kept = self.plan.keep(stage, image);
        if kept == stage && self.around.frames.keep {
            self.plan.output(stage_name(stage, &mut [0; 16]), image);
        }
        kept
    }

    /// A stage of the frame that is described as the host hands it in, of the shape of `like`.
    pub(crate) fn handed(&mut self, stage: u32, like: ImageId) -> ImageId {
        let shape = self.plan.desc(like);
        self.plan.input(stage_name(stage, &mut [0; 16]), shape.channels, shape.class)
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

/// The name of a stage among the inputs and outputs of a plan: "stage" and its number.
fn stage_name(stage: u32, buffer: &mut [u8; 16]) -> &str {
    let mut start = buffer.len();
    let mut rest = stage;
    // Written by hand, since edits of a plan allocate nothing.
    loop {
        start -= 1;
        buffer[start] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    start -= 5;
    buffer[start..start + 5].copy_from_slice(b"stage");
    std::str::from_utf8(&buffer[start..]).unwrap_or("stage")
}
