//! Results that are kept for other parts of their segments, and what each was made from.

use super::contents::Content;
use isophote::engine::Plan;
use isophote::engine::plan::Pass;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Results of which it is known what they were made from; their images take far more.
const MOST: usize = 24;

/// A result that was kept.
pub struct Made {
    /// Number of its plan, and of all that is done to pixels before it.
    pub plan: u128,
    /// Number of its image.
    pub name: u128,
    /// Contents of the images that its plan read, by its names for them.
    pub contents: Vec<(String, Content)>,
    /// The plan that says which rows of it a part is made from: that of its longest vector. None where motion may be as long
    /// as it ever is.
    pub reach: Option<Plan>,
}

impl Made {
    /// The content that went by a name.
    pub fn content(&self, name: &str) -> Option<&Content> {
        self.contents.iter().find(|(known, _)| known == name).map(|(_, content)| content)
    }
}

/// The last at the end.
static ALL: Mutex<Vec<Arc<Made>>> = Mutex::new(Vec::new());

fn lock() -> MutexGuard<'static, Vec<Arc<Made>>> {
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The results of a plan, the last first.
pub fn of(plan: u128) -> Vec<Arc<Made>> {
    lock().iter().rev().filter(|made| made.plan == plan).cloned().collect()
}

/// True where the result of this number is known.
pub fn has(name: u128) -> bool {
    lock().iter().any(|made| made.name == name)
}

/// Takes a result in, in the place of the oldest where there are many.
pub fn keep(made: Made) {
    let mut all = lock();
    all.retain(|other| other.name != made.name);
    if all.len() >= MOST {
        all.remove(0);
    }
    all.push(Arc::new(made));
}

/// Forgets all.
pub fn forget() {
    let gone = std::mem::take(&mut *lock());
    drop(gone);
}

/// True where two plans have the same images and passes but for how far these reach.
pub fn are_alike(a: &Plan, b: &Plan) -> bool {
    let is_alike = |(a, b): (&Pass, &Pass)| {
        a.kernel.name == b.kernel.name && a.inputs == b.inputs && a.outputs == b.outputs
    };
    a.inputs() == b.inputs()
        && a.images() == b.images()
        && a.passes().len() == b.passes().len()
        && a.passes().iter().zip(b.passes()).all(is_alike)
}
