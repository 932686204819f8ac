//! Images of textures that are made of others: coverage from a mask, and channels that files keep apart.

use glam::Vec3;
use image::imageops::FilterType;
use image::{RgbaImage, imageops};

use super::budget::Budget;
use super::material::{AlphaMode, Image};

/// Coverage below and above which a texel is not there, or is.
const HALF: std::ops::Range<u8> = 26..230;

impl Image {
    /// Treatment of the alpha that the image holds. None at all is what some programs write where they mean nothing.
    pub fn alpha_mode(&self) -> AlphaMode {
        let texels = self.rgba.as_chunks::<4>().0;
        if texels.iter().all(|t| t[3] == 255) || texels.iter().all(|t| t[3] == 0) {
            return AlphaMode::Opaque;
        }
        let between = texels.iter().filter(|t| HALF.contains(&t[3])).count();
        // Edges of holes are soft; glass and smoke are soft throughout.
        if between * 4 <= texels.len() { AlphaMode::Mask { cutoff: 0.5 } } else { AlphaMode::Blend }
    }

    /// The image with all of it covered.
    pub fn make_opaque(&mut self) {
        self.rgba.as_chunks_mut::<4>().0.iter_mut().for_each(|texel| texel[3] = 255);
    }

    /// The image at another size.
    ///
    /// # Errors
    /// A clause saying that the budget does not allow it.
    pub fn resized(&self, width: u32, height: u32, budget: &Budget) -> Result<Self, String> {
        budget.take(width as usize * height as usize, 4)?;
        let rgba = if (width, height) == (self.width, self.height) {
            self.rgba.clone()
        } else {
            let source = RgbaImage::from_raw(self.width, self.height, self.rgba.clone());
            let source = source.ok_or("has fewer texels than its size")?;
            imageops::resize(&source, width, height, FilterType::Triangle).into_raw()
        };
        Ok(Self { name: self.name.clone(), width, height, rgba })
    }
}

/// Height of white above black in a map of heights, as a part of the width of the map. Formats leave it open.
const HIGHEST: f32 = 0.02;

/// Normals of a map of heights, which are taken of its texels by `height` and multiplied by `factor`. Beyond its sides it
/// repeats itself, or its edge where it is to be clamped.
///
/// # Errors
/// A clause saying that the budget does not allow it.
pub fn normals_of(
    image: &Image,
    factor: f32,
    clamp: bool,
    height: impl Fn([u8; 4]) -> u8,
    budget: &Budget,
) -> Result<Image, String> {
    let (across, down) = (image.width as usize, image.height as usize);
    budget.take(across * down, 4)?;
    let texels = image.rgba.as_chunks::<4>().0;
    let scale = factor * HIGHEST * across.max(down) as f32 / 255.0;
    let beside = |at: usize, count: usize| {
        if clamp {
            [at.saturating_sub(1), (at + 1).min(count - 1)]
        } else {
            [at + count - 1, at + 1].map(|at| at % count)
        }
    };
    let slope = |places: [usize; 2]| {
        let [before, after] = places.map(|place| f32::from(height(texels[place])));
        (after - before) * 0.5 * scale
    };
    let mut rgba = Vec::with_capacity(texels.len() * 4);
    for y in 0..down {
        let rows = beside(y, down);
        for x in 0..across {
            let right = slope(beside(x, across).map(|x| y * across + x));
            let below = slope(rows.map(|y| y * across + x));
            // Rows go down, and green points up.
            let normal = Vec3::new(-right, below, 1.0).normalize_or(Vec3::Z);
            let [r, g, b] = normal.to_array().map(|n| ((n * 0.5 + 0.5) * 255.0).round() as u8);
            rgba.extend([r, g, b, 255]);
        }
    }
    Ok(Image { name: image.name.clone(), rgba, ..*image })
}

/// Combines two images texel by texel, at the size of the larger one.
///
/// # Errors
/// A clause saying that the budget does not allow it.
pub fn combined(
    name: String,
    first: &Image,
    second: &Image,
    budget: &Budget,
    combine: impl Fn([u8; 4], [u8; 4]) -> [u8; 4],
) -> Result<Image, String> {
    let (width, height) = (first.width.max(second.width), first.height.max(second.height));
    let mut made = first.resized(width, height, budget)?;
    let other = second.resized(width, height, budget)?;
    for (texel, other) in made.rgba.as_chunks_mut::<4>().0.iter_mut().zip(other.rgba.as_chunks::<4>().0) {
        *texel = combine(*texel, *other);
    }
    Ok(Image { name, ..made })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(alphas: &[u8]) -> Image {
        let rgba = alphas.iter().flat_map(|a| [10, 20, 30, *a]).collect();
        Image { name: "a".into(), width: alphas.len() as u32, height: 1, rgba }
    }

    #[test]
    fn alpha_is_a_cutout_or_a_blend() {
        for (alphas, mode) in [
            (&[255; 8][..], AlphaMode::Opaque),
            (&[0; 8], AlphaMode::Opaque),
            (&[0, 0, 0, 128, 255, 255, 255, 255], AlphaMode::Mask { cutoff: 0.5 }),
            (&[128; 8], AlphaMode::Blend),
        ] {
            assert_eq!(image(alphas).alpha_mode(), mode, "{alphas:?}");
        }
    }

    #[test]
    fn the_larger_size_is_kept() {
        let both =
            combined("b".into(), &image(&[255]), &image(&[0, 0, 200, 200]), &Budget::default(), |a, b| {
                [a[0], a[1], a[2], b[3]]
            });
        let both = both.unwrap();
        assert_eq!((both.width, both.rgba[3], both.rgba[15]), (4, 0, 200));
        assert!(image(&[1]).resized(100, 100, &Budget::new(10)).is_err());
    }
}
