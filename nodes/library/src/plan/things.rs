//! Maps of rules for things as inputs of a graph: a host that gives numbers of objects gives a control map and colours of
//! lines with them.

use crate::graph::GraphInput;
use crate::kernels::colour::followed_rules::{self, Painted};
use crate::kernels::colour::nearest_across;
use crate::kernels::colour::thing_rules::{self, Entry};
use crate::plan::request::Request;
use crate::things::ThingRule;
use isophote_engine::{ImageId, PlanBuilder};

/// Distance over which lines beside a thing follow its rules and not those of what is farther away, pixels of a picture 1080
/// lines high.
const REACH: f32 = 5.0;
/// Least and most of it in pixels: no line is narrower than a pixel on a small picture.
const REACHES: [f32; 2] = [2.0, 32.0];

/// Inputs of a graph that its rules make.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ruled<'r> {
    pub rules: &'r [ThingRule],
    pub request: &'r Request,
}

impl Ruled<'_> {
    /// True for an input that the rules make of the numbers of objects.
    pub fn makes(&self, input: GraphInput) -> bool {
        let says = |rule: &ThingRule| match input {
            GraphInput::Control => !rule.is_neutral(),
            GraphInput::LinePaint => rule.line_color.is_some(),
            _ => false,
        };
        self.request.guides.object_id && self.rules.iter().any(says)
    }

    /// The input that the rules make, over what the host has `painted` of it.
    pub fn pass(&self, plan: &mut PlanBuilder, input: GraphInput, painted: Option<ImageId>) -> ImageId {
        let is_control = input == GraphInput::Control;
        let numbers = guide(plan, GraphInput::ObjectId);
        let start = if is_control { [0.5; 4] } else { [0.0; 4] };
        let map = thing_rules::pass(plan, numbers, &self.table(is_control), start);
        let reach = self.reach();
        let depth = self.request.guides.depth.then(|| {
            let depth = guide(plan, GraphInput::Depth);
            ([depth, nearest_across::pass(plan, depth, reach)], reach)
        });
        let painted = painted.map(if is_control { Painted::Control } else { Painted::Colours });
        if depth.is_none() && painted.is_none() {
            return map;
        }
        followed_rules::pass(plan, map, depth, painted)
    }

    /// Entries by number, those of the last rule at the end.
    fn table(&self, is_control: bool) -> Vec<Entry> {
        let mut table = Vec::new();
        for rule in self.rules {
            let values = if is_control {
                rule.control
            } else {
                rule.line_color.map_or([None; 4], |color| color.map(Some))
            };
            if values.iter().any(Option::is_some) {
                table.extend(ranges(&rule.numbers).into_iter().map(|range| (range, values)));
            }
        }
        table
    }

    fn reach(&self) -> u32 {
        let Request { height, canonical_height, scale, .. } = *self.request;
        let canonical = match canonical_height {
            0 => height as f32,
            height => height as f32 * scale,
        };
        (REACH * canonical / 1080.0).round().clamp(REACHES[0], REACHES[1]) as u32
    }
}

fn guide(plan: &mut PlanBuilder, input: GraphInput) -> ImageId {
    plan.input(input.id(), input.kind().channels(), input.kind().class())
}

/// First and last of numbers that follow each other.
fn ranges(numbers: &[u32]) -> Vec<[f32; 2]> {
    let mut sorted = numbers.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    let runs = sorted.chunk_by(|a, b| a.checked_add(1) == Some(*b));
    runs.filter_map(|run| Some([*run.first()? as f32, *run.last()? as f32])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_a_row_are_one_entry() {
        assert_eq!(ranges(&[7, 3, 4, 5, 4]), [[3.0, 5.0], [7.0, 7.0]]);
        assert_eq!(ranges(&[]), [[0.0; 2]; 0]);
        assert_eq!(ranges(&[u32::MAX, 0]), [[0.0, 0.0], [u32::MAX as f32; 2]]);
    }
}
