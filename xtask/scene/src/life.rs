//! Things that move: the camera, pennants (morph targets), birds and a banner (skins), the flame.

use super::market;
use super::materials::{Material, Model};
use super::mesh::{Mesh, Morph};
use super::noise::{Random, lerp};
use super::writer::{Interpolation, Node, Track, Writer};
use glam::{Mat3, Mat4, Quat, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Length of the animation in seconds; everything but the camera repeats after it.
pub const DURATION: f32 = 4.0;

/// Evenly spaced key times.
fn times(intervals: usize) -> Vec<f32> {
    (0..=intervals).map(|index| index as f32 / intervals as f32 * DURATION).collect()
}

/// The camera's place and the point it looks at, at a moment in [0, 1].
fn view(t: f32) -> (Vec3, Vec3) {
    let ease = t * t * (3.0 - 2.0 * t);
    let place = Vec3::new(lerp(12.6, 9.4, ease), lerp(3.0, 4.4, ease), lerp(31.5, 28.2, ease));
    let target = Vec3::new(lerp(-0.4, -1.0, ease), lerp(4.3, 4.6, ease), lerp(2.0, 1.0, ease));
    (place, target)
}

/// Adds the camera and its path: a cubic spline for its place, linear turns.
pub fn camera(writer: &mut Writer) {
    let camera = writer.camera("view of the temple", 38.0, 0.2, 800.0);
    let turn = |t: f32| {
        let (place, target) = view(t);
        let back = (place - target).normalize();
        let right = Vec3::Y.cross(back).normalize();
        Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back))
    };
    let node = writer.root(Node {
        name: "camera".into(),
        translation: view(0.0).0,
        rotation: turn(0.0),
        camera: Some(camera),
        ..Node::default()
    });
    const KEYS: usize = 4;
    let places = (0..=KEYS)
        .flat_map(|key| {
            let t = key as f32 / KEYS as f32;
            let step = 1e-2;
            let (before, after) = ((t - step).max(0.0), (t + step).min(1.0));
            // Tangents are per second.
            let tangent = (view(after).0 - view(before).0) / ((after - before) * DURATION);
            [tangent, view(t).0, tangent]
        })
        .collect();
    writer.animate(node, &times(KEYS), &Track::Translation(places), Interpolation::CubicSpline);
    const TURNS: usize = 16;
    let turns = (0..=TURNS).map(|key| turn(key as f32 / TURNS as f32)).collect();
    writer.animate(node, &times(TURNS), &Track::Rotation(turns), Interpolation::Linear);
}

/// Adds pennants at the given mastheads. Two morph targets are a wave and the same wave a quarter
/// of its length farther; turning their weights around a circle makes it travel.
pub fn pennants(writer: &mut Writer, places: &[(Vec3, f32)]) {
    let size = Vec2::new(2.4, 1.0);
    let rest = |u: f32, v: f32| {
        // It narrows towards its end and droops a little.
        let narrow = lerp(1.0, 0.45, u);
        Vec3::new(0.06 + u * size.x, (v - 0.5) * size.y * narrow - 0.28 * u * u, 0.0)
    };
    let wave = |phase: f32| {
        move |u: f32, v: f32| {
            let swing = (u * 1.35 * TAU - phase + (v - 0.5) * 0.9).sin() * 0.24 * u.powf(0.8);
            rest(u, v) + Vec3::new(0.0, 0.18 * swing, swing)
        }
    };
    let mut mesh = Mesh::default();
    mesh.patch(24, 6, Vec2::ONE, rest);
    for phase in [0.0, PI / 2.0] {
        let mut bent = Mesh::default();
        bent.patch(24, 6, Vec2::ONE, wave(phase));
        let difference =
            |to: &[Vec3], from: &[Vec3]| to.iter().zip(from).map(|(to, from)| *to - *from).collect();
        mesh.morphs.push(Morph {
            positions: difference(&bent.positions, &mesh.positions),
            normals: difference(&bent.normals, &mesh.normals),
        });
    }
    let mut model = Model::default();
    *model.part(Material::Pennant) = mesh;
    let mesh = writer.model("pennant", &model);
    const KEYS: usize = 32;
    for (index, &(place, degrees)) in places.iter().enumerate() {
        let node = writer.place("pennant", mesh, place, degrees);
        let weights = (0..=KEYS)
            .flat_map(|key| {
                let angle = key as f32 / KEYS as f32 * 3.0 * TAU + index as f32;
                [angle.cos(), angle.sin()]
            })
            .collect();
        writer.animate(node, &times(KEYS), &Track::Weights(weights), Interpolation::Linear);
    }
}

/// Adds birds that glide around circles, each with a body joint and one joint for each wing.
pub fn birds(writer: &mut Writer, centres: &[(Vec3, f32)]) {
    let mut model = Model::default();
    *model.part(Material::Plumage) = bird();
    let mesh = writer.model("bird", &model);
    for (index, &(centre, radius)) in centres.iter().enumerate() {
        let circle = |t: f32| {
            let angle = t * TAU + index as f32 * 2.1;
            let place =
                centre + Vec3::new(angle.sin() * radius, 0.4 * (angle * 2.0).sin(), angle.cos() * radius);
            // It flies along the circle and leans into the turn.
            (place, Quat::from_rotation_y(angle + PI / 2.0) * Quat::from_rotation_z(0.35))
        };
        let beat = |t: f32| 0.15 + 0.5 * (t * 6.0 * TAU + index as f32).sin();
        glide(writer, mesh, circle, beat);
    }
}

/// The mesh of a bird with its skin: joint 0 is the body, 1 and 2 are the wings.
fn bird() -> Mesh {
    const SPAN: f32 = 0.85;
    let mut bird = Mesh::default();
    bird.ellipsoid(Vec3::ZERO, Vec3::new(0.10, 0.09, 0.34), 14);
    bird.ellipsoid(Vec3::new(0.0, 0.05, 0.36), Vec3::new(0.07, 0.07, 0.10), 10);
    bird.patch(4, 3, Vec2::ONE, |u, v| {
        // The tail.
        Vec3::new((u - 0.5) * lerp(0.34, 0.08, v), 0.01, lerp(-0.62, -0.25, v))
    });
    for side in [-1.0, 1.0] {
        bird.patch(10, 4, Vec2::ONE, |u, v| {
            let u = if side > 0.0 { u } else { 1.0 - u };
            let chord = lerp(0.34, 0.05, u * u);
            Vec3::new(side * lerp(0.05, SPAN, u), 0.03, 0.12 - 0.16 * u * u + (v - 0.5) * -chord)
        });
    }
    for position in bird.positions.clone() {
        let wing = ((position.x.abs() - 0.08) / 0.12).clamp(0.0, 1.0);
        bird.joints.push([0, if position.x < 0.0 { 1 } else { 2 }, 0, 0]);
        bird.weights.push([1.0 - wing, wing, 0.0, 0.0]);
    }
    // A joint without weight must be joint 0.
    for (joints, weights) in bird.joints.iter_mut().zip(&bird.weights) {
        if weights[1] == 0.0 {
            joints[1] = 0;
        }
    }
    bird.paint(|point, _| {
        if point.x.abs() > 0.62 || point.z < -0.5 { Vec3::splat(0.06) } else { Vec3::new(0.80, 0.78, 0.74) }
    });
    bird
}

/// Adds one bird: `path` is its place and attitude and `beat` the angle of its wings, over a loop from 0 to 1.
fn glide(writer: &mut Writer, mesh: usize, path: impl Fn(f32) -> (Vec3, Quat), beat: impl Fn(f32) -> f32) {
    const KEYS: usize = 32;
    let shoulder = Vec3::new(0.06, 0.03, 0.0);
    let other = shoulder * Vec3::new(-1.0, 1.0, 1.0);
    let joint = |name: &str, translation: Vec3| Node { name: name.into(), translation, ..Node::default() };
    let left = writer.node(joint("left wing", other));
    let right = writer.node(joint("right wing", shoulder));
    let (translation, rotation) = path(0.0);
    let children = vec![left, right];
    let body = writer.root(Node { name: "bird".into(), translation, rotation, children, ..Node::default() });
    let bind = [Mat4::IDENTITY, Mat4::from_translation(other), Mat4::from_translation(shoulder)];
    let skin = writer.skin("bird", &[body, left, right], &bind);
    writer.root(Node { name: "bird skin".into(), mesh: Some(mesh), skin: Some(skin), ..Node::default() });
    let along: Vec<f32> = (0..=KEYS).map(|key| key as f32 / KEYS as f32).collect();
    let places = along.iter().map(|&t| path(t).0).collect();
    let turns = along.iter().map(|&t| path(t).1).collect();
    writer.animate(body, &times(KEYS), &Track::Translation(places), Interpolation::Linear);
    writer.animate(body, &times(KEYS), &Track::Rotation(turns), Interpolation::Linear);
    for (wing, side) in [(left, -1.0), (right, 1.0)] {
        let beats = along.iter().map(|&t| Quat::from_rotation_z(side * beat(t))).collect();
        writer.animate(wing, &times(KEYS), &Track::Rotation(beats), Interpolation::Linear);
    }
}

/// Adds a banner that hangs from a rod and sways: a chain of three joints.
pub fn banner(writer: &mut Writer, place: Vec3, degrees: f32) {
    const LENGTH: f32 = 2.6;
    let mut rod = Model::default();
    rod.part(Material::Wood).tube(
        &[Vec3::new(-0.75, 0.03, 0.0), Vec3::new(0.75, 0.03, 0.0)],
        &[0.035, 0.035],
        8,
    );
    for x in [-0.78, 0.78] {
        rod.part(Material::Gold).ellipsoid(Vec3::new(x, 0.03, 0.0), Vec3::splat(0.07), 10);
    }
    for x in [-0.6, 0.6] {
        rod.part(Material::Wood).beam(Vec3::new(x, 0.03, -0.5), Vec3::new(x, 0.03, 0.0), 0.05, 0.05);
    }
    let mesh = writer.model("banner rod", &rod);
    writer.place("banner rod", mesh, place, degrees);
    let mut cloth = Mesh::default();
    // The picture of the pennant stands upright.
    cloth.patch(8, 18, Vec2::ONE, |u, v| {
        Vec3::new((u - 0.5) * 1.3, (v - 1.0) * LENGTH, 0.015 * (u * TAU * 2.0).sin() * (1.0 - v))
    });
    cloth.uvs.iter_mut().for_each(|uv| *uv = Vec2::new(uv.y, 1.0 - uv.x));
    for position in &cloth.positions {
        let depth = (-position.y / LENGTH * 2.0).clamp(0.0, 1.999);
        let (joint, blend) = (depth as u8, depth.fract());
        cloth.joints.push([joint, if blend > 0.0 { joint + 1 } else { 0 }, 0, 0]);
        cloth.weights.push([1.0 - blend, blend, 0.0, 0.0]);
    }
    let mut model = Model::default();
    *model.part(Material::Pennant) = cloth;
    let mesh = writer.model("banner", &model);
    let step = -Vec3::Y * LENGTH / 2.0;
    let hem = writer.node(Node { name: "banner hem".into(), translation: step, ..Node::default() });
    let middle = writer.node(Node {
        name: "banner middle".into(),
        translation: step,
        children: vec![hem],
        ..Node::default()
    });
    let top = writer.root(Node {
        name: "banner top".into(),
        translation: place,
        rotation: Quat::from_rotation_y(degrees.to_radians()),
        children: vec![middle],
        ..Node::default()
    });
    let bind = [0.0, 1.0, 2.0].map(|joint| Mat4::from_translation(step * joint));
    let skin = writer.skin("banner", &[top, middle, hem], &bind);
    writer.root(Node { name: "banner cloth".into(), mesh: Some(mesh), skin: Some(skin), ..Node::default() });
    const KEYS: usize = 16;
    for (node, size, delay) in [(middle, 0.16, 0.0), (hem, 0.26, 0.9)] {
        let sway = (0..=KEYS)
            .map(|key| {
                let angle = key as f32 / KEYS as f32 * 2.0 * TAU - delay;
                Quat::from_rotation_x(-size * (0.6 + 0.8 * angle.sin()))
            })
            .collect();
        writer.animate(node, &times(KEYS), &Track::Rotation(sway), Interpolation::Linear);
    }
}

/// Adds the flame of the brazier, which jumps between sizes, and its light.
pub fn fire(writer: &mut Writer, place: Vec3) {
    let mesh = writer.model("flame", &market::flame());
    let node = writer.place("flame", mesh, place, 0.0);
    let mut random = Random::new(227);
    const KEYS: usize = 24;
    let mut sizes: Vec<Vec3> = (0..=KEYS)
        .map(|_| Vec3::new(random.range(0.85, 1.1), random.range(0.8, 1.3), random.range(0.85, 1.1)))
        .collect();
    // The last size is the first one, so that the loop closes.
    sizes[KEYS] = sizes[0];
    writer.animate(node, &times(KEYS), &Track::Scale(sizes), Interpolation::Step);
    let light = writer.light("brazier", "point", Vec3::new(1.0, 0.52, 0.18), 18.0, Some(14.0));
    writer.root(Node {
        name: "brazier light".into(),
        translation: place + Vec3::Y * 0.5,
        light: Some(light),
        ..Node::default()
    });
}
