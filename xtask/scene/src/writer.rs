//! Writes glTF 2.0: collects meshes, nodes, skins and animations, and lays their data out in one
//! binary buffer beside the JSON.

use super::materials::{Material, Model};
use super::mesh::Mesh;
use super::textures::Texture;
use glam::{Mat4, Quat, Vec3, Vec4};
use serde_json::{Map, Value, json};

const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A node to add; what is absent is left out of the file.
#[derive(Default)]
pub struct Node {
    pub name: String,
    pub translation: Vec3,
    pub rotation: Quat,
    /// Uniform scale; 0 stands for 1.
    pub scale: f32,
    pub mesh: Option<usize>,
    pub camera: Option<usize>,
    pub light: Option<usize>,
    pub skin: Option<usize>,
    pub children: Vec<usize>,
    /// True where it only surrounds the scene: viewers that frame the scene leave it out.
    pub backdrop: bool,
}

/// Property that a channel animates, with one value for each key (three for cubic splines: in-tangent,
/// value, out-tangent).
pub enum Track {
    Translation(Vec<Vec3>),
    Rotation(Vec<Quat>),
    Scale(Vec<Vec3>),
    /// Morph weights, all of one key side by side.
    Weights(Vec<f32>),
}

/// The way in which values between keys are found.
#[derive(Clone, Copy)]
pub enum Interpolation {
    Step,
    Linear,
    CubicSpline,
}

/// A glTF file under construction.
#[derive(Default)]
pub struct Writer {
    buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    material_keys: Vec<Material>,
    images: Vec<Texture>,
    nodes: Vec<Value>,
    roots: Vec<usize>,
    skins: Vec<Value>,
    cameras: Vec<Value>,
    lights: Vec<Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

impl Writer {
    /// Appends data to the buffer and returns the index of its accessor.
    fn accessor(&mut self, bytes: &[u8], target: Option<u32>, mut accessor: Value) -> usize {
        // Every accessor begins on a multiple of four, which suits all component types.
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.buffer.extend_from_slice(bytes);
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// An accessor of `N` floats per element, with its bounds where asked.
    fn floats<const N: usize>(&mut self, values: &[[f32; N]], target: Option<u32>, bounds: bool) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"].get(N - 1).copied().unwrap_or("MAT4");
        let mut accessor = json!({ "componentType": FLOAT, "count": values.len(), "type": kind });
        if bounds {
            let fold = |start: f32, pick: fn(f32, f32) -> f32| {
                values.iter().fold([start; N], |folded, value| {
                    std::array::from_fn(|component| pick(folded[component], value[component]))
                })
            };
            accessor["min"] = json!(fold(f32::INFINITY, f32::min).to_vec());
            accessor["max"] = json!(fold(f32::NEG_INFINITY, f32::max).to_vec());
        }
        self.accessor(&bytes, target, accessor)
    }

    /// The index of a material, written when it is used for the first time.
    fn material(&mut self, material: Material) -> usize {
        if let Some(index) = self.material_keys.iter().position(|&key| key == material) {
            return index;
        }
        let look = material.definition();
        let mut surface = json!({
            "baseColorFactor": [look.color[0], look.color[1], look.color[2], 1.0],
            "metallicFactor": look.metallic,
            "roughnessFactor": look.roughness,
        });
        if let Some(texture) = look.texture {
            surface["baseColorTexture"] = self.texture(texture, look.tile);
        }
        if let Some(texture) = look.surface {
            surface["metallicRoughnessTexture"] = self.texture(texture, look.tile);
        }
        let mut value = json!({ "name": look.name, "pbrMetallicRoughness": surface });
        if let Some((texture, strength)) = look.normal {
            value["normalTexture"] = self.texture(texture, look.tile);
            value["normalTexture"]["scale"] = json!(strength);
        }
        if let Some(texture) = look.surface {
            value["occlusionTexture"] = self.texture(texture, look.tile);
        }
        let mut extensions = Map::new();
        if let Some((color, strength)) = look.emissive {
            value["emissiveFactor"] = json!(color);
            extensions
                .insert("KHR_materials_emissive_strength".into(), json!({ "emissiveStrength": strength }));
        }
        if look.unlit {
            extensions.insert("KHR_materials_unlit".into(), json!({}));
        }
        if !extensions.is_empty() {
            value["extensions"] = Value::Object(extensions);
        }
        if look.alpha_mask {
            value["alphaMode"] = json!("MASK");
            value["alphaCutoff"] = json!(0.5);
        }
        if look.double_sided {
            value["doubleSided"] = json!(true);
        }
        self.materials.push(value);
        self.material_keys.push(material);
        self.materials.len() - 1
    }

    /// A texture reference, scaled from metres to repetitions.
    fn texture(&mut self, texture: Texture, tile: Option<f32>) -> Value {
        let index = self.images.iter().position(|&image| image == texture).unwrap_or_else(|| {
            self.images.push(texture);
            self.images.len() - 1
        });
        let mut value = json!({ "index": index });
        if let Some(tile) = tile {
            value["extensions"] = json!({ "KHR_texture_transform": { "scale": [1.0 / tile, 1.0 / tile] } });
        }
        value
    }

    /// Adds the mesh of a model, with one primitive for each of its materials.
    pub fn model(&mut self, name: &str, model: &Model) -> usize {
        let mut targets = 0;
        let primitives: Vec<Value> = model
            .parts
            .iter()
            .filter(|(_, mesh)| !mesh.indices.is_empty())
            .map(|(&material, mesh)| {
                targets = targets.max(mesh.morphs.len());
                self.primitive(material, mesh)
            })
            .collect();
        let mut value = json!({ "name": name, "primitives": primitives });
        if targets > 0 {
            value["weights"] = json!(vec![0.0; targets]);
        }
        self.meshes.push(value);
        self.meshes.len() - 1
    }

    /// Writes the vertices and indices of a mesh.
    fn primitive(&mut self, material: Material, mesh: &Mesh) -> Value {
        let vertices = Some(ARRAY_BUFFER);
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|point| point.to_array()).collect();
        let normals: Vec<[f32; 3]> = mesh.normals.iter().map(|normal| normal.to_array()).collect();
        let mut attributes = json!({
            "POSITION": self.floats(&positions, vertices, true),
            "NORMAL": self.floats(&normals, vertices, false),
        });
        let look = material.definition();
        if look.texture.is_some() || look.normal.is_some() {
            let uvs: Vec<[f32; 2]> = mesh.uvs.iter().map(|uv| uv.to_array()).collect();
            attributes["TEXCOORD_0"] = json!(self.floats(&uvs, vertices, false));
        }
        if !mesh.colors.is_empty() {
            let bytes: Vec<u8> = mesh
                .colors
                .iter()
                .chain(std::iter::repeat(&Vec4::ONE))
                .take(mesh.positions.len())
                .flat_map(|color| color.to_array())
                .flat_map(|value| ((value.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16).to_le_bytes())
                .collect();
            let kind = json!({
                "componentType": UNSIGNED_SHORT, "normalized": true, "count": mesh.positions.len(), "type": "VEC4",
            });
            attributes["COLOR_0"] = json!(self.accessor(&bytes, vertices, kind));
        }
        if !mesh.joints.is_empty() {
            let kind = json!({ "componentType": UNSIGNED_BYTE, "count": mesh.joints.len(), "type": "VEC4" });
            attributes["JOINTS_0"] = json!(self.accessor(mesh.joints.as_flattened(), vertices, kind));
            attributes["WEIGHTS_0"] = json!(self.floats(&mesh.weights, vertices, false));
        }
        let targets: Vec<Value> = mesh
            .morphs
            .iter()
            .map(|morph| {
                let positions: Vec<[f32; 3]> = morph.positions.iter().map(|point| point.to_array()).collect();
                let normals: Vec<[f32; 3]> = morph.normals.iter().map(|normal| normal.to_array()).collect();
                json!({
                    "POSITION": self.floats(&positions, vertices, true),
                    "NORMAL": self.floats(&normals, vertices, false),
                })
            })
            .collect();
        let mut primitive = json!({
            "attributes": attributes,
            "indices": self.indices(&mesh.indices, mesh.positions.len()),
            "material": self.material(material),
        });
        if !targets.is_empty() {
            primitive["targets"] = json!(targets);
        }
        primitive
    }

    /// Writes indices, in two bytes each where they fit.
    fn indices(&mut self, indices: &[u32], vertices: usize) -> usize {
        // The largest index of a type is reserved for restarting primitives.
        let (bytes, kind): (Vec<u8>, u32) = if vertices < 65535 {
            (indices.iter().flat_map(|&index| (index as u16).to_le_bytes()).collect(), UNSIGNED_SHORT)
        } else {
            (indices.iter().flat_map(|index| index.to_le_bytes()).collect(), UNSIGNED_INT)
        };
        let accessor = json!({ "componentType": kind, "count": indices.len(), "type": "SCALAR" });
        self.accessor(&bytes, Some(ELEMENT_ARRAY_BUFFER), accessor)
    }

    /// Adds a node that is not in the scene by itself: a child or a joint.
    pub fn node(&mut self, node: Node) -> usize {
        let mut value = json!({ "name": node.name });
        if node.translation != Vec3::ZERO {
            value["translation"] = json!(node.translation.to_array());
        }
        if node.rotation != Quat::IDENTITY {
            value["rotation"] = json!(node.rotation.normalize().to_array());
        }
        if node.scale != 0.0 && node.scale != 1.0 {
            value["scale"] = json!([node.scale, node.scale, node.scale]);
        }
        for (key, index) in [("mesh", node.mesh), ("camera", node.camera), ("skin", node.skin)] {
            if let Some(index) = index {
                value[key] = json!(index);
            }
        }
        if let Some(light) = node.light {
            value["extensions"] = json!({ "KHR_lights_punctual": { "light": light } });
        }
        if !node.children.is_empty() {
            value["children"] = json!(node.children);
        }
        if node.backdrop {
            value["extras"] = json!({ "backdrop": true });
        }
        self.nodes.push(value);
        self.nodes.len() - 1
    }

    /// Adds a node at the top of the scene.
    pub fn root(&mut self, node: Node) -> usize {
        let index = self.node(node);
        self.roots.push(index);
        index
    }

    /// Adds a mesh at a place, turned by `degrees` about the vertical.
    pub fn place(&mut self, name: &str, mesh: usize, position: Vec3, degrees: f32) -> usize {
        self.root(Node {
            name: name.into(),
            translation: position,
            rotation: Quat::from_rotation_y(degrees.to_radians()),
            mesh: Some(mesh),
            ..Node::default()
        })
    }

    /// Adds a skin from its joints and where each of them is in the bind pose.
    pub fn skin(&mut self, name: &str, joints: &[usize], bind: &[Mat4]) -> usize {
        let matrices: Vec<[f32; 16]> = bind.iter().map(|matrix| matrix.inverse().to_cols_array()).collect();
        let inverse = self.floats(&matrices, None, false);
        self.skins.push(json!({ "name": name, "joints": joints, "inverseBindMatrices": inverse }));
        self.skins.len() - 1
    }

    /// Adds a perspective camera; the vertical field of view is in degrees.
    pub fn camera(&mut self, name: &str, field_of_view: f32, near: f32, far: f32) -> usize {
        self.cameras.push(json!({
            "name": name,
            "type": "perspective",
            "perspective": {
                "yfov": field_of_view.to_radians(), "aspectRatio": 16.0 / 9.0, "znear": near, "zfar": far,
            },
        }));
        self.cameras.len() - 1
    }

    /// Adds a light: `kind` is `directional` (intensity in lux) or `point` (in candela).
    pub fn light(
        &mut self,
        name: &str,
        kind: &str,
        color: Vec3,
        intensity: f32,
        range: Option<f32>,
    ) -> usize {
        let mut light =
            json!({ "name": name, "type": kind, "color": color.to_array(), "intensity": intensity });
        if let Some(range) = range {
            light["range"] = json!(range);
        }
        self.lights.push(light);
        self.lights.len() - 1
    }

    /// Animates a node. Times are in seconds.
    pub fn animate(&mut self, node: usize, times: &[f32], track: &Track, interpolation: Interpolation) {
        let keys: Vec<[f32; 1]> = times.iter().map(|&time| [time]).collect();
        let input = self.floats(&keys, None, true);
        let vectors = |values: &[Vec3]| values.iter().map(|value| value.to_array()).collect::<Vec<_>>();
        let (path, output) = match track {
            Track::Translation(values) => ("translation", self.floats(&vectors(values), None, false)),
            Track::Scale(values) => ("scale", self.floats(&vectors(values), None, false)),
            Track::Rotation(values) => {
                let values: Vec<[f32; 4]> = values.iter().map(|value| value.to_array()).collect();
                ("rotation", self.floats(&values, None, false))
            }
            Track::Weights(values) => {
                let values: Vec<[f32; 1]> = values.iter().map(|&value| [value]).collect();
                ("weights", self.floats(&values, None, false))
            }
        };
        let name = match interpolation {
            Interpolation::Step => "STEP",
            Interpolation::Linear => "LINEAR",
            Interpolation::CubicSpline => "CUBICSPLINE",
        };
        let sampler = self.samplers.len();
        self.samplers.push(json!({ "input": input, "output": output, "interpolation": name }));
        self.channels.push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
    }

    /// The finished JSON and the buffer it names.
    pub fn finish(self, buffer_name: &str) -> (String, Vec<u8>) {
        let images: Vec<Value> =
            self.images.iter().map(|image| json!({ "uri": image.file_name() })).collect();
        let textures: Vec<Value> =
            (0..images.len()).map(|index| json!({ "source": index, "sampler": 0 })).collect();
        let document = json!({
            "asset": { "version": "2.0", "generator": "Isophote xtask scene" },
            "extensionsUsed": [
                "KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_unlit",
                "KHR_texture_transform",
            ],
            "extensions": { "KHR_lights_punctual": { "lights": self.lights } },
            "scene": 0,
            "scenes": [{ "name": "city", "nodes": self.roots }],
            "nodes": self.nodes,
            "cameras": self.cameras,
            "meshes": self.meshes,
            "materials": self.materials,
            "textures": textures,
            "images": images,
            "samplers": [{ "magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497 }],
            "skins": self.skins,
            "animations": [{ "name": "day", "channels": self.channels, "samplers": self.samplers }],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "uri": buffer_name, "byteLength": self.buffer.len() }],
        });
        (format!("{document:#}\n"), self.buffer)
    }
}
