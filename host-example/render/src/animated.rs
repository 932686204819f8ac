//! Joints and morph weights of all nodes of a scene one after another, those of a frame before those of the frame before it.

use glam::Mat4;
use isophote_scene::Scene;
use isophote_scene::pose::Pose;

/// Index at which the joints of each skinned node begin, and the number of all.
pub fn joint_offsets(scene: &Scene) -> (Vec<Option<u32>>, usize) {
    let mut total = 0;
    let offsets = scene
        .nodes
        .iter()
        .map(|node| {
            let skin = node.skin.filter(|_| node.visible && node.mesh.is_some())?;
            let start = total;
            total += scene.skins[skin].joints.len();
            Some(start as u32)
        })
        .collect();
    (offsets, total)
}

/// Index at which the morph weights of each node begin, and the number of all.
pub fn weight_offsets(scene: &Scene) -> (Vec<u32>, usize) {
    let mut total = 0;
    let offsets = scene
        .nodes
        .iter()
        .map(|node| {
            let start = total;
            total += node.weights.len();
            start as u32
        })
        .collect();
    (offsets, total)
}

/// Joints of a pose, after which those of the frame before stand; the `first` frame has its own for both.
pub fn fill_joints(
    scene: &Scene,
    pose: &Pose,
    offsets: &[Option<u32>],
    count: usize,
    joints: &mut Vec<Mat4>,
    first: bool,
) {
    joints.resize(2 * count, Mat4::IDENTITY);
    joints.copy_within(..count, count);
    for (node, offset) in offsets.iter().enumerate() {
        let (Some(offset), Some(skin)) = (offset, scene.nodes[node].skin) else { continue };
        for joint in 0..scene.skins[skin].joints.len() {
            joints[*offset as usize + joint] = pose.joint_matrix(scene, skin, joint);
        }
    }
    if first {
        joints.copy_within(..count, count);
    }
}

/// Morph weights of a pose, likewise.
pub fn fill_weights(pose: &Pose, offsets: &[u32], count: usize, weights: &mut Vec<f32>, first: bool) {
    weights.resize(2 * count, 0.0);
    weights.copy_within(..count, count);
    for (node, own) in pose.weights.iter().enumerate() {
        let start = offsets[node] as usize;
        weights[start..start + own.len()].copy_from_slice(own);
    }
    if first {
        weights.copy_within(..count, count);
    }
}
