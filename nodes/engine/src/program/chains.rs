//! Which passes of a plan run as one dispatch: a pass, and after it those that compute each pixel from the pixel that it
//! has just computed. What lies between them is never written to memory nor read from it.

use crate::kernel::MAX_INPUTS;
use crate::plan::{ImageId, Pass, Plan};

/// The passes of `plan` in the order in which they are dispatched, those of one dispatch together.
///
/// A dispatch runs where its last pass stands. No other pass reads what lies between its passes, so that none is missed
/// that stands among them.
pub(super) fn chains(plan: &Plan) -> Vec<Vec<usize>> {
    let readers = readers(plan);
    let mut chains: Vec<Vec<usize>> = Vec::new();
    for (index, pass) in plan.passes().iter().enumerate() {
        let before = chains.iter().position(|chain| follows(plan, &readers, chain, pass));
        match before {
            Some(at) => {
                let mut chain = chains.remove(at);
                chain.push(index);
                chains.push(chain);
            }
            None => chains.push(vec![index]),
        }
    }
    chains
}

/// By image: how many passes read it, those counted twice that read it twice; images that leave count as read.
fn readers(plan: &Plan) -> Vec<usize> {
    let mut readers = vec![0; plan.images().len()];
    let leaving = plan.outputs().iter().map(|port| port.image);
    for image in plan.passes().iter().flat_map(|pass| pass.inputs.iter().copied()).chain(leaving) {
        readers[image.index()] += 1;
    }
    readers
}

/// Whether `pass` can run in the dispatch of `chain`, on what its last pass computes.
fn follows(plan: &Plan, readers: &[usize], chain: &[usize], pass: &Pass) -> bool {
    let passes = || chain.iter().map(|index| &plan.passes()[*index]);
    let (Some(first), Some(last)) = (passes().next(), passes().next_back()) else { return false };
    let between = last.outputs[0];
    let level = |image: ImageId| plan.desc(image).level;
    let inputs = external(passes().chain([pass])).count();
    pass.kernel.parts.is_per_pixel
        && first.kernel.parts.can_lead
        && pass.inputs.contains(&between)
        && readers[between.index()] == 1
        && pass.inputs.iter().all(|image| level(*image) == level(pass.outputs[0]))
        && inputs <= MAX_INPUTS
}

/// The images that a dispatch of these passes reads, in the order of its bindings: those of its first pass and, of the
/// others, all but what the pass before has computed.
pub(super) fn external<'p>(passes: impl Iterator<Item = &'p Pass>) -> impl Iterator<Item = ImageId> {
    let mut before: Option<ImageId> = None;
    passes.flat_map(move |pass| {
        let between = before.replace(pass.outputs[0]);
        pass.inputs.iter().copied().filter(move |image| Some(*image) != between)
    })
}
