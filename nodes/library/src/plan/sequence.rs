//! Frames of a sequence in any order: what neighbouring frames have in common is computed once and kept.
//!
//! A frame depends on a finite window of frames, never on which were computed before: orders differ in time, not in a
//! single bit. [`Sequence::plan`] says what a frame needs, an executor of [`isophote_engine`] runs it, and
//! [`Sequence::finish`] keeps what later frames will ask for.

use crate::error::{Error, Result};
use crate::graph::Graph;
use crate::plan::planned::Planned;
use crate::plan::request::Request;
use isophote_engine::store::{FrameStore, Name};
use isophote_engine::{Kept, Plan};

/// A graph on the frames of a sequence, with stages of type `T`: [`Image`](isophote_engine::Image)s on the CPU,
/// textures on a device.
#[derive(Debug)]
pub struct Sequence<T> {
    /// The plan in which nothing is handed in, which names the stages.
    whole: Option<Planned>,
    /// Plans by what is handed in, the last used at the end.
    plans: Vec<Planned>,
    store: FrameStore<T>,
    /// The stages of the frame at hand, with their names in the store.
    stages: Vec<(Kept, Name)>,
}

/// Plans that are kept: those of a first frame, a second one and so on, and of frames in order.
const MOST_PLANS: usize = 12;

impl<T> Sequence<T> {
    /// A sequence whose stages take at most `most` bytes.
    pub fn new(most: u64) -> Self {
        Self { whole: None, plans: Vec::new(), store: FrameStore::new(most), stages: Vec::new() }
    }

    /// Plans the frame of a request, whose `frames` say which others are known. Stages are kept, and kept ones used,
    /// where `keeps` is true, as it may be for runs of whole pictures.
    ///
    /// # Errors
    /// As [`Planned::new`].
    pub fn plan(&mut self, graph: &Graph, mut request: Request, keeps: bool) -> Result<&Planned> {
        self.stages.clear();
        if keeps && graph.frames() != [0, 0] {
            let whole = Request { frames: request.frames.keeping(), ..request };
            let whole = updated(&mut self.whole, graph, whole)?;
            let keys = whole.plan().keys();
            self.stages.extend(
                whole
                    .plan()
                    .kept()
                    .iter()
                    .zip(keys)
                    .map(|(kept, key)| (*kept, (key, request.frame + i64::from(kept.frame)))),
            );
            request.frames = request.frames.keeping();
            for (kept, _) in &self.stages {
                let mut all = self.stages.iter().filter(|(other, _)| other.frame == kept.frame);
                if all.all(|(_, name)| self.store.has(*name)) {
                    request.frames = request.frames.with_handed(kept.frame);
                }
            }
            for (_, name) in &self.stages {
                self.store.touch(*name);
            }
        }
        let is_it = |planned: &Planned| {
            let earlier = planned.request();
            Request { frame: request.frame, ..*earlier } == request
        };
        let found = self.plans.iter().position(is_it).map(|at| self.plans.remove(at));
        let mut slot = found;
        updated(&mut slot, graph, request)?;
        if self.plans.len() >= MOST_PLANS {
            self.plans.remove(0);
        }
        self.plans.extend(slot);
        self.plans.last().ok_or_else(|| Error::Value("nothing was planned".into()))
    }

    /// The plan that was made last.
    pub fn planned(&self) -> Option<&Planned> {
        self.plans.last()
    }

    /// The stages that enter the plan that was made last, by the names of its inputs.
    pub fn handed<'s>(&'s self, plan: &'s Plan) -> impl Iterator<Item = (&'s str, &'s T)> {
        plan.inputs().iter().filter_map(|port| {
            let stage = stage_of(port.base())?;
            let (_, name) = self.stages.iter().find(|(k, _)| k.frame == port.frame && k.stage == stage)?;
            Some((port.name.as_str(), self.store.peek(*name)?))
        })
    }

    /// Keeps the stages among the results of a run of the plan that was made last, which are in the order of its
    /// outputs; `bytes` tells their sizes. Returns the graph's own output, and what is kept no longer.
    pub fn finish(&mut self, results: Vec<T>, bytes: impl Fn(&T) -> u64) -> (Option<T>, Vec<T>) {
        let Some(planned) = self.plans.last() else { return (None, results) };
        let (mut output, mut gone) = (None, Vec::new());
        for (port, image) in planned.plan().outputs().iter().zip(results) {
            let stage = stage_of(port.base());
            let name = stage.and_then(|stage| {
                self.stages
                    .iter()
                    .find(|(k, _)| k.frame == port.frame && k.stage == stage)
                    .map(|(_, name)| *name)
            });
            match name {
                Some(name) => {
                    let size = bytes(&image);
                    gone.extend(self.store.put(name, image, size));
                }
                None => output = Some(image),
            }
        }
        (output, gone)
    }

    /// True where stages of a frame of this number are kept.
    pub fn knows(&self, frame: i64) -> bool {
        self.store.knows(frame)
    }

    /// Most bytes that are kept.
    pub fn most(&self) -> u64 {
        self.store.most()
    }

    /// Forgets all stages, so that their memory is given back.
    pub fn clear(&mut self) {
        self.store.clear();
    }

    /// Bytes of the stages that are kept.
    pub fn bytes(&self) -> u64 {
        self.store.bytes()
    }
}

/// The number of a stage by the name of its port; none for other ports.
fn stage_of(base: &str) -> Option<u32> {
    base.strip_prefix("stage")?.parse().ok()
}

/// Brings a plan up to date, or makes it anew.
fn updated<'p>(slot: &'p mut Option<Planned>, graph: &Graph, request: Request) -> Result<&'p Planned> {
    let fits = |planned: &Planned| Request { frame: request.frame, ..*planned.request() } == request;
    let planned = match slot.take().filter(fits) {
        Some(mut planned) => {
            planned.set_request(request)?;
            planned.update(graph)?;
            planned
        }
        None => Planned::new(graph, request)?,
    };
    Ok(slot.insert(planned))
}
