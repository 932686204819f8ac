//! Pictures painted by formulas, and fields of heights that become normal maps.

use crate::noise::lerp;
use glam::{Vec2, Vec3};
use image::ImageEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};

/// An 8-bit picture, top row first, with three or four channels.
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub channels: u32,
    pub bytes: Vec<u8>,
}

/// Rounds a value in [0, 1] to a byte.
pub fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

impl Picture {
    /// Paints an RGB picture: `color` maps texture coordinates to display-encoded colour in [0, 1].
    pub fn paint(width: u32, height: u32, color: impl Fn(Vec2) -> Vec3) -> Self {
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
    pub fn encode(&self, jpeg: bool) -> image::ImageResult<Vec<u8>> {
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
pub struct Heights {
    size: u32,
    values: Vec<f32>,
}

impl Heights {
    /// Samples a height function of texture coordinates.
    pub fn sample(size: u32, height: impl Fn(Vec2) -> f32) -> Self {
        let mut values = Vec::with_capacity((size * size) as usize);
        for y in 0..size {
            for x in 0..size {
                values.push(height(Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size as f32));
            }
        }
        Self { size, values }
    }

    /// The height at a pixel; coordinates wrap.
    pub fn at(&self, x: i32, y: i32) -> f32 {
        let size = self.size as i32;
        self.values[(y.rem_euclid(size) * size + x.rem_euclid(size)) as usize]
    }

    /// The height nearest to a texture coordinate.
    pub fn nearest(&self, uv: Vec2) -> f32 {
        let pixel = (uv * self.size as f32).as_ivec2();
        self.at(pixel.x, pixel.y)
    }

    /// The tangent-space normal map (red to the right, green up in the picture); `relief` is the
    /// height of 1 in units of the texture's side.
    pub fn normal_map(&self, relief: f32) -> Picture {
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
pub fn blend(from: Vec3, to: Vec3, t: f32) -> Vec3 {
    Vec3::new(lerp(from.x, to.x, t), lerp(from.y, to.y, t), lerp(from.z, to.z, t))
}
