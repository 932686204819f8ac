//! Maps of rules for things as inputs of a graph: a host that gives numbers of objects, or a Cryptomatte, gives a control map and
//! colours of lines with them.

use crate::graph::GraphInput;
use crate::kernels::colour::followed_rules::{self, Painted};
use crate::kernels::colour::thing_rules::{self, Said};
use crate::kernels::colour::{nearest_across, thing_cover};
use crate::kernels::shared::things::{Entry, Told};
use crate::plan::request::Request;
use crate::things::{ThingRule, Things};
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
    /// True for an input that the rules make of what tells things.
    pub fn makes(&self, input: GraphInput) -> bool {
        let says = |rule: &ThingRule| match input {
            GraphInput::Control => !rule.is_neutral(),
            GraphInput::LinePaint => rule.line_color.is_some(),
            _ => false,
        };
        self.rules.iter().any(|rule| self.knows(&rule.things) && says(rule))
    }

    /// The input that the rules make, over what the host has `painted` of it.
    pub fn pass(
        &self,
        plan: &mut PlanBuilder,
        input: GraphInput,
        painted: Option<ImageId>,
    ) -> Option<ImageId> {
        let is_control = input == GraphInput::Control;
        let start = if is_control { [0.5; 4] } else { [0.0; 4] };
        let told = self.told(plan);
        let map = thing_rules::pass(plan, told, &self.said(is_control), start, !is_control);
        // Rules that make an input say something of things that are told.
        let map = map.or(painted)?;
        let reach = self.reach();
        let depth = self.request.guides.depth.then(|| {
            let depth = guide(plan, GraphInput::Depth);
            ([depth, nearest_across::pass(plan, depth, reach)], reach)
        });
        let painted = painted.map(if is_control { Painted::Control } else { Painted::Colours });
        if depth.is_none() && painted.is_none() {
            return Some(map);
        }
        Some(followed_rules::pass(plan, map, depth, painted))
    }

    /// Share of each pixel that some things cover; none where nothing tells them.
    pub fn cover(&self, plan: &mut PlanBuilder, things: &Things) -> Option<ImageId> {
        if !self.knows(things) {
            return None;
        }
        let told = self.told(plan);
        thing_cover::pass(plan, told, &entries(things))
    }

    /// True where a host gives what tells these things.
    fn knows(&self, things: &Things) -> bool {
        self.request.guides.has(things.guide())
    }

    fn told(&self, plan: &mut PlanBuilder) -> Told {
        let mut given = |input| self.request.guides.has(input).then(|| guide(plan, input));
        Told { numbers: given(GraphInput::ObjectId), names: given(GraphInput::Cryptomatte) }
    }

    /// What the rules say of a map, the last one at the end.
    fn said(&self, is_control: bool) -> Vec<Said> {
        let values = |rule: &ThingRule| match (is_control, rule.line_color) {
            (true, _) => rule.control,
            (false, color) => color.map_or([None; 4], |color| color.map(Some)),
        };
        let rules = self.rules.iter().filter(|rule| self.knows(&rule.things));
        let said = rules.map(|rule| (entries(&rule.things), values(rule)));
        said.filter(|(_, values)| values.iter().any(Option::is_some)).collect()
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

/// Entries of a table for things.
fn entries(things: &Things) -> Vec<Entry> {
    match things {
        Things::Numbers(numbers) => ranges(numbers).into_iter().map(Entry::Numbers).collect(),
        Things::Names(ids) => {
            let mut ids = ids.clone();
            ids.sort_unstable();
            ids.dedup();
            ids.into_iter().map(|id| Entry::Name(f32::from_bits(id))).collect()
        }
    }
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
