//! A scene in memory: what the loaders produce and what the renderer draws. Nothing here knows a GPU.

use glam::{Mat4, Quat, Vec3};

use super::animation::Animation;
use super::material::{Image, Material, Texture};
use isophote_files::identity::Identity;

/// One vertex as it is uploaded: 72 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Position in the space of the mesh.
    pub position: [f32; 3],
    /// Unit normal.
    pub normal: [f32; 3],
    /// Unit tangent along +U; `w` is the sign of the bitangent, or 0 where there is no tangent.
    pub tangent: [f32; 4],
    /// First set of texture coordinates.
    pub uv0: [f32; 2],
    /// Second set of texture coordinates.
    pub uv1: [f32; 2],
    /// Linear colour that multiplies the material's base colour.
    pub color: [f32; 4],
}

impl Default for Vertex {
    fn default() -> Self {
        Self {
            position: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            tangent: [0.0; 4],
            uv0: [0.0; 2],
            uv1: [0.0; 2],
            color: [1.0; 4],
        }
    }
}

/// Four joints of a skin and their shares of a vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Influence {
    /// Indices into the skin's joints.
    pub joints: [u32; 4],
    /// Weights; all influences of a vertex sum to 1.
    pub weights: [f32; 4],
}

/// Change of a vertex by one morph target at weight 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct MorphDelta {
    /// Added to the position.
    pub position: [f32; 3],
    /// Added to the normal.
    pub normal: [f32; 3],
    /// Added to the tangent's direction.
    pub tangent: [f32; 3],
}

/// Value of a control map that changes nothing: detail, width of lines, their amount, and strength of the medium.
pub const NEUTRAL: [f32; 4] = [0.5; 4];

/// An indexed triangle list with one material.
#[derive(Clone, Debug, Default)]
pub struct Primitive {
    /// Vertices; every index is below their number.
    pub vertices: Vec<Vertex>,
    /// Three per triangle.
    pub indices: Vec<u32>,
    /// `influence_sets` entries per vertex, the sets of one vertex side by side; empty when not skinned.
    pub influences: Vec<Influence>,
    /// Number of groups of four joints that each vertex has.
    pub influence_sets: usize,
    /// One list of `vertices.len()` deltas per morph target.
    pub morph_targets: Vec<Vec<MorphDelta>>,
    /// Values of the control map per vertex, of which [`NEUTRAL`] changes nothing; empty where the file gives none. They
    /// are no part of [`Vertex`], since few scenes have them.
    pub control: Vec<[f32; 4]>,
    /// Index into [`Scene::materials`].
    pub material: usize,
}

impl Primitive {
    /// Middle and radius of a sphere around its vertices, in the space of the mesh.
    pub fn sphere(&self) -> (Vec3, f32) {
        let corners = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = self.vertices.iter().fold(corners, |(low, high), vertex| {
            let position = Vec3::from(vertex.position);
            (low.min(position), high.max(position))
        });
        ((low + high) * 0.5, (high - low).length() * 0.5)
    }
}

/// A group of primitives that move together.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Name from the file, or empty.
    pub name: String,
    /// The parts.
    pub primitives: Vec<Primitive>,
    /// Default morph weights.
    pub weights: Vec<f32>,
}

/// A node's transform relative to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// Any affine matrix; cannot be animated.
    Matrix(Mat4),
    /// Scale, then rotation, then translation.
    Parts {
        /// Translation.
        translation: Vec3,
        /// Unit rotation.
        rotation: Quat,
        /// Scale per axis.
        scale: Vec3,
    },
}

impl Transform {
    /// No transform at all.
    pub const IDENTITY: Self =
        Self::Parts { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE };

    /// The transform as a matrix.
    pub fn matrix(&self) -> Mat4 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Parts { translation, rotation, scale } => {
                Mat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }

    /// Translation, rotation and scale; shear of a matrix is lost.
    pub fn parts(&self) -> (Vec3, Quat, Vec3) {
        match *self {
            Self::Matrix(matrix) => {
                let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
                (translation, rotation, scale)
            }
            Self::Parts { translation, rotation, scale } => (translation, rotation, scale),
        }
    }
}

/// A node of the hierarchy.
#[derive(Clone, Debug)]
pub struct Node {
    /// Name from the file, or empty.
    pub name: String,
    /// Index of the parent; `None` for roots.
    pub parent: Option<usize>,
    /// Transform at rest.
    pub transform: Transform,
    /// Index into [`Scene::meshes`].
    pub mesh: Option<usize>,
    /// Index into [`Scene::skins`].
    pub skin: Option<usize>,
    /// Index into [`Scene::cameras`].
    pub camera: Option<usize>,
    /// Index into [`Scene::lights`].
    pub light: Option<usize>,
    /// Morph weights at rest; as many as the mesh has targets.
    pub weights: Vec<f32>,
    /// True where the node belongs to the scene that is shown.
    pub visible: bool,
    /// True for a backdrop, such as sky or hills, that views of the whole scene need not frame. In glTF
    /// a node says so by `"extras": { "backdrop": true }`.
    pub backdrop: bool,
}

impl Default for Node {
    fn default() -> Self {
        Self {
            name: String::new(),
            parent: None,
            transform: Transform::IDENTITY,
            mesh: None,
            skin: None,
            camera: None,
            light: None,
            weights: Vec::new(),
            visible: true,
            backdrop: false,
        }
    }
}

/// Joints that deform a mesh.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    /// Node of each joint.
    pub joints: Vec<usize>,
    /// Per joint: from the space of the mesh to the space of the joint at rest.
    pub inverse_bind: Vec<Mat4>,
}

/// Projection of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Pinhole camera without a far plane.
    Perspective {
        /// Vertical field of view in radians.
        vertical_fov: f32,
        /// Distance of the near plane, above 0.
        near: f32,
    },
    /// Parallel projection.
    Orthographic {
        /// Half the height of the view in scene units.
        half_height: f32,
        /// Distance of the near plane.
        near: f32,
        /// Distance of the far plane.
        far: f32,
    },
}

/// A camera of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name from the file, or empty.
    pub name: String,
    /// Projection of the camera.
    pub projection: Projection,
}

/// A punctual light (KHR_lights_punctual). It shines along -Z of its node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Linear Rec.709 colour.
    pub color: Vec3,
    /// Lux for directional lights, candela for the others.
    pub intensity: f32,
    /// Distance at which the light has faded to nothing; `None` for unbounded.
    pub range: Option<f32>,
    /// The shape of the light.
    pub kind: LightKind,
}

/// The shape of a [`Light`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Parallel rays.
    Directional,
    /// From a point in all directions.
    Point,
    /// From a point within a cone; half angles in radians.
    Spot {
        /// Full brightness inside.
        inner: f32,
        /// Nothing outside.
        outer: f32,
    },
}

/// One primitive at one node: what is drawn at once and has one object id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draw {
    /// Index into [`Scene::nodes`].
    pub node: usize,
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Index into the primitives of the mesh.
    pub primitive: usize,
}

/// Bounds of the visible geometry, over all of its animations.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
    /// Outermost points in a fixed fan of directions; their hull is close to that of the geometry.
    pub extremes: Vec<Vec3>,
}

impl Bounds {
    /// Middle of the box.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Radius of the sphere around the box; never 0.
    pub fn radius(&self) -> f32 {
        ((self.max - self.min).length() * 0.5).max(1e-6)
    }
}

/// Everything that was read from one file.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the file without folder and extension.
    pub name: String,
    /// Meshes.
    pub meshes: Vec<Mesh>,
    /// Materials; never empty.
    pub materials: Vec<Material>,
    /// Textures: an image with a sampler.
    pub textures: Vec<Texture>,
    /// Decoded images.
    pub images: Vec<Image>,
    /// All nodes.
    pub nodes: Vec<Node>,
    /// Indices of all nodes, parents before their children.
    pub order: Vec<usize>,
    /// Cameras of the file.
    pub cameras: Vec<Camera>,
    /// Lights of the file.
    pub lights: Vec<Light>,
    /// Skins.
    pub skins: Vec<Skin>,
    /// Animations.
    pub animations: Vec<Animation>,
    /// Visible primitives; object ids count them from 1.
    pub draws: Vec<Draw>,
    /// Extent of everything visible but backdrops.
    pub bounds: Bounds,
    /// Warnings about what was read but could not be honoured, one line each.
    pub warnings: Vec<String>,
    /// Extensions of glTF that the file uses, and whether each is understood.
    pub extensions: Vec<(String, bool)>,
    /// The files that it was read from, where the system tells them apart.
    pub files: Vec<Identity>,
}

impl Scene {
    /// The primitive of a draw.
    pub fn primitive(&self, draw: &Draw) -> &Primitive {
        &self.meshes[draw.mesh].primitives[draw.primitive]
    }

    /// True where a visible primitive has values of a control map.
    pub fn has_control(&self) -> bool {
        self.draws.iter().any(|draw| !self.primitive(draw).control.is_empty())
    }

    /// True where light falls on anything that is visible: all else is shown as it is.
    pub fn is_lit(&self) -> bool {
        self.draws.iter().any(|draw| !self.materials[self.primitive(draw).material].unlit)
    }

    /// Index of the animation with this name (case ignored) or number (from 0).
    pub fn find_animation(&self, name: &str) -> Option<usize> {
        self.animations
            .iter()
            .position(|a| a.name.eq_ignore_ascii_case(name))
            .or_else(|| name.parse().ok().filter(|&index: &usize| index < self.animations.len()))
    }
}
