//! The textures of the scene, painted by formulas and encoded as PNG, one of them as JPEG.

mod masonry;
mod ornament;
mod plants;

use super::noise::lerp;
use crate::error::{Context, Result};
use glam::{Vec2, Vec3};
use image::ImageEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
pub use plants::SKY_HORIZON;
use std::sync::Mutex;

/// Every texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Texture {
    Marble,
    Blocks,
    BlocksNormal,
    BlocksSurface,
    Paving,
    PavingNormal,
    Cobbles,
    CobblesNormal,
    Mosaic,
    Earth,
    Plaster,
    Terracotta,
    Tiles,
    TilesNormal,
    Wood,
    Bark,
    WaterNormal,
    Leaves,
    Needles,
    Stripes,
    Pennant,
    Vase,
    Sky,
}

impl Texture {
    /// The name of its file.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Marble => "marble.png",
            Self::Blocks => "blocks.png",
            Self::BlocksNormal => "blocks_normal.png",
            Self::BlocksSurface => "blocks_surface.png",
            Self::Paving => "paving.png",
            Self::PavingNormal => "paving_normal.png",
            Self::Cobbles => "cobbles.png",
            Self::CobblesNormal => "cobbles_normal.png",
            Self::Mosaic => "mosaic.png",
            Self::Earth => "earth.png",
            // The one that no edge or normal depends on is a JPEG, so that both decoders are used.
            Self::Plaster => "plaster.jpg",
            Self::Terracotta => "terracotta.png",
            Self::Tiles => "tiles.png",
            Self::TilesNormal => "tiles_normal.png",
            Self::Wood => "wood.png",
            Self::Bark => "bark.png",
            Self::WaterNormal => "water_normal.png",
            Self::Leaves => "leaves.png",
            Self::Needles => "needles.png",
            Self::Stripes => "stripes.png",
            Self::Pennant => "pennant.png",
            Self::Vase => "vase.png",
            Self::Sky => "sky.png",
        }
    }

    /// Whether its file is a JPEG; the others are PNG.
    pub fn is_jpeg(self) -> bool {
        self.file_name().ends_with(".jpg")
    }
}

/// An 8-bit picture, top row first, with three or four channels.
pub struct Picture {
    width: u32,
    height: u32,
    channels: u32,
    bytes: Vec<u8>,
}

/// Rounds a value in [0, 1] to a byte.
fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

impl Picture {
    /// Paints an RGB picture: `color` maps texture coordinates to display-encoded colour in [0, 1].
    fn paint(width: u32, height: u32, color: impl Fn(Vec2) -> Vec3) -> Self {
        let size = Vec2::new(width as f32, height as f32);
        let mut bytes = Vec::with_capacity((width * height * 3) as usize);
        for y in 0..height {
            for x in 0..width {
                let pixel = color(Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size);
                bytes.extend(pixel.to_array().map(byte));
            }
        }
        Self { width, height, channels: 3, bytes }
    }

    /// The picture as an encoded file.
    fn encode(&self, jpeg: bool) -> image::ImageResult<Vec<u8>> {
        let color =
            if self.channels == 4 { image::ExtendedColorType::Rgba8 } else { image::ExtendedColorType::Rgb8 };
        let mut file = Vec::new();
        if jpeg {
            JpegEncoder::new_with_quality(&mut file, 90).write_image(
                &self.bytes,
                self.width,
                self.height,
                color,
            )?;
        } else {
            PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Sub).write_image(
                &self.bytes,
                self.width,
                self.height,
                color,
            )?;
        }
        Ok(file)
    }
}

/// A square field of heights that tiles.
struct Heights {
    size: u32,
    values: Vec<f32>,
}

impl Heights {
    /// Samples a height function of texture coordinates.
    fn sample(size: u32, height: impl Fn(Vec2) -> f32) -> Self {
        let mut values = Vec::with_capacity((size * size) as usize);
        for y in 0..size {
            for x in 0..size {
                values.push(height(Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size as f32));
            }
        }
        Self { size, values }
    }

    /// The height at a pixel; coordinates wrap.
    fn at(&self, x: i32, y: i32) -> f32 {
        let size = self.size as i32;
        self.values[(y.rem_euclid(size) * size + x.rem_euclid(size)) as usize]
    }

    /// The height nearest to a texture coordinate.
    fn nearest(&self, uv: Vec2) -> f32 {
        let pixel = (uv * self.size as f32).as_ivec2();
        self.at(pixel.x, pixel.y)
    }

    /// The tangent-space normal map (red to the right, green up in the picture); `relief` is the
    /// height of 1 in units of the texture's side.
    fn normal_map(&self, relief: f32) -> Picture {
        let scale = relief * self.size as f32 / 2.0;
        Picture::paint(self.size, self.size, |uv| {
            let pixel = (uv * self.size as f32).as_ivec2();
            let right = self.at(pixel.x + 1, pixel.y) - self.at(pixel.x - 1, pixel.y);
            let down = self.at(pixel.x, pixel.y + 1) - self.at(pixel.x, pixel.y - 1);
            Vec3::new(-right * scale, down * scale, 1.0).normalize() * 0.5 + 0.5
        })
    }
}

/// Mixes two colours.
fn blend(from: Vec3, to: Vec3, t: f32) -> Vec3 {
    Vec3::new(lerp(from.x, to.x, t), lerp(from.y, to.y, t), lerp(from.z, to.z, t))
}

/// A picture and what it is for.
type Painted = (Texture, Picture);

/// Paints and encodes every texture; the order does not depend on the number of threads.
///
/// # Errors
/// When an encoder refuses a picture.
pub fn paint_all() -> Result<Vec<(Texture, Vec<u8>)>> {
    const JOBS: [fn() -> Vec<Painted>; 13] = [
        plants::sky,
        masonry::blocks,
        masonry::paving,
        masonry::cobbles,
        plants::earth,
        ornament::mosaic,
        masonry::roof,
        masonry::marble,
        masonry::plaster,
        plants::wood,
        plants::water,
        ornament::fabrics,
        plants::foliage,
    ];
    let next = Mutex::new(JOBS.iter());
    let files = Mutex::new(Vec::new());
    let workers = std::thread::available_parallelism().map_or(1, |count| count.get()).min(JOBS.len());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let job = next.lock().ok().and_then(|mut jobs| jobs.next());
                    let Some(job) = job else { break };
                    for (texture, picture) in job() {
                        let file = picture.encode(texture.is_jpeg());
                        if let Ok(mut files) = files.lock() {
                            files.push((texture, file));
                        }
                    }
                }
            });
        }
    });
    let mut files = files.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    files.sort_by_key(|(texture, _)| *texture);
    files
        .into_iter()
        .map(|(texture, file)| Ok((texture, file.context(|| format!("encoding {}", texture.file_name()))?)))
        .collect()
}
