//! Palettes of Adobe's programs: swatches for exchange (`.ase`) and Photoshop's colour swatches (`.aco`).
//!
//! Sources: "Adobe Photoshop File Formats Specification" (color swatches; color structures); O. Barthelemy, "File formats"
//! (selapa.net) for `.ase`, of which Adobe has no document. Numbers are of the most significant byte first. Every reader gives the
//! problem as a sentence without a subject.

use super::spaces::{Colour, of_hsb, of_inks, of_lab, rounded};

/// First bytes of swatches for exchange.
pub const EXCHANGE: &[u8] = b"ASEF";
/// Kinds of blocks in them: a colour. Others begin and end groups.
const COLOUR: u16 = 1;

/// Colours of a file.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Swatches {
    /// The colours, in their order.
    pub colours: Vec<Colour>,
    /// Number of those that are of inks.
    pub inks: usize,
    /// Number of those that were left out, since they are of books of colours, such as Pantone's.
    pub unread: usize,
}

/// Reads swatches for exchange.
pub fn exchange(bytes: &[u8]) -> Result<Swatches, String> {
    let mut rest = Bytes(bytes.get(EXCHANGE.len()..).unwrap_or_default());
    let head = (rest.word(), rest.word(), rest.long());
    let (Some(_), Some(_), Some(blocks)) = head else { return Err("ends within its head".into()) };
    let mut swatches = Swatches::default();
    for number in 1..=blocks {
        let block = (|| Some((rest.word()?, rest.block()?)))();
        let (kind, block) = block.ok_or_else(|| format!("ends within block {number} of {blocks}"))?;
        if kind == COLOUR {
            swatches.add(exchanged(block).map_err(|e| format!("{e} in block {number} of {blocks}"))?);
        }
    }
    Ok(swatches)
}

/// The colour of a block: its name, four letters for its space, and numbers from 0 to 1; those of Lab are lightness from 0
/// to 1, and a and b as they are.
fn exchanged(block: &[u8]) -> Result<Read, String> {
    let mut rest = Bytes(block);
    let short = || "ends within a colour".to_owned();
    let letters = rest.word().ok_or_else(short)?;
    rest.take(usize::from(letters) * 2).ok_or_else(short)?;
    let space = rest.take(4).ok_or_else(short)?;
    let colour = match space {
        b"RGB " => rest.floats().map(|rgb| Read::Colour(rounded(rgb))),
        b"Gray" => rest.floats().map(|[v]| Read::Colour(rounded([v; 3]))),
        b"CMYK" => rest.floats().map(|inks| Read::Inks(of_inks(inks))),
        b"LAB " => rest.floats().map(|[l, a, b]| Read::Colour(of_lab([l * 100.0, a, b]))),
        _ => return Err(format!("has the unknown space '{}'", space.escape_ascii())),
    };
    colour.ok_or_else(|| "has a colour that is cut short or no number".into())
}

/// Reads Photoshop's swatches, of both versions; a file may have first one list and then the other, which is the same with names.
pub fn photoshop(bytes: &[u8]) -> Result<Swatches, String> {
    let mut rest = Bytes(bytes);
    let (version, count) = rest.word().zip(rest.word()).ok_or("ends within its head")?;
    let mut swatches = Swatches::default();
    for number in 1..=count {
        let colour = (|| {
            let colour = [rest.word()?, rest.word()?, rest.word()?, rest.word()?, rest.word()?];
            if version == 2 {
                let letters = rest.long()?;
                rest.take(usize::try_from(letters).ok()?.checked_mul(2)?)?;
            }
            Some(colour)
        })();
        let colour = colour.ok_or_else(|| format!("ends within colour {number} of {count}"))?;
        swatches.add(of_photoshop(colour));
    }
    Ok(swatches)
}

/// A colour of Photoshop: the number of its space, and four numbers, of which inks are what they leave of the paper.
fn of_photoshop([space, a, b, c, d]: [u16; 5]) -> Read {
    let full = |v: u16| f32::from(v) / 65535.0;
    let signed = |v: u16| f32::from(v.cast_signed()) / 100.0;
    match space {
        0 => Read::Colour(rounded([a, b, c].map(full))),
        1 => Read::Colour(of_hsb([a, b, c].map(full))),
        2 => Read::Inks(of_inks([a, b, c, d].map(|v| 1.0 - full(v)))),
        7 => Read::Colour(of_lab([f32::from(a) / 100.0, signed(b), signed(c)])),
        8 => Read::Colour(rounded([f32::from(a) / 10_000.0; 3])),
        _ => Read::Unread,
    }
}

/// A colour as it was read.
#[derive(Clone, Copy)]
enum Read {
    Colour(Colour),
    Inks(Colour),
    Unread,
}

impl Swatches {
    fn add(&mut self, read: Read) {
        match read {
            Read::Colour(colour) => self.colours.push(colour),
            Read::Inks(colour) => {
                self.inks += 1;
                self.colours.push(colour);
            }
            Read::Unread => self.unread += 1,
        }
    }
}

/// Bytes that are still to be read. Nothing is allocated by what they say.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn word(&mut self) -> Option<u16> {
        self.take(2)?.try_into().ok().map(u16::from_be_bytes)
    }

    fn long(&mut self) -> Option<u32> {
        self.take(4)?.try_into().ok().map(u32::from_be_bytes)
    }

    /// As many bytes as a number before them says.
    fn block(&mut self) -> Option<&'a [u8]> {
        let length = self.long()?;
        self.take(usize::try_from(length).ok()?)
    }

    /// Numbers, all of them finite.
    fn floats<const N: usize>(&mut self) -> Option<[f32; N]> {
        let mut floats = [0.0; N];
        for float in &mut floats {
            *float = f32::from_bits(self.long()?);
        }
        floats.iter().all(|v| v.is_finite()).then_some(floats)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Swatches for exchange with these colours in a group, each with a name.
    fn ase(colours: &[(&[u8; 4], &[f32])]) -> Vec<u8> {
        let name: Vec<u8> = "Rot\0".encode_utf16().flat_map(u16::to_be_bytes).collect();
        let mut blocks = vec![(0xc001_u16, [&[0, 4][..], &name].concat())];
        for (space, numbers) in colours {
            let numbers: Vec<u8> = numbers.iter().flat_map(|v| v.to_be_bytes()).collect();
            blocks.push((1, [&[0, 4][..], &name, &space[..], &numbers, &[0, 2]].concat()));
        }
        blocks.push((0xc002, vec![]));
        let mut bytes = [b"ASEF", &[0, 1, 0, 0][..], &(blocks.len() as u32).to_be_bytes()].concat();
        for (kind, block) in blocks {
            bytes.extend(kind.to_be_bytes());
            bytes.extend((block.len() as u32).to_be_bytes());
            bytes.extend(block);
        }
        bytes
    }

    #[test]
    fn swatches_for_exchange_have_four_spaces() {
        let bytes = ase(&[
            (b"RGB ", &[1.0, 0.5, 0.0]),
            (b"Gray", &[0.2]),
            (b"CMYK", &[0.0, 1.0, 1.0, 0.5]),
            (b"LAB ", &[1.0, 0.0, 0.0]),
            (b"LAB ", &[0.5429, 80.81, 69.89]),
        ]);
        let read = exchange(&bytes).unwrap();
        assert_eq!(read.colours, [[255, 128, 0], [51; 3], [128, 0, 0], [255; 3], [255, 0, 0]]);
        assert_eq!((read.inks, read.unread), (1, 0));
        let wild = exchange(&ase(&[(b"RGB ", &[9.0, -1.0, 1e30]), (b"LAB ", &[1e30, -1e30, 1e30])])).unwrap();
        assert_eq!(wild.colours.len(), 2);
        assert_eq!(wild.colours[0], [255, 0, 255]);
    }

    #[test]
    fn broken_swatches_for_exchange_are_refused_wherever_they_end() {
        let bytes = ase(&[(b"RGB ", &[1.0, 0.5, 0.0]), (b"Gray", &[0.2])]);
        for end in EXCHANGE.len()..bytes.len() {
            let problem = exchange(&bytes[..end]).unwrap_err();
            assert!(problem.starts_with("ends within"), "{end}: {problem}");
        }
        for (space, numbers) in [(b"RGB ", [f32::NAN; 3]), (b"LAB ", [f32::INFINITY; 3])] {
            assert!(exchange(&ase(&[(space, &numbers)])).unwrap_err().contains("no number in block 2 of 3"));
        }
        assert!(exchange(&ase(&[(b"CMYK", &[1.0])])).unwrap_err().contains("cut short"));
        assert!(exchange(&ase(&[(b"XYZ ", &[1.0; 3])])).unwrap_err().contains("'XYZ '"));
        let mut many = bytes.clone();
        many[8..12].fill(0xff);
        assert!(exchange(&many).unwrap_err().contains("ends within block 5 of 4294967295"));
        let mut long = bytes;
        long[14..18].fill(0xff);
        assert!(exchange(&long).unwrap_err().contains("ends within block 1 of 4"));
    }

    /// A list of Photoshop's swatches.
    fn aco(version: u16, colours: &[[u16; 5]]) -> Vec<u8> {
        let mut words = vec![version, colours.len() as u16];
        for colour in colours {
            words.extend(colour);
            if version == 2 {
                words.extend([0, 3, 0x41, 0x42, 0]);
            }
        }
        words.into_iter().flat_map(u16::to_be_bytes).collect()
    }

    const MANY: [[u16; 5]; 7] = [
        [0, 65535, 32896, 0, 0],
        [1, 21845, 65535, 65535, 0],
        [2, 65535, 0, 0, 65535],
        [7, 10_000, 0, 0, 0],
        [7, 5429, 8081, 6989, 0],
        [8, 2000, 0, 0, 0],
        [7, 2957, 6830, 0_u16.wrapping_sub(11203), 0],
    ];
    const READ: [Colour; 7] =
        [[255, 128, 0], [0, 255, 0], [255, 0, 0], [255; 3], [255, 0, 0], [51; 3], [0, 0, 255]];

    #[test]
    fn swatches_of_photoshop_have_five_spaces_and_two_versions() {
        for bytes in [aco(1, &MANY), aco(2, &MANY), [aco(1, &MANY), aco(2, &MANY)].concat()] {
            let read = photoshop(&bytes).unwrap();
            assert_eq!((read.colours, read.inks, read.unread), (READ.to_vec(), 1, 0));
        }
        let book = photoshop(&aco(1, &[[3, 1, 2, 3, 4], MANY[0]])).unwrap();
        assert_eq!((book.colours, book.unread), (vec![READ[0]], 1));
    }

    #[test]
    fn broken_swatches_of_photoshop_are_refused_wherever_they_end() {
        for version in [1, 2] {
            let bytes = aco(version, &MANY);
            for end in 0..bytes.len() {
                assert!(photoshop(&bytes[..end]).unwrap_err().starts_with("ends within"), "{end}");
            }
        }
        let mut long = aco(2, &MANY[..1]);
        long[14..18].fill(0xff);
        assert!(photoshop(&long).unwrap_err().contains("colour 1 of 1"));
    }
}
