//! The square before the temple: pavement, mosaic, fountain, statue, gate and portico.

use super::elements::{Slope, arched_wall, smooth_column};
use super::materials::{Material, Model};
use super::mesh::{Faces, Mesh};
use super::noise::{catmull_rom, smoothstep};
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Half the size of the paved square, and its centre in z.
pub const HALF: Vec2 = Vec2::new(15.5, 13.0);
/// Position of the middle of the square, in z.
pub const CENTRE_Z: f32 = 15.5;
/// Height of the paving above the streets.
pub const LEVEL: f32 = 0.12;

/// The paving with its kerb, the mosaic in the middle, and the cobbled streets about it.
pub fn pavement() -> Model {
    let mut model = Model::default();
    let mut slab = Mesh::default();
    slab.moulding(HALF, &[(0.0, -0.1), (0.0, LEVEL), (-0.45, LEVEL)].map(Vec2::from));
    model.part(Material::MarbleBlocks).append(&slab, Mat4::from_translation(Vec3::Z * CENTRE_Z));
    let flat = |half: Vec2, y: f32, centre: f32| {
        [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
            .map(|(x, z)| Vec3::new(half.x * x, y, centre + half.y * z))
    };
    // In pieces, so that no triangle reaches from one end of the picture to the other.
    let (pieces, inner) = (6, HALF - 0.45);
    let at = |x: i32, z: i32| {
        let step = Vec2::new(x as f32, z as f32) / pieces as f32 * 2.0 - 1.0;
        Vec3::new(inner.x * step.x, LEVEL, CENTRE_Z + inner.y * step.y)
    };
    for z in 0..pieces {
        for x in 0..pieces {
            let corners = [at(x, z + 1), at(x + 1, z + 1), at(x + 1, z), at(x, z)];
            model.part(Material::Paving).face(&corners);
        }
    }
    model.part(Material::Cobbles).face(&flat(Vec2::new(27.0, 33.0), 0.0, 0.0));
    let mosaic = Vec2::splat(3.9);
    let frame: Vec<Vec2> = [(0.28, -0.02), (0.26, 0.035), (0.0, 0.035)].map(Vec2::from).to_vec();
    let mut border = Mesh::default();
    border.moulding(mosaic, &frame);
    let lift = Mat4::from_translation(Vec3::new(-2.6, LEVEL, 10.8));
    model.part(Material::Marble).append(&border, lift);
    let mut carpet = Mesh::default();
    carpet.picture(flat(mosaic, 0.034, 0.0));
    model.part(Material::Mosaic).append(&carpet, lift);
    model
}

/// A round basin with a pedestal, a hemispherical bowl, and a ball on top.
pub fn fountain() -> Model {
    let mut model = Model::default();
    let marble = model.part(Material::Marble);
    let points = |list: &[(f32, f32)]| -> Vec<Vec2> { list.iter().copied().map(Vec2::from).collect() };
    marble.lathe(&points(&[(2.75, -0.1), (2.75, 0.16), (2.35, 0.16)]), 48);
    let mut basin =
        points(&[(2.35, 0.16), (2.35, 0.26), (2.22, 0.30), (2.18, 0.34), (2.18, 0.70), (2.24, 0.76)]);
    // A rounded rim.
    basin.extend((0..=8).map(|step| {
        let angle = PI * (0.0 + step as f32 / 8.0);
        Vec2::new(2.20 + 0.14 * angle.cos(), 0.84 + 0.07 * angle.sin())
    }));
    basin.extend(points(&[(2.04, 0.2)]));
    marble.lathe(&basin, 56);
    let mut pedestal = points(&[
        (0.52, 0.2),
        (0.52, 0.7),
        (0.44, 0.74),
        (0.30, 0.95),
        (0.22, 1.2),
        (0.24, 1.35),
        (0.34, 1.42),
    ]);
    pedestal.extend(points(&[(0.34, 1.46), (0.24, 1.5)]));
    marble.lathe(&pedestal, 32);
    // The bowl: a hemisphere outside, a shallower curve inside.
    let mut bowl: Vec<Vec2> = (0..=12)
        .map(|step| {
            let angle = PI / 2.0 * (step as f32 / 12.0);
            Vec2::new(0.22 + 0.86 * angle.sin(), 2.1 - 0.62 * angle.cos())
        })
        .collect();
    bowl.extend(points(&[(1.14, 2.12), (1.14, 2.17), (1.02, 2.17), (0.98, 2.05)]));
    marble.lathe(&bowl, 48);
    marble
        .lathe(&points(&[(0.2, 2.0), (0.16, 2.25), (0.12, 2.45), (0.2, 2.52), (0.2, 2.56), (0.1, 2.6)]), 24);
    model.part(Material::Bronze).ellipsoid(Vec3::Y * 2.84, Vec3::splat(0.27), 32);
    let water = model.part(Material::Water);
    water.lathe(&points(&[(2.08, 0.66), (0.0, 0.66)]), 48);
    water.lathe(&points(&[(1.0, 2.12), (0.0, 2.12)]), 40);
    // Water that runs over the rim of the bowl in arcs.
    for jet in 0..8 {
        let angle = (jet as f32 + 0.5) / 8.0 * TAU;
        let out = Vec3::new(angle.sin(), 0.0, angle.cos());
        let path: Vec<Vec3> = (0..=9)
            .map(|step| {
                let t = step as f32 / 9.0;
                out * (1.10 + 0.45 * t) + Vec3::Y * (2.18 + 0.10 * t - 1.62 * t * t)
            })
            .collect();
        let radii: Vec<f32> = (0..=9).map(|step| 0.03 + 0.012 * (step as f32 / 9.0)).collect();
        model.part(Material::Spray).tube(&path, &radii, 7);
    }
    model
}

/// A round stone bench about a bed of earth, for a tree that stands in the square.
pub fn planter() -> Model {
    let mut model = Model::default();
    let outline = [
        (1.3, -0.1),
        (1.3, 0.08),
        (1.18, 0.1),
        (1.18, 0.36),
        (1.3, 0.42),
        (1.3, 0.5),
        (0.92, 0.5),
        (0.92, 0.3),
    ];
    model.part(Material::Marble).lathe(&outline.map(Vec2::from), 40);
    let mut bed = Mesh::default();
    bed.lathe(&[(0.95, 0.38), (0.0, 0.46)].map(Vec2::from), 24);
    model.part(Material::Earth).append(&bed, Mat4::IDENTITY);
    model
}

/// A draped figure on a plinth, made of one smooth patch with folds, a head and arms.
pub fn statue() -> Model {
    let mut model = Model::default();
    let plinth = [
        (0.12, -0.05),
        (0.12, 0.2),
        (0.06, 0.26),
        (0.0, 0.3),
        (0.0, 1.25),
        (0.05, 1.3),
        (0.12, 1.36),
        (0.12, 1.5),
        (-0.58, 1.5),
    ];
    model.part(Material::MarbleBlocks).moulding(Vec2::splat(0.58), &plinth.map(Vec2::from));
    let marble = model.part(Material::Marble);
    drapery(marble);
    head(marble);
    arms(marble);
    // A staff in the raised hand, a bowl in the other.
    let bronze = model.part(Material::Bronze);
    bronze.tube(
        &[Vec3::new(0.46, PLINTH + 0.0, 0.46), Vec3::new(0.46, PLINTH + 2.55, 0.42)],
        &[0.022, 0.02],
        8,
    );
    bronze.ellipsoid(Vec3::new(0.46, PLINTH + 2.62, 0.42), Vec3::new(0.05, 0.13, 0.05), 10);
    model
}

/// Height of the plinth of the statue.
const PLINTH: f32 = 1.5;

/// Half widths across and along the body at heights from the hem to the neck.
const BODY: [(f32, f32, f32); 12] = [
    (0.00, 0.36, 0.33),
    (0.10, 0.34, 0.30),
    (0.45, 0.29, 0.26),
    (0.80, 0.29, 0.25),
    (1.02, 0.31, 0.26),
    (1.25, 0.235, 0.19),
    (1.42, 0.26, 0.215),
    (1.60, 0.31, 0.225),
    (1.72, 0.33, 0.18),
    (1.80, 0.24, 0.13),
    (1.85, 0.10, 0.095),
    (2.00, 0.075, 0.08),
];

/// Half widths of the body at a height: a Catmull-Rom curve through those of [`BODY`].
fn profile(height: f32) -> Vec2 {
    let index = BODY.iter().rposition(|knot| knot.0 <= height).unwrap_or(0).min(BODY.len() - 2);
    let knot = |offset: isize| BODY[(index as isize + offset).clamp(0, BODY.len() as isize - 1) as usize];
    let (p0, p1, p2, p3) = (knot(-1), knot(0), knot(1), knot(2));
    let t = (height - p1.0) / (p2.0 - p1.0);
    catmull_rom([p0, p1, p2, p3].map(|knot| Vec2::new(knot.1, knot.2)), t)
}

/// The body under its clothes.
fn drapery(marble: &mut Mesh) {
    marble.patch(78, 54, Vec2::new(2.0, 2.2), |u, v| {
        let (angle, height) = (u * TAU, v * 2.0);
        let half = profile(height);
        let hem = smoothstep(1.45, 0.2, height);
        // Folds fall from the hips; across the chest they hang in arcs.
        let falling = (angle * 13.0 + (angle * 2.0).sin() * 1.2 + height * 0.6).sin() * 0.045 * hem;
        let arcs = ((height * 26.0 + (angle.cos() * 1.6).powi(2) * 2.0).sin() * 0.012)
            * smoothstep(1.2, 1.35, height)
            * smoothstep(1.75, 1.6, height);
        let fold = 1.0 + falling * 2.2 + arcs * 2.0;
        // The weight rests on one leg.
        let sway = 0.05 * (height * 1.7).sin();
        Vec3::new(angle.sin() * half.x * fold + sway, PLINTH + height, angle.cos() * half.y * fold)
    });
}

/// The head with its hair.
fn head(marble: &mut Mesh) {
    let sway = 0.05 * (2.0_f32 * 1.7).sin();
    marble.ellipsoid(Vec3::new(sway, PLINTH + 2.12, 0.02), Vec3::new(0.115, 0.155, 0.135), 24);
    marble.ellipsoid(Vec3::new(sway, PLINTH + 2.17, -0.06), Vec3::new(0.135, 0.13, 0.14), 20);
    marble.ellipsoid(Vec3::new(sway, PLINTH + 2.15, -0.2), Vec3::new(0.07, 0.07, 0.08), 14);
}

/// The arms with their hands, one of them raised.
fn arms(marble: &mut Mesh) {
    let mut limb = |path: &[(f32, f32, f32)], radii: &[f32]| {
        let path: Vec<Vec3> = path.iter().map(|&(x, y, z)| Vec3::new(x, PLINTH + y, z)).collect();
        marble.tube(&path, radii, 12);
        if let (Some(&end), Some(&radius)) = (path.last(), radii.last()) {
            marble.ellipsoid(end, Vec3::splat(radius * 1.35), 12);
        }
    };
    limb(
        &[
            (0.24, 1.70, 0.0),
            (0.37, 1.60, 0.03),
            (0.45, 1.49, 0.10),
            (0.48, 1.48, 0.22),
            (0.48, 1.58, 0.33),
            (0.46, 1.80, 0.42),
        ],
        &[0.11, 0.10, 0.085, 0.075, 0.06, 0.045],
    );
    limb(
        &[
            (-0.22, 1.70, 0.0),
            (-0.34, 1.58, 0.0),
            (-0.38, 1.35, -0.02),
            (-0.37, 1.15, 0.05),
            (-0.34, 1.02, 0.14),
        ],
        &[0.11, 0.10, 0.08, 0.065, 0.05],
    );
}

/// An arched gate with a cornice and battlements; it stands about the origin and faces z.
pub fn gate() -> Model {
    let mut model = Model::default();
    let size = Vec2::new(7.6, 6.6);
    let stone = model.part(Material::Ashlar);
    arched_wall(stone, size, 1.6, 3.4, 3.0);
    let trim = [(0.0, 0.0), (0.1, 0.05), (0.1, 0.2), (0.25, 0.3), (0.25, 0.45), (-0.3, 0.45)];
    let mut cornice = Mesh::default();
    cornice.moulding(Vec2::new(size.x / 2.0, 0.8), &trim.map(Vec2::from));
    model.part(Material::Marble).append(&cornice, Mat4::from_translation(Vec3::Y * size.y));
    let top = size.y + 0.45;
    let stone = model.part(Material::Ashlar);
    stone.cuboid(Vec3::new(-3.8, top - 0.2, -0.75), Vec3::new(3.8, top + 0.02, 0.75), Faces::Standing);
    battlements(stone, -3.8, 3.8, top, 0.55);
    for x in [-2.75, 2.75] {
        for z in [-1.0, 1.0] {
            let column = smooth_column(5.6, 0.3);
            let marble = model.part(Material::Marble);
            marble.append(&column, Mat4::from_translation(Vec3::new(x, 0.6, z * 1.25)));
            marble.block(x, -0.1, z * 1.2, Vec3::new(1.05, 0.7, 1.0));
            marble.block(x, 6.2, z * 1.15, Vec3::new(0.95, 0.4, 0.8));
        }
    }
    model
}

/// A town wall along x, `length` long, with battlements.
pub fn town_wall(length: f32) -> Model {
    let mut model = Model::default();
    let stone = model.part(Material::Ashlar);
    stone.cuboid(Vec3::new(0.0, -1.0, -0.5), Vec3::new(length, 4.6, 0.5), Faces::Standing);
    stone.cuboid(Vec3::new(0.0, 4.45, 0.5), Vec3::new(length, 4.6, 0.62), Faces::All);
    battlements(stone, 0.0, length, 4.6, 0.22);
    model
}

/// Adds a row of battlements.
fn battlements(mesh: &mut Mesh, from: f32, to: f32, y: f32, z: f32) {
    let count = ((to - from) / 1.3).round();
    let step = (to - from) / count;
    for index in 0..count as usize {
        let x = from + (index as f32 + 0.5) * step;
        mesh.block(x, y, z, Vec3::new(step * 0.56, 0.75, 0.4));
        mesh.block(x, y + 0.75, z, Vec3::new(step * 0.62, 0.1, 0.5));
    }
}

/// A portico along x that faces +z: columns, a painted back wall and a lean-to roof. Its columns
/// are placed apart; see [`portico_columns`].
pub fn portico(length: f32) -> Model {
    let mut model = Model::default();
    let depth = PORTICO.0;
    let half = length / 2.0;
    let steps = [(0.35, -0.1), (0.35, 0.2), (0.0, 0.2), (0.0, 0.4), (-0.5, 0.4)];
    let mut base = Mesh::default();
    base.moulding(Vec2::new(half, depth / 2.0 + 0.2), &steps.map(Vec2::from));
    base.face(
        &[(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
            .map(|(x, z)| Vec3::new(half * x, 0.4, (depth / 2.0 + 0.2) * z)),
    );
    model.part(Material::MarbleBlocks).append(&base, Mat4::IDENTITY);
    painted_wall(&mut model, length);
    lean_to(&mut model, length);
    model
}

/// Depth of a portico, and height of its columns.
const PORTICO: (f32, f32) = (4.0, 4.0);

/// The back wall of a portico with its painted panels.
fn painted_wall(model: &mut Model, length: f32) {
    let (half, back) = (length / 2.0, -PORTICO.0 / 2.0);
    model.part(Material::PlasterWhite).cuboid(
        Vec3::new(-half, 0.3, back - 0.4),
        Vec3::new(half, 5.9, back - 0.02),
        Faces::Sides,
    );
    for (low, high, paint) in [(0.4, 1.7, Material::PlasterRed), (1.7, 3.5, Material::PlasterOchre)] {
        let (low, high) = (Vec3::new(-half + 0.3, low, back - 0.1), Vec3::new(half - 0.3, high, back));
        model.part(paint).cuboid(low, high, Faces::Standing);
    }
    for index in 0..8 {
        // Painted panels between the columns.
        let x = (index as f32 + 0.5) / 8.0 * (length - 0.9) - half + 0.45;
        let (low, high) = (Vec3::new(x - 0.8, 1.95, back - 0.1), Vec3::new(x + 0.8, 3.2, back + 0.012));
        model.part(Material::PlasterRed).cuboid(low, high, Faces::Standing);
        let inset = Vec3::new(0.07, 0.07, -0.004);
        model.part(Material::PlasterWhite).cuboid(low + inset, high - inset, Faces::Standing);
        let inset = Vec3::new(0.12, 0.12, -0.008);
        model.part(Material::PlasterBlue).cuboid(low + inset, high - inset, Faces::Standing);
    }
    model.part(Material::PlasterBlue).cuboid(
        Vec3::new(-half + 0.3, 1.66, back - 0.1),
        Vec3::new(half - 0.3, 1.78, back + 0.02),
        Faces::All,
    );
}

/// The entablature of a portico, the roof behind it, and the walls that close its ends.
fn lean_to(model: &mut Model, length: f32) {
    let (depth, height) = PORTICO;
    let (half, back) = (length / 2.0, -depth / 2.0);
    let front = depth / 2.0 - 0.3;
    let marble = model.part(Material::Marble);
    marble.cuboid(Vec3::new(-half, 0.4 + height, front - 0.3), Vec3::new(half, 4.9, front + 0.3), Faces::All);
    marble.cuboid(Vec3::new(-half, 4.9, front - 0.36), Vec3::new(half, 5.02, front + 0.42), Faces::All);
    let ridge = Vec3::new(-half - 0.3, 6.35, back - 0.5);
    let slope = Slope {
        ridge,
        along: Vec3::X * (length + 0.6),
        down: Vec3::new(0.0, 5.0 - 6.35 + 0.06, front + 0.75 - (back - 0.5)),
        tile: Vec2::new(0.32, 0.45),
    };
    slope.tiles(model.part(Material::RoofTiles));
    slope.underside(model.part(Material::Wood), 0.06);
    // Close the back and the ends below the roof.
    for side in [-1.0, 1.0] {
        let (x0, x1) = (side * half, side * (half - 0.35));
        let mut end = Mesh::default();
        let outline = [(0.0, 0.4), (0.5, 0.4), (0.5, 5.8), (0.0, 5.95)].map(Vec2::from);
        end.prism(&outline, 0.35);
        let turn =
            Mat4::from_translation(Vec3::new(x0.min(x1), 0.0, back + 0.45)) * Mat4::from_rotation_y(PI / 2.0);
        model.part(Material::PlasterWhite).append(&end, turn);
    }
}

/// Places of the columns of a portico, in its own coordinates.
pub fn portico_columns(length: f32) -> Vec<Vec3> {
    let count = (length / 2.6).round();
    (0..=count as usize)
        .map(|index| Vec3::new((index as f32 / count - 0.5) * (length - 0.9), 0.4, 1.7))
        .collect()
}
