//! The draws that a frame needs, in order: solid ones from near to far, so that hidden surfaces are
//! rejected before they are shaded, and blended ones from far to near over them.

use glam::{Mat4, Vec3, Vec4};

use crate::upload::GpuPrimitive;
use isophote_scene::pose::Pose;
use isophote_scene::{AlphaMode, Scene};

/// The draws of one frame; its memory is reused for the next.
#[derive(Debug, Default)]
pub struct Visible {
    /// World space spheres of all draws; `None` for those that deform out of theirs.
    pub spheres: Vec<Option<(Vec3, f32)>>,
    /// Opaque and masked draws in view, near ones first, with their distance.
    pub solid: Vec<(f32, usize)>,
    /// Blended draws in view, far ones first, with their distance.
    pub blended: Vec<(f32, usize)>,
}

impl Visible {
    /// Finds and orders the draws.
    pub fn update(
        &mut self,
        scene: &Scene,
        primitives: &[Vec<GpuPrimitive>],
        pose: &Pose,
        eye: Vec3,
        view_projection: Mat4,
    ) {
        self.spheres.clear();
        self.solid.clear();
        self.blended.clear();
        let planes = side_planes(view_projection);
        for (index, draw) in scene.draws.iter().enumerate() {
            let primitive = &primitives[draw.mesh][draw.primitive];
            let world = pose.world[draw.node];
            let (middle, radius) = primitive.sphere;
            let middle = world.transform_point3(middle);
            let stretch = world.x_axis.length().max(world.y_axis.length()).max(world.z_axis.length());
            let radius = radius * stretch;
            self.spheres.push((!primitive.deforms).then_some((middle, radius)));
            if !primitive.deforms && planes.iter().any(|p| p.dot(middle.extend(1.0)) < -radius) {
                continue;
            }
            let material = &scene.materials[scene.primitive(draw).material];
            let distance = middle.distance(eye);
            if material.alpha_mode == AlphaMode::Blend {
                self.blended.push((distance, index));
            } else {
                self.solid.push((distance - radius, index));
            }
        }
        self.solid.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.blended.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    }
}

/// The left, right, lower and upper plane of a view, with unit normals pointing inward.
fn side_planes(view_projection: Mat4) -> [Vec4; 4] {
    let [x, y, w] = [0, 1, 3].map(|row| view_projection.row(row));
    [w + x, w - x, w + y, w - y].map(|plane| plane / plane.truncate().length().max(1e-30))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_scene::camera::View;
    use isophote_scene::model::Projection;

    #[test]
    fn planes_bound_the_picture() {
        for projection in [
            Projection::Perspective { vertical_fov: 1.0, near: 0.1 },
            Projection::Orthographic { half_height: 2.0, near: 0.1, far: 50.0 },
        ] {
            let view = View { world_to_view: Mat4::from_translation(Vec3::new(0.0, -3.0, 0.0)), projection };
            let planes = side_planes(view.projection_matrix(1.0) * view.world_to_view);
            let inside = |x: f32, y: f32| planes.iter().all(|p| p.dot(Vec4::new(x, y, -4.0, 1.0)) > 0.0);
            assert!(inside(0.0, 3.0) && inside(1.9, 4.9));
            assert!(!inside(0.0, 0.4) && !inside(3.0, 3.0) && !inside(-3.0, 3.0) && !inside(0.0, 5.6));
        }
    }
}
