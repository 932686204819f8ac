//! Mixing of results by masks, where no node of the library does it: in the manner of its port `mask`, by coverage and in
//! gamma-encoded colours.

use rayon::prelude::*;

use crate::pixels::{Pixels, Samples};
use crate::space::Space;
use crate::transfer::{srgb_decode, srgb_encode};

/// Number that infinities become, as in the library.
const LARGEST_HALF: f32 = 65504.0;

/// Encoding of the colours that are mixed.
#[derive(Clone, Copy, Debug)]
pub struct Encoding {
    /// True where colour is multiplied by alpha.
    pub is_premultiplied: bool,
    /// Its space.
    pub space: Space,
}

/// `above` where the mask is 1, `below` where it is 0, both to the bit as far as the precision of `above` holds them. `below`
/// may have fewer channels than `above`: grey, or no alpha.
pub fn mixed(below: &Pixels, above: Pixels, mask: &Pixels, encoding: Encoding) -> Pixels {
    let channels = above.channels() as usize;
    let size = (above.width(), above.height());
    if (below.width(), below.height()) != size
        || (mask.width(), mask.height()) != size
        || mask.channels() != 1
    {
        return above;
    }
    let (under, mask) = (below.to_f32(), mask.to_f32());
    let count = below.channels() as usize;
    let mut numbers = above.to_f32();
    let pixels =
        numbers.par_chunks_exact_mut(channels).zip(under.par_chunks_exact(count)).zip(mask.par_iter());
    pixels.for_each(|((to, from), share)| {
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
        if share == 1.0 {
            return;
        }
        let below = rgba(from);
        let pixel = match share {
            0.0 => below,
            _ => blend(below, rgba(to), share, encoding),
        };
        for (to, value) in to.iter_mut().zip(pixel) {
            *to = value;
        }
    });
    let precision = above.precision();
    match Pixels::new(size.0, size.1, above.channels(), Samples::F32(numbers)) {
        Some(mixed) => mixed.converted(precision),
        None => above,
    }
}

/// A pixel with four channels, of finite numbers.
fn rgba(pixel: &[f32]) -> [f32; 4] {
    let [r, g, b, a] = match *pixel {
        [r, g, b, a, ..] => [r, g, b, a.clamp(0.0, 1.0)],
        [r, g, b] => [r, g, b, 1.0],
        [v, ..] => [v, v, v, 1.0],
        [] => [0.0; 4],
    };
    [r, g, b, a].map(|v| if v.is_nan() { 0.0 } else { v.clamp(-LARGEST_HALF, LARGEST_HALF) })
}

fn blend(below: [f32; 4], above: [f32; 4], share: f32, encoding: Encoding) -> [f32; 4] {
    let is_premultiplied = encoding.is_premultiplied;
    let weights = [below[3] * (1.0 - share), above[3] * share];
    // Light without coverage has no colour of its own.
    if is_premultiplied && (below[3] == 0.0 || above[3] == 0.0) || weights == [0.0; 2] {
        let mut mixed = below;
        mixed.iter_mut().zip(above).for_each(|(a, b)| *a += (b - *a) * share);
        return mixed;
    }
    let is_encoded = encoding.space == Space::Srgb;
    let alpha = weights[0] + weights[1];
    let color = |pixel: [f32; 4], c: usize| {
        let value = if is_premultiplied { pixel[c] / pixel[3] } else { pixel[c] };
        if is_encoded { value } else { srgb_encode(value) }
    };
    let mut mixed = [alpha; 4];
    for (c, value) in mixed.iter_mut().take(3).enumerate() {
        let encoded = (weights[0] * color(below, c) + weights[1] * color(above, c)) / alpha;
        let plain = if is_encoded { encoded } else { srgb_decode(encoded) };
        *value = if is_premultiplied { plain * alpha } else { plain };
    }
    mixed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pixels::Precision;

    fn pixels(channels: u32, numbers: &[f32]) -> Pixels {
        Pixels::new(numbers.len() as u32 / channels, 1, channels, Samples::F32(numbers.to_vec())).unwrap()
    }

    const SCENE: Encoding = Encoding { is_premultiplied: true, space: Space::Linear };
    const DISPLAY: Encoding = Encoding { is_premultiplied: false, space: Space::Srgb };

    #[test]
    fn where_the_mask_is_whole_nothing_is_reckoned() {
        let (below, above) = (pixels(3, &[0.1, 7.3, -0.2, f32::NAN, 0.3, 0.4]), pixels(3, &[9.0; 6]));
        let mixed = mixed(&below, above, &pixels(1, &[0.0, 1.0]), SCENE);
        assert_eq!(mixed.to_f32(), [0.1, 7.3, -0.2, 9.0, 9.0, 9.0]);
        // Grey becomes a colour, and what has no alpha is opaque.
        let grey = super::mixed(&pixels(1, &[0.5]), pixels(4, &[0.0; 4]), &pixels(1, &[0.0]), DISPLAY);
        assert_eq!(grey.to_f32(), [0.5, 0.5, 0.5, 1.0]);
        let bytes = |v: u8| Pixels::new(1, 1, 3, Samples::U8(vec![v; 3])).unwrap();
        let kept = super::mixed(&bytes(77), bytes(200), &pixels(1, &[0.0]), DISPLAY);
        assert_eq!((kept.precision(), kept.bytes()), (Precision::U8, &[77u8; 3][..]));
    }

    #[test]
    fn parts_are_mixed_by_coverage_in_encoded_colours() {
        let half = mixed(&pixels(3, &[0.0; 3]), pixels(3, &[1.0; 3]), &pixels(1, &[0.5]), SCENE).to_f32();
        assert!(half.iter().all(|v| (v - srgb_decode(0.5)).abs() < 1e-6), "{half:?}");
        let encoded = mixed(&pixels(3, &[0.0; 3]), pixels(3, &[1.0; 3]), &pixels(1, &[0.25]), DISPLAY);
        assert_eq!(encoded.to_f32(), [0.25; 3]);
        // What is not covered lends no colour; its light stays.
        let straight = mixed(
            &pixels(4, &[9.0, 9.0, 9.0, 0.0]),
            pixels(4, &[0.5, 0.5, 0.5, 1.0]),
            &pixels(1, &[0.5]),
            DISPLAY,
        );
        assert_eq!(straight.to_f32(), [0.5, 0.5, 0.5, 0.5]);
        let glow = mixed(&pixels(4, &[4.0, 2.0, 0.0, 0.0]), pixels(4, &[0.0; 4]), &pixels(1, &[0.5]), SCENE);
        assert_eq!(glow.to_f32(), [2.0, 1.0, 0.0, 0.0]);
    }
}
