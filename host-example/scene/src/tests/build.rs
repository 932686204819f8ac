//! Small glTF files made in memory.

use std::fs;
use std::path::PathBuf;

use serde_json::{Value, json};

use crate::Scene;
use isophote_files::error::Result;

/// A document with one buffer that grows as accessors are added.
pub struct Builder {
    pub json: Value,
    pub bytes: Vec<u8>,
}

/// Component types of the format.
pub const U8: u32 = 5121;
pub const U16: u32 = 5123;
pub const F32: u32 = 5126;

impl Builder {
    /// A document without content.
    pub fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {}}]}], "accessors": [], "bufferViews": []
        });
        Self { json, bytes: Vec::new() }
    }

    /// One triangle in the plane z = 0, counter-clockwise seen from +Z, with indices.
    pub fn triangle() -> Self {
        let mut b = Self::new();
        let positions = b.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let indices = b.add(U16, "SCALAR", 3, &[0, 0, 1, 0, 2, 0]);
        b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
        b.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        b
    }

    /// Adds an accessor with a view of its own and yields its index.
    pub fn add(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
        )
    }

    /// Adds an accessor of floats.
    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "MAT4" => 16,
            _ => 4,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.add(F32, kind, values.len() / width, &bytes)
    }

    /// Adds bytes to the buffer with a view of them.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": start, "byteLength": bytes.len()}))
    }

    /// Appends to a list of the document and yields the index.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// The first primitive.
    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// The text of a .gltf with its buffer inside.
    pub fn gltf(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json["buffers"].is_null() {
            let data: String = self.bytes.iter().map(|b| format!("%{b:02x}")).collect();
            let uri = format!("data:application/octet-stream,{data}");
            json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        }
        serde_json::to_vec(&json).unwrap()
    }

    /// The bytes of a .glb.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bytes.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut out = b"glTF".to_vec();
        let word = |out: &mut Vec<u8>, value: usize| out.extend((value as u32).to_le_bytes());
        word(&mut out, 2);
        word(&mut out, 12 + 8 + text.len() + 8 + bin.len());
        word(&mut out, text.len());
        out.extend(b"JSON");
        out.extend(text);
        word(&mut out, bin.len());
        out.extend(b"BIN\0");
        out.extend(bin);
        out
    }

    /// Writes and loads the .gltf.
    pub fn load(&self) -> Result<Scene> {
        load_bytes("scene.gltf", &self.gltf())
    }
}

/// Loads a file with these contents from a folder of its own.
pub fn load_bytes(name: &str, bytes: &[u8]) -> Result<Scene> {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    Scene::load(&path, None)
}

/// A PNG of 2x2 pixels.
pub fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_fn(2, 2, |x, y| image::Rgba([x as u8 * 255, y as u8 * 255, 7, 255]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
