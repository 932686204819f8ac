//! Filters of attributes that meshopt compresses, "Appendix B: Filters" of KHR_meshopt_compression: unit vectors,
//! turns, floats and colours from the numbers that stand for them.

/// Replaces each element of four numbers of `N / 4` bytes.
fn each<const N: usize>(data: &mut [u8], replace: impl Fn([u8; N]) -> [u8; N]) {
    data.as_chunks_mut::<N>().0.iter_mut().for_each(|element| *element = replace(*element));
}

fn words(element: [u8; 8]) -> [i16; 4] {
    [0, 2, 4, 6].map(|k| i16::from_le_bytes([element[k], element[k + 1]]))
}

fn bytes(words: [u16; 4]) -> [u8; 8] {
    let [[a, b], [c, d], [e, f], [g, h]] = words.map(u16::to_le_bytes);
    [a, b, c, d, e, f, g, h]
}

/// Unit vectors of bytes from places on an octahedron; the fourth number stays.
pub fn octahedral_8(data: &mut [u8]) {
    each(data, |element: [u8; 4]| {
        let [x, y, one, _] = element.map(|byte| f32::from(byte as i8));
        let [x, y, z] = unit([x, y], one).map(|v| (v * 127.0).round() as i8 as u8);
        [x, y, z, element[3]]
    });
}

/// As [`octahedral_8`], of 16-bit numbers.
pub fn octahedral_16(data: &mut [u8]) {
    each(data, |element| {
        let words = words(element);
        let [x, y, one, _] = words.map(f32::from);
        let [x, y, z] = unit([x, y], one).map(|v| (v * 32767.0).round() as i16 as u16);
        bytes([x, y, z, words[3] as u16])
    });
}

/// The unit vector at a place on an octahedron.
fn unit([x, y]: [f32; 2], one: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// Unit quaternions of 16-bit numbers from their three smaller numbers.
pub fn quaternion(data: &mut [u8]) {
    each(data, |element| {
        let words = words(element);
        let one = f32::from(words[3] | 3);
        let [x, y, z] = [0, 1, 2].map(|k| f32::from(words[k]) / one * std::f32::consts::FRAC_1_SQRT_2);
        let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let largest = (words[3] & 3) as usize;
        let mut out = [0; 4];
        for (k, value) in [w, x, y, z].into_iter().enumerate() {
            out[(largest + k) % 4] = (value * 32767.0).round() as i16 as u16;
        }
        bytes(out)
    });
}

/// Floats from an exponent of 8 bits and a mantissa of 24.
pub fn exponential(data: &mut [u8]) {
    each(data, |element: [u8; 4]| {
        let value = i32::from_le_bytes(element);
        let (exponent, mantissa) = (value >> 24, value << 8 >> 8);
        // Powers of two are exact everywhere when their bits are written.
        let power = f64::from_bits(((1023 + exponent) as u64) << 52);
        ((f64::from(mantissa) * power) as f32).to_le_bytes()
    });
}

/// Colours of bytes from luma, two chromas and alpha.
pub fn color_8(data: &mut [u8]) {
    each(data, |element: [u8; 4]| {
        let [luma, orange, green, alpha] = element;
        let numbers = [luma.into(), i32::from(orange as i8), i32::from(green as i8), alpha.into()];
        color(numbers).map(|v| (v * 255.0).round() as u8)
    });
}

/// As [`color_8`], of 16-bit numbers.
pub fn color_16(data: &mut [u8]) {
    each(data, |element| {
        let [luma, orange, green, alpha] = words(element);
        let numbers = [i32::from(luma as u16), orange.into(), green.into(), i32::from(alpha as u16)];
        bytes(color(numbers).map(|v| (v * 65535.0).round() as u16))
    });
}

/// A colour of 0 to 1. The highest bit of alpha says of how many bits all numbers are.
fn color([luma, orange, green, alpha]: [i32; 4]) -> [f32; 4] {
    let most = (1 << (32 - alpha.leading_zeros())) - 1;
    let alpha = alpha & most >> 1;
    let rgba = [luma + orange - green, luma + green, luma - orange - green, alpha << 1 | alpha & 1];
    rgba.map(|v| v as f32 / most as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_vectors_of_both_hemispheres() {
        let mut data = [127, 0, 127, 5, 0, 0, 127, 1, 0x81, 0x7f, 127, 0, 64, 0xc0, 127, 0];
        octahedral_8(&mut data);
        let vectors = [0, 4, 8, 12].map(|at| [0, 1, 2, 3].map(|k| data[at + k] as i8));
        assert_eq!(vectors[..3], [[127, 0, 0, 5], [0, 0, 127, 1], [0, 0, -127, 0]]);
        assert_eq!(vectors[3], [90, -90, -1, 0]);
    }

    #[test]
    fn a_quaternion_without_its_largest_number() {
        let mut data = bytes([0, 0, 0, 32767 - 1]);
        quaternion(&mut data);
        assert_eq!(words(data), [0, 0, 32767, 0]);
    }

    #[test]
    fn floats_of_all_exponents() {
        for (exponent, mantissa, value) in [
            (0i8, 3, 3.0),
            (-2, -3, -0.75),
            (100, 1, 1.267_650_6e30),
            (-128, 1, 2f32.powi(-128)),
            (127, 2, f32::INFINITY),
        ] {
            let mut data = (i32::from(exponent) << 24 | mantissa & 0xff_ffff).to_le_bytes();
            exponential(&mut data);
            assert_eq!(f32::from_le_bytes(data), value);
        }
    }

    #[test]
    fn colours_of_any_number_of_bits() {
        // Of 8 bits: white of half alpha. Of 4 bits: the strongest red.
        let mut data = [255, 0, 0, 0x80 | 64, 3, 6, 0xfd, 0x08 | 7];
        color_8(&mut data);
        assert_eq!(data, [255, 255, 255, 128, 204, 0, 0, 255]);
        let mut data = bytes([0; 4]);
        color_16(&mut data);
        assert_eq!(data, [0; 8]);
    }
}
