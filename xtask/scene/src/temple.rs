//! The temple: Doric, six by ten fluted columns around a walled cella, on three steps.
//!
//! It stands about the origin with its front towards +z. The proportions are those of the fifth
//! century: a column is five and a half lower diameters high, a triglyph stands over every column
//! and every gap, the gable rises one in four.

use super::elements::{Opening, Slope, wall};
use super::materials::{Material, Model};
use super::mesh::{Faces, Mesh};
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Distance between the axes of columns.
const SPACING: f32 = 2.3;
/// Columns at the front and along the side.
const FRONT: usize = 6;
const SIDE: usize = 10;
/// Height of the platform, of a column, and of what the columns carry.
const PLATFORM: f32 = 1.14;
/// Height of a column.
pub const COLUMN: f32 = 5.9;
const ENTABLATURE: f32 = 2.06;
/// Half the thickness of the architrave.
const BEAM: f32 = 0.42;
/// Rise of the roof over its run.
const PITCH: f32 = 0.25;

/// Half the distance between the axes of the corner columns.
fn axes() -> Vec2 {
    Vec2::new((FRONT - 1) as f32, (SIDE - 1) as f32) * SPACING / 2.0
}

/// Places of the columns.
pub fn columns() -> Vec<Vec3> {
    let half = axes();
    let at =
        |x: usize, z: usize| Vec3::new(x as f32 * SPACING - half.x, PLATFORM, half.y - z as f32 * SPACING);
    let mut places = Vec::new();
    for x in 0..FRONT {
        places.extend([at(x, 0), at(x, SIDE - 1)]);
    }
    for z in 1..SIDE - 1 {
        places.extend([at(0, z), at(FRONT - 1, z)]);
    }
    // Two between the ends of the cella's walls.
    places.extend([at(2, 1) - Vec3::Z * 0.9, at(3, 1) - Vec3::Z * 0.9]);
    places
}

/// The temple without its columns.
pub fn temple() -> Model {
    let mut model = Model::default();
    platform(&mut model);
    entablature(&mut model);
    frieze(&mut model);
    cella(&mut model);
    roof(&mut model);
    for turn in [0.0, 180.0] {
        model.place(&gable(), Vec3::ZERO, turn);
    }
    model
}

/// The stepped platform, with half steps at the middle of the front.
fn platform(model: &mut Model) {
    let half = axes() + 0.75;
    let stone = model.part(Material::MarbleBlocks);
    let (rise, tread) = (PLATFORM / 3.0, 0.42);
    let mut profile = Vec::new();
    for step in 0..3 {
        let outset = tread * (2 - step) as f32;
        let y = rise * step as f32;
        profile.push(Vec2::new(outset - 0.03, if step == 0 { -0.3 } else { y }));
        profile.extend([
            Vec2::new(outset - 0.03, y + rise - 0.07),
            Vec2::new(outset, y + rise - 0.05),
            Vec2::new(outset, y + rise),
        ]);
    }
    stone.moulding(half, &profile);
    stone.face(
        &[(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
            .map(|(x, z)| Vec3::new(half.x * x, PLATFORM, half.y * z)),
    );
    for step in 0..3 {
        let back = half.y + tread * (2 - step) as f32 - 0.03;
        let low = rise * step as f32 - if step == 0 { 0.2 } else { 0.0 };
        let high = rise * (step as f32 + 0.5);
        stone.cuboid(Vec3::new(-2.0, low, back), Vec3::new(2.0, high, back + tread / 2.0), Faces::Standing);
    }
}

/// Architrave, frieze and cornice, with their inner faces and the ceiling.
fn entablature(model: &mut Model) {
    let half = axes() + BEAM;
    let base = PLATFORM + COLUMN;
    let outline = |points: &[(f32, f32)]| -> Vec<Vec2> {
        points.iter().map(|&(outset, y)| Vec2::new(outset, base + y)).collect()
    };
    let outside = outline(&[
        (0.0, 0.0),
        (0.0, 0.70),
        (0.06, 0.70),
        (0.06, 0.79),
        (0.0, 0.79),
        (0.0, 1.58),
        (0.07, 1.58),
        (0.07, 1.66),
        (0.10, 1.80),
        (0.46, 1.74),
        (0.46, 1.92),
        (0.49, 1.94),
        (0.54, 2.02),
        (0.54, ENTABLATURE),
        (-0.5, ENTABLATURE),
    ]);
    let inside = outline(&[(-2.0 * BEAM, 1.4), (-2.0 * BEAM, 0.0), (0.0, 0.0)]);
    model.part(Material::Marble).moulding(half, &outside).moulding(half, &inside);
    let inner = axes() - BEAM + 0.05;
    let ceiling = base + 1.3;
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, z)| Vec3::new(inner.x * x, ceiling, inner.y * z));
    model.part(Material::PlasterBlue).face(&corners);
    let beams = SIDE * 2 - 1;
    for index in 0..beams {
        let z = (index as f32 / (beams - 1) as f32 * 2.0 - 1.0) * (inner.y - 0.25);
        model.part(Material::Wood).cuboid(
            Vec3::new(-inner.x, ceiling - 0.3, z - 0.12),
            Vec3::new(inner.x, ceiling, z + 0.12),
            Faces::All,
        );
    }
    // Dentils under the cornice.
    let dentil = Vec3::new(0.13, 0.12, 0.13);
    for (length, side_distance, turn) in sides() {
        let count = (length / 0.24) as usize;
        for index in 0..=count {
            let x = (index as f32 / count as f32 - 0.5) * (length + 0.2);
            let mut block = Mesh::default();
            block.block(x, base + 1.66, side_distance + 0.13, dentil);
            model.part(Material::Marble).append(&block, Mat4::from_rotation_y(turn));
        }
    }
}

/// The sides of the entablature: length between the corners, distance from the centre, and the turn
/// that brings +z there.
fn sides() -> [(f32, f32, f32); 4] {
    let half = axes() + BEAM;
    let (front, side) = ((half.x * 2.0, half.y), (half.y * 2.0, half.x));
    [(front.0, front.1, 0.0), (side.0, side.1, PI / 2.0), (front.0, front.1, PI), (side.0, side.1, -PI / 2.0)]
}

/// Triglyphs, metopes with shields, and the drops below the triglyphs.
fn frieze(model: &mut Model) {
    let base = PLATFORM + COLUMN;
    let triglyph = triglyph();
    let mut shield = Model::default();
    let disc = [(0.27, 0.0), (0.27, 0.03), (0.21, 0.05), (0.20, 0.03), (0.06, 0.10), (0.0, 0.11)];
    let mut round = Mesh::default();
    round.lathe(&disc.map(Vec2::from), 20);
    shield.part(Material::Gold).append(&round, Mat4::from_rotation_x(PI / 2.0));
    for (index, (length, distance, turn)) in sides().into_iter().enumerate() {
        let bays = if index % 2 == 0 { FRONT - 1 } else { SIDE - 1 } * 2;
        let step = (length - 0.56) / bays as f32;
        let turned = Mat4::from_rotation_y(turn);
        for bay in 0..=bays {
            let x = bay as f32 * step - (length - 0.56) / 2.0;
            model.append(&triglyph, turned * Mat4::from_translation(Vec3::new(x, base, distance)));
            if bay < bays {
                let (left, right) = (x + 0.28, x + step - 0.28);
                let mut panel = Mesh::default();
                panel.cuboid(
                    Vec3::new(left, base + 0.79, distance),
                    Vec3::new(right, base + 1.58, distance + 0.012),
                    Faces::Sides,
                );
                model.part(Material::PlasterRed).append(&panel, turned);
                let centre = Vec3::new((left + right) / 2.0, base + 1.185, distance + 0.012);
                model.append(&shield, turned * Mat4::from_translation(centre));
            }
        }
    }
}

/// One triglyph: three bars with bevelled edges under a band; below the taenia a strip with drops.
fn triglyph() -> Model {
    let mut model = Model::default();
    let paint = model.part(Material::PlasterBlue);
    let (foot, head, front) = (0.79, 1.50, 0.075);
    for bar in 0..3 {
        let x = (bar as f32 - 1.0) * 0.19;
        let section = [(-0.095, 0.01), (-0.05, front), (0.05, front), (0.095, 0.01)];
        for pair in section.windows(2) {
            let point = |(dx, z): (f32, f32), y: f32| Vec3::new(x + dx, y, z);
            paint.face(&[
                point(pair[0], foot),
                point(pair[1], foot),
                point(pair[1], head),
                point(pair[0], head),
            ]);
        }
    }
    paint.cuboid(Vec3::new(-0.285, head, 0.0), Vec3::new(0.285, 1.58, front + 0.012), Faces::All);
    let marble = model.part(Material::Marble);
    marble.cuboid(Vec3::new(-0.28, 0.64, 0.0), Vec3::new(0.28, 0.70, 0.055), Faces::All);
    for drop in 0..6 {
        let mut cone = Mesh::default();
        cone.lathe(&[Vec2::new(0.0, 0.0), Vec2::new(0.034, 0.0), Vec2::new(0.024, 0.06)], 7);
        let x = (drop as f32 - 2.5) * 0.096;
        marble.append(&cone, Mat4::from_translation(Vec3::new(x, 0.58, 0.034)));
    }
    model
}

/// The walled room, open to the front between the ends of its side walls.
fn cella(model: &mut Model) {
    let (half, porch, back) = (Vec2::new(3.45, 7.9), 5.3, 0.45);
    let height = COLUMN + 1.3;
    let base = Mat4::from_translation(Vec3::Y * PLATFORM);
    let stone = model.part(Material::MarbleBlocks);
    for side in [-1.0, 1.0] {
        let (a, b) = (side * half.x, side * (half.x - back));
        let mut flank = Mesh::default();
        flank.cuboid(Vec3::new(a.min(b), 0.0, -half.y), Vec3::new(a.max(b), height, half.y), Faces::Sides);
        // The end of the wall is thickened into a pilaster.
        flank.block(side * (half.x - back / 2.0), 0.0, half.y - 0.3, Vec3::new(0.62, height - 0.55, 0.75));
        flank.block(side * (half.x - back / 2.0), height - 1.55, half.y - 0.3, Vec3::new(0.78, 0.2, 0.9));
        stone.append(&flank, base);
    }
    let mut rear = Mesh::default();
    rear.cuboid(
        Vec3::new(-half.x, 0.0, -half.y - 0.01),
        Vec3::new(half.x, height, -half.y + back),
        Faces::Sides,
    );
    stone.append(&rear, base);
    let width = (half.x - back) * 2.0;
    let door = Opening::centred(width / 2.0, 0.0, 2.2, 4.6);
    let mut front = Model::default();
    wall(&mut front, Vec2::new(width, height), &[door], 0.5, &[], Material::MarbleBlocks);
    let frame = front.part(Material::Marble);
    for x in [-1.25, 1.25] {
        frame.block(width / 2.0 + x, 0.0, 0.05, Vec3::new(0.3, 4.75, 0.22));
    }
    frame.block(width / 2.0, 4.6, 0.07, Vec3::new(3.0, 0.32, 0.28));
    frame.block(width / 2.0, 4.92, 0.11, Vec3::new(3.3, 0.16, 0.4));
    model.append(&front, Mat4::from_translation(Vec3::new(-width / 2.0, PLATFORM, porch)));
    // Leaves of the door, open inwards before the darkness.
    for side in [-1.0, 1.0] {
        let mut leaf = Mesh::default();
        leaf.cuboid(Vec3::new(0.0, 0.05, -0.06), Vec3::new(1.05, 4.55, 0.0), Faces::All);
        for (x, y) in [(0.28, 0.4), (0.78, 0.4), (0.28, 2.5), (0.78, 2.5)] {
            leaf.cuboid(Vec3::new(x - 0.18, y, 0.0), Vec3::new(x + 0.18, y + 1.7, 0.04), Faces::All);
        }
        let hinge = Mat4::from_translation(Vec3::new(side * 1.08, PLATFORM, porch - 0.5))
            * Mat4::from_scale(Vec3::new(-side, 1.0, 1.0))
            * Mat4::from_rotation_y(1.35);
        model.part(Material::Bronze).append(&leaf, hinge);
    }
    let dark = model.part(Material::Dark);
    let deep = porch - 2.2;
    dark.cuboid(Vec3::new(-1.6, PLATFORM, deep - 0.05), Vec3::new(1.6, PLATFORM + 5.0, deep), Faces::Sides);
    for side in [-1.6, 1.6] {
        let mut side_wall = Mesh::default();
        side_wall.cuboid(Vec3::new(-0.03, 0.0, deep), Vec3::new(0.03, 5.0, porch - 0.5), Faces::All);
        dark.append(&side_wall, Mat4::from_translation(Vec3::new(side, PLATFORM, 0.0)));
    }
}

/// The tiled roof with its ridge and the antefixes along the eaves.
fn roof(model: &mut Model) {
    let half = axes() + BEAM;
    let run = half.x + 0.62;
    let base = PLATFORM + COLUMN + ENTABLATURE;
    let (eave, length) = (base + 0.16, (half.y + 0.50) * 2.0);
    let ridge = eave + run * PITCH;
    for side in [-1.0, 1.0] {
        let slope = Slope {
            ridge: Vec3::new(0.0, ridge, side * length / 2.0),
            along: Vec3::new(0.0, 0.0, -side * length),
            down: Vec3::new(side * run, eave - ridge, 0.0),
            tile: Vec2::new(0.55, 0.72),
        };
        slope.tiles(model.part(Material::RoofTiles));
        slope.underside(model.part(Material::Wood), 0.05);
        let count = (length / 0.55).round() as usize;
        for index in 0..count {
            let z = ((index as f32 + 0.73) / count as f32 - 0.5) * -side * length;
            let turn = Mat4::from_translation(Vec3::new(side * (run + 0.01), eave - 0.04, z))
                * Mat4::from_rotation_y(side * PI / 2.0);
            model.part(Material::Marble).append(&antefix(), turn);
        }
        // The gutter that the antefixes stand on.
        model.part(Material::Marble).cuboid(
            Vec3::new((side * (run - 0.35)).min(side * run), base - 0.02, -length / 2.0),
            Vec3::new((side * (run - 0.35)).max(side * run), eave - 0.03, length / 2.0),
            Faces::All,
        );
    }
    let points: Vec<Vec3> =
        (0..=1).map(|end| Vec3::new(0.0, ridge + 0.02, (end as f32 - 0.5) * length)).collect();
    model.part(Material::RoofTiles).tube(&points, &[0.2, 0.2], 12);
}

/// The upright ornament at the end of a row of cover tiles; it faces +z.
fn antefix() -> Mesh {
    let mut mesh = Mesh::default();
    let outline: Vec<Vec2> =
        [(0.11, 0.0), (0.14, 0.14), (0.09, 0.25), (0.0, 0.31), (-0.09, 0.25), (-0.14, 0.14), (-0.11, 0.0)]
            .map(Vec2::from)
            .to_vec();
    mesh.prism(&outline, 0.05);
    mesh
}

/// The front gable: its wall with a relief, the raking cornices, and the ornaments on its corners.
fn gable() -> Model {
    let mut model = Model::default();
    let half = axes() + BEAM;
    let run = half.x + 0.66;
    let base = PLATFORM + COLUMN + ENTABLATURE;
    let rise = run * PITCH;
    let plane = half.y + 0.02;
    let corners = [(-half.x, 0.0), (half.x, 0.0), (0.0, half.x * PITCH)];
    model.part(Material::PlasterBlue).face(&corners.map(|(x, y)| Vec3::new(x, base + y + 0.02, plane)));
    for side in [-1.0, 1.0] {
        // Each course of the raking cornice projects beyond the one below.
        for (low, high, depth) in [(-0.16, 0.06, 0.34), (0.06, 0.24, 0.58), (0.24, 0.36, 0.68)] {
            let mut outline =
                [(0.0, rise + low), (run, low.max(0.0)), (run, high), (0.0, rise + high)].map(Vec2::from);
            if low < 0.0 {
                // It is cut off where it meets the horizontal cornice.
                outline[1].x = run + low / PITCH;
            }
            if side < 0.0 {
                outline.iter_mut().for_each(|point| point.x = -point.x);
                outline.reverse();
            }
            let mut course = Mesh::default();
            course.prism(&outline, depth + 0.02);
            model
                .part(Material::Marble)
                .append(&course, Mat4::from_translation(Vec3::new(0.0, base, plane - 0.02)));
        }
        let corner = Vec3::new(side * (run - 0.2), base + 0.34, plane + 0.3);
        model.append(&palmette(), Mat4::from_translation(corner) * Mat4::from_scale(Vec3::splat(0.62)));
    }
    let apex = Vec3::new(0.0, base + rise + 0.32, plane + 0.3);
    model.append(&palmette(), Mat4::from_translation(apex));
    relief(&mut model, Vec3::new(0.0, base, plane));
    model
}

/// A gilded fan of leaves over two scrolls; it faces +z.
fn palmette() -> Model {
    let mut model = Model::default();
    let gold = model.part(Material::Gold);
    for leaf in 0..7 {
        let angle = (leaf as f32 - 3.0) * 0.42;
        let length = 0.50 - 0.03 * (leaf as f32 - 3.0).abs();
        let mut petal = Mesh::default();
        petal.ellipsoid(Vec3::Y * length, Vec3::new(0.085, length * 0.62, 0.06), 10);
        let turn = Mat4::from_translation(Vec3::Y * 0.22) * Mat4::from_rotation_z(angle);
        gold.append(&petal, turn);
    }
    gold.ellipsoid(Vec3::Y * 0.25, Vec3::new(0.12, 0.12, 0.1), 12);
    for side in [-1.0, 1.0] {
        spiral(gold, Vec3::new(side * 0.24, 0.14, 0.0), 0.15, side, 0.05);
    }
    gold.block(0.0, -0.1, 0.0, Vec3::new(0.62, 0.16, 0.22));
    model
}

/// Adds a scroll: a tube that winds towards its centre, in the xy plane.
fn spiral(mesh: &mut Mesh, centre: Vec3, radius: f32, side: f32, thickness: f32) {
    const STEPS: usize = 28;
    let turns = 1.75;
    let along = |step: usize| step as f32 / STEPS as f32;
    let path: Vec<Vec3> = (0..=STEPS)
        .map(|step| {
            let angle = along(step) * turns * TAU;
            let reach = radius * (1.0 - 0.85 * along(step));
            centre + Vec3::new(-side * angle.cos(), -angle.sin(), 0.0) * reach
        })
        .collect();
    let radii: Vec<f32> = (0..=STEPS).map(|step| thickness * (1.0 - 0.6 * along(step))).collect();
    mesh.tube(&path, &radii, 7);
}

/// The relief of the gable: a shield between scrolls that shrink into the corners.
fn relief(model: &mut Model, base: Vec3) {
    let gold = model.part(Material::Gold);
    let disc =
        [(0.62, 0.0), (0.62, 0.08), (0.54, 0.14), (0.50, 0.09), (0.26, 0.13), (0.20, 0.20), (0.0, 0.27)];
    let mut shield = Mesh::default();
    shield.lathe(&disc.map(Vec2::from), 40);
    let centre = base + Vec3::new(0.0, 0.74, 0.0);
    gold.append(&shield, Mat4::from_translation(centre) * Mat4::from_rotation_x(PI / 2.0));
    for petal in 0..12 {
        let mut leaf = Mesh::default();
        leaf.ellipsoid(Vec3::new(0.0, 0.37, 0.10), Vec3::new(0.065, 0.13, 0.05), 8);
        let turn = petal as f32 / 12.0 * TAU;
        gold.append(&leaf, Mat4::from_translation(centre) * Mat4::from_rotation_z(turn));
    }
    let white = model.part(Material::Marble);
    for side in [-1.0, 1.0] {
        let mut x = 1.15;
        for index in 0..5 {
            let radius = (6.17 - x) * PITCH * 0.36;
            let flip = if index % 2 == 0 { side } else { -side };
            spiral(white, base + Vec3::new(side * x, radius + 0.1, 0.08), radius, flip, radius * 0.3);
            x += radius * 2.35;
        }
    }
}
