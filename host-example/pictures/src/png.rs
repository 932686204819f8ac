//! Chunks of PNG files: whether all are there, and what they say of colours and of the shape of pixels.
//!
//! Source: Portable Network Graphics, third edition (W3C, 2025), sections 5 and 11.3.2.

use crate::cicp;
use crate::display::densities;
use crate::meaning::Meaning;
use crate::primaries::{Change, Chromaticities, REC709};
use crate::transfer::Transfer;

/// Length of the signature at the start.
const SIGNATURE: usize = 8;
/// Bytes of a chunk beside its data: length, type and checksum.
const FRAME: usize = 12;
/// End of the first chunk, which others follow.
const HEAD: usize = SIGNATURE + FRAME + 13;
/// Unit of numbers in `gAMA` and `cHRM`.
const UNIT: f32 = 100_000.0;
/// Numbers that files of sRGB have in `gAMA`: their curve is no power.
const OF_SRGB: std::ops::Range<u32> = 45_000..46_000;

/// Chunks of a file, in their order, and whether the last is there.
struct Chunks<'a> {
    rest: &'a [u8],
}

impl<'a> Iterator for Chunks<'a> {
    type Item = ([u8; 4], &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let length = u32::from_be_bytes(*self.rest.first_chunk()?) as usize;
        let kind = *self.rest.get(4..8)?.first_chunk()?;
        let data = self.rest.get(8..)?.get(..length)?;
        self.rest = self.rest.get(length.saturating_add(FRAME)..)?;
        Some((kind, data))
    }
}

fn chunks(bytes: &[u8]) -> Chunks<'_> {
    Chunks { rest: bytes.get(SIGNATURE..).unwrap_or_default() }
}

/// True where the last chunk is there. Decoders have all pixels before it, and some of the one before it.
pub fn is_whole(bytes: &[u8]) -> bool {
    chunks(bytes).any(|(kind, _)| kind == *b"IEND")
}

/// Meaning of a file's numbers, and whether its profile counts; `has_profile` says that there is one. Code points go before a
/// profile, that before `sRGB`, and that before gamma and chromaticities.
pub fn meant(bytes: &[u8], mut meaning: Meaning, has_profile: bool) -> (Meaning, bool) {
    let before = || chunks(bytes).take_while(|(kind, _)| kind != b"IDAT");
    let chunk = |wanted: &[u8; 4]| before().find(|(kind, _)| kind == wanted).map(|(_, data)| data);
    if let Some(&[primaries, transfer, matrix, range]) = chunk(b"cICP") {
        if matrix != 0 || range != 1 {
            let problem = "its cICP tells of luma or of a limited range, which is left aside";
            meaning.warnings.push(problem.to_owned());
        }
        match (cicp::primaries(primaries), cicp::transfer(transfer)) {
            (Some(primaries), Some(transfer)) => {
                return (Meaning { primaries, transfer, said_by: Some("cICP"), ..meaning }, false);
            }
            _ => {
                meaning.warnings.push(format!("its cICP {primaries} {transfer} is not known and left aside"))
            }
        }
    }
    if has_profile {
        return (meaning, true);
    }
    if chunk(b"sRGB").is_some() {
        return (Meaning { said_by: Some("sRGB"), ..meaning }, false);
    }
    let numbers = |data: &[u8]| -> Vec<u32> {
        data.as_chunks::<4>().0.iter().map(|number| u32::from_be_bytes(*number)).collect()
    };
    if let Some(written) = chunk(b"cHRM") {
        match chromaticities(&numbers(written)) {
            Some(primaries) => {
                meaning.primaries = primaries;
                meaning.said_by = Some("cHRM");
            }
            None => meaning.warnings.push("its cHRM spans no colours and is left aside".to_owned()),
        }
    }
    if let Some(written) = chunk(b"gAMA") {
        meaning.said_by = meaning.said_by.or(Some("gAMA"));
        match numbers(written).first() {
            None | Some(0) => meaning.warnings.push("its gAMA is none and left aside".to_owned()),
            Some(gamma) if OF_SRGB.contains(gamma) && meaning.has_primaries(REC709) => {}
            Some(100_000) => meaning.transfer = Transfer::Linear,
            Some(gamma) => meaning.transfer = Transfer::Gamma(UNIT / *gamma as f32),
        }
    }
    (meaning, false)
}

/// Width of a pixel over its height, where the file says that they differ.
pub fn pixel_aspect(bytes: &[u8]) -> Option<f32> {
    let mut before = chunks(bytes).take_while(|(kind, _)| kind != b"IDAT");
    let (_, data) = before.find(|(kind, _)| kind == b"pHYs")?;
    let number = |at: usize| Some(u32::from_be_bytes(*data.get(at..)?.first_chunk()?));
    let (across, down) = (number(0)?, number(4)?);
    let aspect = (f64::from(down) / f64::from(across)) as f32;
    Some(aspect).filter(|aspect| (0.01..=100.0).contains(aspect) && across != down)
}

/// A file that says in no unit how its pixels are shaped, where they are not square.
pub fn with_shape(mut file: Vec<u8>, pixel_aspect: f32) -> Vec<u8> {
    if pixel_aspect == 1.0 || file.len() < HEAD {
        return file;
    }
    let [across, down] = densities(pixel_aspect).map(u32::to_be_bytes);
    let mut shape = Vec::new();
    chunk(&mut shape, *b"pHYs", &[&across[..], &down, &[0]].concat());
    file.splice(HEAD..HEAD, shape);
    file
}

/// Primaries of `cHRM`, which has white first.
fn chromaticities(numbers: &[u32]) -> Option<Chromaticities> {
    let &[wx, wy, rx, ry, gx, gy, bx, by] = numbers else { return None };
    let found = [rx, ry, gx, gy, bx, by, wx, wy].map(|number| number as f32 / UNIT);
    Change::new(found, REC709).map(|_| found)
}

/// True where chunks other than a profile can say what numbers mean: chromaticities in them are not negative, as those of
/// ACES2065-1 are.
pub fn can_say(meaning: &Meaning) -> bool {
    meaning.primaries.iter().all(|v| *v >= 0.0)
}

/// A file with chunks that say what its numbers mean, where that is not what is assumed without. Code points say it all; gamma
/// and chromaticities say it to older programs as well as they can.
pub fn with_meaning(mut file: Vec<u8>, meaning: &Meaning) -> Vec<u8> {
    if meaning.is_usual() || file.len() < HEAD {
        return file;
    }
    let mut said = Vec::new();
    let codes = (cicp::code_of_primaries(meaning.primaries), cicp::code_of_transfer(&meaning.transfer));
    if let (Some(primaries), Some(transfer)) = codes {
        chunk(&mut said, *b"cICP", &[primaries, transfer, 0, 1]);
    }
    let gamma = match meaning.transfer {
        Transfer::Linear => Some(1.0),
        Transfer::Srgb => Some(0.45455),
        Transfer::Gamma(gamma) => Some(1.0 / gamma),
        // Of the curve of cameras, and on a display of BT.1886.
        Transfer::Rec709 => Some(0.51),
        Transfer::Pq | Transfer::Hlg | Transfer::Curves(_) => None,
    };
    if let Some(gamma) = gamma {
        chunk(&mut said, *b"gAMA", &number(gamma).to_be_bytes());
        let [rx, ry, gx, gy, bx, by, wx, wy] = meaning.primaries;
        if can_say(meaning) {
            let data: Vec<u8> =
                [wx, wy, rx, ry, gx, gy, bx, by].iter().flat_map(|v| number(*v).to_be_bytes()).collect();
            chunk(&mut said, *b"cHRM", &data);
        }
    }
    file.splice(HEAD..HEAD, said);
    file
}

fn number(value: f32) -> u32 {
    (value * UNIT).round() as u32
}

/// Puts a chunk at the end of `file`.
fn chunk(file: &mut Vec<u8>, kind: [u8; 4], data: &[u8]) {
    file.extend((data.len() as u32).to_be_bytes());
    let start = file.len();
    file.extend(kind);
    file.extend(data);
    let sum = checksum(&file[start..]);
    file.extend(sum.to_be_bytes());
}

/// CRC-32 as PNG has it (annex D).
fn checksum(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0xedb8_8320;
    !bytes.iter().fold(!0, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ (POLYNOMIAL * (sum & 1)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primaries::{P3, REC2020};

    fn file() -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(24, 16, |x, y| image::Rgb([x as u8, y as u8, (x * y) as u8]));
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn whole_files_end_and_every_beginning_of_one_does_not() {
        let bytes = file();
        assert!(is_whole(&bytes));
        assert!(is_whole(&[bytes.as_slice(), b"appended"].concat()));
        for length in 0..bytes.len() {
            assert!(!is_whole(&bytes[..length]), "{length} of {}", bytes.len());
        }
    }

    #[test]
    fn shapes_of_pixels_are_written_and_read() {
        for aspect in [1.0, 2.0, 0.75] {
            let bytes = with_shape(file(), aspect);
            assert!(is_whole(&bytes));
            assert_eq!(pixel_aspect(&bytes).unwrap_or(1.0), aspect);
            // The checksum is right.
            assert_eq!(image::load_from_memory(&bytes).unwrap().width(), 24);
            // Beginnings of files are no reason to fail.
            let told = (0..bytes.len()).filter_map(|length| pixel_aspect(&bytes[..length])).count();
            assert!(aspect == 1.0 || told > 0);
        }
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(with_meaning(file(), &Meaning::display()), file());
        for (primaries, transfer) in [
            (P3, Transfer::Srgb),
            (REC2020, Transfer::Pq),
            (REC2020, Transfer::Hlg),
            (REC709, Transfer::Linear),
            (REC709, Transfer::Gamma(1.8)),
            ([0.7347, 0.2653, 0.1596, 0.8404, 0.0366, 0.0001, 0.3457, 0.3585], Transfer::Gamma(1.8)),
        ] {
            let written = Meaning { primaries, transfer, ..Meaning::display() };
            let bytes = with_meaning(file(), &written);
            // The checksums are right.
            let decoded = image::load_from_memory(&bytes).unwrap();
            assert_eq!(decoded.width(), 24);
            let (read, _) = meant(&bytes, Meaning::display(), false);
            assert!(read.has_primaries(primaries), "{read:?}");
            match (&read.transfer, &written.transfer) {
                (Transfer::Gamma(read), Transfer::Gamma(written)) => assert!((read - written).abs() < 1e-3),
                (read, written) => assert_eq!(read, written),
            }
        }
    }

    fn with(said: &[([u8; 4], &[u8])]) -> Vec<u8> {
        let mut chunks = Vec::new();
        said.iter().for_each(|(kind, data)| chunk(&mut chunks, *kind, data));
        let mut bytes = file();
        bytes.splice(HEAD..HEAD, chunks);
        bytes
    }

    #[test]
    fn code_points_go_before_a_profile_and_that_before_the_rest() {
        let gamma: ([u8; 4], &[u8]) = (*b"gAMA", &100_000u32.to_be_bytes());
        let p3: ([u8; 4], &[u8]) = (*b"cICP", &[12, 13, 0, 1]);
        let srgb: ([u8; 4], &[u8]) = (*b"sRGB", &[0]);
        let read = |said: &[_], has_profile| meant(&with(said), Meaning::display(), has_profile);
        let (meaning, counts) = read(&[p3, gamma], true);
        assert_eq!((meaning.primaries, meaning.said_by, counts), (P3, Some("cICP"), false));
        assert!(read(&[gamma], true).1);
        assert_eq!(read(&[srgb, gamma], false).0.transfer, Transfer::Srgb);
        assert_eq!(read(&[gamma], false).0.transfer, Transfer::Linear);
        let usual: ([u8; 4], &[u8]) = (*b"gAMA", &45_455u32.to_be_bytes());
        assert_eq!(read(&[usual], false).0.transfer, Transfer::Srgb);
    }

    #[test]
    fn what_is_not_known_is_warned_of() {
        let unknown: [([u8; 4], &[u8]); 4] = [
            (*b"cICP", &[3, 13, 0, 1]),
            (*b"cICP", &[1, 13, 1, 0]),
            (*b"cHRM", &[0; 32]),
            (*b"gAMA", &[0; 4]),
        ];
        for said in unknown {
            let (meaning, _) = meant(&with(&[said]), Meaning::display(), false);
            assert_eq!(meaning.warnings.len(), 1, "{said:?}");
        }
    }
}
