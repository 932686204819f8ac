//! Camera from which the scene is seen.

use std::f32::consts::TAU;

use isophote_scene::Scene;
use isophote_scene::camera::{Framing, Orbit, View, file_camera};
use isophote_scene::pose::Pose;

/// Camera of the file, or one that goes around the scene.
pub struct Camera {
    /// Node of the file's camera, until the other one is steered.
    node: Option<usize>,
    orbit: Orbit,
}

impl Camera {
    /// The first camera of the file, or else one that has the whole scene in a picture of that size.
    pub fn of(scene: &Scene, size: (u32, u32)) -> Self {
        Self { node: file_camera(scene), orbit: Orbit::framing(scene, aspect(size), Framing::default()) }
    }

    /// A camera that keeps the whole scene in the picture as it goes around it.
    pub fn turntable(scene: &Scene, size: (u32, u32)) -> Self {
        Self { node: None, orbit: Orbit::turntable(scene, aspect(size), Framing::default()) }
    }

    /// View of a scene from it.
    pub fn view(&self, scene: &Scene, pose: &Pose) -> View {
        let own = self.node.and_then(|node| View::from_node(scene, pose, node));
        own.unwrap_or_else(|| self.orbit.view())
    }

    /// View from it after a share of one turn.
    pub fn turned(&self, share: f32) -> View {
        self.orbit.turned(share * TAU).view()
    }

    /// Goes around the scene by angles in radians.
    pub fn rotate(&mut self, azimuth: f32, elevation: f32) {
        self.node = None;
        self.orbit.rotate(azimuth, elevation);
    }

    /// Multiplies the distance by a factor.
    pub fn zoom(&mut self, factor: f32) {
        self.node = None;
        self.orbit.zoom(factor);
    }
}

fn aspect((width, height): (u32, u32)) -> f32 {
    width as f32 / height as f32
}
