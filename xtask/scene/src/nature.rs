//! Ground, hills, sky and trees.

use super::materials::{Material, Model};
use super::mesh::Mesh;
use super::noise::{Random, fractal, lerp, smoothstep};
use super::textures::SKY_HORIZON;
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Radius at which the town ends, in metres from the centre; what lies beyond is backdrop.
pub const TOWN: f32 = 37.0;
/// Radius at which the ground ends and the hills begin.
const EDGE: f32 = 112.0;

/// Height of the ground: level in the town, rising behind it.
pub fn ground_height(x: f32, z: f32) -> f32 {
    let distance = Vec2::new(x, z).length();
    let back = smoothstep(-30.0, -66.0, z) * 9.0;
    let rim = smoothstep(45.0, EDGE, distance) * 4.0;
    let outside = smoothstep(28.0, 44.0, x.abs().max(z.abs()));
    let uv = Vec2::new(x, z) / 300.0 + 0.5;
    back + rim + outside * 2.0 * (fractal(uv, 8, 3, 151) - 0.5) - 0.04
}

/// A ring of ground with colours between earth and grass.
fn ground(from: f32, to: f32, rings: u32) -> Mesh {
    let mut ground = Mesh::default();
    ground.patch(96, rings, Vec2::ONE, |u, v| {
        let (sin, cos) = (u * TAU).sin_cos();
        let radius = lerp(to, from, v);
        let (x, z) = (radius * sin, radius * cos);
        Vec3::new(x, ground_height(x, z), z)
    });
    for (uv, position) in ground.uvs.iter_mut().zip(&ground.positions) {
        *uv = Vec2::new(position.x, position.z);
    }
    ground.paint(|point, _| {
        let uv = Vec2::new(point.x, point.z) / 300.0 + 0.5;
        let dry = smoothstep(0.35, 0.65, fractal(uv, 12, 4, 157));
        let green = Vec3::new(0.62, 0.78, 0.42).lerp(Vec3::new(0.95, 0.86, 0.66), dry);
        let distance = Vec2::new(point.x, point.z).length();
        green.lerp(Vec3::new(0.86, 0.92, 0.82), smoothstep(55.0, EDGE, distance))
    });
    ground
}

/// The ground of the town.
pub fn land() -> Model {
    let mut model = Model::default();
    *model.part(Material::Earth) = ground(0.0, TOWN, 16);
    model
}

/// The ground about the town, the hills that close the view, and the sky.
pub fn surroundings() -> Model {
    let mut model = Model::default();
    *model.part(Material::Earth) = ground(TOWN, EDGE, 22);
    // Each range is farther, higher and paler, as in haze.
    let ranges = [
        (EDGE - 2.0, 9.0, 9, Vec3::new(0.33, 0.43, 0.34), Vec3::new(0.44, 0.52, 0.42)),
        (EDGE + 20.0, 17.0, 7, Vec3::new(0.42, 0.54, 0.58), Vec3::new(0.54, 0.64, 0.66)),
        (EDGE + 48.0, 32.0, 5, Vec3::new(0.50, 0.63, 0.74), Vec3::new(0.60, 0.72, 0.81)),
    ];
    for (index, (radius, height, period, crest, foot)) in ranges.into_iter().enumerate() {
        let mut range = Mesh::default();
        let seed = 163 + index as u32;
        let profile = |u: f32| fractal(Vec2::new(u.fract(), 0.37), period, 5, seed);
        range.patch(180, 3, Vec2::ONE, |u, v| {
            let top = 4.0 + height * smoothstep(0.15, 0.85, profile(u));
            around(radius, u, lerp(-4.0, top, v))
        });
        range.paint(|point, _| foot.lerp(crest, smoothstep(0.0, height, point.y)));
        model.part(Material::Hills).append(&range, Mat4::IDENTITY);
    }
    model.part(Material::Sky).patch(64, 24, Vec2::ONE, |u, v| {
        // The picture spreads evenly over the angle above the horizon.
        let (sin, cos) = (FRAC_PI_2 * (1.0 - (1.0 - v) / SKY_HORIZON)).sin_cos();
        around(SKY * cos.max(0.0), u, SKY * sin)
    });
    model
}

/// Radius of the sky.
const SKY: f32 = 320.0;

/// A point at a share `u` of the way around a ring; it runs to the right as seen from inside.
fn around(radius: f32, u: f32, y: f32) -> Vec3 {
    let (sin, cos) = (-u * TAU).sin_cos();
    Vec3::new(radius * sin, y, radius * cos)
}

/// A broad-leaved tree about 6 m high. `tint` colours its leaves.
pub fn broadleaf(seed: u32, tint: Vec3) -> Model {
    let mut model = Model::default();
    let mut random = Random::new(seed);
    let lean = Vec3::new(random.around(0.5), 0.0, random.around(0.5));
    let fork = Vec3::Y * 2.2 + lean * 0.6;
    let bark = model.part(Material::Bark);
    bark.tube(
        &[Vec3::Y * -0.3, Vec3::Y * 0.25, Vec3::Y * 1.1 + lean * 0.2, fork],
        &[0.42, 0.30, 0.23, 0.20],
        12,
    );
    let centre = Vec3::Y * 4.2 + lean;
    let mut clumps = Vec::new();
    for index in 0..9 {
        let angle = (index as f32 + random.unit() * 0.6) / 8.0 * TAU;
        let (reach, height) =
            if index == 8 { (0.2, 1.35) } else { (random.range(1.1, 1.75), random.range(-0.6, 0.75)) };
        let clump = centre + Vec3::new(angle.sin() * reach, height, angle.cos() * reach);
        let elbow =
            fork.lerp(clump, 0.5) + Vec3::Y * 0.15 + Vec3::new(random.around(0.15), 0.0, random.around(0.15));
        bark.tube(&[fork - Vec3::Y * 0.15, elbow, clump], &[0.12, 0.08, 0.03], 7);
        clumps.push((clump, random.range(0.95, 1.3)));
    }
    let leaves = model.part(Material::Broadleaf);
    for (clump, size) in clumps {
        for _ in 0..46 {
            let out = direction(&mut random);
            let depth = random.unit().cbrt();
            let place = clump + out * Vec3::new(1.0, 0.8, 1.0) * size * depth;
            let outwards = (place - centre).normalize_or(Vec3::Y);
            let card = random.range(0.34, 0.50);
            let facing = (out + direction(&mut random) * 0.8).normalize_or(Vec3::Y);
            // Deep inside little light arrives, and below less than above.
            let light =
                lerp(0.50, 1.0, depth * depth) * lerp(0.72, 1.0, smoothstep(-1.2, 1.2, place.y - centre.y));
            let shade = tint * light * random.range(0.86, 1.1);
            let normal = (outwards * 0.7 + out * 0.4 + Vec3::Y * 0.2).normalize();
            leaf_card(leaves, place, facing, random.unit() * TAU, card, normal, shade);
        }
    }
    model
}

/// A cypress about 8 m high.
pub fn cypress(seed: u32) -> Model {
    let mut model = Model::default();
    let mut random = Random::new(seed);
    model.part(Material::Bark).tube(&[Vec3::Y * -0.3, Vec3::Y * 0.9, Vec3::Y * 6.5], &[0.22, 0.15, 0.03], 9);
    let needles = model.part(Material::Cypress);
    for index in 0..420 {
        let t = index as f32 / 420.0;
        let height = lerp(0.5, 7.3, t);
        let girth = 0.92 * smoothstep(-0.12, 0.22, t) * (1.0 - t).powf(0.62) + 0.06;
        let angle = index as f32 * 2.399_963 + random.around(0.4);
        let depth = random.range(0.62, 1.0);
        let out = Vec3::new(angle.sin(), 0.0, angle.cos());
        let place = Vec3::Y * height + out * girth * depth;
        let facing = (out + Vec3::Y * 0.25 + direction(&mut random) * 0.35).normalize();
        let shade = Vec3::splat(lerp(0.5, 1.0, (depth - 0.62) / 0.38) * random.range(0.85, 1.1));
        let normal = (out + Vec3::Y * 0.35).normalize();
        let size = lerp(0.52, 0.30, t);
        leaf_card(needles, place, facing, random.around(0.25), size, normal, shade);
    }
    model
}

/// A low bush, about 1 m across.
pub fn bush(seed: u32) -> Model {
    let mut model = Model::default();
    let mut random = Random::new(seed);
    let leaves = model.part(Material::Broadleaf);
    for _ in 0..110 {
        let out = direction(&mut random);
        let out = Vec3::new(out.x, out.y.abs(), out.z);
        let depth = random.unit().cbrt();
        let place = out * Vec3::new(0.6, 0.65, 0.6) * depth + Vec3::Y * 0.12;
        let facing = (out + direction(&mut random) * 0.7).normalize_or(Vec3::Y);
        let shade = Vec3::new(0.85, 0.95, 0.8) * lerp(0.45, 1.0, depth) * random.range(0.85, 1.1);
        let size = random.range(0.18, 0.26);
        let normal = (out + Vec3::Y * 0.3).normalize();
        leaf_card(leaves, place, facing, random.unit() * TAU, size, normal, shade);
    }
    model
}

/// A random direction.
fn direction(random: &mut Random) -> Vec3 {
    let y = random.around(1.0);
    let angle = random.unit() * TAU;
    let reach = (1.0 - y * y).max(0.0).sqrt();
    Vec3::new(reach * angle.sin(), y, reach * angle.cos())
}

/// Adds a square card of leaves, turned by `roll` about the direction it faces. Its normal is that
/// of the crown, so that a tree is shaded as one body.
fn leaf_card(mesh: &mut Mesh, place: Vec3, facing: Vec3, roll: f32, half: f32, normal: Vec3, color: Vec3) {
    let right = Vec3::Y.cross(facing).try_normalize().unwrap_or(Vec3::X);
    let up = facing.cross(right);
    let (sin, cos) = roll.sin_cos();
    let (right, up) = (right * cos + up * sin, up * cos - right * sin);
    let first = mesh.positions.len() as u32;
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let uv = Vec2::new(x, -y) * 0.5 + 0.5;
        mesh.vertex(place + (right * x + up * y) * half, normal, uv);
        mesh.colors.push(color.clamp(Vec3::ZERO, Vec3::ONE).extend(1.0));
    }
    mesh.indices.extend([first, first + 1, first + 2, first, first + 2, first + 3]);
}
