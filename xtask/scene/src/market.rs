//! Small things of the market: the stall, crates of produce, vases, the brazier and poles.

use super::materials::{Material, Model};
use super::mesh::{Faces, Mesh};
use super::noise::{Random, catmull_rom};
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A stall under striped cloth; it faces +z.
pub fn stall() -> Model {
    let mut model = Model::default();
    frame(model.part(Material::Wood));
    awning(model.part(Material::StripedCloth));
    goods(&mut model);
    model
}

/// Half the width and half the depth of a stall, and the heights of its posts in front and at the back.
const STALL: (f32, f32, f32, f32) = (1.9, 1.25, 2.25, 2.9);

/// Posts, beams and the table of a stall.
fn frame(wood: &mut Mesh) {
    let (half, depth, front, rear) = STALL;
    for x in [-half, half] {
        for (z, height) in [(depth, front), (-depth, rear)] {
            wood.tube(&[Vec3::new(x, -0.1, z), Vec3::new(x, height, z)], &[0.06, 0.05], 10);
        }
        wood.beam(Vec3::new(x, front - 0.05, depth), Vec3::new(x, rear - 0.05, -depth), 0.07, 0.07);
    }
    for (z, height) in [(depth, front), (-depth, rear)] {
        wood.beam(
            Vec3::new(-half - 0.15, height - 0.04, z),
            Vec3::new(half + 0.15, height - 0.04, z),
            0.07,
            0.07,
        );
    }
    wood.cuboid(Vec3::new(-half + 0.1, 0.82, -0.1), Vec3::new(half - 0.1, 0.9, depth - 0.1), Faces::All);
    for x in [-half + 0.25, 0.0, half - 0.25] {
        for z in [0.05, depth - 0.25] {
            wood.block(x, -0.05, z, Vec3::new(0.1, 0.87, 0.1));
        }
    }
    wood.cuboid(
        Vec3::new(-half + 0.15, 0.25, depth - 0.16),
        Vec3::new(half - 0.15, 0.82, depth - 0.13),
        Faces::All,
    );
}

/// The cloth over a stall.
fn awning(cloth: &mut Mesh) {
    let (half, depth, front, rear) = STALL;
    // The roof sags between the beams.
    cloth.patch(28, 14, Vec2::ONE, |u, v| {
        let sag = 0.16 * (PI * u).sin() * (PI * v).sin() + 0.02 * (u * TAU * 4.0).sin() * (PI * v).sin();
        let x = (u * 2.0 - 1.0) * (half + 0.2);
        Vec3::new(x, front + (rear - front) * v - sag + 0.03, depth + 0.25 - (2.0 * depth + 0.4) * v)
    });
    // A scalloped edge hangs down in front.
    cloth.patch(72, 3, Vec2::new(1.0, 0.25), |u, v| {
        let scallop = 0.30 + 0.10 * (u * PI * 9.0).sin().abs();
        let x = (u * 2.0 - 1.0) * (half + 0.2);
        let wave = 0.03 * (u * TAU * 4.5).sin() * (1.0 - v);
        Vec3::new(x, front + 0.03 - scallop * (1.0 - v), depth + 0.25 + wave + 0.02 * (1.0 - v))
    });
}

/// Crates of produce on the table and before it.
fn goods(model: &mut Model) {
    let mut random = Random::new(211);
    let colors = [
        Vec3::new(0.80, 0.28, 0.03),
        Vec3::new(0.55, 0.04, 0.03),
        Vec3::new(0.75, 0.60, 0.05),
        Vec3::new(0.22, 0.36, 0.05),
        Vec3::new(0.25, 0.04, 0.14),
    ];
    for (index, &color) in colors.iter().enumerate() {
        let x = (index as f32 - 2.0) * 0.68;
        let tilt = Mat4::from_translation(Vec3::new(x, 0.98, 0.52)) * Mat4::from_rotation_x(0.28);
        model.append(&crate_of(color, &mut random), tilt);
    }
    for (x, z, degrees) in [(-1.2, 1.75, 20.0), (-0.45, 1.85, -12.0)] {
        let color = colors[if x < -1.0 { 3 } else { 0 }];
        model.place(&crate_of(color, &mut random), Vec3::new(x, 0.0, z), degrees);
    }
}

/// A slatted crate of round fruit, about 0.6 m wide.
fn crate_of(color: Vec3, random: &mut Random) -> Model {
    let mut model = Model::default();
    let wood = model.part(Material::Wood);
    let (half, height) = (Vec2::new(0.29, 0.22), 0.2);
    wood.cuboid(Vec3::new(-half.x, 0.0, -half.y), Vec3::new(half.x, 0.03, half.y), Faces::All);
    for slat in 0..2 {
        let y = 0.03 + slat as f32 * 0.09;
        for z in [-half.y, half.y - 0.02] {
            wood.cuboid(Vec3::new(-half.x, y, z), Vec3::new(half.x, y + 0.07, z + 0.02), Faces::All);
        }
        for x in [-half.x, half.x - 0.02] {
            wood.cuboid(Vec3::new(x, y, -half.y), Vec3::new(x + 0.02, y + 0.07, half.y), Faces::All);
        }
    }
    let fruit = model.part(Material::Produce);
    for row in 0..4 {
        for column in 0..5 {
            let radius = random.range(0.052, 0.066);
            let x = (column as f32 - 2.0) * 0.107 + random.around(0.008);
            let z = (row as f32 - 1.5) * 0.104 + random.around(0.008);
            let bulge = 0.05 * (1.0 - (x / half.x).powi(2)) + random.range(0.0, 0.02);
            fruit.ellipsoid(Vec3::new(x, height - 0.03 + bulge, z), Vec3::splat(radius), 8);
            let ripe = random.range(0.75, 1.2);
            fruit.paint(|_, normal| color * ripe * (0.75 + 0.25 * normal.y));
        }
    }
    model
}

/// The outline of a storage jar with a pointed foot, 1 m high.
const AMPHORA: [(f32, f32); 14] = [
    (0.0, 0.0),
    (0.05, 0.01),
    (0.06, 0.06),
    (0.13, 0.18),
    (0.21, 0.34),
    (0.255, 0.50),
    (0.25, 0.62),
    (0.19, 0.72),
    (0.10, 0.78),
    (0.075, 0.84),
    (0.075, 0.92),
    (0.10, 0.96),
    (0.105, 0.99),
    (0.08, 1.0),
];

/// A plain clay amphora with two handles, 1 m high.
pub fn amphora() -> Model {
    let mut model = Model::default();
    let clay = model.part(Material::Terracotta);
    clay.lathe(&smooth(&AMPHORA, 24), 22);
    handles(clay, 0.08, 0.93, 0.22, 0.66, 0.028);
    model
}

/// Adds two handles from the neck to the shoulder.
fn handles(mesh: &mut Mesh, neck: f32, high: f32, shoulder: f32, low: f32, thickness: f32) {
    for side in [-1.0, 1.0] {
        let path: Vec<Vec3> = (0..=10)
            .map(|step| {
                let t = step as f32 / 10.0;
                let bow = (PI * t).sin() * 0.13 * (1.0 - 0.4 * t);
                Vec3::new(
                    side * (neck + (shoulder - neck) * t * t + bow),
                    high + (low - high) * t + bow * 0.25,
                    0.0,
                )
            })
            .collect();
        mesh.tube(&path, &[thickness; 11], 8);
    }
}

/// Draws a Catmull-Rom curve through the points of an outline.
fn smooth(outline: &[(f32, f32)], count: usize) -> Vec<Vec2> {
    let last = outline.len() - 1;
    let knot = |index: isize| Vec2::from(outline[index.clamp(0, last as isize) as usize]);
    let mut points: Vec<Vec2> = (0..=count)
        .map(|step| {
            let position = step as f32 / count as f32 * last as f32;
            let index = (position as usize).min(last - 1) as isize;
            let t = position - index as f32;
            catmull_rom([knot(index - 1), knot(index), knot(index + 1), knot(index + 2)], t)
        })
        .collect();
    points.iter_mut().for_each(|point| point.x = point.x.max(0.0));
    points
}

/// A large painted vase on a foot, 1.6 m high, and the plinth below it.
pub fn painted_vase() -> Model {
    let mut model = Model::default();
    let outline = [
        (0.30, 0.0),
        (0.31, 0.05),
        (0.20, 0.10),
        (0.16, 0.16),
        (0.26, 0.30),
        (0.42, 0.55),
        (0.52, 0.82),
        (0.53, 1.02),
        (0.44, 1.20),
        (0.29, 1.30),
        (0.25, 1.40),
        (0.30, 1.52),
        (0.40, 1.58),
        (0.42, 1.60),
    ];
    let mut body = Mesh::default();
    body.lathe(&smooth(&outline, 36), 42);
    body.fit_uvs();
    let mut rim = Mesh::default();
    rim.lathe(&[(0.42, 1.60), (0.40, 1.62), (0.35, 1.60), (0.26, 1.48)].map(Vec2::from), 56);
    rim.uvs.iter_mut().for_each(|uv| *uv = Vec2::new(uv.x, 0.02));
    handles(&mut rim, 0.30, 1.5, 0.5, 1.1, 0.045);
    rim.uvs.iter_mut().for_each(|uv| uv.y = 0.02);
    let lift = Mat4::from_translation(Vec3::Y * 0.5);
    model.part(Material::PaintedVase).append(&body, lift).append(&rim, lift);
    let plinth =
        [(0.06, -0.1), (0.06, 0.1), (0.0, 0.14), (0.0, 0.4), (0.05, 0.44), (0.05, 0.5), (-0.42, 0.5)];
    model.part(Material::Marble).moulding(Vec2::splat(0.42), &plinth.map(Vec2::from));
    model
}

/// The bronze brazier on three legs, with embers; the flame is apart.
pub fn brazier() -> Model {
    let mut model = Model::default();
    let bronze = model.part(Material::Bronze);
    let bowl = [
        (0.0, 1.0),
        (0.2, 1.02),
        (0.4, 1.12),
        (0.52, 1.28),
        (0.56, 1.36),
        (0.60, 1.38),
        (0.58, 1.42),
        (0.50, 1.36),
        (0.40, 1.28),
    ];
    bronze.lathe(&bowl.map(Vec2::from), 36);
    for leg in 0..3 {
        let angle = (leg as f32 + 0.25) / 3.0 * TAU;
        let out = Vec3::new(angle.sin(), 0.0, angle.cos());
        let path = [(0.42, 1.2), (0.46, 0.9), (0.34, 0.5), (0.40, 0.15), (0.52, 0.0)]
            .map(|(reach, y)| out * reach + Vec3::Y * (y + LEG));
        bronze.tube(&path, &[0.045, 0.04, 0.032, 0.035, 0.06], 8);
    }
    bronze.lathe(&[(0.36, 0.5), (0.38, 0.53), (0.36, 0.56)].map(Vec2::from), 24);
    let mut random = Random::new(223);
    let embers = model.part(Material::Charcoal);
    for _ in 0..26 {
        let (angle, reach) = (random.unit() * TAU, random.unit().sqrt() * 0.4);
        let centre = Vec3::new(angle.sin() * reach, 1.33 + random.around(0.03), angle.cos() * reach);
        embers.ellipsoid(centre, Vec3::new(0.08, 0.05, 0.07), 6);
    }
    model
}

/// Height of the feet of the brazier above its base.
const LEG: f32 = 0.04;

/// Tongues of flame above the origin.
pub fn flame() -> Model {
    let mut model = Model::default();
    let mesh = model.part(Material::Flame);
    for (x, z, size, lean) in
        [(0.0, 0.0, 1.0, 0.05), (0.16, 0.08, 0.7, 0.12), (-0.15, 0.06, 0.75, -0.1), (0.02, -0.17, 0.65, 0.0)]
    {
        mesh.patch(14, 12, Vec2::ONE, |u, v| {
            let (sin, cos) = (u * TAU).sin_cos();
            let radius = 0.15 * size * (PI * v.powf(0.62)).sin();
            let curl = lean + 0.09 * size * (v * 5.0 + x * 9.0).sin() * v;
            Vec3::new(
                x + radius * sin + curl * v,
                v * 0.8 * size,
                z + radius * cos + 0.05 * v * (v * 7.0).cos(),
            )
        });
    }
    model
}

/// A mast with a gilded ball, `height` high.
pub fn mast(height: f32) -> Model {
    let mut model = Model::default();
    let base = [(0.16, -0.1), (0.16, 0.1), (0.06, 0.22), (-0.2, 0.3)];
    model.part(Material::Marble).moulding(Vec2::splat(0.25), &base.map(Vec2::from));
    model.part(Material::Wood).tube(&[Vec3::Y * 0.1, Vec3::Y * height], &[0.08, 0.05], 12);
    model.part(Material::Gold).ellipsoid(Vec3::Y * (height + 0.1), Vec3::splat(0.13), 16);
    model
}
