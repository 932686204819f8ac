//! Nodes on the frames of a shot, each frame for itself or with its neighbours, on the CPU.

use super::shot::Shot;
use crate::run;
use crate::sequences::Player;
use isophote::graph::GraphInput;
use isophote::{Graph, Request};
use isophote_engine::Image;

/// Bytes of stages that are kept: more than any of the shots here needs.
const KEPT: u64 = 1 << 30;

/// A node with what it may know beside the colour.
#[derive(Clone, Debug)]
pub struct Style {
    graph: Graph,
    has_guides: bool,
}

impl Style {
    /// A node with its defaults but for `params`, which knows the guides that the sample host gives when it renders.
    ///
    /// # Panics
    /// For unknown names and values.
    pub fn new(id: &str, params: &[(&str, &str)]) -> Self {
        Self { graph: run::single(id, params), has_guides: true }
    }

    /// The same without normals, depth and object numbers, which draw lines of their own.
    #[must_use]
    pub fn without_guides(self) -> Self {
        Self { has_guides: false, ..self }
    }

    /// The same with motion that is estimated from the pictures.
    ///
    /// # Panics
    /// For nodes that take no motion.
    #[must_use]
    pub fn estimating(mut self) -> Self {
        let mut connect = || -> isophote::Result<()> {
            let node = self.graph.node(0)?;
            let flow = self.graph.add("flow", "optical_flow")?;
            // As hosts estimate it.
            self.graph.set_text(flow, "quality", "fast")?;
            self.graph.connect_input(GraphInput::Color, flow, "color")?;
            self.graph.connect(flow, node, "motion")
        };
        match connect() {
            Ok(()) => self,
            Err(e) => panic!("{e}"),
        }
    }

    /// The frames of a shot in order, from 0, that may look at so many frames before and after.
    ///
    /// # Panics
    /// When the shot has no such frame, or the node cannot be planned or run.
    pub fn play(self, shot: &Shot, around: [u32; 2]) -> impl FnMut(usize) -> Image {
        let mut player = Player::new(self.graph, KEPT);
        player.around = [0, 1].map(|side| player.around[side].min(around[side]));
        move |index| {
            let size = &shot.frames[index].color;
            let source = |input: GraphInput, number: i64| {
                let frame = shot.frames.get(usize::try_from(number).ok()?)?;
                let image = match input {
                    GraphInput::Color => &frame.color,
                    GraphInput::Motion => &frame.motion,
                    GraphInput::MotionForward if around[1] > 0 => &frame.motion_forward,
                    GraphInput::Normal if self.has_guides => &frame.normal,
                    GraphInput::Depth if self.has_guides => &frame.depth,
                    GraphInput::ObjectId if self.has_guides => &frame.object_id,
                    GraphInput::RestPosition => &frame.rest,
                    _ => return None,
                };
                Some(image.clone())
            };
            player.frame(Request::new(size.width(), size.height()), index as i64, &source)
        }
    }
}
