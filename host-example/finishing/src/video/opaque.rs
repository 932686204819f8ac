//! Frames without alpha, for videos that hold none.

use isophote_pictures::pixels::{Pixels, Precision, Samples};

/// The same frame of 16 bits, put on black where it is transparent.
pub fn on_black(frame: &Pixels) -> Pixels {
    let pixels = frame.clone().converted(Precision::U16);
    let Samples::U16(samples) = pixels.samples() else { return pixels };
    if pixels.channels() != 4 {
        return pixels;
    }
    let over = |v: u16, a: u16| ((u32::from(v) * u32::from(a) + 32767) / 65535) as u16;
    let pixel = |[r, g, b, a]: &[u16; 4]| [*r, *g, *b].map(|v| over(v, *a));
    let samples = samples.as_chunks::<4>().0.iter().flat_map(pixel).collect();
    // As many samples as the size says.
    Pixels::new(pixels.width(), pixels.height(), 3, Samples::U16(samples)).unwrap_or(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_transparent_is_black() {
        let frame = Pixels::new(2, 1, 4, Samples::U8(vec![200, 100, 255, 255, 200, 100, 255, 51])).unwrap();
        let expected = [200 * 257, 100 * 257, 65535, 40 * 257, 20 * 257, 51 * 257];
        assert_eq!(on_black(&frame).samples(), &Samples::U16(expected.to_vec()));
        let grey = Pixels::new(1, 1, 1, Samples::U8(vec![3])).unwrap();
        assert_eq!(on_black(&grey).samples(), &Samples::U16(vec![771]));
    }
}
