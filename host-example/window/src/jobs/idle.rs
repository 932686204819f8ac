//! Search for controls that have no effect at the moment: those whose other values leave every pass as it is.

use std::collections::HashSet;
use std::sync::Arc;

use super::worker::{Wake, Worker};
use crate::state::look::EditedLook;
use crate::state::outcome::{IdleControls, Outcome};
use crate::state::session::Session;
use isophote_files::error::Result;
use isophote_finishing::stylize::frame_request;
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_loader::Plan;
use isophote_loader::abi::IsophoteRequest;

/// Side of the picture that plans are compared for.
const SIDE: u32 = 512;
/// Number of the frame that plans are compared for: marks that are held, however long, are others than those that stay.
const FRAME: i64 = 1 << 20;

/// A look about whose controls something is to be known.
struct IdleRequest {
    library: Library,
    look: EditedLook,
    /// Request of looks on the picture; that of scenes without.
    request: Option<IsophoteRequest>,
}

/// The search, on a thread of its own.
pub struct IdleSearch {
    worker: Worker<IdleRequest, IdleControls>,
    /// The last look that was asked about, on what picture.
    requested: Option<(EditedLook, Option<IsophoteRequest>)>,
}

impl IdleSearch {
    /// Starts the thread.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(wake: &Wake) -> Result<Self> {
        Ok(Self { worker: Worker::new("controls", Arc::clone(wake), idle_controls)?, requested: None })
    }

    /// Controls that were found since the last call.
    pub fn answer(&mut self) -> Option<Outcome> {
        self.worker.answer().map(Outcome::Idle)
    }

    /// Searches the controls of the look that is shown, unless it has.
    pub fn follow(&mut self, session: &Session) {
        let request = session.request();
        let is_known =
            self.requested.as_ref().is_some_and(|(look, of)| look == session.look() && *of == request);
        if is_known || !session.open.has_picture() {
            return;
        }
        let (library, look) = (session.library.clone(), session.look().clone());
        self.requested = Some((look.clone(), request));
        self.worker.ask(IdleRequest { library, look, request });
    }
}

/// Tries all controls. What cannot be tried has an effect.
fn idle_controls(request: IdleRequest) -> IdleControls {
    let idle = find(&request).unwrap_or_default();
    IdleControls { look: request.look, request: request.request, idle }
}

fn find(IdleRequest { library, look, request }: &IdleRequest) -> Result<HashSet<String>> {
    let mut idle = HashSet::new();
    let Some(style) = look.style(library)? else { return Ok(idle) };
    let usual = frame_request(library, &style, (SIDE, SIDE))?;
    let IsophoteRequest { width, height, scale, reference_height, canonical_height, .. } = usual;
    let request = request.map_or(usual, |request| IsophoteRequest {
        width,
        height,
        scale,
        reference_height,
        canonical_height,
        ..request
    });
    let request = IsophoteRequest { frame: FRAME, ..request };
    // One frame before shows what all show.
    let known = style.named().past(library, &request)?.frames.min(1);
    let now = Work::of(&style.named().plan(library, &request, known)?);
    for parameter in look.parameters(library)? {
        let present = look.value(&parameter);
        let set = |value: &Value| value.put(&style.graph, parameter.node, parameter.param.id);
        let has_effect = present.others(&parameter.param.kind).iter().any(|other| {
            set(other).is_ok() && {
                let known = style.named().past(library, &request).map_or(0, |past| past.frames.min(1));
                // What cannot be planned is at least not the same.
                style.named().plan(library, &request, known).map_or(true, |plan| Work::of(&plan) != now)
            }
        });
        let is_back = set(&present).is_ok();
        if !has_effect && is_back {
            idle.insert(parameter.name);
        }
    }
    Ok(idle)
}

/// All that a plan computes.
#[derive(PartialEq)]
struct Work(Vec<Step>);

/// A pass: its kernel, its uniform bytes, what it reads and what it writes.
type Step = (String, Vec<u8>, Vec<u32>, Vec<u32>);

impl Work {
    fn of(plan: &Plan) -> Self {
        let passes = plan.passes().into_iter().flatten();
        Self(
            passes
                .map(|pass| {
                    let bytes = [pass.grid, pass.params].concat();
                    (pass.kernel.to_owned(), bytes, pass.inputs.to_vec(), pass.outputs.to_vec())
                })
                .collect(),
        )
    }
}
