//! Reading of Wavefront OBJ with its MTL, if any. Normals that the file does not have are averaged from its
//! faces: those of a smoothing group, or where there are no groups, up to a crease angle. `tobj` parses the OBJ file,
//! once it is brought into a form that it reads well.

mod library;
mod materials;
mod normal_form;
mod options;
mod polygons;
mod primitives;
mod statements;

use std::cell::RefCell;
use std::collections::HashMap;
use std::fs::File;
use std::io::Cursor;
use std::path::Path;

use glam::Vec4;

use self::library::Definition;
use self::materials::{Loader, for_colors, named_texture, plain_material};
use self::normal_form::{Group, UNNAMED, normal_form, object};
use self::primitives::{primitive, triangles};
use self::statements::text_of;
use super::budget::{Budget, TOO_LARGE};
use super::material::TextureUse;
use super::model::{Mesh, Node, Scene};
use isophote_files::error::{Error, Result};

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
    let too_large = |problem: String| Error::file(path, problem, TOO_LARGE);
    budget.take(bytes.len(), 2).map_err(too_large)?;
    let text = text_of(&bytes);
    drop(bytes);
    let form = normal_form(&text).map_err(invalid)?;
    drop(text);
    budget.take(form.text.len(), 1).and_then(|()| budget.take(form.corners, CORNER)).map_err(too_large)?;
    let (definitions, warnings) = (RefCell::new(Vec::new()), RefCell::new(form.warnings));
    let options =
        tobj::LoadOptions { single_index: false, triangulate: false, ..tobj::LoadOptions::default() };
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(form.text.as_bytes()), &options, |names| {
        let read = library::read(path, &names.to_string_lossy(), budget, &mut warnings.borrow_mut());
        let named = named(&read);
        definitions.borrow_mut().extend(read);
        named
    })
    .map_err(|problem| invalid(problem.to_string()))?;
    drop(form.text);
    let (definitions, warnings) = (definitions.into_inner(), warnings.into_inner());
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
    add_meshes(&models, form.smoothing, &mut scene);
    Ok(scene)
}

/// The materials of a library as `tobj` needs them: their names, and the index of each. Of several with one name the
/// last counts.
fn named(definitions: &[Definition]) -> tobj::MTLLoadResult {
    let names = definitions.iter().map(|definition| match definition.name.as_str() {
        "" => UNNAMED.to_owned(),
        name => name.to_owned(),
    });
    let materials = names.clone().map(|name| tobj::Material { name, ..tobj::Material::default() });
    Ok((materials.collect(), names.zip(0..).collect()))
}

/// Adds a mesh for each run of faces of one object and one material; `smoothing` is that of all faces.
fn add_meshes(models: &[tobj::Model], smoothing: Vec<Group>, scene: &mut Scene) {
    let plain = scene.materials.len() - 1;
    let mut groups = smoothing.into_iter();
    let mut colored: HashMap<usize, usize> = HashMap::new();
    for models in models.chunk_by(|a, b| a.name == b.name) {
        let name = object(&models[0].name).1;
        let meshes: Vec<&tobj::Mesh> = models.iter().map(|model| &model.mesh).collect();
        for (mesh, triangles) in meshes.iter().zip(triangles(&meshes, &mut groups)) {
            if triangles.is_empty() {
                continue;
            }
            let mut index = mesh.material_id.unwrap_or(plain);
            if !mesh.vertex_color.is_empty() {
                index = *colored.entry(index).or_insert_with(|| {
                    let Some(white) = for_colors(&scene.materials[index]) else { return index };
                    scene.materials.push(white);
                    scene.materials.len() - 1
                });
            }
            let primitives = vec![primitive(mesh, &triangles, index)];
            let mesh = Some(scene.meshes.len());
            scene.meshes.push(Mesh { name: name.to_owned(), primitives, weights: Vec::new() });
            scene.nodes.push(Node { name: name.to_owned(), mesh, ..Node::default() });
        }
    }
}
