//! A scene at one moment: world transforms, morph weights and deformed vertices.

use glam::{Mat4, Vec3};

use super::animation::{self, Property};
use super::model::{Bounds, Draw, Node, Scene, Transform};

/// World transforms and morph weights of all nodes at one moment.
#[derive(Clone, Debug, Default)]
pub struct Pose {
    /// Per node: from its space to the world.
    pub world: Vec<Mat4>,
    /// Per node: its morph weights.
    pub weights: Vec<Vec<f32>>,
    local: Vec<Transform>,
}

impl Pose {
    /// The scene at `time` seconds of an animation, which loops; at rest without one. Reuses its memory
    /// when called again for the same scene.
    pub fn update(&mut self, scene: &Scene, animation: Option<usize>, time: f32) {
        self.local.clear();
        self.local.extend(scene.nodes.iter().map(|n| n.transform));
        self.weights.resize(scene.nodes.len(), Vec::new());
        for (weights, node) in self.weights.iter_mut().zip(&scene.nodes) {
            weights.clear();
            weights.extend_from_slice(&node.weights);
        }
        if let Some(animation) = animation.and_then(|index| scene.animations.get(index)) {
            let time = animation.looped(time);
            for channel in &animation.channels {
                self.apply(channel, time);
            }
        }
        self.world.resize(scene.nodes.len(), Mat4::IDENTITY);
        for &index in &scene.order {
            let local = self.local[index].matrix();
            self.world[index] = match scene.nodes[index].parent {
                Some(parent) => self.world[parent] * local,
                None => local,
            };
        }
    }

    /// The scene at rest.
    pub fn at_rest(scene: &Scene) -> Self {
        let mut pose = Self::default();
        pose.update(scene, None, 0.0);
        pose
    }

    fn apply(&mut self, channel: &animation::Channel, time: f32) {
        if channel.property == Property::Weights {
            let weights = &mut self.weights[channel.node];
            weights.resize(channel.width, 0.0);
            channel.sample(time, weights);
            return;
        }
        let mut buffer = [0.0; 4];
        let value = &mut buffer[..channel.width.min(4)];
        channel.sample(time, value);
        let (mut translation, mut rotation, mut scale) = self.local[channel.node].parts();
        match channel.property {
            Property::Translation => translation = animation::vector(value),
            Property::Rotation => rotation = animation::quaternion(value),
            Property::Scale => scale = animation::vector(value),
            Property::Weights => {}
        }
        self.local[channel.node] = Transform::Parts { translation, rotation, scale };
    }

    /// Matrix of one joint of a skin: from the space of the mesh to the world.
    pub fn joint_matrix(&self, scene: &Scene, skin: usize, joint: usize) -> Mat4 {
        let skin = &scene.skins[skin];
        self.world[skin.joints[joint]] * skin.inverse_bind[joint]
    }

    /// Calls `visit` with the world position of each vertex of a draw, morphed and skinned.
    pub fn positions(&self, scene: &Scene, draw: &Draw, mut visit: impl FnMut(Vec3)) {
        let primitive = scene.primitive(draw);
        let node = &scene.nodes[draw.node];
        let weights = &self.weights[draw.node];
        let joints: Option<Vec<Mat4>> = node.skin.filter(|_| !primitive.influences.is_empty()).map(|skin| {
            (0..scene.skins[skin].joints.len()).map(|j| self.joint_matrix(scene, skin, j)).collect()
        });
        for (index, vertex) in primitive.vertices.iter().enumerate() {
            let mut position = Vec3::from(vertex.position);
            for (target, &weight) in primitive.morph_targets.iter().zip(weights) {
                position += Vec3::from(target[index].position) * weight;
            }
            let matrix = match &joints {
                Some(joints) => {
                    let sets = primitive.influence_sets;
                    let mut sum = Mat4::ZERO;
                    for set in &primitive.influences[index * sets..(index + 1) * sets] {
                        for (&joint, &weight) in set.joints.iter().zip(&set.weights) {
                            sum += joints[joint as usize] * weight;
                        }
                    }
                    sum
                }
                None => self.world[draw.node],
            };
            visit(matrix.transform_point3(position));
        }
    }
}

/// Node indices, parents before their children.
///
/// # Errors
/// A clause naming a node that is part of a cycle.
pub fn parents_first(nodes: &[Node]) -> Result<Vec<usize>, String> {
    let mut children = vec![Vec::new(); nodes.len()];
    let mut order: Vec<usize> = Vec::with_capacity(nodes.len());
    for (index, node) in nodes.iter().enumerate() {
        match node.parent {
            Some(parent) => children[parent].push(index),
            None => order.push(index),
        }
    }
    let mut done = 0;
    while done < order.len() {
        order.extend_from_slice(&children[order[done]]);
        done += 1;
    }
    let mut reached = vec![false; nodes.len()];
    order.iter().for_each(|&index| reached[index] = true);
    match reached.iter().position(|reached| !reached) {
        Some(node) => Err(format!("node {node} is its own ancestor")),
        None => Ok(order),
    }
}

/// Moments of each animation at which the bounds are taken.
const BOUNDS_SAMPLES: usize = 8;

/// Extent of all visible geometry but backdrops, at rest and over its animations; `None` if it is not
/// finite. Where all is backdrop, all counts.
pub fn bounds(scene: &Scene) -> Option<Bounds> {
    let directions = fan();
    let mut extremes = vec![(f32::NEG_INFINITY, Vec3::ZERO); directions.len()];
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let mut finite = true;
    let mut include = |p: Vec3| {
        finite &= p.is_finite();
        (min, max) = (min.min(p), max.max(p));
        for (best, direction) in extremes.iter_mut().zip(&directions) {
            let reach = p.dot(*direction);
            if reach > best.0 {
                *best = (reach, p);
            }
        }
    };
    let backdrop = |draw: &Draw| scene.nodes[draw.node].backdrop;
    let all = scene.draws.iter().all(backdrop);
    let framed = |draw: &&Draw| all || !backdrop(draw);
    let mut pose = Pose::at_rest(scene);
    for draw in scene.draws.iter().filter(framed) {
        pose.positions(scene, draw, &mut include);
    }
    for (index, animation) in scene.animations.iter().enumerate() {
        let moving = moving_draws(scene, animation);
        for sample in 0..BOUNDS_SAMPLES {
            let time = animation.duration() * sample as f32 / BOUNDS_SAMPLES as f32;
            pose.update(scene, Some(index), time);
            for draw in moving.iter().filter(framed) {
                pose.positions(scene, draw, &mut include);
            }
        }
    }
    finite.then(|| Bounds { min, max, extremes: extremes.into_iter().map(|(_, p)| p).collect() })
}

/// Draws that an animation moves; cameras and lights move nothing visible.
fn moving_draws(scene: &Scene, animation: &animation::Animation) -> Vec<Draw> {
    let mut moving = vec![false; scene.nodes.len()];
    for channel in &animation.channels {
        moving[channel.node] = true;
    }
    for &index in &scene.order {
        if let Some(parent) = scene.nodes[index].parent {
            moving[index] |= moving[parent];
        }
    }
    let moves = |draw: &&Draw| {
        let skin = scene.nodes[draw.node].skin;
        moving[draw.node] || skin.is_some_and(|s| scene.skins[s].joints.iter().any(|&j| moving[j]))
    };
    scene.draws.iter().filter(moves).copied().collect()
}

/// Directions in which extremes are kept: the axes, so that flat scenes keep their corners, and an even
/// spiral over the sphere.
fn fan() -> Vec<Vec3> {
    const SPIRAL: usize = 90;
    let golden = std::f32::consts::PI * (3.0 - 5.0f32.sqrt());
    let spiral = (0..SPIRAL).map(|i| {
        let y = 1.0 - (2 * i + 1) as f32 / SPIRAL as f32;
        let (sine, cosine) = (golden * i as f32).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        Vec3::new(radius * cosine, y, radius * sine)
    });
    let corners = (0..8).map(|i| {
        let sign = |bit: usize| if i >> bit & 1 == 0 { 1.0 } else { -1.0 };
        Vec3::new(sign(0), sign(1), sign(2)).normalize()
    });
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    axes.chain(corners).chain(spiral).collect()
}
