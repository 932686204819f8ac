//! The blocks that shaders read, laid out as WGSL lays them out, and how a frame fills them.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};

use crate::ground::Plane;
use crate::lighting::{Lighting, visible_lights};
use crate::shadow::{CASCADES, Cascades};
use isophote_scene::camera::View;
use isophote_scene::model::Projection;
use isophote_scene::pose::Pose;
use isophote_scene::{Light, LightKind, Material, Scene};

/// `Frame` of `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct FrameBlock {
    pub world_to_view: Mat4,
    pub view_projection: Mat4,
    pub previous_view_projection: Mat4,
    pub sun_matrices: [Mat4; CASCADES],
    pub eye: Vec4,
    pub backward: Vec4,
    pub sun_direction: Vec4,
    pub sun_color: Vec4,
    pub zenith: Vec4,
    pub horizon: Vec4,
    pub ground: Vec4,
    pub sky_ray: Vec4,
    pub size: Vec4,
    pub cascade_ends: Vec4,
    pub cascade_texels: Vec4,
    pub irradiance: [Vec4; 9],
    pub ground_plane: Plane,
    pub settings: Vec4,
}

/// `Instance` of `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct InstanceBlock {
    pub model: Mat4,
    pub previous_model: Mat4,
    pub rest: Mat4,
    pub joints: u32,
    pub previous_joints: u32,
    pub weights: u32,
    pub previous_weights: u32,
    pub morph_targets: u32,
    pub vertex_count: u32,
    pub influence_sets: u32,
    pub object_id: u32,
}

/// `Light` of `surface.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct LightBlock {
    pub position: Vec4,
    pub color: Vec4,
    pub direction: Vec4,
    pub spot: Vec4,
}

/// `Material` of `material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct MaterialBlock {
    pub base_color: Vec4,
    pub emissive: Vec4,
    pub metallic: f32,
    pub roughness: f32,
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    pub alpha_cutoff: f32,
    pub flags: u32,
    pub uv_sets: u32,
    pub reflectance: f32,
    pub transforms: [Vec4; 10],
}

const _: () = assert!(size_of::<FrameBlock>() == 6 * 64 + 23 * 16);
const _: () = assert!(size_of::<InstanceBlock>() == 224);
const _: () = assert!(size_of::<LightBlock>() == 64);
const _: () = assert!(size_of::<MaterialBlock>() == 64 + 160);

/// Flag of materials without shading; flags 0 to 4 say which textures there are.
const UNLIT: u32 = 32;

impl MaterialBlock {
    /// The block of a material. Blended materials enter geometry buffer and shadow map where they are more
    /// than half there, hence their cutoff.
    pub fn new(material: &Material) -> Self {
        let mut block = Self {
            base_color: material.base_color,
            emissive: material.emissive.extend(0.0),
            metallic: material.metallic,
            roughness: material.roughness,
            reflectance: material.reflectance,
            normal_scale: material.normal_scale,
            occlusion_strength: material.occlusion_strength,
            alpha_cutoff: match material.alpha_mode {
                isophote_scene::AlphaMode::Mask { cutoff } => cutoff,
                _ => 0.5,
            },
            flags: if material.unlit { UNLIT } else { 0 },
            ..Self::default()
        };
        for (index, (use_, _)) in material.textures().into_iter().enumerate() {
            let Some(use_) = use_ else { continue };
            block.flags |= 1 << index;
            block.uv_sets |= use_.uv_set << index;
            let (matrix, offset) = (use_.transform.matrix2, use_.transform.translation);
            block.transforms[2 * index] = Vec4::new(matrix.x_axis.x, matrix.y_axis.x, offset.x, 0.0);
            block.transforms[2 * index + 1] = Vec4::new(matrix.x_axis.y, matrix.y_axis.y, offset.y, 0.0);
        }
        block
    }
}

impl FrameBlock {
    /// The block of a frame of `size` pixels. `previous` is the view-projection matrix of the frame before.
    pub fn new(
        view: &View,
        lighting: &Lighting,
        shadow: &Cascades,
        ground: Option<Plane>,
        size: (u32, u32),
        previous: Option<Mat4>,
    ) -> Self {
        let (width, height) = (size.0 as f32, size.1 as f32);
        let projection = view.projection_matrix(width / height);
        let view_projection = projection * view.world_to_view;
        let to_world = view.world_to_view.inverse();
        let perspective = matches!(view.projection, Projection::Perspective { .. });
        // Parallel projection sees the sky in one direction only; a usual lens stands in for it.
        let sky_ray = if perspective {
            Vec4::new(1.0 / projection.x_axis.x, 1.0 / projection.y_axis.y, 0.0, 0.0)
        } else {
            Vec4::new(0.4 * width / height, 0.4, 0.0, 0.0)
        };
        Self {
            world_to_view: view.world_to_view,
            view_projection,
            previous_view_projection: previous.unwrap_or(view_projection),
            sun_matrices: shadow.matrices,
            eye: to_world.w_axis.truncate().extend(if perspective { 1.0 } else { 0.0 }),
            backward: to_world.z_axis.truncate().normalize_or(Vec3::Z).extend(0.0),
            sun_direction: lighting.sun_direction.extend(0.0),
            sun_color: lighting.sun_color.map_or(Vec4::ZERO, |c| c.extend(1.0)),
            zenith: lighting.zenith.extend(0.0),
            horizon: lighting.horizon.extend(0.0),
            ground: lighting.ground.extend(0.0),
            sky_ray,
            size: Vec4::new(width, height, 1.0 / width, 1.0 / height),
            cascade_ends: Vec3::from(shadow.ends).extend(0.0),
            cascade_texels: Vec3::from(shadow.texels).extend(0.0),
            irradiance: lighting.irradiance.map_or([Vec4::ZERO; 9], |light| light.map(|v| v.extend(1.0))),
            ground_plane: ground.unwrap_or_default(),
            settings: Vec4::new(lighting.exposure, 0.0, shadow.count as f32, lighting.sky_scale),
        }
    }
}

/// The lights of the file, without the one that is the sun.
pub fn lights(scene: &Scene, pose: &Pose, lighting: &Lighting, out: &mut Vec<LightBlock>) {
    out.clear();
    let mut sun = lighting.sun_color.is_some();
    for (node, light) in visible_lights(scene) {
        if light.kind == LightKind::Directional && std::mem::take(&mut sun) {
            continue;
        }
        out.push(light_block(&light, pose.world[node], lighting.light_scale));
    }
}

fn light_block(light: &Light, place: Mat4, scale: f32) -> LightBlock {
    let backward = place.transform_vector3(Vec3::Z).normalize_or(Vec3::Y);
    let (kind, direction, spot) = match light.kind {
        LightKind::Directional => (0.0, backward, Vec4::ZERO),
        LightKind::Point => (1.0, -backward, Vec4::ZERO),
        LightKind::Spot { inner, outer } => {
            let width = 1.0 / (inner.cos() - outer.cos()).max(1e-4);
            (2.0, -backward, Vec4::new(width, -outer.cos() * width, 0.0, 0.0))
        }
    };
    LightBlock {
        position: place.w_axis.truncate().extend(kind),
        color: (light.color * light.intensity * scale / std::f32::consts::PI)
            .extend(light.range.unwrap_or(0.0)),
        direction: direction.extend(0.0),
        spot,
    }
}
