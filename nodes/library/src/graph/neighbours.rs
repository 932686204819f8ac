//! Number of frames around its own that a frame of a graph depends on.

use crate::frames::{Frames, MOST_FRAMES};
use crate::graph::{Graph, GraphInput, Node, Upstream};
use crate::things::ThingRule;

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
        let looks = self.looks().iter().map(|look| look.graph.frames());
        most(windows.chain(looks)).map(|n| n.min(MOST_FRAMES))
    }

    /// True where frames that are given the same pictures may differ: marks are drawn anew as time goes by, or are carried
    /// along motion and begin anew.
    pub fn is_animated(&self) -> bool {
        let mut needs = Vec::new();
        needs_of(self, &Frames::NONE, &mut needs);
        let is_animated = |node: &Node| node.marks() > 0 || node.spec.redraws(&node.values);
        self.nodes().iter().zip(&needs).any(|(node, need)| need.is_some() && is_animated(node))
            || self.looks().iter().any(|look| look.graph.is_animated())
    }

    /// Of these, the frames before and after its own whose `input` it reads.
    pub fn frames_of(&self, input: GraphInput) -> [u32; 2] {
        let tells = |rule: &ThingRule| rule.things.guide() == input;
        let is_told = self.rules().iter().any(tells);
        let own = std::iter::once(self).chain(self.looks().iter().map(|look| &look.graph));
        most(own.map(|graph| graph.frames_read(input, is_told))).map(|n| n.min(MOST_FRAMES))
    }

    /// The same of the graph without its looks. What `tells` things is read where maps of rules are.
    fn frames_read(&self, input: GraphInput, tells: bool) -> [u32; 2] {
        let mut needs = Vec::new();
        needs_of(self, &Frames::around(MOST_FRAMES, MOST_FRAMES), &mut needs);
        let is_read = |source: GraphInput| {
            source == input || tells && matches!(source, GraphInput::Control | GraphInput::LinePaint)
        };
        let mut read = [0, 0];
        for (node, need) in self.nodes().iter().zip(&needs) {
            let Some([first, last]) = *need else { continue };
            let window = node.spec.window(&node.values);
            for (port, source) in node.spec.ports().zip(&node.inputs) {
                if matches!(source, Some(Upstream::Input(source)) if is_read(*source)) {
                    let past = window.max(node.mark_window(port, *source)) - first;
                    read = most([read, [past as u32, (window + last) as u32]].into_iter());
                }
            }
        }
        read
    }
}

/// The most of each of two numbers.
fn most(pairs: impl Iterator<Item = [u32; 2]>) -> [u32; 2] {
    pairs.fold([0, 0], |[a, b], [c, d]| [a.max(c), b.max(d)])
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
