//! Number of frames around its own that a frame of a graph depends on.

use crate::frames::{Frames, MOST_FRAMES};
use crate::graph::{Graph, GraphInput, Node, Upstream};

impl Graph {
    /// Frames before and after its own that a frame of the graph's output depends on, where all are known; [0, 0] for
    /// graphs of stills.
    pub fn frames(&self) -> [u32; 2] {
        let mut needs = Vec::new();
        needs_of(self, &Frames::around(MOST_FRAMES, MOST_FRAMES), &mut needs);
        let windows = self.nodes().iter().zip(&needs).filter_map(|(node, need)| {
            let window = node.spec.window(&node.values);
            need.map(|[first, last]| [(window.max(node.marks()) - first) as u32, (window + last) as u32])
        });
        windows.fold([0, 0], |[a, b], [c, d]| [a.max(c), b.max(d)]).map(|n| n.min(MOST_FRAMES))
    }

    /// True where frames that are given the same pictures may differ: marks are drawn anew as time goes by, or are carried
    /// along motion and begin anew.
    pub fn is_animated(&self) -> bool {
        let mut needs = Vec::new();
        needs_of(self, &Frames::NONE, &mut needs);
        let is_animated = |node: &Node| node.marks() > 0 || node.spec.redraws(&node.values);
        self.nodes().iter().zip(&needs).any(|(node, need)| need.is_some() && is_animated(node))
    }

    /// Of these, the frames before and after its own whose `input` it reads.
    pub fn frames_of(&self, input: GraphInput) -> [u32; 2] {
        let mut needs = Vec::new();
        needs_of(self, &Frames::around(MOST_FRAMES, MOST_FRAMES), &mut needs);
        let mut most = [0, 0];
        for (node, need) in self.nodes().iter().zip(&needs) {
            let Some([first, last]) = *need else { continue };
            let window = node.spec.window(&node.values);
            for (port, source) in node.spec.ports().zip(&node.inputs) {
                if *source == Some(Upstream::Input(input)) {
                    let past = window.max(node.mark_window(port, *source)) - first;
                    most = [most[0].max(past), most[1].max(window + last)];
                }
            }
        }
        most.map(|n| (n as u32).min(MOST_FRAMES))
    }
}

/// By node, the first and the last frame whose result the graph's output needs, as far as frames are known; none for
/// nodes that it does not need.
pub(crate) fn needs_of(graph: &Graph, frames: &Frames, needs: &mut Vec<Option<[i32; 2]>>) {
    needs.clear();
    needs.resize(graph.len(), None);
    if let Some((output, _)) = graph.output_node() {
        needs[output] = Some([0, 0]);
    }
    let [first, last] = frames.range();
    for index in graph.order().iter().rev() {
        let Some([from, to]) = needs[*index] else { continue };
        let node = graph.node_at(*index);
        let window = node.spec.window(&node.values);
        let wanted = [(from - window).max(first), (to + window).min(last)];
        for source in node.sources() {
            let need = needs[source].get_or_insert(wanted);
            *need = [need[0].min(wanted[0]), need[1].max(wanted[1])];
        }
    }
}
