//! Reading of Wavefront OBJ with its MTL, if any. Normals that the file does not have are averaged from its
//! faces up to a crease angle.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::{Vec3, Vec4};

use super::geometry;
use super::gltf_file::resolve;
use super::material::{AlphaMode, DecodeProblem, Image, Material, Sampler, Texture, TextureUse};
use super::model::{Bounds, Mesh, Node, Primitive, Scene, Vertex};
use crate::error::{Error, Result};

/// Faces that meet at more than this keep a sharp edge between them when normals are averaged.
const CREASE: f32 = 60.0 * std::f32::consts::PI / 180.0;

/// Colour of surfaces that say nothing about it.
const PLAIN: Vec3 = Vec3::new(0.45, 0.44, 0.42);

/// Roughness of surfaces that say nothing about it.
const DEFAULT_ROUGHNESS: f32 = 0.55;

/// Loads a file; `texture` colours materials that have no texture of their own. The order of nodes, draws and
/// bounds are left to [`Scene::load`].
///
/// # Errors
/// [`Error::Input`] as [`Scene::load`]. A missing or damaged MTL file or texture named there is a warning; a
/// damaged `texture` is an error.
pub fn load(path: &Path, texture: Option<&Path>) -> Result<Scene> {
    let bytes = fs::read(path).map_err(|e| Error::file(path, e, "give the path of a readable OBJ file"))?;
    // Names in old files are in any encoding; numbers and keywords are ASCII.
    let text = String::from_utf8_lossy(&bytes);
    let warnings = RefCell::new(Vec::new());
    let options =
        tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let (models, materials) = tobj::load_obj_buf(&mut Cursor::new(text.as_bytes()), &options, |name| {
        load_mtl(path, name, &warnings)
    })
    .map_err(|e| Error::file(path, format!("is not a valid OBJ file: {e}"), "export the model again"))?;
    let mut loader = Loader { path, images: HashMap::new(), scene: empty_scene(warnings.into_inner()) };
    for material in materials.unwrap_or_default() {
        let converted = loader.material(&material);
        loader.scene.materials.push(converted);
    }
    loader.scene.materials.push(plain_material());
    if let Some(texture) = texture {
        let texture = named_texture(&mut loader.scene, texture)?;
        for material in loader.scene.materials.iter_mut().filter(|m| m.base_color_texture.is_none()) {
            material.base_color_texture = Some(TextureUse::plain(texture));
            material.base_color = Vec4::ONE.with_w(material.base_color.w);
        }
    }
    let mut scene = loader.scene;
    for model in models {
        let primitive = primitive(&model.mesh, scene.materials.len() - 1).map_err(|problem| {
            Error::file(path, format!("object '{}' {problem}", model.name), "export it again")
        })?;
        if primitive.indices.is_empty() {
            continue;
        }
        let mesh = Some(scene.meshes.len());
        scene.meshes.push(Mesh {
            name: model.name.clone(),
            primitives: vec![primitive],
            weights: Vec::new(),
        });
        scene.nodes.push(Node { name: model.name, mesh, ..Node::default() });
    }
    Ok(scene)
}

fn empty_scene(warnings: Vec<String>) -> Scene {
    Scene {
        name: String::new(),
        meshes: Vec::new(),
        materials: Vec::new(),
        textures: Vec::new(),
        images: Vec::new(),
        nodes: Vec::new(),
        order: Vec::new(),
        cameras: Vec::new(),
        lights: Vec::new(),
        skins: Vec::new(),
        animations: Vec::new(),
        draws: Vec::new(),
        bounds: Bounds { min: Vec3::ZERO, max: Vec3::ZERO, extremes: Vec::new() },
        warnings,
    }
}

/// OBJ says nothing reliable about the side a face is seen from, so both are shown.
fn plain_material() -> Material {
    Material {
        base_color: PLAIN.extend(1.0),
        metallic: 0.0,
        roughness: DEFAULT_ROUGHNESS,
        double_sided: true,
        ..Material::default()
    }
}

fn load_mtl(path: &Path, name: &Path, warnings: &RefCell<Vec<String>>) -> tobj::MTLLoadResult {
    let shown = name.display();
    let problem = match resolve(path, &name.to_string_lossy()) {
        Ok(file) => match fs::read(&file) {
            Ok(bytes) => {
                let text = String::from_utf8_lossy(&bytes);
                match tobj::load_mtl_buf(&mut Cursor::new(text.as_bytes())) {
                    Ok(materials) => return Ok(materials),
                    Err(e) => format!("{shown} is not a valid MTL file: {e}"),
                }
            }
            Err(e) => format!("{shown} cannot be read: {e}"),
        },
        Err(problem) => format!("the file {problem}"),
    };
    warnings.borrow_mut().push(format!("{problem}; plain materials are used"));
    Ok((Vec::new(), Default::default()))
}

/// An image named by the caller.
fn named_texture(scene: &mut Scene, path: &Path) -> Result<usize> {
    let bytes =
        fs::read(path).map_err(|e| Error::file(path, e, "give the path of a readable PNG or JPEG file"))?;
    let image = Image::decode(&path.display().to_string(), &bytes).map_err(|problem| {
        let problem = match problem {
            DecodeProblem::Unsupported(_) => "is neither a PNG nor a JPEG image".into(),
            DecodeProblem::Damaged(problem) => problem,
        };
        Error::file(path, problem, "give a whole PNG or JPEG file")
    })?;
    Ok(add_texture(scene, image))
}

fn add_texture(scene: &mut Scene, image: Image) -> usize {
    scene.images.push(image);
    scene.textures.push(Texture { image: Some(scene.images.len() - 1), sampler: Sampler::default() });
    scene.textures.len() - 1
}

struct Loader<'a> {
    path: &'a Path,
    images: HashMap<PathBuf, Option<usize>>,
    scene: Scene,
}

impl Loader<'_> {
    fn material(&mut self, source: &tobj::Material) -> Material {
        let base_color_texture = source.diffuse_texture.as_deref().and_then(|name| self.texture(name));
        // Exporters write black Kd beside a texture; the texture is what was meant.
        let diffuse = match source.diffuse {
            Some(kd) if base_color_texture.is_none() || kd != [0.0; 3] => Vec3::from(kd),
            _ if base_color_texture.is_some() => Vec3::ONE,
            _ => PLAIN,
        };
        let opacity = source.dissolve.unwrap_or(1.0).clamp(0.0, 1.0);
        let emissive = source.emissive.map_or(Vec3::ZERO, |ke| Vec3::from(ke).max(Vec3::ZERO));
        Material {
            name: source.name.clone(),
            base_color: diffuse.max(Vec3::ZERO).extend(opacity),
            base_color_texture,
            // The Blinn-Phong exponent Ns of a lobe as wide as that of GGX.
            roughness: source
                .shininess
                .filter(|ns| *ns > 0.0)
                .map_or(DEFAULT_ROUGHNESS, |ns| (2.0 / (ns + 2.0)).powf(0.25).clamp(0.05, 1.0)),
            normal_texture: source.unknown_param.get("norm").and_then(|name| self.texture(name)),
            emissive,
            alpha_mode: if opacity < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque },
            ..plain_material()
        }
    }

    /// A texture of the MTL file; options before its name are ignored.
    fn texture(&mut self, statement: &str) -> Option<TextureUse> {
        let name = without_options(statement);
        let path = match resolve(self.path, &name.replace('%', "%25").replace('\\', "/")) {
            Ok(path) => path,
            Err(problem) => {
                self.scene.warnings.push(format!("a material {problem}; it is left out"));
                return None;
            }
        };
        if let Some(known) = self.images.get(&path) {
            return known.map(TextureUse::plain);
        }
        let decoded = fs::read(&path).map_err(|e| e.to_string()).and_then(|bytes| {
            Image::decode(name, &bytes).map_err(|problem| match problem {
                DecodeProblem::Unsupported(_) => "is neither PNG nor JPEG".to_owned(),
                DecodeProblem::Damaged(problem) => problem,
            })
        });
        let texture = match decoded {
            Ok(image) => Some(add_texture(&mut self.scene, image)),
            Err(problem) => {
                self.scene.warnings.push(format!("texture '{name}': {problem}; it is left out"));
                None
            }
        };
        self.images.insert(path, texture);
        texture.map(TextureUse::plain)
    }
}

/// Drops options such as `-s 1 1 1` and `-clamp on` that may precede a file name, which itself may hold spaces.
fn without_options(statement: &str) -> &str {
    let mut rest = statement.trim();
    while let Some(option) = rest.strip_prefix('-') {
        let Some((_, mut after)) = option.split_once(char::is_whitespace) else { break };
        loop {
            after = after.trim_start();
            match after.split_once(char::is_whitespace) {
                Some((word, tail)) if word.parse::<f32>().is_ok() || matches!(word, "on" | "off") => {
                    after = tail
                }
                _ => break,
            }
        }
        rest = after.trim_start();
    }
    rest
}

fn primitive(mesh: &tobj::Mesh, plain: usize) -> std::result::Result<Primitive, String> {
    let positions = mesh.positions.as_chunks::<3>().0;
    let normals = mesh.normals.as_chunks::<3>().0;
    let texcoords = mesh.texcoords.as_chunks::<2>().0;
    let colors = mesh.vertex_color.as_chunks::<3>().0;
    if mesh.indices.iter().any(|i| *i as usize >= positions.len()) {
        return Err("names a vertex that does not exist".into());
    }
    let has_normals = normals.len() == positions.len() && !positions.is_empty();
    let vertices = positions
        .iter()
        .enumerate()
        .map(|(i, position)| {
            let mut vertex = Vertex { position: *position, ..Vertex::default() };
            if has_normals {
                vertex.normal = Vec3::from(normals[i]).normalize_or(Vec3::Z).to_array();
            }
            if let Some([u, v]) = texcoords.get(i) {
                // V of OBJ points up the image.
                vertex.uv0 = [*u, 1.0 - v];
            }
            if let Some([r, g, b]) = colors.get(i) {
                vertex.color = [*r, *g, *b, 1.0];
            }
            vertex
        })
        .collect();
    let mut primitive = Primitive {
        vertices,
        indices: geometry::triangle_list(geometry::Topology::List, &mesh.indices),
        material: mesh.material_id.unwrap_or(plain).min(plain),
        ..Primitive::default()
    };
    if !has_normals {
        geometry::smooth_normals(&mut primitive, CREASE);
    }
    if !texcoords.is_empty() {
        geometry::tangents(&mut primitive, 0);
    }
    Ok(primitive)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_textures_are_skipped() {
        assert_eq!(without_options("wall.png"), "wall.png");
        assert_eq!(without_options("-s 2 2 1 -clamp on old wall.png"), "old wall.png");
        assert_eq!(without_options("-bm 0.5 stone.jpg"), "stone.jpg");
    }
}
