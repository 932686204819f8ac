//! Kernel fusion: which passes of a plan run as one dispatch, so that what lies between them is neither written to memory
//! nor read from it.
//!
//! A dispatch begins with any pass, or with a separable window's rows and columns, before which the pass may stand that
//! gives what they sum. Passes of single pixels follow: those that alone read what the dispatch has computed, with what else
//! is computed pixel by pixel for them, and those that need nothing but a pixel which the dispatch also stores.

use crate::kernel::{Fusible, MAX_INPUTS, PAIR_REACH, Pair};
use crate::plan::{ImageId, Pass, Plan};

/// Passes that run as one dispatch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fusion {
    /// In the order in which they are computed.
    pub passes: Vec<usize>,
    /// The first of them.
    pub lead: Lead,
    /// Result that is stored.
    pub outputs: Vec<ImageId>,
}

/// Beginning of a dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lead {
    /// One pass.
    Single,
    /// The rows and the columns of a separable window.
    Pair,
    /// The pass that computes what the window sums, its rows and its columns.
    ProducerAndPair,
}

impl Lead {
    /// Its passes.
    pub fn len(self) -> usize {
        match self {
            Self::Single => 1,
            Self::Pair => 2,
            Self::ProducerAndPair => 3,
        }
    }
}

/// Images stored by a dispatch at most.
const MAX_OUTPUTS: usize = 3;

/// The dispatches of `plan` in their order.
///
/// A dispatch of several passes runs where its last pass stands, or, where it stores more than one image, where its first
/// does. No other pass reads what lies between its passes, so that none is missed that stands among them.
///
/// Windows are fused if `windows` says so: that moves fewer bytes and computes more, which devices without memory of their
/// own for workgroups, such as drivers that compute on the CPU, pay for dearly.
pub(super) fn fusions(plan: &Plan, windows: bool) -> Vec<Fusion> {
    let mut fusing = Fusing { plan, windows, readers: readers(plan), done: Vec::new() };
    for (index, pass) in plan.passes().iter().enumerate() {
        fusing.add(index, pass);
    }
    fusing.done
}

/// The radius of the window of a pair, and how far the pass before it reads around, where they can run as one dispatch.
pub(super) fn reaches(plan: &Plan, passes: &[usize], lead: Lead) -> Option<[u32; 2]> {
    let pass = |at: usize| passes.get(at).and_then(|index| plan.passes().get(*index));
    let radius = |at: usize| pass(at)?.support().sides().map(|[x, y]| x.max(y));
    let rows = lead.len().checked_sub(2)?;
    // What is read at another level is not held in the window, but fetched.
    let is_held = |pass: &Pass| plan.desc(pass.inputs[0]).level == plan.desc(pass.outputs[0]).level;
    let before = match lead {
        Lead::ProducerAndPair if is_held(pass(0)?) => radius(0)?,
        _ => 0,
    };
    let reaches = [radius(rows)?, before];
    (radius(rows + 1)? == reaches[0] && reaches.iter().sum::<u32>() <= PAIR_REACH).then_some(reaches)
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

/// A plan on its way to dispatches.
struct Fusing<'p> {
    plan: &'p Plan,
    windows: bool,
    readers: Vec<usize>,
    done: Vec<Fusion>,
}

impl Fusing<'_> {
    fn add(&mut self, index: usize, pass: &Pass) {
        let alone = || Fusion { passes: vec![index], lead: Lead::Single, outputs: pass.outputs.clone() };
        let fused = match pass.kernel.fusible {
            Fusible::Window(pair) => self.columns(index, pass, pair),
            Fusible::SinglePixels { around } => self.end(index, pass, around),
            Fusible::Never | Fusible::First | Fusible::BeforeWindow { .. } => None,
        };
        if let Some(fusion) = fused {
            self.done.push(fusion);
        } else if !self.stored_besides(index, pass) {
            self.done.push(alone());
        }
    }

    /// The place of the dispatch that stores `image` and nothing else, if `reader` alone reads it.
    fn only_read_by(&self, image: ImageId) -> Option<usize> {
        let is_it = |fusion: &Fusion| fusion.outputs == [image];
        (self.readers[image.index()] == 1).then(|| self.done.iter().position(is_it)).flatten()
    }

    fn pass(&self, index: usize) -> &Pass {
        &self.plan.passes()[index]
    }

    /// The dispatch of a window whose columns `pass` sums.
    fn columns(&mut self, index: usize, pass: &Pass, pair: Pair) -> Option<Fusion> {
        let rows = self.windows.then(|| self.only_read_by(pass.inputs[0])).flatten()?;
        let [first] = self.done[rows].passes[..] else { return None };
        let is_pair =
            self.pass(first).kernel == pass.kernel && (pair.fits)(&self.pass(first).params, &pass.params);
        let mut passes = vec![first, index];
        reaches(self.plan, &passes, Lead::Pair).filter(|_| is_pair)?;
        self.done.remove(rows);
        let mut lead = Lead::Pair;
        let producer = self.only_read_by(self.pass(first).inputs[0]);
        let producer = producer.and_then(|at| match self.done[at].passes[..] {
            [before] if matches!(self.pass(before).kernel.fusible, Fusible::BeforeWindow { .. }) => {
                Some((at, before))
            }
            _ => None,
        });
        if let Some((at, before)) = producer
            && reaches(self.plan, &[before, first, index], Lead::ProducerAndPair).is_some()
        {
            self.done.remove(at);
            passes.insert(0, before);
            lead = Lead::ProducerAndPair;
        }
        Some(Fusion { passes, lead, outputs: pass.outputs.clone() })
    }

    /// Of a pass of single pixels: the dispatch that ends with it, where it alone reads what others have computed.
    fn end(&mut self, index: usize, pass: &Pass, around: &[usize]) -> Option<Fusion> {
        let level = |image: &ImageId| self.plan.desc(*image).level;
        let pixels = || {
            let inputs = pass.inputs.iter().enumerate();
            inputs.filter(|(at, _)| !around.contains(at)).map(|(_, image)| image)
        };
        if pixels().any(|image| level(image) != level(&pass.outputs[0])) {
            return None;
        }
        let mut taken: Vec<usize> = pixels().filter_map(|image| self.only_read_by(*image)).collect();
        taken.retain(|at| self.can_lead(&self.done[*at]));
        // At most one of them computes more than single pixels: it comes first.
        let first = taken.iter().position(|at| !self.is_per_pixel(&self.done[*at])).unwrap_or_default();
        let first = (!taken.is_empty()).then(|| taken.remove(first))?;
        taken.retain(|at| self.is_per_pixel(&self.done[*at]));
        let passes = |others: &[usize]| -> Vec<usize> {
            let of = |at: &usize| self.done[*at].passes.iter().copied();
            of(&first).chain(others.iter().flat_map(of)).chain([index]).collect()
        };
        if external(self.plan, &passes(&taken)).count() > MAX_INPUTS {
            taken.clear();
        }
        let passes = passes(&taken);
        if external(self.plan, &passes).count() > MAX_INPUTS {
            return None;
        }
        let lead = self.done[first].lead;
        taken.push(first);
        taken.sort_unstable();
        for at in taken.into_iter().rev() {
            self.done.remove(at);
        }
        Some(Fusion { passes, lead, outputs: pass.outputs.clone() })
    }

    /// Of a pass that needs one pixel alone: adds it to the dispatch that stores this pixel, which then stores both, or the
    /// new one alone if nothing else reads the other. Says whether there is such a dispatch.
    fn stored_besides(&mut self, index: usize, pass: &Pass) -> bool {
        let Some([]) = pass.kernel.fusible.around() else { return false };
        let ([source], [result]) = (&pass.inputs[..], &pass.outputs[..]) else { return false };
        let leaves = |image: &ImageId| self.plan.outputs().iter().any(|port| port.image == *image);
        let levels = [source, result].map(|image| self.plan.desc(*image).level);
        let stores = |fusion: &Fusion| fusion.outputs.contains(source);
        let Some(at) = self.done.iter().position(stores) else { return false };
        if leaves(source) || leaves(result) || levels[0] != levels[1] || !self.can_lead(&self.done[at]) {
            return false;
        }
        let is_last = self.readers[source.index()] == 1;
        if !is_last && self.done[at].outputs.len() == MAX_OUTPUTS {
            return false;
        }
        let fusion = &mut self.done[at];
        fusion.passes.push(index);
        fusion.outputs.retain(|output| !is_last || output != source);
        fusion.outputs.push(*result);
        true
    }

    fn can_lead(&self, fusion: &Fusion) -> bool {
        fusion.lead != Lead::Single || self.pass(fusion.passes[0]).kernel.fusible.can_lead()
    }

    fn is_per_pixel(&self, fusion: &Fusion) -> bool {
        fusion.lead == Lead::Single && self.pass(fusion.passes[0]).kernel.fusible.around().is_some()
    }
}

/// The images that a dispatch of these passes reads, in the order of its bindings: all that its own passes do not compute.
pub(super) fn external<'p>(plan: &'p Plan, passes: &'p [usize]) -> impl Iterator<Item = ImageId> + 'p {
    let of = |index: &usize| &plan.passes()[*index];
    passes.iter().enumerate().flat_map(move |(place, index)| {
        let is_own = move |image: &ImageId| passes[..place].iter().any(|p| of(p).outputs.contains(image));
        of(index).inputs.iter().copied().filter(move |image| !is_own(image))
    })
}
