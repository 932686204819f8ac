//! Result that a page is told: JSON, and the bytes that it points into.

use isophote::engine::Class;
use isophote::engine::program::{Dispatch, Program, Role, Shader, Texture};
use serde_json::{Value, json};

/// A response.
#[derive(Debug, Default)]
pub struct Response {
    /// Text that is told.
    pub json: Value,
    /// Uniform blocks; `json` says where each begins and how long it is.
    pub bytes: Vec<u8>,
}

impl From<Value> for Response {
    fn from(json: Value) -> Self {
        Self { json, bytes: Vec::new() }
    }
}

impl Response {
    /// The length of the JSON in four bytes, the lowest first, the JSON, and the bytes.
    pub fn into_bytes(self) -> Vec<u8> {
        let json = self.json.to_string();
        let mut all = Vec::with_capacity(4 + json.len() + self.bytes.len());
        all.extend_from_slice(&(json.len() as u32).to_le_bytes());
        all.extend_from_slice(json.as_bytes());
        all.extend_from_slice(&self.bytes);
        all
    }

    /// Adds a program, with the operations of each dispatch.
    pub fn program(mut self, program: &Program, operations: impl Iterator<Item = f64>) -> Self {
        let textures: Vec<Value> = program.textures.iter().map(texture).collect();
        let dispatches: Vec<Value> = program
            .dispatches
            .iter()
            .zip(operations)
            .map(|(dispatch, operations)| self.dispatch(dispatch, operations))
            .collect();
        self.json["textures"] = textures.into();
        self.json["dispatches"] = dispatches.into();
        self
    }

    fn dispatch(&mut self, dispatch: &Dispatch, operations: f64) -> Value {
        let mut block = |bytes: &[u8]| {
            let at = self.bytes.len();
            self.bytes.extend_from_slice(bytes);
            json!([at, bytes.len()])
        };
        json!({
            "shader": dispatch.shader.name,
            "grid": block(bytemuck::bytes_of(&dispatch.grid)),
            "params": if dispatch.params.is_empty() { Value::Null } else { block(&dispatch.params) },
            "inputs": dispatch.inputs,
            "outputs": dispatch.outputs,
            "workgroups": dispatch.workgroups,
            "operations": operations,
        })
    }
}

fn texture(texture: &Texture) -> Value {
    let (role, name) = match &texture.role {
        Role::Input(name) => ("input", Some(name)),
        Role::Output(name) => ("output", Some(name)),
        Role::Transient => ("transient", None),
    };
    let w = texture.window;
    json!({
        "role": role,
        "name": name,
        "format": texture.format.wgsl(),
        "isField": texture.class == Class::Field,
        "window": [w.x0, w.y0, w.x1, w.y1],
    })
}

/// A shader and how it is bound.
pub fn shader(shader: &Shader) -> Value {
    let outputs: Vec<&str> = shader.outputs.iter().map(|format| format.wgsl()).collect();
    json!({
        "name": shader.name,
        "code": shader.source,
        "inputs": shader.inputs,
        "filtered": shader.filtered,
        "outputs": outputs,
        "hasParams": shader.params_size > 0,
    })
}
