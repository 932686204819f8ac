//! Positions of surfaces before anything moves, so that marks can stick to them.

use glam::Mat4;

use isophote_scene::Scene;
use isophote_scene::pose::Pose;

/// For every draw, from the space of its mesh to the scene at rest: nodes where the file puts them. A skin is
/// placed by its first joint, which is exact where the file shows it in its bind pose.
pub fn matrices(scene: &Scene) -> Vec<Mat4> {
    let pose = Pose::at_rest(scene);
    let matrix = |draw: &isophote_scene::Draw| {
        let has_influences = !scene.primitive(draw).influences.is_empty();
        match scene.nodes[draw.node].skin.filter(|_| has_influences) {
            Some(skin) if !scene.skins[skin].joints.is_empty() => pose.joint_matrix(scene, skin, 0),
            _ => pose.world[draw.node],
        }
    };
    scene.draws.iter().map(matrix).collect()
}
