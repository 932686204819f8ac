//! The picture that previews show, in main memory, and what it is on the screen.

use std::sync::Arc;

use egui::{Color32, ColorImage};
use rayon::prelude::*;

use crate::state::document::frame::Frame;
use crate::state::things::Things;
use isophote_pictures::primaries::{Change, REC709};
use isophote_pictures::space::Space;
use isophote_pictures::transfer::{srgb_decode, srgb_encode};

/// Side of the squares behind transparent pictures, in pixels of the preview.
const SQUARE: usize = 8;
/// Grey of the squares, gamma-encoded.
const SQUARES: [f32; 2] = [0.28, 0.22];

/// The picture that looks are tried on.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The pixels, with what is known beside colour.
    pub frame: Arc<Frame>,
    /// Things in them, where rules of looks may be for them.
    pub things: Option<Things>,
    /// Pixels across and down of the whole picture, of which the frame may be a smaller copy.
    pub size: (u32, u32),
    /// Factor on light when it is shown.
    pub exposure: f32,
}

/// Meaning of the numbers of a result.
#[derive(Clone, Copy, Debug)]
pub struct Meaning {
    /// Their space.
    pub space: Space,
    /// True where colour is multiplied by alpha.
    pub is_premultiplied: bool,
}

impl Picture {
    /// The size over that of the whole picture of a copy so many pixels across.
    pub fn scale(&self, width: u32) -> f32 {
        width as f32 / self.size.0.max(1) as f32
    }

    /// The largest size of its own shape, at least one pixel and no larger than the frame, that lies within a size.
    pub fn fitting(&self, within: [f32; 2]) -> (u32, u32) {
        let (width, height) = (self.frame.width as f32, self.frame.height as f32);
        let scale = (within[0] / width).min(within[1] / height).clamp(0.0, 1.0);
        let pixels = |length: f32| ((length * scale).round() as u32).max(1);
        (pixels(width), pixels(height))
    }

    /// The frame's own numbers.
    pub fn meaning(&self) -> Meaning {
        let is_premultiplied = self.frame.is_premultiplied();
        let space = match self.frame.request.space {
            Space::Srgb => Space::Srgb,
            Space::Acescg => Space::Acescg,
            _ => Space::Linear,
        };
        Meaning { space, is_premultiplied }
    }
}

/// Colours, rows of `width`, as they are shown: each pixel is the mean light of squares of `fineness` by `fineness`.
pub fn shown(
    colors: &[[f32; 4]],
    width: usize,
    fineness: usize,
    meaning: Meaning,
    exposure: f32,
) -> ColorImage {
    let across = width / fineness;
    let down = colors.len() / width.max(1) / fineness;
    let primaries = Some(meaning.space.primaries()).filter(|from| *from != REC709);
    let change = primaries.and_then(|from| Change::new(from, REC709));
    let mut pixels = vec![Color32::BLACK; across * down];
    pixels.par_chunks_mut(across.max(1)).enumerate().for_each(|(y, line)| {
        for (x, pixel) in line.iter_mut().enumerate() {
            let mut sum = [0.0; 4];
            for row in 0..fineness {
                let start = (y * fineness + row) * width + x * fineness;
                for color in &colors[start..start + fineness] {
                    let light = light(*color, meaning, change.as_ref());
                    sum.iter_mut().zip(light).for_each(|(sum, part)| *sum += part);
                }
            }
            let count = (fineness * fineness) as f32;
            let behind = SQUARES[(x / SQUARE + y / SQUARE) % 2];
            *pixel = encoded(sum.map(|part| part / count), exposure, srgb_decode(behind));
        }
    });
    ColorImage::new([across, down], pixels)
}

/// Premultiplied light of Rec.709.
fn light([r, g, b, a]: [f32; 4], meaning: Meaning, change: Option<&Change>) -> [f32; 4] {
    let mut rgb = [r, g, b];
    if meaning.space == Space::Srgb {
        rgb = rgb.map(srgb_decode);
    }
    if let Some(change) = change {
        rgb = change.apply(rgb);
    }
    if !meaning.is_premultiplied {
        rgb = rgb.map(|value| value * a);
    }
    let [r, g, b] = rgb;
    [r, g, b, a]
}

fn encoded([r, g, b, a]: [f32; 4], exposure: f32, behind: f32) -> Color32 {
    let uncovered = behind * (1.0 - a).clamp(0.0, 1.0);
    let [r, g, b] = [r, g, b].map(|value| {
        let value = srgb_encode((value * exposure + uncovered).clamp(0.0, 1.0));
        (value * 255.0).round() as u8
    });
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_averaged_and_shown_over_squares() {
        let display = Meaning { space: Space::Srgb, is_premultiplied: false };
        let black_and_white = [[0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 1.0, 1.0]];
        let image = shown(&black_and_white.repeat(2), 2, 2, display, 1.0);
        assert_eq!((image.size, image.pixels[0]), ([1, 1], Color32::from_gray(188)), "half the light");
        let image = shown(&black_and_white, 2, 1, display, 1.0);
        assert_eq!(image.pixels, [Color32::BLACK, Color32::WHITE]);
        let linear = Meaning { space: Space::Linear, is_premultiplied: true };
        let image = shown(&[[0.25, 0.25, 0.25, 1.0], [0.0; 4]], 2, 1, linear, 2.0);
        assert_eq!(image.pixels, [Color32::from_gray(188), Color32::from_gray(71)], "a stop more; nothing");
    }
}
