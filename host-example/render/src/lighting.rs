//! Light and exposure: the defaults, and what the lights of a file turn into.

use glam::Vec3;

use isophote_scene::camera::{Direction, View};
use isophote_scene::environment::Environment;
use isophote_scene::pose::Pose;
use isophote_scene::{LightKind, Scene};

/// Light and exposure of a scene. Light is given by what a white surface that faces it reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
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
    /// The light of a picture of the surroundings instead of the sky's, as [`Environment::irradiance`].
    pub irradiance: Option<[Vec3; 9]>,
    /// Factor on the light of the sky, but not on its picture behind the scene.
    pub sky_scale: f32,
    /// Factor on the lights of the file.
    pub light_scale: f32,
}

/// The default sun, seen from the camera: high on its left, so that shapes show light, half tone and shade.
pub const KEY: Direction = Direction { azimuth: -1.05, elevation: 0.7 };

/// Its colour.
const KEY_COLOR: Vec3 = Vec3::new(1.02, 0.97, 0.90);

/// The light of the sky beside it: what the sun does not reach is to be shade.
const KEY_FILL: f32 = 0.55;

impl Default for Lighting {
    /// The default sun, seen by the default camera, under a bright sky.
    fn default() -> Self {
        let azimuth = Direction::default().azimuth + KEY.azimuth;
        Self {
            exposure: 1.0,
            sun_direction: Direction { azimuth, ..KEY }.vector(),
            sun_color: Some(KEY_COLOR),
            zenith: Vec3::new(0.19, 0.30, 0.47),
            horizon: Vec3::new(0.56, 0.62, 0.68),
            ground: Vec3::new(0.15, 0.14, 0.125),
            irradiance: None,
            sky_scale: KEY_FILL,
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

impl Lighting {
    /// The default lighting, or, where the file has lights, those: its first directional light is the sun, and
    /// the sky only fills. Files count in lux and candela of any magnitude, so that together they are scaled
    /// to a picture that is neither dark nor burnt out. `light` says where the sun is instead. It and the default
    /// sun are placed as seen from the camera at `view`, and stay there when it moves. `environment` takes the place
    /// of the sky; what is brightest in it is where the sun is, unless `light` or the file says.
    pub fn for_scene(
        scene: &Scene,
        pose: &Pose,
        view: &View,
        light: Option<Direction>,
        environment: Option<&Environment>,
    ) -> Self {
        let own = Self::of_file(scene, pose);
        let key = own.is_none().then_some(KEY);
        let mut lighting = own.unwrap_or_default();
        let sun = environment.and_then(|e| e.sun).filter(|_| light.is_none() && key.is_some());
        if let Some(sun) = sun {
            lighting.sun_direction = sun;
        } else if let Some(light) = light.or(key) {
            let azimuth = view.azimuth() + light.azimuth;
            lighting.sun_direction = Direction { azimuth, ..light }.vector();
            lighting.sun_color.get_or_insert(KEY_COLOR);
        }
        if let Some(Environment { irradiance, zenith, horizon, ground, .. }) = environment {
            lighting = Self {
                irradiance: Some(*irradiance),
                zenith: *zenith,
                horizon: *horizon,
                ground: *ground,
                sky_scale: 1.0,
                ..lighting
            };
        }
        lighting
    }

    /// The lights of the file, if they shine.
    fn of_file(scene: &Scene, pose: &Pose) -> Option<Self> {
        let mut lighting = Self::default();
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
        if total <= 0.0 || !total.is_finite() {
            return None;
        }
        lighting.sky_scale = SKY_FILL;
        lighting.light_scale = total.clamp(LEAST_LIGHT, MOST_LIGHT) / total;
        lighting.sun_color = sun.map(|(_, color)| color * lighting.light_scale);
        if let Some((place, _)) = sun {
            lighting.sun_direction = place.transform_vector3(Vec3::Z).normalize_or(Vec3::Y);
        }
        Some(lighting)
    }
}

/// Visible lights with their nodes.
pub fn visible_lights(scene: &Scene) -> impl Iterator<Item = (usize, isophote_scene::Light)> + '_ {
    scene
        .nodes
        .iter()
        .enumerate()
        .filter(|(_, node)| node.visible)
        .filter_map(|(index, node)| Some((index, *scene.lights.get(node.light?)?)))
}
