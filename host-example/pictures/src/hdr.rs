//! Header of a Radiance HDR file: the programs that write it, and the primaries of its light.
//!
//! Source: the Radiance file format of Greg Ward, and his `rgbe.c`, whose files begin with `#?RGBE`.

use std::io::Cursor;

use image::ImageResult;
use image::codecs::hdr::HdrDecoder;

use crate::primaries::Chromaticities;

/// First bytes of the files of most programs.
const USUAL: &[u8] = b"#?RADIANCE";
/// The line with x and y of red, green, blue and white.
const PRIMARIES: &str = "PRIMARIES=";

/// A decoder that has read the header. Others than Radiance itself may write what they like behind `#?`.
///
/// # Errors
/// Errors of the decoder.
pub fn decoder(bytes: &[u8]) -> ImageResult<HdrDecoder<Cursor<&[u8]>>> {
    HdrDecoder::with_strictness(Cursor::new(bytes), bytes.starts_with(USUAL))
}

/// The primaries that the header names; nothing without, and for lines that are no eight numbers.
pub fn primaries(bytes: &[u8]) -> Option<Chromaticities> {
    let lines = bytes.split(|byte| *byte == b'\n').take_while(|line| !line.trim_ascii().is_empty());
    let values = lines.filter_map(|line| std::str::from_utf8(line).ok()?.trim().strip_prefix(PRIMARIES));
    let numbers = values.last()?.split_whitespace().map(|word| word.parse().ok());
    let numbers: Vec<f32> = numbers.collect::<Option<_>>()?;
    numbers.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn primaries_are_those_of_the_header() {
        let file = |line: &str| {
            format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{line}\n\n-Y 1 +X 1\nPRIMARIES=1").into_bytes()
        };
        let rec2020 = "PRIMARIES= .708 .292 .170 .797 .131 .046 .3127 .3290";
        assert_eq!(primaries(&file(rec2020)).map(|c| c[..2].to_vec()), Some(vec![0.708, 0.292]));
        for bad in ["PRIMARIES=", "PRIMARIES=1 2", "PRIMARIES=a b c d e f g h", "VIEW=x"] {
            assert_eq!(primaries(&file(bad)), None, "{bad}");
        }
    }
}
