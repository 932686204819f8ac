//! Between display-referred and scene-referred numbers, and between primaries.

use crate::pixels::{Pixels, Samples};
use crate::primaries::{Change, REC709};
use crate::read::ImageState;
use crate::space::{Space, srgb_decode, srgb_encode};

/// Turns colours that a graph gave for a picture of `from` in `space` into what a file of `to` holds. PNG and
/// JPEG become sRGB from whatever EXR held; EXR becomes light of the same primaries.
pub fn between(pixels: Pixels, from: ImageState, space: Space, to: ImageState) -> Pixels {
    if from == to {
        return pixels;
    }
    let (width, height, channels) = (pixels.width(), pixels.height(), pixels.channels());
    let change = space.primaries().and_then(|from| Change::new(from, REC709));
    let mut numbers = pixels.to_f32();
    for pixel in numbers.chunks_exact_mut(channels as usize) {
        let (color, alpha) = match pixel {
            [r, g, b, a] => ([r, g, b], *a),
            [r, g, b] => ([r, g, b], 1.0),
            _ => continue,
        };
        let [r, g, b] = color;
        let mut rgb = [*r, *g, *b];
        match to {
            ImageState::DisplayReferred => {
                if alpha > 0.0 {
                    rgb = rgb.map(|v| v / alpha);
                }
                if let Some(change) = &change {
                    rgb = change.apply(rgb);
                }
                if space != Space::Srgb {
                    rgb = rgb.map(srgb_encode);
                }
            }
            ImageState::SceneReferred => {
                if space == Space::Srgb {
                    rgb = rgb.map(srgb_decode);
                }
                rgb = rgb.map(|v| v * alpha);
            }
        }
        [*r, *g, *b] = rgb;
    }
    let samples = Samples::F32(numbers);
    // The number of samples is that of `pixels`.
    Pixels::new(width, height, channels, samples).unwrap_or(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_where_it_was() {
        let numbers: Vec<f32> =
            (0..8 * 4).map(|i| [0.0f32, 0.02, 0.5, 1.0][i % 4].max(0.01 * i as f32)).collect();
        let picture = Pixels::new(8, 1, 4, Samples::F32(numbers.clone())).unwrap();
        let light =
            between(picture.clone(), ImageState::DisplayReferred, Space::Srgb, ImageState::SceneReferred);
        assert_ne!(light, picture);
        let back =
            between(light, ImageState::SceneReferred, Space::Linear, ImageState::DisplayReferred).to_f32();
        for (a, b) in back.iter().zip(&numbers) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }

    #[test]
    fn white_stays_white_and_primaries_widen() {
        let aces = Pixels::new(2, 1, 3, Samples::F32(vec![1.0, 1.0, 1.0, 0.0, 1.0, 0.0])).unwrap();
        let display =
            between(aces, ImageState::SceneReferred, Space::Acescg, ImageState::DisplayReferred).to_f32();
        assert!(display[..3].iter().all(|v| (v - 1.0).abs() < 1e-6));
        assert!(display[3] < 0.0 && display[4] > 1.0);
    }
}
