//! Reading of Wavefront OBJ with its MTL, if any. Normals that the file does not have are averaged from its
//! faces up to a crease angle. `tobj` parses both files, once they are brought into a form that it reads well.

mod materials;
mod normal_form;
mod statements;

use std::cell::RefCell;
use std::collections::HashMap;
use std::fs::File;
use std::io::Cursor;
use std::path::Path;

use glam::{Vec3, Vec4};

use self::materials::{Loader, load_mtl, named_texture, plain_material};
use self::normal_form::normal_form;
use super::budget::{Budget, TOO_LARGE};
use super::geometry;
use super::material::TextureUse;
use super::model::{Mesh, Node, Primitive, Scene, Vertex};
use isophote_files::error::{Error, Result};

/// Faces that meet at more than this keep a sharp edge between them when normals are averaged.
const CREASE: f32 = 60.0 * std::f32::consts::PI / 180.0;

/// Memory of one corner of a face, here and in the parser.
const CORNER: usize = 256;

/// Loads a file; `texture` colours materials that have no texture of their own. The order of nodes, draws and
/// bounds are left to [`Scene::load`].
///
/// # Errors
/// [`Error::Input`] as [`Scene::load`]. A missing or damaged MTL file or texture named there is a warning; a
/// damaged `texture` is an error.
pub fn load(path: &Path, texture: Option<&Path>, budget: &Budget) -> Result<Scene> {
    let unreadable =
        |problem: String| Error::file(path, problem, budget.fix("give the path of a readable OBJ file"));
    let file = File::open(path).map_err(|e| unreadable(e.to_string()))?;
    let bytes = budget.read(file).map_err(unreadable)?;
    let invalid = |problem: String| {
        Error::file(path, format!("is not a valid OBJ file: {problem}"), "export the model again")
    };
    // Names in old files are in any encoding; numbers and keywords are ASCII.
    let (text, corners) = normal_form(&String::from_utf8_lossy(&bytes)).map_err(invalid)?;
    drop(bytes);
    let counted = budget.take(text.len(), 1).and_then(|()| budget.take(corners, CORNER));
    counted.map_err(|problem| Error::file(path, problem, TOO_LARGE))?;
    let warnings = RefCell::new(Vec::new());
    let options =
        tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let (models, materials) = tobj::load_obj_buf(&mut Cursor::new(text.as_bytes()), &options, |name| {
        load_mtl(path, name, budget, &warnings)
    })
    .map_err(|e| invalid(e.to_string()))?;
    let mut loader =
        Loader { path, budget, images: HashMap::new(), scene: Scene::empty(warnings.into_inner()) };
    for material in materials.unwrap_or_default() {
        let converted = loader.material(&material);
        loader.scene.materials.push(converted);
    }
    loader.scene.materials.push(plain_material());
    if let Some(texture) = texture {
        let texture = named_texture(&mut loader.scene, texture, budget)?;
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
