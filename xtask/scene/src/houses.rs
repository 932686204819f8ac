//! Houses: plastered walls with windows and doors, tiled roofs, an outside stair, a balcony.

use super::elements::{Opening, Slope, wall};
use super::materials::{Material, Model};
use super::mesh::{Faces, Mesh};
use super::noise::Random;
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Depth of window and door reveals.
const REVEAL: f32 = 0.24;
/// Distance that a roof reaches beyond the walls.
const OVERHANG: f32 = 0.5;
/// Rise of a roof over its run.
const PITCH: f32 = 0.46;

/// Form of a house. It stands about the origin with its front towards +z.
pub struct House {
    /// Size in plan.
    pub size: Vec2,
    pub storeys: u32,
    pub plaster: Material,
    /// Painted zone at the foot of the walls.
    pub dado: Material,
    pub shutters: Material,
    pub seed: u32,
    /// Modelled tiles and rafters, instead of a flat roof with a normal map.
    pub detailed: bool,
    pub balcony: bool,
    pub outside_stair: bool,
}

/// Height of a storey.
const STOREY: f32 = 3.05;

impl House {
    /// Height of the eaves.
    fn height(&self) -> f32 {
        self.storeys as f32 * STOREY + 0.25
    }

    /// Builds the house.
    pub fn build(&self) -> Model {
        let mut model = Model::default();
        let mut random = Random::new(self.seed);
        for side in 0..4 {
            let turn = Mat4::from_rotation_y(side as f32 * FRAC_PI_2);
            let (length, distance) = if side % 2 == 0 {
                (self.size.x, self.size.y / 2.0)
            } else {
                (self.size.y, self.size.x / 2.0)
            };
            let face = self.facade(side, length, &mut random);
            model.append(&face, turn * Mat4::from_translation(Vec3::new(-length / 2.0, 0.0, distance)));
        }
        if self.detailed {
            // A band between the storeys.
            let height = STOREY + 0.02;
            let band = [(0.0, height), (0.06, height + 0.03), (0.06, height + 0.13), (0.0, height + 0.16)];
            model.part(Material::PlasterWhite).moulding(self.size / 2.0, &band.map(Vec2::from));
        }
        self.roof(&mut model);
        if self.balcony {
            self.balcony(&mut model);
        }
        if self.outside_stair {
            self.stair(&mut model);
        }
        model
    }

    /// A wall with its windows; the front, side 0, also has the door.
    fn facade(&self, side: usize, length: f32, random: &mut Random) -> Model {
        let mut model = Model::default();
        let bays = (length / 2.3).floor().max(1.0) as u32;
        let door_bay = if side == 0 { (random.unit() * bays as f32) as u32 } else { u32::MAX };
        let balcony_bay = if self.balcony && side == 0 { bays / 2 } else { u32::MAX };
        let mut windows = Vec::new();
        let mut doors = Vec::new();
        for storey in 0..self.storeys {
            for bay in 0..bays {
                let x = (bay as f32 + 0.5) * length / bays as f32;
                let foot = storey as f32 * STOREY;
                if storey == 0 && bay == door_bay {
                    doors.push(Opening::centred(x, 0.0, 1.15, 2.25));
                } else if storey == 1 && bay == balcony_bay {
                    doors.push(Opening::centred(x, foot + 0.2, 1.0, 2.1));
                } else if storey == 0 && (side != 0 || random.unit() < 0.35) {
                    // High slits towards the street.
                    if random.unit() < 0.7 {
                        windows.push((Opening::centred(x, foot + 1.75, 0.55, 0.7), false));
                    }
                } else if random.unit() < 0.88 {
                    windows.push((Opening::centred(x, foot + 1.0, 0.9, 1.3), true));
                }
            }
        }
        let openings: Vec<Opening> =
            windows.iter().map(|window| window.0).chain(doors.iter().copied()).collect();
        let bands = [(1.1, self.dado)];
        wall(&mut model, Vec2::new(length, self.height()), &openings, REVEAL, &bands, self.plaster);
        for (window, shutters) in windows {
            self.window(&mut model, &window, shutters, random);
        }
        for door in doors {
            self.door(&mut model, &door, random);
        }
        model
    }

    /// The dark pane, the glazing bars, the frame and the shutters of a window.
    fn window(&self, model: &mut Model, opening: &Opening, shutters: bool, random: &mut Random) {
        let (x, y) = (opening.x, opening.y);
        let (right, top) = (x + opening.width, y + opening.height);
        let middle = x + opening.width / 2.0;
        model.part(Material::Dark).face(&[
            Vec3::new(x, y, -REVEAL),
            Vec3::new(right, y, -REVEAL),
            Vec3::new(right, top, -REVEAL),
            Vec3::new(x, top, -REVEAL),
        ]);
        let lattice = model.part(Material::Wood);
        let bars = if shutters { [0.5, 0.5] } else { [0.33, 0.67] };
        for t in bars {
            let at = x + opening.width * t;
            lattice.cuboid(Vec3::new(at - 0.025, y, -0.2), Vec3::new(at + 0.025, top, -0.15), Faces::Sides);
        }
        let at = y + opening.height * 0.55;
        lattice.cuboid(Vec3::new(x, at - 0.025, -0.2), Vec3::new(right, at + 0.025, -0.15), Faces::All);
        if self.detailed {
            let frame = model.part(Material::PlasterWhite);
            let (z, band) = (0.035, 0.11);
            frame.cuboid(Vec3::new(x - band, top, 0.0), Vec3::new(right + band, top + 0.14, z), Faces::All);
            frame.cuboid(Vec3::new(x - 0.16, y - 0.1, 0.0), Vec3::new(right + 0.16, y, 0.11), Faces::All);
            for left in [x - band, right] {
                frame.cuboid(Vec3::new(left, y, 0.0), Vec3::new(left + band, top, z), Faces::All);
            }
        }
        if shutters {
            let wood = model.part(self.shutters);
            let width = opening.width * 0.52;
            for side in [-1.0, 1.0] {
                // They stand open, some wider than others, hinged at the edge of the opening.
                let open = if self.detailed { random.range(0.06, 0.7) } else { 0.05 };
                let hinge = Vec3::new(middle + side * (opening.width / 2.0 + 0.11), y, 0.06);
                let turn = Mat4::from_translation(hinge)
                    * Mat4::from_rotation_y(-side * open)
                    * Mat4::from_scale(Vec3::new(side, 1.0, 1.0));
                wood.append(&shutter(Vec2::new(width, opening.height), self.detailed), turn);
            }
        }
    }

    /// A plank door in its frame, with a step before it.
    fn door(&self, model: &mut Model, opening: &Opening, random: &mut Random) {
        let (x, y) = (opening.x, opening.y);
        let (right, top) = (x + opening.width, y + opening.height);
        let wood = model.part(Material::Wood);
        for left in [x - 0.12, right] {
            wood.cuboid(Vec3::new(left, y, 0.0), Vec3::new(left + 0.12, top, 0.06), Faces::All);
        }
        wood.cuboid(Vec3::new(x - 0.25, top, 0.0), Vec3::new(right + 0.25, top + 0.2, 0.1), Faces::All);
        model.part(Material::Dark).face(&[
            Vec3::new(x, y, -REVEAL),
            Vec3::new(right, y, -REVEAL),
            Vec3::new(right, top, -REVEAL),
            Vec3::new(x, top, -REVEAL),
        ]);
        let ajar = if random.unit() < 0.5 { 0.0 } else { random.range(0.5, 1.1) };
        let mut leaf = Mesh::default();
        leaf.cuboid(Vec3::ZERO, Vec3::new(opening.width, opening.height, 0.05), Faces::All);
        for rail in [0.25, 0.55, 0.85] {
            let at = opening.height * rail;
            leaf.cuboid(
                Vec3::new(0.05, at - 0.07, 0.05),
                Vec3::new(opening.width - 0.05, at + 0.07, 0.08),
                Faces::All,
            );
        }
        let hinge = Mat4::from_translation(Vec3::new(x, y, -REVEAL + 0.08)) * Mat4::from_rotation_y(ajar);
        model.part(self.shutters).append(&leaf, hinge);
        if y == 0.0 {
            let step = Vec3::new(x - 0.3, -0.2, 0.0);
            model.part(Material::Ashlar).cuboid(step, Vec3::new(right + 0.3, 0.16, 0.5), Faces::Standing);
        }
    }

    /// A gabled roof; its ridge runs along x.
    fn roof(&self, model: &mut Model) {
        let (half, eave) = (self.size / 2.0, self.height());
        let run = half.y + OVERHANG;
        // The slope passes over the top of the wall, so the eave hangs below it.
        let ridge = eave + half.y * PITCH + 0.12;
        let length = self.size.x + OVERHANG * 1.2;
        for side in [-1.0, 1.0] {
            let slope = Slope {
                ridge: Vec3::new(-side * length / 2.0, ridge, 0.0),
                along: Vec3::new(side * length, 0.0, 0.0),
                down: Vec3::new(0.0, -run * PITCH, side * run),
                tile: Vec2::new(0.267, 0.4),
            };
            if self.detailed {
                slope.tiles(model.part(Material::RoofTiles));
                let count = (length / 0.62) as usize;
                for index in 0..=count {
                    let x = (index as f32 / count as f32 - 0.5) * (length - 0.15);
                    let at = |t: f32| Vec3::new(x, ridge - 0.16 - run * t * PITCH, side * run * t);
                    model.part(Material::Wood).beam(at(half.y / run - 0.04), at(0.985), 0.09, 0.12);
                }
            } else {
                slope.flat(model.part(Material::RoofFar));
            }
            slope.underside(model.part(Material::Wood), 0.08);
            // Gable walls.
            let (x, top) = (side * half.x, eave + half.y * PITCH);
            let corners = [
                Vec3::new(x, eave, side * half.y),
                Vec3::new(x, eave, -side * half.y),
                Vec3::new(x, top, 0.0),
            ];
            model.part(self.plaster).face(&corners);
            // Boards that close the ends of the roof.
            for toward in [-1.0, 1.0] {
                let end = side * (length / 2.0 - 0.04);
                let board = model.part(Material::Wood);
                board.beam(
                    Vec3::new(end, ridge - 0.05, 0.0),
                    Vec3::new(end, ridge - 0.05 - run * PITCH, toward * run),
                    0.07,
                    0.16,
                );
            }
        }
        let ends = [-1.0, 1.0].map(|side: f32| Vec3::new(side * length / 2.0, ridge + 0.02, 0.0));
        model.part(Material::RoofTiles).tube(&ends, &[0.14, 0.14], 10);
        self.chimney(model, ridge);
    }

    /// A small smoke stack behind the ridge.
    fn chimney(&self, model: &mut Model, ridge: f32) {
        let (x, z) = (self.size.x * 0.27, -self.size.y * 0.16);
        let stack = model.part(self.plaster);
        stack.cuboid(
            Vec3::new(x - 0.28, ridge - 1.0, z - 0.22),
            Vec3::new(x + 0.28, ridge + 0.45, z + 0.22),
            Faces::Standing,
        );
        let clay = model.part(Material::RoofTiles);
        clay.block(x, ridge + 0.45, z, Vec3::new(0.72, 0.08, 0.6));
    }

    /// A wooden balcony before the middle of the front.
    fn balcony(&self, model: &mut Model) {
        let wood = model.part(Material::Wood);
        let bays = (self.size.x / 2.3).floor().max(1.0);
        let centre = ((bays / 2.0).floor() + 0.5) * self.size.x / bays - self.size.x / 2.0;
        let (front, floor, half) = (self.size.y / 2.0, STOREY + 0.2, 1.7);
        wood.cuboid(
            Vec3::new(centre - half, floor - 0.08, front),
            Vec3::new(centre + half, floor, front + 1.1),
            Faces::All,
        );
        for x in [-half + 0.15, -half / 3.0, half / 3.0, half - 0.15] {
            let x = centre + x;
            wood.beam(Vec3::new(x, floor - 0.16, front), Vec3::new(x, floor - 0.16, front + 1.2), 0.12, 0.16);
            wood.beam(Vec3::new(x, floor - 0.95, front), Vec3::new(x, floor - 0.2, front + 0.85), 0.09, 0.09);
        }
        let corners = [
            Vec3::new(centre - half + 0.05, floor, front + 0.05),
            Vec3::new(centre - half + 0.05, floor, front + 1.05),
            Vec3::new(centre + half - 0.05, floor, front + 1.05),
            Vec3::new(centre + half - 0.05, floor, front + 0.05),
        ];
        for pair in corners.windows(2) {
            let up = Vec3::Y * 0.92;
            wood.beam(pair[0] + up, pair[1] + up, 0.09, 0.07);
            let count = (pair[0].distance(pair[1]) / 0.16) as usize;
            for index in 0..=count {
                let foot = pair[0].lerp(pair[1], index as f32 / count as f32);
                wood.cuboid(
                    foot - Vec3::new(0.022, 0.0, 0.022),
                    foot + Vec3::new(0.022, 0.9, 0.022),
                    Faces::Sides,
                );
            }
        }
    }

    /// A stone stair that climbs along the right side to the upper floor.
    fn stair(&self, model: &mut Model) {
        let stone = model.part(Material::Ashlar);
        let steps = 15;
        let (x, front) = (self.size.x / 2.0, self.size.y / 2.0);
        let rise = (STOREY + 0.1) / steps as f32;
        for step in 0..steps {
            let z = front - 0.2 - step as f32 * 0.29;
            let top = (step + 1) as f32 * rise;
            // The last step is the landing.
            let depth = if step + 1 == steps { 1.2 } else { 0.29 };
            stone.cuboid(Vec3::new(x, -0.2, z - depth), Vec3::new(x + 1.2, top, z), Faces::Standing);
        }
    }
}

/// A shutter from (0, 0, 0), outwards along x: a frame with slats.
fn shutter(size: Vec2, detailed: bool) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.cuboid(Vec3::ZERO, Vec3::new(size.x, size.y, 0.03), Faces::All);
    if !detailed {
        return mesh;
    }
    for x in [0.0, size.x - 0.06] {
        mesh.cuboid(Vec3::new(x, 0.0, 0.03), Vec3::new(x + 0.06, size.y, 0.05), Faces::All);
    }
    let slats = (size.y / 0.13) as usize;
    for slat in 0..slats {
        let y = (slat as f32 + 0.2) * size.y / slats as f32;
        let mut board = Mesh::default();
        board.cuboid(Vec3::new(0.06, -0.035, -0.006), Vec3::new(size.x - 0.06, 0.035, 0.006), Faces::All);
        mesh.append(
            &board,
            Mat4::from_translation(Vec3::new(0.0, y + 0.03, 0.038)) * Mat4::from_rotation_x(-PI / 6.0),
        );
    }
    mesh
}
