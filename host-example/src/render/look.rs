//! Light and exposure: the defaults, and what the lights of a file turn into.

use glam::camera::rh::{proj::directx as clip, view};
use glam::{Mat4, Vec3};

use crate::scene::pose::Pose;
use crate::scene::{LightKind, Scene};

/// How a scene is lit and exposed. Light is given by what a white surface that faces it reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Factor on the radiance before tone mapping.
    pub exposure: f32,
    /// Unit vector towards the sun.
    pub sun_direction: Vec3,
    /// Colour of the sun; `None` for no sun.
    pub sun_color: Option<Vec3>,
    /// Radiance of the sky above.
    pub zenith: Vec3,
    /// Radiance of the sky at the horizon.
    pub horizon: Vec3,
    /// Radiance of the ground below.
    pub ground: Vec3,
    /// Factor on the lights of the file.
    pub light_scale: f32,
}

impl Default for Look {
    /// A high sun to the left of the default camera under a bright sky.
    fn default() -> Self {
        Self {
            exposure: 1.0,
            sun_direction: Vec3::new(-0.25, 0.85, 0.75).normalize(),
            sun_color: Some(Vec3::new(1.0, 0.95, 0.87) * 0.95),
            zenith: Vec3::new(0.19, 0.30, 0.47),
            horizon: Vec3::new(0.56, 0.62, 0.68),
            ground: Vec3::new(0.15, 0.14, 0.125),
            light_scale: 1.0,
        }
    }
}

/// The light that files with lights of their own should put on the middle of the scene, in multiples of what
/// makes white white; outside of this range they are scaled.
const LEAST_LIGHT: f32 = 0.7;
const MOST_LIGHT: f32 = 1.4;

impl Look {
    /// The default look, or, where the file has lights, those: its first directional light is the sun, and
    /// the sky only fills. Files count in lux and candela of any magnitude, so that together they are scaled
    /// to a picture that is neither dark nor burnt out.
    pub fn for_scene(scene: &Scene, pose: &Pose) -> Self {
        let mut look = Self::default();
        let center = scene.bounds.center();
        let mut total = 0.0;
        let mut sun = None;
        for (node, light) in visible_lights(scene) {
            let place = pose.world[node];
            let strength = light.intensity / std::f32::consts::PI * light.color.max_element();
            match light.kind {
                LightKind::Directional => {
                    total += strength;
                    sun.get_or_insert((place, light.color * light.intensity / std::f32::consts::PI));
                }
                LightKind::Point | LightKind::Spot { .. } => {
                    let near = scene.bounds.radius() * 0.3;
                    let squared = (place.w_axis.truncate() - center).length_squared().max(near * near);
                    total += strength / squared;
                }
            }
        }
        if total > 0.0 && total.is_finite() {
            look.light_scale = total.clamp(LEAST_LIGHT, MOST_LIGHT) / total;
            look.sun_color = sun.map(|(_, color)| color * look.light_scale);
            if let Some((place, _)) = sun {
                look.sun_direction = place.transform_vector3(Vec3::Z).normalize_or(Vec3::Y);
            }
        }
        look
    }

    /// World to the shadow map: a box around the scene along the sun's direction, and the size of one of
    /// `resolution` texels in the world.
    pub fn sun_matrix(&self, scene: &Scene, resolution: u32) -> (Mat4, f32) {
        let up = if self.sun_direction.y.abs() > 0.99 { Vec3::X } else { Vec3::Y };
        let center = scene.bounds.center();
        let rotation = view::look_at_mat4(center + self.sun_direction, center, up);
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (min, max) = (scene.bounds.min, scene.bounds.max);
        for corner in 0..8 {
            let pick = |bit: u32, a: f32, b: f32| if corner >> bit & 1 == 0 { a } else { b };
            let point = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
            let seen = rotation.transform_point3(point);
            (low, high) = (low.min(seen), high.max(seen));
        }
        // Room for the filter at the edges, and for scenes that are flat.
        let margin = scene.bounds.radius() * 0.02;
        let (low, high) = (low - margin, high + margin);
        let projection = clip::orthographic(low.x, high.x, low.y, high.y, -high.z, -low.z);
        (projection * rotation, (high.x - low.x).max(high.y - low.y) / resolution as f32)
    }
}

/// Visible lights with their nodes.
pub fn visible_lights(scene: &Scene) -> impl Iterator<Item = (usize, crate::scene::Light)> + '_ {
    scene
        .nodes
        .iter()
        .enumerate()
        .filter(|(_, node)| node.visible)
        .filter_map(|(index, node)| Some((index, *scene.lights.get(node.light?)?)))
}
