//! The plans of a page, and the answers to its calls.

use crate::ask::{Picture, Request, region};
use crate::catalogue::catalogue;
use crate::look::GraphAtFrame;
use crate::parts::{graph_and_request, history, parts};
#[cfg(feature = "cpu")]
use crate::processor::Processor;
use crate::response::{self, Response};
use isophote::engine::Rect;
use isophote::planned::Change;
use isophote::{Error, Lowered};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// All that a page has asked for and not released.
#[derive(Debug, Default)]
pub struct Planner {
    plans: BTreeMap<u32, Lowered>,
    last: u32,
    #[cfg(feature = "cpu")]
    processor: Processor,
}

impl Planner {
    /// Answers a request, which is JSON, with the pixels that it is about. What fails is told as `{"error": …}`; nothing
    /// has changed then.
    pub fn answer(&mut self, request: &[u8], pixels: &[u8]) -> Response {
        let parsed =
            serde_json::from_slice(request).map_err(|e| Error::Format(format!("not a request: {e}")));
        let answered = parsed.and_then(|request| self.answered(request, pixels));
        answered.unwrap_or_else(|error| json!({ "error": error.to_string() }).into())
    }

    #[cfg_attr(not(feature = "cpu"), expect(unused_variables, reason = "planners compute nothing"))]
    fn answered(&mut self, request: Request, pixels: &[u8]) -> Result<Response, Error> {
        match request {
            Request::Catalogue => Ok(catalogue().into()),
            Request::Graph { look, frame } => {
                let text = GraphAtFrame::read(&look, frame)?.graph.to_json()?;
                let graph: Value = serde_json::from_str(&text).map_err(|e| Error::Format(e.to_string()))?;
                Ok(json!({ "graph": graph }).into())
            }
            Request::Plan { look, picture, region } => self.plan(&look, &picture, region),
            Request::Update { plan, look, picture } => {
                let (graph, request) = graph_and_request(&look, &picture)?;
                let history = history(&graph, request)?;
                let plan = self.get(plan)?;
                let change = match plan.update(graph, Some(request))? {
                    Change::Uniforms => "uniforms",
                    Change::Structure => "structure",
                };
                Ok(program(plan, json!({ "change": change, "history": history })))
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
                Ok(response::shader(&found.shader).into())
            }
            Request::Release { plan } => {
                self.plans.remove(&plan);
                Ok(json!({}).into())
            }
            Request::Parts { look, picture, memory } => Ok(parts(&look, &picture, memory)?.into()),
            #[cfg(feature = "cpu")]
            Request::Compute { look, picture, region, inputs } => {
                self.processor.compute((&look, &picture), region, &inputs, pixels)
            }
        }
    }

    fn plan(&mut self, look: &Value, picture: &Picture, part: Option<[i32; 4]>) -> Result<Response, Error> {
        let (graph, request) = graph_and_request(look, picture)?;
        let part = part.map_or_else(|| Rect::of_size(request.width, request.height), region);
        let history = history(&graph, request)?;
        let plan = Lowered::new(graph, request, part)?;
        self.last += 1;
        let answer = program(&plan, json!({ "plan": self.last, "history": history }));
        self.plans.insert(self.last, plan);
        Ok(answer)
    }

    fn get(&mut self, plan: u32) -> Result<&mut Lowered, Error> {
        self.plans.get_mut(&plan).ok_or_else(|| Error::Unknown(format!("there is no plan {plan}")))
    }
}

fn program(plan: &Lowered, json: Value) -> Response {
    Response::from(json).program(plan.program(), plan.operations())
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote::registry;

    fn ask(planner: &mut Planner, request: Value) -> Response {
        planner.answer(request.to_string().as_bytes(), &[])
    }

    fn plan(planner: &mut Planner, look: Value) -> Value {
        ask(planner, json!({ "ask": "plan", "look": look, "picture": { "width": 64, "height": 48 } })).json
    }

    #[test]
    fn the_catalogue_has_every_node() {
        let answer = ask(&mut Planner::default(), json!({ "ask": "catalogue" }));
        let ids: Vec<&str> =
            answer.json["nodes"].as_array().unwrap().iter().map(|n| n["id"].as_str().unwrap()).collect();
        assert_eq!(ids, registry::nodes().iter().map(|spec| spec.id).collect::<Vec<_>>());
    }

    #[test]
    fn blocks_lie_in_the_bytes() {
        let mut planner = Planner::default();
        let request = json!({ "ask": "plan", "look": { "style": "cartoon" }, "picture": { "width": 64, "height": 48 } });
        let answer = ask(&mut planner, request);
        for dispatch in answer.json["dispatches"].as_array().unwrap() {
            for block in [&dispatch["grid"], &dispatch["params"]].into_iter().filter(|block| !block.is_null())
            {
                let [at, length] = [0, 1].map(|i| block[i].as_u64().unwrap() as usize);
                assert!(length > 0 && at + length <= answer.bytes.len());
            }
            assert!(dispatch["operations"].as_f64().unwrap() > 0.0);
        }
        let length = answer.bytes.len();
        let all = answer.into_bytes();
        let json = u32::from_le_bytes([all[0], all[1], all[2], all[3]]) as usize;
        assert_eq!(all.len(), 4 + json + length);
        assert!(serde_json::from_slice::<Value>(&all[4..4 + json]).is_ok());
    }

    #[test]
    fn plans_are_updated_moved_and_released() {
        let mut planner = Planner::default();
        let number = plan(&mut planner, json!({ "style": "cartoon" }))["plan"].clone();
        let picture = json!({ "width": 64, "height": 48 });
        let mut update = |parameters: Value| {
            let look = json!({ "style": "cartoon", "parameters": parameters });
            let request = json!({ "ask": "update", "plan": number, "look": look, "picture": picture });
            ask(&mut planner, request).json
        };
        assert_eq!(update(json!({ "posterize": 5 }))["change"], "uniforms");
        assert_eq!(update(json!({ "abstraction": "flow" }))["change"], "structure");
        assert!(update(json!({ "posterize": -4 }))["error"].as_str().unwrap().contains("posterize"));
        let region = json!({ "ask": "region", "plan": number, "region": [0, 0, 16, 16] });
        let moved = ask(&mut planner, region.clone()).json;
        let output = moved["textures"].as_array().unwrap().iter().find(|t| t["role"] == "output");
        assert_eq!(output.unwrap()["window"], json!([0, 0, 16, 16]));
        let shader = ask(&mut planner, json!({ "ask": "shader", "plan": number, "dispatch": 0 })).json;
        assert!(shader["code"].as_str().unwrap().contains("fn main("));
        ask(&mut planner, json!({ "ask": "release", "plan": number }));
        assert!(ask(&mut planner, region).json["error"].as_str().unwrap().contains("no plan"));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let mut planner = Planner::default();
        let size = json!({ "width": 64, "height": 48 });
        for (request, part) in [
            (json!({ "ask": "everything" }), "everything"),
            (json!({ "ask": "graph", "look": { "style": "cartoom" } }), "cartoon"),
            (json!({ "ask": "graph", "look": { "parameters": {} } }), "names no style"),
            (
                json!({ "ask": "plan", "look": { "style": "cartoon" }, "picture": { "width": 0, "height": 1 } }),
                "0",
            ),
            (
                json!({ "ask": "plan", "look": { "format": "isophote-graph", "version": 1, "output": "lines",
                    "nodes": [{ "name": "lines", "node": "composite_lines" }] }, "picture": size }),
                "not connected",
            ),
            (json!({ "ask": "shader", "plan": 9, "dispatch": 0 }), "no plan 9"),
        ] {
            let error = ask(&mut planner, request).json["error"].as_str().unwrap().to_owned();
            assert!(error.contains(part), "{error}");
        }
        assert!(planner.answer(b"{", &[]).json["error"].as_str().unwrap().contains("not a request"));
        let guides = json!({ "width": 64, "height": 48, "guides": ["normals"] });
        let request = json!({ "ask": "plan", "look": { "style": "ink" }, "picture": guides });
        assert!(ask(&mut planner, request).json["error"].as_str().unwrap().contains("normal, depth"));
    }

    #[test]
    fn parts_cover_the_picture_and_say_what_they_read() {
        let mut planner = Planner::default();
        let look = json!({ "style": "gaussian", "lengths": "pixels" });
        let picture = json!({ "width": 4000, "height": 3000, "alpha": "straight" });
        let request = json!({ "ask": "parts", "look": look, "picture": picture, "memory": 256 << 20 });
        let answer = ask(&mut planner, request).json;
        let parts = answer["parts"].as_array().unwrap();
        assert!(parts.len() > 8, "{}", parts.len());
        let mut down = 0;
        for part in parts {
            let [x0, y0, x1, y1] = [0, 1, 2, 3].map(|i| part["region"][i].as_i64().unwrap());
            assert_eq!((x0, y0, x1), (0, down, 4000));
            let read = part["inputs"]["color"].as_array().unwrap();
            assert!(read[1].as_i64().unwrap() <= y0 && read[3].as_i64().unwrap() >= y1);
            assert!(part["bytes"].as_u64().unwrap() <= 256 << 20);
            down = y1;
        }
        assert_eq!(down, 3000);
    }

    #[test]
    fn frames_in_order_say_what_they_read_of_those_before() {
        let mut planner = Planner::default();
        let look = json!({ "style": "cartoon", "parameters": { "steadiness": 1 } });
        let mut plan = |past: Value| {
            let picture = json!({ "width": 64, "height": 48, "guides": ["motion"], "past": past });
            ask(&mut planner, json!({ "ask": "plan", "look": look, "picture": picture })).json
        };
        let names = |plan: &Value, role: &str| -> Vec<String> {
            let textures =
                plan["textures"].as_array().unwrap().iter().filter(|texture| texture["role"] == role);
            textures.map(|texture| texture["name"].as_str().unwrap().to_owned()).collect()
        };
        let still = plan(Value::Null);
        assert_eq!(still["history"], Value::Null);
        assert_eq!(names(&still, "output").len(), 1);
        let first = plan(json!(0));
        let frames = first["history"]["frames"].as_u64().unwrap();
        assert!(frames > 0 && first["history"]["images"]["stage0"].as_u64().unwrap() <= frames);
        assert!(names(&first, "output").iter().any(|name| name == "stage0"));
        assert!(!names(&first, "input").iter().any(|name| name.contains('@')));
        // More frames than are read are as many as are.
        for past in [1, 99] {
            let inputs = names(&plan(json!(past)), "input");
            assert!(inputs.iter().any(|name| name == "stage0@-1"), "{inputs:?}");
        }
    }

    #[cfg(feature = "cpu")]
    #[test]
    fn the_processor_computes_parts_that_are_the_whole() {
        let mut planner = Planner::default();
        let [width, height] = [40_usize, 160];
        let pixels: Vec<u8> = (0..width * height * 4).map(|i| (i * 7919 % 251) as u8).collect();
        let mut compute = |region: [usize; 4], window: [usize; 4]| {
            let own = &pixels[window[1] * width * 4..window[3] * width * 4];
            let request = json!({
                "ask": "compute", "look": { "style": "gaussian", "lengths": "pixels" },
                "picture": { "width": width, "height": height, "alpha": "straight" },
                "region": region, "inputs": { "color": window },
            });
            planner.answer(request.to_string().as_bytes(), own)
        };
        let whole = compute([0, 0, width, height], [0, 0, width, height]);
        assert_eq!(whole.bytes.len(), pixels.len());
        assert_ne!(whole.bytes, pixels);
        let part = compute([0, 60, width, 100], [0, 20, width, 140]);
        assert_eq!(part.json, json!({ "width": width, "height": 40 }));
        assert_eq!(part.bytes, whole.bytes[60 * width * 4..100 * width * 4]);
        let short = compute([0, 0, width, height], [0, 0, width, 20]).json;
        assert!(short["error"].as_str().unwrap().contains("color"), "{short}");
    }
}
