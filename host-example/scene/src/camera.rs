//! Cameras: those of the file, a default view that frames the scene, and the orbit of turntables and viewers.

use std::f32::consts::TAU;

use glam::camera::rh::{proj::directx as clip, view};
use glam::{Mat4, Vec3};

use super::model::{Projection, Scene};
use super::pose::Pose;

/// A camera in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From the world to the camera, which looks along -Z with +Y up.
    pub world_to_view: Mat4,
    /// The projection.
    pub projection: Projection,
}

impl View {
    /// From camera space to clip space with reversed depth: 1 at the near plane, 0 far away. Reversing gives
    /// floating-point depth nearly even precision over distance.
    pub fn projection_matrix(&self, aspect: f32) -> Mat4 {
        match self.projection {
            Projection::Perspective { vertical_fov, near } => {
                clip::perspective_infinite_reverse(vertical_fov, aspect, near)
            }
            Projection::Orthographic { half_height, near, far } => {
                let half_width = half_height * aspect;
                clip::orthographic(-half_width, half_width, -half_height, half_height, far, near)
            }
        }
    }

    /// Position of the camera in the world.
    pub fn eye(&self) -> Vec3 {
        self.world_to_view.inverse().w_axis.truncate()
    }

    /// Angle of the camera around the vertical, as [`Orbit::azimuth`].
    pub fn azimuth(&self) -> f32 {
        let backward = self.world_to_view.row(2);
        backward.x.atan2(backward.z)
    }

    /// The camera at a node of the file.
    pub fn from_node(scene: &Scene, pose: &Pose, node: usize) -> Option<Self> {
        let projection = scene.cameras.get(scene.nodes.get(node)?.camera?)?.projection;
        // Cameras are placed without the scale of their node.
        let (_, rotation, translation) = pose.world.get(node)?.to_scale_rotation_translation();
        let world_to_view = Mat4::from_rotation_translation(rotation, translation).inverse();
        world_to_view.is_finite().then_some(Self { world_to_view, projection })
    }
}

/// Visible nodes with a camera.
fn file_cameras(scene: &Scene) -> impl Iterator<Item = usize> + '_ {
    (0..scene.nodes.len()).filter(|&n| scene.nodes[n].visible && scene.nodes[n].camera.is_some())
}

/// First visible node with a camera.
pub fn file_camera(scene: &Scene) -> Option<usize> {
    file_cameras(scene).next()
}

/// Names of the camera at a node: that of its node, and its own.
fn names(scene: &Scene, node: usize) -> [&str; 2] {
    let entry = &scene.nodes[node];
    let own = entry.camera.and_then(|camera| scene.cameras.get(camera)).map_or("", |camera| &camera.name);
    [&entry.name, own]
}

/// Visible node with the camera of this name (case ignored) or number (from 0).
pub fn find_file_camera(scene: &Scene, name: &str) -> Option<usize> {
    let is_named = |node: &usize| names(scene, *node).iter().any(|own| own.eq_ignore_ascii_case(name));
    file_cameras(scene)
        .find(is_named)
        .or_else(|| name.parse().ok().and_then(|index: usize| file_cameras(scene).nth(index)))
}

/// Numbers and names of the cameras of the file, for messages.
pub fn list_file_cameras(scene: &Scene) -> Vec<String> {
    let text = |(index, node): (usize, usize)| match names(scene, node) {
        ["", ""] => index.to_string(),
        ["", name] | [name, _] => format!("{index} ({name})"),
    };
    file_cameras(scene).enumerate().map(text).collect()
}

/// A camera on a sphere around a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Point that it looks at.
    pub target: Vec3,
    /// Distance of the camera from it.
    pub distance: f32,
    /// Angle about the vertical in radians; 0 looks from +Z, growing towards +X.
    pub azimuth: f32,
    /// Angle above the horizon in radians, within (-pi/2, pi/2).
    pub elevation: f32,
    /// Vertical field of view in radians.
    pub vertical_fov: f32,
}

/// Direction from which an orbit looks, in radians as in [`Orbit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// About the vertical.
    pub azimuth: f32,
    /// Above the horizon.
    pub elevation: f32,
}

impl Default for Direction {
    /// A three-quarter view from slightly above.
    fn default() -> Self {
        Self { azimuth: 0.55, elevation: 0.28 }
    }
}

impl Direction {
    /// The unit vector that way.
    pub fn vector(self) -> Vec3 {
        let (sin_e, cos_e) = self.elevation.sin_cos();
        let (sin_a, cos_a) = self.azimuth.sin_cos();
        Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e)
    }
}

/// Framing of a scene by the default camera and by turntables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// From where.
    pub direction: Direction,
    /// Distance, as a factor on that from which the scene fills the picture.
    pub distance: f32,
    /// Vertical field of view in radians.
    pub vertical_fov: f32,
    /// Point in the middle of the picture instead of the scene.
    pub target: Option<Vec3>,
}

impl Default for Framing {
    fn default() -> Self {
        Self { direction: Direction::default(), distance: 1.0, vertical_fov: 0.6, target: None }
    }
}

/// Steepest elevation; straight up has no defined azimuth.
const STEEPEST: f32 = 1.55;

/// Free space kept around the scene, as a share of the view.
const MARGIN: f32 = 0.06;

impl Orbit {
    /// A view that frames the whole scene in a picture of this aspect (width over height).
    pub fn framing(scene: &Scene, aspect: f32, framing: Framing) -> Self {
        let mut orbit = Self::towards(scene.bounds.center(), framing);
        orbit.fit(&scene.bounds.extremes, aspect);
        orbit.distance *= framing.distance;
        orbit.target = framing.target.unwrap_or(orbit.target);
        orbit
    }

    /// Like [`Orbit::framing`], but the scene stays in frame at every azimuth.
    pub fn turntable(scene: &Scene, aspect: f32, framing: Framing) -> Self {
        let center = scene.bounds.center();
        let mut orbit = Self::towards(center, framing);
        let swept: Vec<Vec3> = scene
            .bounds
            .extremes
            .iter()
            .flat_map(|p| {
                let radius = (*p - center).with_y(0.0).length();
                (0..16).map(move |step| {
                    let (sine, cosine) = (step as f32 / 16.0 * TAU).sin_cos();
                    Vec3::new(center.x + radius * sine, p.y, center.z + radius * cosine)
                })
            })
            .collect();
        orbit.distance = orbit.fit_distance(&swept, aspect) * framing.distance;
        orbit.target = framing.target.unwrap_or(orbit.target);
        orbit
    }

    fn towards(target: Vec3, framing: Framing) -> Self {
        let Direction { azimuth, elevation } = framing.direction;
        let elevation = elevation.clamp(-STEEPEST, STEEPEST);
        Self { target, distance: 1.0, azimuth, elevation, vertical_fov: framing.vertical_fov }
    }

    /// This orbit with another azimuth added, in radians.
    pub fn turned(mut self, angle: f32) -> Self {
        self.azimuth += angle;
        self
    }

    /// The camera.
    pub fn view(&self) -> View {
        let eye = self.target + self.direction() * self.distance;
        View {
            world_to_view: view::look_at_mat4(eye, self.target, Vec3::Y),
            projection: Projection::Perspective {
                vertical_fov: self.vertical_fov,
                near: (self.distance * 0.01).max(1e-5),
            },
        }
    }

    /// Unit vector from the target to the camera.
    pub fn direction(&self) -> Vec3 {
        let elevation = self.elevation.clamp(-STEEPEST, STEEPEST);
        Direction { azimuth: self.azimuth, elevation }.vector()
    }

    /// Turns by angles in radians, as when dragging.
    pub fn rotate(&mut self, azimuth: f32, elevation: f32) {
        self.azimuth = (self.azimuth + azimuth) % TAU;
        self.elevation = (self.elevation + elevation).clamp(-STEEPEST, STEEPEST);
    }

    /// Multiplies the distance by a factor, as when scrolling.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = (self.distance * factor).clamp(1e-4, 1e7);
    }

    /// Moves the target across the view; 1 is the height of the picture at the target.
    pub fn pan(&mut self, right: f32, up: f32) {
        let height = 2.0 * self.distance * (self.vertical_fov * 0.5).tan();
        let backward = self.direction();
        let across = Vec3::Y.cross(backward).normalize_or(Vec3::X);
        self.target += (across * right + backward.cross(across) * up) * height;
    }

    /// Distance at which all points, seen from this direction, lie within the picture.
    fn fit_distance(&self, points: &[Vec3], aspect: f32) -> f32 {
        let rotation = view::look_to_mat4(Vec3::ZERO, -self.direction(), Vec3::Y);
        let tan_y = (self.vertical_fov * 0.5).tan() * (1.0 - MARGIN);
        let tan_x = tan_y * aspect.max(1e-3);
        let needed = |p: &Vec3| {
            let q = rotation.transform_vector3(*p - self.target);
            q.z + (q.x.abs() / tan_x).max(q.y.abs() / tan_y)
        };
        points.iter().map(needed).fold(1e-4, f32::max)
    }

    /// Moves target and distance so that the points fill the picture evenly. The extents on the screen
    /// depend on the distance, so centring and fitting alternate a few times.
    fn fit(&mut self, points: &[Vec3], aspect: f32) {
        self.distance = self.fit_distance(points, aspect);
        for _ in 0..8 {
            let view = self.view().world_to_view;
            let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
            let (mut left, mut right) = (f32::INFINITY, f32::NEG_INFINITY);
            for p in points {
                let q = view.transform_point3(*p);
                let (x, y) = (q.x / -q.z, q.y / -q.z);
                (left, right, low, high) = (left.min(x), right.max(x), low.min(y), high.max(y));
            }
            let backward = self.direction();
            let across = Vec3::Y.cross(backward).normalize_or(Vec3::X);
            let shift = across * (left + right) * 0.5 + backward.cross(across) * (low + high) * 0.5;
            if !shift.is_finite() {
                return;
            }
            self.target += shift * self.distance;
            self.distance = self.fit_distance(points, aspect);
        }
    }
}

/// A camera of the file, or one that goes around the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Node of the file's camera that is looked through.
    pub node: Option<usize>,
    /// The camera that is looked through where there is none.
    pub orbit: Orbit,
}

impl Viewpoint {
    /// The first camera of the file, or else one that has the whole scene in a picture of this aspect.
    pub fn of(scene: &Scene, aspect: f32) -> Self {
        Self { node: file_camera(scene), orbit: Orbit::framing(scene, aspect, Framing::default()) }
    }

    /// View of a scene from it.
    pub fn view(&self, scene: &Scene, pose: &Pose) -> View {
        let own = self.node.and_then(|node| View::from_node(scene, pose, node));
        own.unwrap_or_else(|| self.orbit.view())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    #[test]
    fn points_fill_the_picture_and_stay_in_it() {
        let points: Vec<Vec3> = (0..8)
            .map(|i| Vec3::new((i & 1) as f32 * 9.0, (i >> 1 & 1) as f32 * 3.0, (i >> 2) as f32) - 40.0)
            .collect();
        for aspect in [0.3, 1.0, 1.78, 4.0] {
            for azimuth in [0.0, 0.55, 2.0] {
                let direction = Direction { azimuth, elevation: 0.28 };
                let framing = Framing { direction, ..Framing::default() };
                let mut orbit = Orbit::towards(Vec3::new(4.5, 1.5, 0.5) - 40.0, framing);
                orbit.fit(&points, aspect);
                let view = orbit.view();
                let clip = view.projection_matrix(aspect) * view.world_to_view;
                let reach = points.iter().map(|p| {
                    let q = clip * p.extend(1.0);
                    assert!(q.w > 0.0);
                    (q.x / q.w).abs().max((q.y / q.w).abs())
                });
                let most = reach.fold(0.0, f32::max);
                assert!(
                    (1.0 - MARGIN - 0.02..=1.0 - MARGIN + 1e-3).contains(&most),
                    "{most} at {aspect}, {azimuth}"
                );
            }
        }
    }

    #[test]
    fn depth_is_reversed() {
        let depth = |projection: Projection, z: f32| {
            let view = View { world_to_view: Mat4::IDENTITY, projection };
            let q = view.projection_matrix(1.5) * Vec4::new(0.0, 0.0, z, 1.0);
            q.z / q.w
        };
        let perspective = Projection::Perspective { vertical_fov: 1.0, near: 0.1 };
        assert!((depth(perspective, -0.1) - 1.0).abs() < 1e-6);
        assert!(depth(perspective, -1e6) < 1e-6);
        let parallel = Projection::Orthographic { half_height: 1.0, near: 0.5, far: 4.0 };
        assert!((depth(parallel, -0.5) - 1.0).abs() < 1e-6);
        assert!(depth(parallel, -4.0).abs() < 1e-6);
    }

    #[test]
    fn an_orbit_can_be_steered() {
        let direction = Direction { azimuth: 0.0, elevation: 0.0 };
        let mut orbit = Orbit::towards(Vec3::ZERO, Framing { direction, ..Framing::default() });
        assert_eq!(orbit.turned(2.0).view().azimuth(), 2.0);
        assert!(orbit.view().eye().abs_diff_eq(Vec3::Z, 1e-6));
        orbit.rotate(std::f32::consts::FRAC_PI_2, 0.0);
        assert!(orbit.view().eye().abs_diff_eq(Vec3::X, 1e-6));
        orbit.rotate(0.0, 100.0);
        assert!(orbit.view().world_to_view.is_finite() && orbit.elevation < std::f32::consts::FRAC_PI_2);
        orbit.zoom(2.0);
        assert_eq!(orbit.distance, 2.0);
        orbit.elevation = 0.0;
        orbit.pan(0.0, 1.0);
        assert!((orbit.target.y - 4.0 * 0.3f32.tan()).abs() < 1e-5);
    }
}
