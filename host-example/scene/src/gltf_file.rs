//! Reading of glTF 2.0: `.gltf` and `.glb`, with embedded and external buffers.
//!
//! The `gltf` crate parses the JSON; what it leaves unchecked (indices that its own validation trips over,
//! lengths, hierarchies) is checked here before it is used, since its readers panic on such files.

mod accessors;
mod animations;
mod draco;
mod extensions;
mod glossiness;
mod images;
mod instances;
mod materials;
mod meshes;
mod meshopt;
mod sources;
mod uses;

use std::borrow::Cow;
use std::fs::File;
use std::path::Path;

use glam::{Mat4, Quat, Vec3, Vec4};
use gltf::json;
use gltf::json::validation::{Error as Flaw, Validate};

use self::accessors::{Accessors, Pick};
use self::animations::Outline;
use super::budget::Budget;
use super::model::{Camera, Light, LightKind, Node, Projection, Scene, Skin, Transform};
use super::references::Folders;
use isophote_files::error::{Error, Result};

/// Loads a file. The order of nodes, draws and bounds are left to [`Scene::load`].
///
/// # Errors
/// [`Error::Input`] as [`Scene::load`].
pub fn load(path: &Path, budget: &Budget) -> Result<Scene> {
    let unreadable =
        |problem: String| Error::file(path, problem, budget.fix("give the path of a readable glTF file"));
    let file = File::open(path).map_err(|e| unreadable(e.to_string()))?;
    let bytes = budget.read(file).map_err(unreadable)?;
    let malformed = |problem: String| Error::file(path, problem, budget.fix("export the scene again"));
    let Parsed { document, channels, blob, extensions, warnings } =
        parse(&bytes, budget).map_err(malformed)?;
    let buffers = read_buffers(path, &document, blob, budget)?;
    let decoded = meshopt::decode(&document, &buffers, budget).map_err(malformed)?;
    let accessors = Accessors { buffers: &buffers, decoded: &decoded, budget };
    let mut scene = Scene {
        cameras: read_cameras(&document),
        lights: read_lights(&document),
        extensions,
        ..Scene::empty(warnings)
    };
    images::read(path, &document, &accessors, &mut scene)?;
    materials::read(&document, &accessors, &mut scene);
    meshes::read(&document, &accessors, &mut scene).map_err(malformed)?;
    read_nodes(&document, budget, &mut scene).map_err(malformed)?;
    instances::read(&document, &accessors, &mut scene).map_err(malformed)?;
    read_skins(&document, &accessors, &mut scene).map_err(malformed)?;
    animations::read(&document, &channels, &accessors, &mut scene).map_err(malformed)?;
    Ok(scene)
}

/// Declarations of a file, before any of its buffers is read.
struct Parsed {
    document: gltf::Document,
    /// The channels of each animation, which the document leaves out.
    channels: animations::Channels,
    /// The binary chunk of a `.glb`.
    blob: Option<Vec<u8>>,
    extensions: Vec<(String, bool)>,
    warnings: Vec<String>,
}

/// Memory of an entry of a list, and of an object with its entry, of a document once it is parsed, at most.
const ENTRY: usize = 64;
const OBJECT: usize = 1024;

/// Parses and validates.
fn parse(bytes: &[u8], budget: &Budget) -> std::result::Result<Parsed, String> {
    if bytes.starts_with(b"glTF") {
        let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        if word(4) == Some(1) {
            return Err("is binary glTF version 1, not 2".into());
        }
        let length = word(8).filter(|_| bytes.len() >= 20).ok_or("is cut off within its header")?;
        if (length as usize) < 20 || length as usize > bytes.len() {
            return Err(format!("claims {length} bytes but has {}", bytes.len()));
        }
    }
    let invalid = |problem: String| format!("is not valid glTF: {problem}");
    let (text, blob) = if bytes.starts_with(b"glTF") {
        let glb = gltf::Glb::from_slice(bytes).map_err(|e| invalid(e.to_string()))?;
        budget.take(glb.bin.as_ref().map_or(0, |bin| bin.len()), 1)?;
        (glb.json, glb.bin.map(Cow::into_owned))
    } else {
        (Cow::Borrowed(bytes), None)
    };
    let text = std::str::from_utf8(&text).map_err(|e| invalid(format!("its JSON is no text: {e}")))?;
    let count = |byte: u8| text.bytes().filter(|b| *b == byte).count();
    budget.take(count(b','), ENTRY)?;
    budget.take(count(b'{'), OBJECT)?;
    extensions::check_version(text)?;
    let Outline { text, channels } = Outline::of(text).map_err(invalid)?;
    let mut root: json::Root = json::deserialize::from_str(&text).map_err(|e| invalid(e.to_string()))?;
    let required = std::mem::take(&mut root.extensions_required);
    let warnings = extensions::check(&root.extensions_used, &required)?;
    let extensions = extensions::all(&root.extensions_used, &required);
    validate(&root)?;
    let document = gltf::Document::from_json_without_validation(root);
    Ok(Parsed { document, channels, blob, extensions, warnings })
}

fn validate(root: &json::Root) -> std::result::Result<(), String> {
    // The validation below indexes accessors by the POSITION attribute without looking.
    let positions = json::validation::Checked::Valid(gltf::Semantic::Positions);
    for (index, mesh) in root.meshes.iter().enumerate() {
        for primitive in &mesh.primitives {
            let known = primitive.attributes.get(&positions).is_none_or(|a| a.value() < root.accessors.len());
            if !known {
                return Err(format!("mesh {index} names an accessor that does not exist"));
            }
        }
    }
    let mut first = None;
    root.validate(root, json::Path::new, &mut |path, flaw| {
        let path = path();
        // Bounds of positions are computed here and not believed, so they may be missing.
        let bounds = path.as_str().ends_with(".min") || path.as_str().ends_with(".max");
        // An accessor without data holds zeros.
        let zeros = path.as_str().starts_with("accessors[") && path.as_str().ends_with("].bufferView");
        let legal = bounds && matches!(flaw, Flaw::Missing | Flaw::Invalid) || zeros && flaw == Flaw::Missing;
        if first.is_none() && !legal {
            first =
                Some(format!("is not valid glTF: {} at {}", flaw.to_string().to_lowercase(), path.as_str()));
        }
    });
    first.map_or(Ok(()), Err)
}

fn read_buffers(
    path: &Path,
    document: &gltf::Document,
    mut blob: Option<Vec<u8>>,
    budget: &Budget,
) -> Result<Vec<Vec<u8>>> {
    // Textures may lie beside the folder; numbers are read from what belongs to the scene without doubt.
    let folders = Folders::of(path);
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        if meshopt::is_placeholder(&buffer, document) {
            buffers.push(Vec::new());
            continue;
        }
        let bytes = match buffer.source() {
            gltf::buffer::Source::Uri(uri) => sources::read_uri(&folders, uri, budget)
                .map_err(|(problem, fix)| Error::file(path, problem, fix))?,
            gltf::buffer::Source::Bin => blob.take().unwrap_or_default(),
        };
        if bytes.len() < buffer.length() {
            return Err(Error::file(
                path,
                format!("buffer {} has {} bytes of {}", buffer.index(), bytes.len(), buffer.length()),
                "copy or export its files again",
            ));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

fn read_cameras(document: &gltf::Document) -> Vec<Camera> {
    let positive = |value: f32, default: f32| if value.is_finite() && value > 0.0 { value } else { default };
    document
        .cameras()
        .map(|camera| Camera {
            name: camera.name().unwrap_or_default().to_owned(),
            projection: match camera.projection() {
                gltf::camera::Projection::Perspective(p) => Projection::Perspective {
                    vertical_fov: positive(p.yfov(), 0.8).min(3.0),
                    near: positive(p.znear(), 0.01),
                },
                gltf::camera::Projection::Orthographic(o) => {
                    let near = if o.znear().is_finite() { o.znear().max(0.0) } else { 0.0 };
                    Projection::Orthographic {
                        half_height: positive(o.ymag().abs(), 1.0),
                        near,
                        far: positive(o.zfar(), 100.0).max(near + 1e-3),
                    }
                }
            },
        })
        .collect()
}

fn read_lights(document: &gltf::Document) -> Vec<Light> {
    use gltf::khr_lights_punctual::Kind;
    document
        .lights()
        .into_iter()
        .flatten()
        .map(|light| Light {
            color: Vec3::from(light.color()),
            intensity: light.intensity().max(0.0),
            range: light.range().filter(|r| *r > 0.0),
            kind: match light.kind() {
                Kind::Directional => LightKind::Directional,
                Kind::Point => LightKind::Point,
                Kind::Spot { inner_cone_angle, outer_cone_angle } => LightKind::Spot {
                    inner: inner_cone_angle,
                    outer: outer_cone_angle.max(inner_cone_angle + 1e-4),
                },
            },
        })
        .collect()
}

fn read_nodes(
    document: &gltf::Document,
    budget: &Budget,
    scene: &mut Scene,
) -> std::result::Result<(), String> {
    for node in document.nodes() {
        let transform = match node.transform() {
            gltf::scene::Transform::Matrix { matrix } => Transform::Matrix(Mat4::from_cols_array_2d(&matrix)),
            gltf::scene::Transform::Decomposed { translation, rotation, scale } => Transform::Parts {
                translation: Vec3::from(translation),
                rotation: Quat::from_vec4(Vec4::from(rotation).normalize_or(Vec4::W)),
                scale: Vec3::from(scale),
            },
        };
        let mesh = node.mesh().map(|m| m.index());
        let defaults = mesh.map(|m| scene.meshes[m].weights.as_slice()).unwrap_or_default();
        budget.take(defaults.len(), size_of::<f32>())?;
        scene.nodes.push(Node {
            name: node.name().unwrap_or_default().to_owned(),
            parent: None,
            transform,
            mesh,
            skin: node.skin().map(|s| s.index()),
            camera: node.camera().map(|c| c.index()),
            light: node.light().map(|l| l.index()),
            weights: node.weights().unwrap_or(defaults).to_vec(),
            visible: false,
            backdrop: is_backdrop(node.extras()),
        });
    }
    for node in document.nodes() {
        for child in node.children() {
            let entry = &mut scene.nodes[child.index()];
            if entry.parent.replace(node.index()).is_some() {
                return Err(format!("has a node ({}) with two parents", child.index()));
            }
        }
    }
    let shown = document.default_scene().or_else(|| document.scenes().next());
    let mut pending: Vec<usize> = match &shown {
        Some(shown) => shown.nodes().map(|n| n.index()).collect(),
        None => (0..scene.nodes.len()).filter(|n| scene.nodes[*n].parent.is_none()).collect(),
    };
    let children: Vec<Vec<usize>> =
        document.nodes().map(|n| n.children().map(|c| c.index()).collect()).collect();
    let hidden: Vec<bool> = document.nodes().map(|node| extensions::is_hidden(&node)).collect();
    while let Some(index) = pending.pop() {
        if hidden[index] {
            continue;
        }
        if !std::mem::replace(&mut scene.nodes[index].visible, true) {
            pending.extend_from_slice(&children[index]);
        }
    }
    Ok(())
}

/// True where the extras of a node mark it as a backdrop; extras of other programs can hold anything.
fn is_backdrop(extras: &json::Extras) -> bool {
    let value = extras.as_ref().and_then(|raw| serde_json::from_str::<serde_json::Value>(raw.get()).ok());
    value.is_some_and(|value| value["backdrop"] == true)
}

fn read_skins(
    document: &gltf::Document,
    accessors: &Accessors,
    scene: &mut Scene,
) -> std::result::Result<(), String> {
    for skin in document.skins() {
        let joints: Vec<usize> = skin.joints().map(|j| j.index()).collect();
        let inverse_bind = match skin.inverse_bind_matrices() {
            Some(accessor) => accessors
                .floats(&accessor, &[16], Pick::All)?
                .arrays([0.0; 16])
                .iter()
                .map(Mat4::from_cols_array)
                .collect(),
            None => vec![Mat4::IDENTITY; joints.len()],
        };
        if joints.is_empty() || inverse_bind.len() < joints.len() {
            return Err(format!("skin {} has fewer matrices than joints", skin.index()));
        }
        scene.skins.push(Skin { joints, inverse_bind });
    }
    for node in &mut scene.nodes {
        let Some(mesh) = node.mesh else { continue };
        let targets = scene.meshes[mesh].primitives.iter().map(|p| p.morph_targets.len()).max().unwrap_or(0);
        accessors.budget.take(targets, size_of::<f32>())?;
        node.weights.resize(targets, 0.0);
        let Some(skin) = node.skin else { continue };
        let joints = scene.skins[skin].joints.len();
        let influences = scene.meshes[mesh].primitives.iter().flat_map(|p| &p.influences);
        if influences.flat_map(|i| i.joints).any(|j| j as usize >= joints) {
            return Err(format!("mesh {mesh} names a joint that skin {skin} does not have"));
        }
    }
    Ok(())
}
