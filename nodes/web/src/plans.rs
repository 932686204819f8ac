//! The plans of a page, and the answers to its calls.

use crate::answer::{self, Answer};
use crate::ask::{Picture, Request, region};
use crate::catalogue::catalogue;
use crate::look::Look;
use isophote::engine::Rect;
use isophote::request::Change;
use isophote::{Error, Graph, Lowered};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// All that a page has asked for and not released.
#[derive(Debug, Default)]
pub struct Planner {
    plans: BTreeMap<u32, Lowered>,
    last: u32,
}

impl Planner {
    /// Answers a request, which is JSON. What fails is told as `{"error": …}`; nothing has changed then.
    pub fn answer(&mut self, request: &[u8]) -> Answer {
        let asked = serde_json::from_slice(request).map_err(|e| Error::Format(format!("not a request: {e}")));
        let answered = asked.and_then(|request| self.answered(request));
        answered.unwrap_or_else(|error| json!({ "error": error.to_string() }).into())
    }

    fn answered(&mut self, request: Request) -> Result<Answer, Error> {
        match request {
            Request::Catalogue => Ok(catalogue().into()),
            Request::Graph { look, frame } => {
                let text = Look::read(&look, frame)?.graph.to_json()?;
                let graph: Value = serde_json::from_str(&text).map_err(|e| Error::Format(e.to_string()))?;
                Ok(json!({ "graph": graph }).into())
            }
            Request::Plan { look, picture, region } => self.plan(&look, &picture, region),
            Request::Update { plan, look, picture } => {
                let (graph, request) = asked(&look, &picture)?;
                let plan = self.get(plan)?;
                let change = match plan.update(graph, Some(request))? {
                    Change::Uniforms => "uniforms",
                    Change::Structure => "structure",
                };
                Ok(program(plan, json!({ "change": change })))
            }
            Request::Region { plan, region: part } => {
                let plan = self.get(plan)?;
                plan.set_region(region(part))?;
                Ok(program(plan, json!({})))
            }
            Request::Shader { plan, dispatch } => {
                let dispatches = &self.get(plan)?.program().dispatches;
                let found = dispatches.get(dispatch).ok_or_else(|| {
                    let count = dispatches.len();
                    Error::Unknown(format!(
                        "the plan has {count} dispatches, counted from 0, and no {dispatch}"
                    ))
                })?;
                Ok(answer::shader(&found.shader).into())
            }
            Request::Release { plan } => {
                self.plans.remove(&plan);
                Ok(json!({}).into())
            }
        }
    }

    fn plan(&mut self, look: &Value, picture: &Picture, part: Option<[i32; 4]>) -> Result<Answer, Error> {
        let (graph, request) = asked(look, picture)?;
        isophote::engine::image::check_size(request.width, request.height)?;
        let part = part.map_or_else(|| Rect::of_size(request.width, request.height), region);
        let plan = Lowered::new(graph, request, part)?;
        self.last += 1;
        let answer = program(&plan, json!({ "plan": self.last }));
        self.plans.insert(self.last, plan);
        Ok(answer)
    }

    fn get(&mut self, plan: u32) -> Result<&mut Lowered, Error> {
        self.plans.get_mut(&plan).ok_or_else(|| Error::Unknown(format!("there is no plan {plan}")))
    }
}

/// The graph of a look and what is wanted of it.
fn asked(look: &Value, picture: &Picture) -> Result<(Graph, isophote::Request), Error> {
    let look = Look::read(look, picture.frame)?;
    let mut graph = look.graph;
    graph.set_precision(picture.precision());
    Ok((graph, picture.request(look.reference_height)?))
}

fn program(plan: &Lowered, json: Value) -> Answer {
    Answer::from(json).program(plan.program(), plan.operations())
}
