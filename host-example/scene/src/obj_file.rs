//! Reading of Wavefront OBJ with its MTL, if any. Normals that the file does not have are averaged from its
//! faces: those of a smoothing group, or where there are no groups, up to a crease angle.

mod library;
mod materials;
mod options;
mod polygons;
mod primitives;
mod statements;
mod surfaces;

use std::collections::HashMap;
use std::fs::File;
use std::path::Path;

use glam::Vec4;

use self::materials::{Loader, for_colors, named_texture, plain_material};
use self::primitives::{primitive, triangles};
use self::statements::text_of;
use self::surfaces::{Face, Surfaces, surfaces};
use super::budget::{Budget, TOO_LARGE};
use super::material::TextureUse;
use super::model::{Mesh, Node, Scene};
use isophote_files::error::{Error, Result};

/// Memory of one corner of a face, while it is read and after.
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
    let too_large = |problem: String| Error::file(path, problem, TOO_LARGE);
    budget.take(bytes.len(), 2).map_err(too_large)?;
    let text = text_of(&bytes);
    drop(bytes);
    let mut surfaces = surfaces(&text).map_err(invalid)?;
    drop(text);
    budget.take(surfaces.corners.len(), CORNER).map_err(too_large)?;
    let mut warnings = std::mem::take(&mut surfaces.warnings);
    let mut definitions = Vec::new();
    for names in &surfaces.libraries {
        definitions.extend(library::read(path, names, budget, &mut warnings));
    }
    let mut loader = Loader::new(path, budget, warnings);
    for definition in &definitions {
        let converted = loader.material(definition);
        loader.scene.materials.push(converted);
    }
    let mut scene = loader.scene;
    scene.materials.push(plain_material());
    if let Some(texture) = texture {
        let texture = named_texture(&mut scene, texture, budget)?;
        for material in scene.materials.iter_mut().filter(|m| m.base_color_texture.is_none()) {
            material.base_color_texture = Some(TextureUse::plain(texture));
            material.base_color = Vec4::ONE.with_w(material.base_color.w);
        }
    }
    // Of several materials with one name the last counts.
    let names = definitions.iter().enumerate().map(|(index, definition)| (definition.name.as_str(), index));
    add_meshes(&surfaces, &names.collect(), &mut scene);
    Ok(scene)
}

/// Adds a mesh for each run of triangles of one object and one material.
fn add_meshes(surfaces: &Surfaces, names: &HashMap<&str, usize>, scene: &mut Scene) {
    let plain = scene.materials.len() - 1;
    let indices = surfaces.materials.iter().map(|name| names.get(name.as_str()).copied().unwrap_or(plain));
    let indices: Vec<usize> = indices.collect();
    let material = |face: &Face| face.material.map_or(plain, |name| indices[name]);
    let mut colored: HashMap<usize, usize> = HashMap::new();
    for faces in surfaces.faces.chunk_by(|a, b| a.object == b.object) {
        let name = match surfaces.objects[faces[0].object].as_str() {
            "" => "unnamed_object",
            name => name,
        };
        for part in triangles(surfaces, faces, material).chunk_by(|a, b| a.material == b.material) {
            let mut index = part[0].material;
            if !surfaces.colors.is_empty() {
                index = *colored.entry(index).or_insert_with(|| {
                    let Some(white) = for_colors(&scene.materials[index]) else { return index };
                    scene.materials.push(white);
                    scene.materials.len() - 1
                });
            }
            let mesh = Some(scene.meshes.len());
            let primitives = vec![primitive(surfaces, part, index)];
            scene.meshes.push(Mesh { name: name.to_owned(), primitives, weights: Vec::new() });
            scene.nodes.push(Node { name: name.to_owned(), mesh, ..Node::default() });
        }
    }
}
