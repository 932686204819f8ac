//! Animated WebP files, frame by frame.
//!
//! Source: Google, "WebP Container Specification".

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder, Rgba};

use crate::read::check_size;
use isophote_files::error::{Error, Result};

/// Milliseconds of frames that are said to last no time, as browsers have it.
const USUAL_LENGTH: u32 = 100;
const FIX: &str = "name an intact WebP file";

/// An animated WebP file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MovingWebp {
    /// The file.
    pub path: PathBuf,
    /// Size of its frames.
    pub size: (u32, u32),
    /// Milliseconds that its frames last; not empty.
    pub lengths: Vec<u32>,
}

impl MovingWebp {
    /// Reads how large its frames are, and how long they last.
    ///
    /// # Errors
    /// [`Error::Input`] for files that are cut short, hold no frames or frames that are too large.
    pub fn open(path: &Path) -> Result<Self> {
        let found = File::open(path).and_then(|file| parts(&mut BufReader::new(file)));
        let (size, lengths) = found
            .ok()
            .filter(|(_, lengths)| !lengths.is_empty())
            .ok_or_else(|| Error::file(path, "is damaged or cut short", FIX))?;
        check_size(path, size.0.into(), size.1.into())?;
        Ok(Self { path: path.to_owned(), size, lengths })
    }

    /// Hands all frames on, of 8 bits with alpha, until nobody takes them. Returns what is wrong with them.
    pub fn relay(&self, into: &mut impl Write) -> Option<String> {
        let damaged = |e: &dyn std::fmt::Display| Some(format!("is damaged: {e}"));
        let file = match File::open(&self.path) {
            Ok(file) => file,
            Err(e) => return Some(format!("cannot be read: {e}")),
        };
        let mut decoder = match WebPDecoder::new(BufReader::new(file)) {
            Ok(decoder) => decoder,
            Err(e) => return damaged(&e),
        };
        // Browsers show what is behind the picture there.
        if let Err(e) = decoder.set_background_color(Rgba([0; 4])) {
            return damaged(&e);
        }
        for frame in decoder.into_frames() {
            match frame {
                Ok(frame) if frame.buffer().dimensions() == self.size => {
                    // What fails here is the decoder behind, which says why.
                    into.write_all(frame.buffer()).ok()?;
                }
                Ok(_) => return damaged(&"it has frames of two sizes"),
                Err(e) => return damaged(&e),
            }
        }
        None
    }
}

/// Size of the pictures and milliseconds of each frame, from the parts of a file.
fn parts(file: &mut (impl Read + io::Seek)) -> io::Result<((u32, u32), Vec<u32>)> {
    let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte));
    let end = file.seek(io::SeekFrom::End(0))?;
    let mut at = 12;
    let (mut size, mut lengths) = ((0, 0), Vec::new());
    while at + 8 <= end {
        file.seek(io::SeekFrom::Start(at))?;
        let mut head = [0; 24];
        let known = usize::try_from(end - at).unwrap_or(usize::MAX).min(head.len());
        file.read_exact(&mut head[..known])?;
        let bytes = u64::from(number(&head[4..8]));
        match &head[..4] {
            b"VP8X" => size = (number(&head[12..15]) + 1, number(&head[15..18]) + 1),
            b"ANMF" => lengths.push(number(&head[20..23])),
            _ => {}
        }
        at += 8 + bytes + bytes % 2;
    }
    if at > end {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    lengths.iter_mut().filter(|length| **length == 0).for_each(|length| *length = USUAL_LENGTH);
    Ok((size, lengths))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    #[test]
    fn frames_are_counted_and_timed() {
        let part = |name: &[u8], bytes: &[u8]| [name, &(bytes.len() as u32).to_le_bytes(), bytes].concat();
        let frame = |length: u8| part(b"ANMF", &[&[0; 12][..], &[length, 0, 0, 0, 9, 9]].concat());
        let start = [&b"RIFF\0\0\0\0WEBP"[..], &part(b"VP8X", &[2, 0, 0, 0, 159, 0, 0, 89, 0, 0])].concat();
        let all = [&start[..], &frame(40), &frame(0), &frame(80)].concat();
        let (size, lengths) = parts(&mut Cursor::new(&all)).unwrap();
        assert_eq!((size, lengths.as_slice()), ((160, 90), &[40, 100, 80][..]));
        assert!(parts(&mut Cursor::new(&all[..all.len() - 3])).is_err());
    }
}
