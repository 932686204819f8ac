//! Stone, plaster and fired clay.

use super::names::Texture;
use super::picture::{Heights, Picture, blend};
use crate::noise::{cells, fractal, hash, mix, smoothstep, unit};
use glam::{IVec2, Vec2, Vec3};

/// A stone of a wall laid in courses.
struct Stone {
    /// Distance to the nearest joint, in units of the texture's side.
    joint: f32,
    id: u32,
}

/// Finds the stone at a texture coordinate in a wall of `rows` courses; each course has between
/// `least` and `least + extra` stones, of uneven length, and begins somewhere else.
fn course(uv: Vec2, rows: i32, least: u32, extra: u32, seed: u32) -> Stone {
    let y = uv.y * rows as f32;
    let row = (y.floor() as i32).rem_euclid(rows);
    let row_hash = hash(IVec2::new(row, 17), seed);
    let count = least + if extra == 0 { 0 } else { row_hash % (extra + 1) };
    let x = (uv.x + unit(mix(row_hash))).rem_euclid(1.0) * count as f32;
    // The joint at the left end of stone `index`, moved a little; the ends of the course agree.
    let left = |index: u32| {
        let id = hash(IVec2::new(row, (index % count) as i32), seed ^ 0xa5a5);
        index as f32 + (unit(id) - 0.5) * 0.5
    };
    let mut index = x.floor() as u32;
    let mut position = x;
    if position < left(index) {
        if index == 0 {
            index += count;
            position += count as f32;
        }
        index -= 1;
    } else if position >= left(index + 1) {
        index += 1;
    }
    let across = (position - left(index)).min(left(index + 1) - position) / count as f32;
    let along = y.fract().min(1.0 - y.fract()) / rows as f32;
    Stone { joint: across.min(along), id: hash(IVec2::new(row, (index % count) as i32), seed) }
}

/// A uniform number of a stone, independent for each `salt`.
fn trait_of(id: u32, salt: u32) -> f32 {
    unit(mix(id ^ salt.wrapping_mul(0x9e37_79b9)))
}

/// Squared blocks with drafted joints: colour, normals, occlusion and roughness.
pub fn blocks() -> Vec<(Texture, Picture)> {
    const SIZE: u32 = 1024;
    let stone = |uv| course(uv, 5, 2, 1, 3);
    let heights = Heights::sample(SIZE, |uv| {
        let stone = stone(uv);
        let face = smoothstep(0.0015, 0.009, stone.joint);
        face * (0.8 + 0.2 * trait_of(stone.id, 1)) + 0.16 * fractal(uv, 24, 4, 5)
    });
    let color = Picture::paint(SIZE, SIZE, |uv| {
        let stone = stone(uv);
        let tone = 0.80 + 0.14 * trait_of(stone.id, 2);
        let warmth = 0.05 * (trait_of(stone.id, 3) - 0.5);
        let weather = fractal(uv, 4, 5, 11);
        let joint = smoothstep(0.001, 0.006, stone.joint);
        let value = (tone - 0.16 * (weather - 0.45)) * (0.66 + 0.34 * joint);
        Vec3::new(value + warmth + 0.02, value, value - warmth - 0.03)
    });
    let surface = Picture::paint(SIZE / 2, SIZE / 2, |uv| {
        let height = heights.nearest(uv);
        Vec3::new(0.45 + 0.55 * smoothstep(0.05, 0.8, height), 0.72 + 0.2 * fractal(uv, 8, 2, 7), 0.0)
    });
    vec![
        (Texture::BlocksNormal, heights.normal_map(0.008)),
        (Texture::Blocks, color),
        (Texture::BlocksSurface, surface),
    ]
}

/// Slabs of a paved square.
pub fn paving() -> Vec<(Texture, Picture)> {
    const SIZE: u32 = 1024;
    let stone = |uv| course(uv, 7, 5, 2, 21);
    let heights = Heights::sample(SIZE, |uv| {
        let stone = stone(uv);
        let tilt = 0.25 * trait_of(stone.id, 1);
        smoothstep(0.0008, 0.006, stone.joint) * (0.75 + tilt) + 0.22 * fractal(uv, 16, 3, 23)
    });
    let color = Picture::paint(SIZE, SIZE, |uv| {
        let stone = stone(uv);
        let worn = fractal(uv, 6, 4, 29);
        let joint = smoothstep(0.0006, 0.0042, stone.joint);
        let value = 0.72 + 0.20 * trait_of(stone.id, 2) - 0.14 * (worn - 0.4);
        let tint = trait_of(stone.id, 3) - 0.5;
        let slab = Vec3::new(value + 0.05 * tint, value, value - 0.08 * tint - 0.02);
        blend(Vec3::new(0.36, 0.32, 0.25), slab, joint)
    });
    vec![(Texture::PavingNormal, heights.normal_map(0.004)), (Texture::Paving, color)]
}

/// Rounded cobbles in earth.
pub fn cobbles() -> Vec<(Texture, Picture)> {
    const SIZE: u32 = 512;
    let dome = |uv: Vec2| {
        let cell = cells(uv, 13, 0.75, 31);
        (smoothstep(0.02, 0.32, cell.border), cell.id)
    };
    let heights = Heights::sample(SIZE, |uv| dome(uv).0 + 0.1 * fractal(uv, 32, 2, 33));
    let color = Picture::paint(SIZE, SIZE, |uv| {
        let (height, id) = dome(uv);
        let value = 0.55 + 0.32 * trait_of(id, 1) + 0.08 * (fractal(uv, 24, 3, 37) - 0.5);
        let tint = trait_of(id, 2) - 0.4;
        let cobble = Vec3::new(value + 0.06 * tint, value, value - 0.09 * tint);
        blend(Vec3::new(0.34, 0.28, 0.20), cobble, smoothstep(0.05, 0.5, height))
    });
    vec![(Texture::CobblesNormal, heights.normal_map(0.018)), (Texture::Cobbles, color)]
}

/// White marble with faint grey veins: a low-contrast surface.
pub fn marble() -> Vec<(Texture, Picture)> {
    let picture = Picture::paint(512, 512, |uv| {
        let bend = Vec2::new(fractal(uv, 3, 3, 41), fractal(uv, 3, 3, 43)) - 0.5;
        let flow = fractal((uv + bend * 0.22).rem_euclid(Vec2::ONE), 4, 4, 47);
        let vein = 1.0 - smoothstep(0.0, 0.045, (flow - 0.5).abs());
        let cloud = fractal(uv, 5, 4, 53);
        let value = 0.965 - 0.07 * (cloud - 0.4) - 0.075 * vein * cloud;
        Vec3::new(value, value - 0.006, value - 0.018)
    });
    vec![(Texture::Marble, picture)]
}

/// Lime plaster, patchy and streaked by rain.
pub fn plaster() -> Vec<(Texture, Picture)> {
    let picture = Picture::paint(512, 512, |uv| {
        let patches = fractal(uv, 3, 5, 61);
        let trowel = fractal(uv, 40, 2, 67);
        let value = 0.90 - 0.20 * smoothstep(0.45, 0.75, patches) + 0.05 * (trowel - 0.5);
        Vec3::new(value + 0.01, value, value - 0.015)
    });
    vec![(Texture::Plaster, picture)]
}

/// Tiles of a roof: the plain clay for roofs whose tiles are modelled, and colour and normals for
/// roofs that are flat. One repetition is 12 tiles wide and 8 tiles high.
pub fn roof() -> Vec<(Texture, Picture)> {
    const SIZE: u32 = 512;
    let across = 12;
    let down = 8;
    let clay = |id: u32, uv: Vec2| {
        let fired = trait_of(id, 1);
        let pale = blend(Vec3::new(0.80, 0.47, 0.30), Vec3::new(0.88, 0.62, 0.42), trait_of(id, 2));
        let base = blend(pale, Vec3::new(0.64, 0.30, 0.19), smoothstep(0.35, 0.95, fired));
        base * (0.92 + 0.16 * fractal(uv, 16, 3, 71))
    };
    let id = |uv: Vec2| {
        let cell = (uv * Vec2::new(across as f32, down as f32)).floor().as_ivec2();
        hash(cell.rem_euclid(IVec2::new(across, down)), 73)
    };
    let plain = Picture::paint(SIZE, SIZE, |uv| clay(id(uv), uv));
    // A cover tile arches over each joint; every course steps up where it overlaps the next one.
    let arch = |uv: Vec2| {
        let x = (uv.x * across as f32).fract() * 2.0 - 1.0;
        (1.0 - x * x).max(0.0).sqrt()
    };
    let heights = Heights::sample(SIZE, |uv| arch(uv) * 0.9 + 0.35 * (uv.y * down as f32).fract());
    let shaded = Picture::paint(SIZE, SIZE, |uv| {
        let lip = (uv.y * down as f32).fract();
        let shadow = smoothstep(0.0, 0.12, lip) * (0.45 + 0.55 * smoothstep(0.0, 0.6, arch(uv)));
        clay(id(uv), uv) * (0.45 + 0.55 * shadow)
    });
    vec![
        (Texture::TilesNormal, heights.normal_map(0.035)),
        (Texture::Terracotta, plain),
        (Texture::Tiles, shaded),
    ]
}
