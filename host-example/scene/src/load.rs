//! Loading of scenes, and what is derived from what the files hold.

use std::path::Path;

use glam::{Mat4, Vec3, Vec4};

use super::budget::Budget;
use super::material::{Image, Material, Texture};
use super::model::{Bounds, Draw, Mesh, Node, Scene, Transform};
use super::{gltf_file, obj_file, pose};
use isophote_files::error::{Error, Result};

impl Scene {
    /// Loads a glTF (`.gltf`, `.glb`) or OBJ (`.obj`) file. `texture` names an image that colours an OBJ whose
    /// materials have none.
    ///
    /// # Errors
    /// [`Error::Input`] naming the file when it is missing, malformed, of another kind, needs more than
    /// 4 GiB of memory, or holds nothing to draw; what can be drawn in spite of a flaw ends in
    /// [`Scene::warnings`].
    pub fn load(path: &Path, texture: Option<&Path>) -> Result<Self> {
        Self::load_within(path, texture, &Budget::default())
    }

    /// As [`Scene::load`], within another bound of memory.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load_within(path: &Path, texture: Option<&Path>, budget: &Budget) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let mut scene = match extension.as_str() {
            "gltf" | "glb" => gltf_file::load(path, budget)?,
            "obj" => obj_file::load(path, texture, budget)?,
            _ => {
                return Err(Error::file(
                    path,
                    "is not a kind of scene known here",
                    "give a .gltf, .glb or .obj file",
                ));
            }
        };
        if texture.is_some() && extension != "obj" {
            scene.warnings.push("the texture named by the caller is used for OBJ files only".into());
        }
        scene.finish(path)?;
        scene.files = budget.files();
        Ok(scene)
    }

    /// A scene that no file holds: meshes that stand where they are, with what they are made of. Views of the whole need not
    /// frame those that are named as backdrops.
    ///
    /// # Errors
    /// [`Error::Input`] when there is nothing to draw.
    pub fn assembled(
        name: &str,
        meshes: Vec<Mesh>,
        backdrops: &[&str],
        materials: Vec<Material>,
        textures: Vec<Texture>,
        images: Vec<Image>,
    ) -> Result<Self> {
        let node = |(index, mesh): (usize, &Mesh)| Node {
            name: mesh.name.clone(),
            mesh: Some(index),
            backdrop: backdrops.contains(&mesh.name.as_str()),
            ..Node::default()
        };
        let nodes = meshes.iter().enumerate().map(node).collect();
        let mut scene = Self { meshes, materials, textures, images, nodes, ..Self::empty(Vec::new()) };
        scene.finish(Path::new(name))?;
        Ok(scene)
    }

    /// A scene of nothing yet.
    pub(super) fn empty(warnings: Vec<String>) -> Self {
        Self {
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
            extensions: Vec::new(),
            files: Vec::new(),
        }
    }

    /// Turns a scene whose +Z points up so that +Y does, and -Z is where its +Y was.
    pub fn turn_z_up(&mut self) {
        let turn = Mat4::from_cols(Vec4::X, -Vec4::Z, Vec4::Y, Vec4::W);
        let root = self.nodes.len();
        for node in self.nodes.iter_mut().filter(|node| node.parent.is_none()) {
            node.parent = Some(root);
        }
        self.nodes.push(Node { transform: Transform::Matrix(turn), ..Node::default() });
        self.order.insert(0, root);
        // Bounds were finite, and stay so.
        if let Some(bounds) = pose::bounds(self) {
            self.bounds = bounds;
        }
    }

    /// Derives what both loaders leave open: the order of nodes, the list of draws and the bounds.
    fn finish(&mut self, path: &Path) -> Result<()> {
        self.name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        self.order = pose::parents_first(&self.nodes)
            .map_err(|problem| Error::file(path, problem, "repair the node hierarchy"))?;
        self.draws = Vec::new();
        for (node, entry) in self.nodes.iter().enumerate() {
            let Some(mesh) = entry.mesh.filter(|_| entry.visible) else { continue };
            for primitive in 0..self.meshes[mesh].primitives.len() {
                self.draws.push(Draw { node, mesh, primitive });
            }
        }
        if self.draws.is_empty() {
            return Err(Error::file(path, "holds no triangles to draw", "give a scene with visible meshes"));
        }
        self.bounds = pose::bounds(self).ok_or_else(|| {
            Error::file(path, "has positions that are not finite", "export the scene again")
        })?;
        Ok(())
    }
}
