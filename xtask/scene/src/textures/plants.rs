//! Sky, earth, wood, water and leaves.

use super::names::Texture;
use super::picture::{Heights, Picture, blend, byte};
use crate::noise::{Random, fractal, fractal_stretched, hash, smoothstep, unit};
use glam::{IVec2, Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Dry ground with tufts of grass; vertex colours make it greener or paler.
pub fn earth() -> Vec<(Texture, Picture)> {
    let picture = Picture::paint(1024, 1024, |uv| {
        let grass = smoothstep(0.30, 0.66, fractal(uv, 11, 5, 101));
        let blades = fractal_stretched(uv, IVec2::new(256, 96), 2, 103);
        let grit = fractal(uv, 96, 3, 107);
        let soil = Vec3::new(0.76, 0.69, 0.52) * (0.80 + 0.40 * grit);
        let green = Vec3::new(0.64, 0.65, 0.41) * (0.66 + 0.62 * blades);
        blend(soil, green, grass)
    });
    vec![(Texture::Earth, picture)]
}

/// Eight upright planks, and bark.
pub fn wood() -> Vec<(Texture, Picture)> {
    let picture = Picture::paint(512, 512, |uv| {
        let plank = (uv.x * 8.0).floor();
        let id = hash(IVec2::new(plank as i32, 0), 109);
        let across = (uv.x * 8.0).fract();
        let gap = smoothstep(0.01, 0.07, across.min(1.0 - across));
        let grain_uv = Vec2::new(uv.x, (uv.y + unit(id)).fract());
        let grain = fractal_stretched(grain_uv, IVec2::new(64, 4), 4, 113);
        let rings = (grain * 14.0).fract();
        let value =
            (0.66 + 0.22 * unit(id) + 0.10 * (rings - 0.5) + 0.2 * (grain - 0.5)) * (0.35 + 0.65 * gap);
        Vec3::new(value, value * 0.96, value * 0.90)
    });
    let bark = Picture::paint(256, 256, |uv| {
        let ridges = fractal_stretched(uv, IVec2::new(18, 3), 3, 117);
        let value = 0.50 + 0.42 * smoothstep(0.36, 0.60, ridges) + 0.2 * (fractal(uv, 24, 3, 119) - 0.5);
        Vec3::new(value, value * 0.95, value * 0.88)
    });
    vec![(Texture::Wood, picture), (Texture::Bark, bark)]
}

/// Ripples.
pub fn water() -> Vec<(Texture, Picture)> {
    let heights = Heights::sample(512, |uv| 0.6 * fractal(uv, 5, 3, 127) + 0.4 * fractal(uv, 9, 2, 131));
    vec![(Texture::WaterNormal, heights.normal_map(0.10))]
}

/// A bright sky with thin clouds, once around; from the zenith (top) to below the horizon.
pub fn sky() -> Vec<(Texture, Picture)> {
    let picture = Picture::paint(2048, 512, |uv| {
        let height = (1.0 - uv.y / SKY_HORIZON).max(0.0);
        let haze = (1.0 - height).powi(5);
        let clear = blend(Vec3::new(0.36, 0.56, 0.80), Vec3::new(0.80, 0.88, 0.93), haze);
        // Clouds look flatter towards the horizon, as layers seen from the side do.
        let layer = Vec2::new(uv.x, (uv.y * uv.y * 1.4).fract());
        let bend = fractal_stretched(layer, IVec2::new(6, 4), 3, 241) - 0.5;
        let drift = Vec2::new((layer.x + bend * 0.04).rem_euclid(1.0), layer.y);
        let cloud = fractal_stretched(drift, IVec2::new(9, 10), 6, 239);
        let cover = smoothstep(0.48, 0.74, cloud) * smoothstep(0.02, 0.22, height) * 0.85;
        let lit = fractal_stretched(drift + Vec2::new(0.004, -0.012), IVec2::new(9, 10), 6, 239);
        let shade = 0.95 + 0.5 * (cloud - lit).clamp(-0.12, 0.08);
        blend(clear, Vec3::new(shade, shade, shade + 0.01), cover)
    });
    vec![(Texture::Sky, picture)]
}

/// Height of the horizon in the picture of the sky, from its top.
pub const SKY_HORIZON: f32 = 0.94;

/// One leaf of a card, in pixels.
struct Leaf {
    base: Vec2,
    direction: Vec2,
    length: f32,
    width: f32,
    color: Vec3,
}

/// A transparent card on which leaves are drawn, later ones over earlier ones.
struct Card {
    picture: Picture,
}

impl Card {
    /// An empty card. Its hidden colour is that of leaves, so that filtering at their edges does
    /// not bring in another one.
    fn new(size: u32, hidden: Vec3) -> Self {
        let pixel = [byte(hidden.x), byte(hidden.y), byte(hidden.z), 0];
        let bytes = pixel.repeat((size * size) as usize);
        Self { picture: Picture { width: size, height: size, channels: 4, bytes } }
    }

    /// Draws a lens-shaped leaf with a pale rib and soft edges.
    fn draw(&mut self, leaf: &Leaf) {
        let size = self.picture.width as i32;
        let tip = leaf.base + leaf.direction * leaf.length;
        let low = (leaf.base.min(tip) - leaf.width).max(Vec2::ZERO).as_ivec2();
        let high = (leaf.base.max(tip) + leaf.width).as_ivec2().min(IVec2::splat(size - 1));
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let offset = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - leaf.base;
                let along = offset.dot(leaf.direction) / leaf.length;
                let across = offset.perp_dot(leaf.direction);
                if !(0.0..=1.0).contains(&along) {
                    continue;
                }
                let half = leaf.width * (along.powf(0.7) * std::f32::consts::PI).sin();
                let cover = (half - across.abs() + 0.5).clamp(0.0, 1.0);
                if cover <= 0.0 {
                    continue;
                }
                let rib = 1.0 - smoothstep(0.0, 1.6, across.abs());
                let side = if across > 0.0 { 1.06 } else { 0.92 };
                let color = leaf.color * side * (0.86 + 0.2 * along) + Vec3::new(0.07, 0.08, 0.03) * rib;
                let pixel = &mut self.picture.bytes[((y * size + x) * 4) as usize..][..4];
                for (channel, value) in pixel.iter_mut().zip(color.to_array()) {
                    *channel = byte(f32::from(*channel) / 255.0 * (1.0 - cover) + value * cover);
                }
                pixel[3] = pixel[3].max(byte(cover));
            }
        }
    }
}

/// Leaf cards: a spray of broad leaves, and the scales of a cypress.
pub fn foliage() -> Vec<(Texture, Picture)> {
    const SIZE: u32 = 512;
    let middle = Vec2::splat(SIZE as f32 / 2.0);
    let mut random = Random::new(137);
    let mut leaves = Card::new(SIZE, Vec3::new(0.25, 0.34, 0.12));
    for index in 0..150 {
        // Outer leaves first; they lie under the inner ones and point outwards.
        let reach = (1.0 - index as f32 / 150.0).sqrt() * 0.72;
        let angle = random.unit() * 4.0 * FRAC_PI_2;
        let outwards = Vec2::from_angle(angle);
        let direction = Vec2::from_angle(angle + random.around(0.8));
        let light = random.unit();
        leaves.draw(&Leaf {
            base: middle + outwards * reach * middle.x,
            direction,
            length: random.range(58.0, 84.0),
            width: random.range(11.0, 17.0),
            color: blend(Vec3::new(0.24, 0.36, 0.10), Vec3::new(0.52, 0.60, 0.22), light),
        });
    }
    let mut needles = Card::new(SIZE, Vec3::new(0.13, 0.24, 0.11));
    for index in 0..420 {
        let height = index as f32 / 420.0;
        let spread = (1.0 - height).powf(0.6) * 0.34;
        let x = random.around(spread);
        let light = random.unit();
        needles.draw(&Leaf {
            base: Vec2::new(0.5 + x, 0.97 - height * 0.86) * SIZE as f32,
            direction: Vec2::from_angle(-FRAC_PI_2 + x * 2.4 + random.around(0.35)),
            length: random.range(30.0, 60.0),
            width: random.range(4.0, 7.5),
            color: blend(Vec3::new(0.10, 0.20, 0.10), Vec3::new(0.30, 0.42, 0.20), light),
        });
    }
    vec![(Texture::Leaves, leaves.picture), (Texture::Needles, needles.picture)]
}
