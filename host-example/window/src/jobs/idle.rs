//! Search for controls that have no effect at the moment: those whose other values leave every pass as it is.

use std::collections::HashSet;

use crate::state::look::EditedLook;
use crate::state::value::Value;
use isophote_files::error::Result;
use isophote_finishing::stylize::frame_request;
use isophote_loader::Library;
use isophote_loader::Plan;
use isophote_loader::abi::IsophoteRequest;

/// Side of the picture that plans are compared for.
const SIDE: u32 = 512;

/// A look about whose controls something is to be known.
pub struct IdleRequest {
    /// The library.
    pub library: Library,
    /// The look.
    pub look: EditedLook,
    /// Request of looks on the picture; that of scenes without.
    pub asked: Option<IsophoteRequest>,
}

/// The controls that are known to have none.
pub struct IdleControls {
    /// The look.
    pub look: EditedLook,
    /// Request that it was found for.
    pub asked: Option<IsophoteRequest>,
    /// Names of the parameters without effect.
    pub idle: HashSet<String>,
}

/// Tries all controls. What cannot be tried has an effect.
pub fn idle_controls(request: IdleRequest) -> IdleControls {
    let idle = find(&request).unwrap_or_default();
    IdleControls { look: request.look, asked: request.asked, idle }
}

fn find(IdleRequest { library, look, asked }: &IdleRequest) -> Result<HashSet<String>> {
    let mut idle = HashSet::new();
    let Some(style) = look.style(library)? else { return Ok(idle) };
    let usual = frame_request(library, &style, (SIDE, SIDE))?;
    let IsophoteRequest { width, height, scale, reference_height, canonical_height, .. } = usual;
    let request = asked.map_or(usual, |asked| IsophoteRequest {
        width,
        height,
        scale,
        reference_height,
        canonical_height,
        ..asked
    });
    // One frame before shows what all show.
    let known = style.past(library, &request)?.frames.min(1);
    let now = Work::of(&style.plan(library, &request, known)?);
    for parameter in look.parameters(library)? {
        let present = look.value(&parameter);
        let set = |value: &Value| style.graph.set(parameter.node, parameter.param.id, &value.text());
        let has_effect = present.others(&parameter.param.kind).iter().any(|other| {
            set(other).is_ok() && {
                let known = style.past(library, &request).map_or(0, |past| past.frames.min(1));
                // What cannot be planned is at least not the same.
                style.plan(library, &request, known).map_or(true, |plan| Work::of(&plan) != now)
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
