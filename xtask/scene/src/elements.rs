//! Building elements that several buildings share: walls with openings, tiled roofs, columns.

use super::materials::{Material, Model};
use super::mesh::{Faces, Mesh};
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A rectangular opening in a wall; x from the wall's left end, y from its foot.
#[derive(Clone, Copy)]
pub struct Opening {
    pub x: f32,
    pub y: f32,
    pub width: f32,
    pub height: f32,
}

impl Opening {
    /// An opening about a centre line.
    pub fn centred(x: f32, y: f32, width: f32, height: f32) -> Self {
        Self { x: x - width / 2.0, y, width, height }
    }

    fn contains(&self, point: Vec2) -> bool {
        point.x > self.x
            && point.x < self.x + self.width
            && point.y > self.y
            && point.y < self.y + self.height
    }
}

/// Adds a wall from (0, 0, 0) to (`size.x`, `size.y`, 0) that faces +z, with openings whose reveals
/// are `reveal` deep. Below each height in `bands` it is of that band's material, above of `top`.
pub fn wall(
    model: &mut Model,
    size: Vec2,
    openings: &[Opening],
    reveal: f32,
    bands: &[(f32, Material)],
    top: Material,
) {
    let mut columns = vec![0.0, size.x];
    let mut rows = vec![0.0, size.y];
    rows.extend(bands.iter().map(|band| band.0));
    for opening in openings {
        columns.extend([opening.x, opening.x + opening.width]);
        rows.extend([opening.y, opening.y + opening.height]);
    }
    for cuts in [&mut columns, &mut rows] {
        cuts.sort_by(f32::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() < 1e-4);
    }
    let material_at = |y: f32| bands.iter().find(|band| y < band.0).map_or(top, |band| band.1);
    for row in rows.windows(2) {
        for column in columns.windows(2) {
            let middle = Vec2::new(column[0] + column[1], row[0] + row[1]) / 2.0;
            if openings.iter().any(|opening| opening.contains(middle)) {
                continue;
            }
            let (a, b) = (Vec3::new(column[0], row[0], 0.0), Vec3::new(column[1], row[1], 0.0));
            model.part(material_at(middle.y)).face(&[
                a,
                Vec3::new(b.x, a.y, 0.0),
                b,
                Vec3::new(a.x, b.y, 0.0),
            ]);
        }
    }
    for opening in openings {
        reveals(model.part(top), opening, reveal);
    }
}

/// Adds the four faces that lead from the edges of an opening into the wall, `depth` deep.
fn reveals(mesh: &mut Mesh, opening: &Opening, depth: f32) {
    let (left, right) = (opening.x, opening.x + opening.width);
    let (foot, head) = (opening.y, opening.y + opening.height);
    let front = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let back = |x: f32, y: f32| Vec3::new(x, y, -depth);
    mesh.face(&[front(left, foot), back(left, foot), back(left, head), front(left, head)]);
    mesh.face(&[back(right, foot), front(right, foot), front(right, head), back(right, head)]);
    mesh.face(&[back(left, head), back(right, head), front(right, head), front(left, head)]);
    mesh.face(&[front(left, foot), front(right, foot), back(right, foot), back(left, foot)]);
}

/// A slope of pan and cover tiles.
pub struct Slope {
    /// The left end of the ridge, seen from outside with the eave below.
    pub ridge: Vec3,
    /// From there along the ridge to its right end.
    pub along: Vec3,
    /// From the ridge down to the eave.
    pub down: Vec3,
    /// Wanted width and length of a tile; they are adjusted so that whole tiles fit.
    pub tile: Vec2,
}

impl Slope {
    /// Adds the modelled tiles.
    pub fn tiles(&self, mesh: &mut Mesh) {
        let (along, down) = (self.along.normalize(), self.down.normalize());
        let out = down.cross(along);
        let columns = (self.along.length() / self.tile.x).round().max(1.0) as usize;
        let rows = (self.down.length() / self.tile.y).round().max(1.0) as usize;
        let tile = Vec2::new(self.along.length() / columns as f32, self.down.length() / rows as f32);
        let radius = tile.x * 0.27;
        let lip = tile.x * 0.16;
        // Across one tile: a flat pan, then a cover that arches over the joint.
        const ARCH: usize = 3;
        let mut section = vec![(0.0, 0.0, Vec3::Y), (tile.x - 2.0 * radius, 0.0, Vec3::Y)];
        for step in 0..=ARCH {
            let angle = PI * (1.0 - step as f32 / ARCH as f32);
            let x = tile.x - radius + radius * angle.cos();
            section.push((x, radius * angle.sin() * 1.1, Vec3::new(angle.cos(), angle.sin(), 0.0)));
        }
        for row in 0..rows {
            for column in 0..columns {
                let corner = self.ridge + along * (column as f32 * tile.x) + down * (row as f32 * tile.y);
                let uv = Vec2::new(column as f32, row as f32) * tile;
                for (index, pair) in section.windows(2).enumerate() {
                    if index == 1 {
                        continue;
                    }
                    let first = mesh.positions.len() as u32;
                    for (fall, rise) in [(tile.y, lip), (0.0, 0.0)] {
                        for &(x, height, normal) in pair {
                            let normal = along * normal.x + out * normal.y;
                            let position = corner + along * x + down * fall + out * (height + rise);
                            mesh.vertex(position, normal, uv + Vec2::new(x, fall * 0.98));
                        }
                    }
                    mesh.indices.extend([first, first + 1, first + 3, first, first + 3, first + 2]);
                    // The lip that overlaps the next course.
                    let first = mesh.positions.len() as u32;
                    for rise in [-0.02, lip] {
                        for &(x, height, _) in pair {
                            let position = corner
                                + along * x
                                + down * tile.y
                                + out * (height * (rise / lip).max(0.0) + rise);
                            mesh.vertex(position, down, uv + Vec2::new(x, tile.y * 0.98));
                        }
                    }
                    mesh.indices.extend([first, first + 1, first + 3, first, first + 3, first + 2]);
                }
            }
        }
    }

    /// Adds the slope as one face, for roofs that are far away.
    pub fn flat(&self, mesh: &mut Mesh) {
        let corners = [
            self.ridge + self.down,
            self.ridge + self.down + self.along,
            self.ridge + self.along,
            self.ridge,
        ];
        let (width, length) = (self.along.length(), self.down.length());
        let uvs = [Vec2::new(0.0, length), Vec2::new(width, length), Vec2::new(width, 0.0), Vec2::ZERO];
        mesh.textured_face(&corners, &uvs);
    }

    /// Adds the boards below the tiles, seen from under the eave.
    pub fn underside(&self, mesh: &mut Mesh, thickness: f32) {
        let out = self.down.cross(self.along).normalize() * thickness;
        let (a, b) = (self.ridge - out, self.ridge + self.along - out);
        mesh.face(&[a, b, b + self.down, a + self.down]);
    }
}

/// A fluted Doric column of the given height, standing at the origin.
pub fn fluted_column(height: f32) -> Mesh {
    const FLUTES: u32 = 20;
    let mut mesh = Mesh::default();
    let shaft = height * 0.905;
    let scale = height / 5.9;
    let radius = |t: f32| (0.56 - 0.12 * t + 0.026 * (PI * t).sin()) * scale;
    for flute in 0..FLUTES {
        mesh.patch(4, 6, Vec2::new(0.18, shaft), |u, v| {
            let (sin, cos) = ((flute as f32 + u) / FLUTES as f32 * TAU).sin_cos();
            let hollow = radius(v) * (1.0 - 0.085 * (PI * u).sin());
            Vec3::new(hollow * sin, v * shaft, hollow * cos)
        });
    }
    let ring = |r: f32, y: f32| Vec2::new(r * scale, shaft + y * scale);
    let echinus = [
        ring(0.43, -0.02),
        ring(0.465, 0.0),
        ring(0.465, 0.02),
        ring(0.45, 0.025),
        ring(0.475, 0.045),
        ring(0.475, 0.06),
        ring(0.53, 0.12),
        ring(0.60, 0.20),
        ring(0.645, 0.26),
        ring(0.655, 0.29),
        ring(0.63, 0.315),
    ];
    mesh.lathe(&echinus, 32);
    let top = shaft + 0.31 * scale;
    mesh.block(0.0, top, 0.0, Vec3::new(1.36 * scale, height - top, 1.36 * scale));
    mesh
}

/// A smooth column with a moulded base and a simple capital, standing at the origin.
pub fn smooth_column(height: f32, radius: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let point = |r: f32, y: f32| Vec2::new(r * radius, y);
    let profile = [
        point(1.45, 0.10),
        point(1.52, 0.15),
        point(1.45, 0.20),
        point(1.20, 0.22),
        point(1.12, 0.27),
        point(1.0, 0.32),
        point(1.0, 0.32 + (height - 0.7) * 0.33),
        point(0.84, height - 0.36),
        point(0.95, height - 0.34),
        point(0.95, height - 0.31),
        point(0.86, height - 0.29),
        point(0.90, height - 0.22),
        point(1.15, height - 0.16),
        point(1.25, height - 0.10),
    ];
    mesh.lathe(&profile, 24);
    let plinth = radius * 3.1;
    mesh.block(0.0, 0.0, 0.0, Vec3::new(plinth, 0.1, plinth));
    mesh.block(0.0, height - 0.1, 0.0, Vec3::new(radius * 2.7, 0.1, radius * 2.7));
    mesh
}

/// A wall with a round arch through it: centred in x, standing on y = 0, from z = -`thickness` / 2 to
/// `thickness` / 2. The arch springs at `spring` and is `span` wide.
pub fn arched_wall(mesh: &mut Mesh, size: Vec2, thickness: f32, span: f32, spring: f32) {
    const STEPS: usize = 16;
    let (half, radius, depth) = (size.x / 2.0, span / 2.0, thickness / 2.0);
    let arc: Vec<Vec2> = (0..=STEPS)
        .map(|step| Vec2::from_angle(PI * (1.0 - step as f32 / STEPS as f32)) * radius + Vec2::Y * spring)
        .collect();
    let mut front = |outline: &[Vec2]| {
        let face: Vec<Vec3> = outline.iter().map(|point| point.extend(depth)).collect();
        let back: Vec<Vec3> = outline.iter().rev().map(|point| point.extend(-depth)).collect();
        mesh.face(&face).face(&back);
    };
    for side in [-1.0, 1.0] {
        let (inner, outer) = (radius * side, half * side);
        let (low, high) = (inner.min(outer), inner.max(outer));
        let rectangle = [(low, 0.0), (high, 0.0), (high, size.y), (low, size.y)];
        front(&rectangle.map(Vec2::from));
    }
    for pair in arc.windows(2) {
        front(&[pair[0], pair[1], Vec2::new(pair[1].x, size.y), Vec2::new(pair[0].x, size.y)]);
    }
    let mut jambs = vec![Vec2::new(-radius, 0.0)];
    jambs.extend(&arc);
    jambs.push(Vec2::new(radius, 0.0));
    for pair in jambs.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        mesh.face(&[b.extend(depth), a.extend(depth), a.extend(-depth), b.extend(-depth)]);
    }
    for x in [-half, half] {
        let corners = [(depth, 0.0), (-depth, 0.0), (-depth, size.y), (depth, size.y)];
        let mut face = corners.map(|(z, y)| Vec3::new(x, y, z));
        if x < 0.0 {
            face.reverse();
        }
        mesh.face(&face);
    }
    mesh.cuboid(Vec3::new(-half, size.y, -depth), Vec3::new(half, size.y + 0.02, depth), Faces::Standing);
    // Wedge stones that stand a little proud of the wall.
    for step in 0..STEPS / 2 * 2 {
        if step % 2 == 1 && step != STEPS / 2 {
            continue;
        }
        let from = PI * (step as f32 - 0.5).max(0.0) / STEPS as f32;
        let to = PI * (step as f32 + 0.5) / STEPS as f32;
        let outline = [
            Vec2::from_angle(from) * (radius - 0.02),
            Vec2::from_angle(from) * (radius + 0.55),
            Vec2::from_angle(to) * (radius + 0.55),
            Vec2::from_angle(to) * (radius - 0.02),
        ];
        let mut stone = Mesh::default();
        stone.prism(&outline, thickness + 0.12);
        mesh.append(&stone, Mat4::from_translation(Vec3::new(0.0, spring, -depth - 0.06)));
    }
}
