//! YUV4MPEG streams: their first line in numbers and words of closed lists, and their frames on the way to ffmpeg.
//!
//! Nothing that a stream says is never handed on. ffmpeg gets a line that is made anew, and pixels.

use std::io::{self, BufRead, Read, Write};
use std::path::Path;

use super::closed::{PIXELS, Ratio, usual_matrix, word};
use super::stream::{Promise, Stream};
use isophote_files::error::{Error, Result};
use isophote_pictures::read::check_size;

/// Beginning of every stream.
pub const MAGIC: &[u8] = b"YUV4MPEG2";
/// Beginning of every frame.
const FRAME: &[u8] = b"FRAME";
/// Longest first line of a stream or a frame.
const MOST_HEADER: u64 = 1024;

/// Forms of pixels: names in streams, those of ffmpeg, and over how many columns and rows chroma reaches.
#[rustfmt::skip]
const FORMS: [(&str, &str, [u32; 2]); 28] = [
    ("420", "yuv420p", [2, 2]), ("420jpeg", "yuv420p", [2, 2]), ("420mpeg2", "yuv420p", [2, 2]),
    ("420paldv", "yuv420p", [2, 2]), ("411", "yuv411p", [4, 1]), ("422", "yuv422p", [2, 1]), ("444", "yuv444p", [1, 1]),
    ("444alpha", "yuva444p", [1, 1]), ("mono", "gray", [0, 0]),
    ("420p9", "yuv420p9", [2, 2]), ("422p9", "yuv422p9", [2, 1]), ("444p9", "yuv444p9", [1, 1]),
    ("420p10", "yuv420p10", [2, 2]), ("422p10", "yuv422p10", [2, 1]), ("444p10", "yuv444p10", [1, 1]),
    ("420p12", "yuv420p12", [2, 2]), ("422p12", "yuv422p12", [2, 1]), ("444p12", "yuv444p12", [1, 1]),
    ("420p14", "yuv420p14", [2, 2]), ("422p14", "yuv422p14", [2, 1]), ("444p14", "yuv444p14", [1, 1]),
    ("420p16", "yuv420p16", [2, 2]), ("422p16", "yuv422p16", [2, 1]), ("444p16", "yuv444p16", [1, 1]),
    ("mono9", "gray9", [0, 0]), ("mono10", "gray10", [0, 0]), ("mono12", "gray12", [0, 0]), ("mono16", "gray16", [0, 0]),
];

/// The first line of a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    size: [u32; 2],
    rate: Ratio,
    aspect: Option<Ratio>,
    /// Order of the fields of a frame, by the letter for it.
    fields: Option<char>,
    /// An entry of [`FORMS`].
    form: (&'static str, &'static str, [u32; 2]),
    is_full: bool,
    /// Names of what is unknown in it.
    pub unknown: Vec<&'static str>,
}

impl Header {
    /// Reads it, up to the first frame.
    ///
    /// # Errors
    /// [`Error::Input`] for anything else than such a stream.
    pub fn read(place: &str, from: &mut impl BufRead) -> Result<Self> {
        let fix = "pipe YUV4MPEG into it, as ffmpeg -f yuv4mpegpipe writes it";
        let wrong = |problem: &str| Error::input(place, problem, fix);
        let line = line(from).ok().flatten().ok_or_else(|| wrong("is no YUV4MPEG stream"))?;
        let mut words = line.split(|byte| *byte == b' ').map(|word| str::from_utf8(word).unwrap_or("?"));
        if words.next().map(str::as_bytes) != Some(MAGIC) {
            return Err(wrong("is no YUV4MPEG stream"));
        }
        let words: Vec<&str> = words.collect();
        let word = |letter: char| words.iter().find_map(|word| word.strip_prefix(letter));
        let number = |text: &str| text.parse::<u32>().ok().filter(|_| !text.starts_with('+'));
        let size = |letter| word(letter).and_then(number);
        let (width, height) = size('W').zip(size('H')).ok_or_else(|| wrong("says no size"))?;
        check_size(Path::new(place), width.into(), height.into())?;
        let name = word('C').unwrap_or("420");
        let form = FORMS.iter().find(|(known, ..)| *known == name);
        let mut unknown = Vec::new();
        let rate = word('F').and_then(|rate| Ratio::parse(rate, ':')?.as_rate());
        if rate.is_none() {
            unknown.push("rate of frames");
        }
        let aspect = word('A').filter(|aspect| *aspect != "0:0").map(|aspect| Ratio::parse(aspect, ':'));
        if aspect == Some(None) {
            unknown.push("aspect");
        }
        Ok(Self {
            size: [width, height],
            rate: rate.unwrap_or(Ratio::USUAL_RATE),
            aspect: aspect.flatten(),
            fields: word('I')
                .and_then(|text| ['p', 't', 'b', 'm'].into_iter().find(|c| text == c.to_string())),
            form: *form.ok_or_else(|| wrong("has pixels of an unknown form"))?,
            is_full: words.contains(&"XCOLORRANGE=FULL"),
            unknown,
        })
    }

    /// The line anew.
    pub fn line(&self) -> String {
        let [width, height] = self.size;
        let (rate, form) = (self.rate.with(':'), self.form.0);
        let aspect = self.aspect.map_or_else(|| "0:0".to_owned(), |aspect| aspect.with(':'));
        let fields = self.fields.unwrap_or('?');
        let range = if self.is_full { "FULL" } else { "LIMITED" };
        format!("YUV4MPEG2 W{width} H{height} F{rate} I{fields} A{aspect} C{form} XCOLORRANGE={range}\n")
    }

    /// Bytes of a frame's pixels.
    pub fn frame(&self) -> u64 {
        let [width, height] = self.size.map(u64::from);
        let (name, pixels, [across, down]) = self.form;
        let chroma = match (across, down) {
            (0, _) | (_, 0) => 0,
            _ => 2 * width.div_ceil(across.into()) * height.div_ceil(down.into()),
        };
        let alpha = if pixels.starts_with("yuva") { width * height } else { 0 };
        let bytes = if is_deep(name) { 2 } else { 1 };
        (width * height + chroma + alpha) * bytes
    }

    /// The stream that it begins, of which so many bytes follow where that is known.
    pub fn stream(&self, bytes: Option<u64>) -> Stream {
        let [width, height] = self.size;
        let range = if self.is_full { "pc" } else { "tv" };
        let (name, pixels, _) = self.form;
        let ending = match (is_deep(name), cfg!(target_endian = "little")) {
            (false, _) => "",
            (true, true) => "le",
            (true, false) => "be",
        };
        let frame = self.frame() + FRAME.len() as u64 + 1;
        Stream {
            index: 0,
            width,
            height,
            rate: self.rate,
            grid: self.rate,
            tick: self.rate.inverse(),
            fields: match self.fields {
                Some('t') => Some("tff"),
                Some('b') => Some("bff"),
                _ => None,
            },
            decoder: None,
            is_animation: false,
            frames: bytes.map_or(0, |bytes| bytes / frame),
            // Frames are counted on their way.
            promise: Promise::None,
            pixels: word(&PIXELS, &format!("{pixels}{ending}")).unwrap_or("yuv420p"),
            aspect: self.aspect.unwrap_or(Ratio::ONE),
            range,
            matrix: usual_matrix(height),
            tags: vec![["-color_range", range]],
        }
    }

    /// Hands a stream's frames on until it ends, or nobody takes them. Returns what is wrong with its end.
    pub fn relay(&self, from: &mut impl BufRead, into: &mut impl Write) -> Option<String> {
        into.write_all(self.line().as_bytes()).ok()?;
        for number in 1_u64.. {
            let begins = match line(from) {
                Ok(None) => return None,
                Ok(Some(line)) => {
                    line.strip_prefix(FRAME).is_some_and(|rest| matches!(rest, [] | [b' ', ..]))
                }
                Err(_) => false,
            };
            if !begins {
                return Some(format!("does not go on with a frame after {} frames", number - 1));
            }
            into.write_all(FRAME).and_then(|()| into.write_all(b"\n")).ok()?;
            // What fails here is the decoder, which says why.
            let bytes = io::copy(&mut from.by_ref().take(self.frame()), into).ok()?;
            if bytes < self.frame() {
                let all = self.frame();
                return Some(format!("is cut short: it has {bytes} of {all} bytes of frame {number}"));
            }
        }
        None
    }
}

/// True where samples of a form have more than 8 bits, which its name ends with.
fn is_deep(form: &str) -> bool {
    let bits = form.strip_prefix("mono").or_else(|| form.rsplit_once('p').map(|(_, bits)| bits));
    bits.is_some_and(|bits| bits.parse::<u8>().is_ok())
}

/// A line without its end; nothing at the end of all.
fn line(from: &mut impl BufRead) -> io::Result<Option<Vec<u8>>> {
    let mut line = Vec::new();
    from.by_ref().take(MOST_HEADER).read_until(b'\n', &mut line)?;
    match line.pop() {
        None => Ok(None),
        Some(b'\n') => Ok(Some(line)),
        Some(_) => Err(io::ErrorKind::InvalidData.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(line: &[u8]) -> Result<Header> {
        Header::read("standard input", &mut &line[..])
    }

    #[test]
    fn headers_are_read_and_made_anew() {
        let full =
            header(b"YUV4MPEG2 W64 H48 F30000:1001 Ip A4:3 C422p10 XCOLORRANGE=FULL\nFRAME\n").unwrap();
        let stream = full.stream(None);
        assert_eq!((stream.width, stream.height, stream.rate.with('/').as_str()), (64, 48, "30000/1001"));
        assert_eq!((stream.pixels.trim_end_matches(['l', 'b', 'e']), stream.range), ("yuv422p10", "pc"));
        assert_eq!(full.frame(), 64 * 48 * 2 * 2);
        assert_eq!(full.line(), "YUV4MPEG2 W64 H48 F30000:1001 Ip A4:3 C422p10 XCOLORRANGE=FULL\n");
        let plain = header(b"YUV4MPEG2 W5 H3 F25:1\n").unwrap();
        assert_eq!(plain.line(), "YUV4MPEG2 W5 H3 F25:1 I? A0:0 C420 XCOLORRANGE=LIMITED\n");
        assert_eq!((plain.frame(), plain.unknown.len()), (15 + 2 * 6, 0));
        let odd = header(b"YUV4MPEG2 W5 H3 F0:1 A1:1,null=x C411 I\n").unwrap();
        assert_eq!(odd.unknown, ["rate of frames", "aspect"]);
        assert_eq!(odd.line(), "YUV4MPEG2 W5 H3 F25:1 I? A0:0 C411 XCOLORRANGE=LIMITED\n");
        for bad in [
            &b""[..],
            b"RIFF....",
            b"YUV4MPEG2 W64\n",
            b"YUV4MPEG2 W0 H4\n",
            b"YUV4MPEG2 W+4 H4\n",
            b"YUV4MPEG2 W4 H4 Codd\n",
            b"YUV4MPEG2 W4 H4",
            &[b'Y'; 5000],
        ] {
            assert!(header(bad).is_err(), "{:?}", String::from_utf8_lossy(bad));
        }
    }

    #[test]
    fn every_form_is_one_of_ffmpegs() {
        for (name, pixels, _) in FORMS {
            let header = header(format!("YUV4MPEG2 W4 H4 F1:1 C{name}\n").as_bytes()).unwrap();
            assert!(header.stream(None).pixels.starts_with(pixels), "{name}");
        }
    }

    #[test]
    fn frames_are_handed_on_and_cut_ones_noticed() {
        let header = header(b"YUV4MPEG2 W2 H2 F1:1 Cmono\n").unwrap();
        let relay = |frames: &[u8]| {
            let mut into = Vec::new();
            let said = header.relay(&mut &frames[..], &mut into);
            (said, String::from_utf8(into).unwrap().strip_prefix(&header.line()).unwrap().to_owned())
        };
        assert_eq!(relay(b"FRAME\nabcdFRAME Ip\nefgh"), (None, "FRAME\nabcdFRAME\nefgh".into()));
        let (said, handed) = relay(b"FRAME\nabcdFRAME\nef");
        assert!(said.is_some_and(|s| s.contains("2 of 4 bytes of frame 2")));
        assert_eq!(handed, "FRAME\nabcdFRAME\nef");
        for bad in [&b"FRAME\nabcdFRAMES\nefgh"[..], b"FRAME\nabcdFRAME", b"FRAME\nabcd\n"] {
            let (said, handed) = relay(bad);
            assert!(said.is_some_and(|s| s.contains("after 1 frames")), "{bad:?}");
            assert_eq!(handed, "FRAME\nabcd");
        }
    }
}
