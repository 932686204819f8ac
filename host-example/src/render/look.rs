//! Light and exposure: the defaults, and what the lights of a file turn into.

use glam::Vec3;

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
    /// Factor on the light of the sky, but not on its picture behind the scene.
    pub sky_scale: f32,
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
            sky_scale: 1.0,
            light_scale: 1.0,
        }
    }
}

/// The light that files with lights of their own should put on the middle of the scene, in multiples of what
/// makes white white; outside of this range they are scaled.
const LEAST_LIGHT: f32 = 0.7;
const MOST_LIGHT: f32 = 1.2;

/// The light of the sky beside that of the file.
const SKY_FILL: f32 = 0.65;

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
            look.sky_scale = SKY_FILL;
            look.light_scale = total.clamp(LEAST_LIGHT, MOST_LIGHT) / total;
            look.sun_color = sun.map(|(_, color)| color * look.light_scale);
            if let Some((place, _)) = sun {
                look.sun_direction = place.transform_vector3(Vec3::Z).normalize_or(Vec3::Y);
            }
        }
        look
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
