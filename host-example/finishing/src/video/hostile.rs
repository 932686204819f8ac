//! Headers and answers made to do harm: whatever they say, ffmpeg is given numbers and words of closed lists.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

use super::closed::{MATRICES, PIXELS, PRIMARIES, RANGES, SPACES, TRANSFERS};
use super::decode::{OnError, Origin, decoder};
use super::encode::{Encoding, More};
use super::probe;
use super::stream::Stream;
use super::timed::Times;
use super::tracks::Tracks;
use super::y4m::Header;

/// Signs that separate words within arguments.
const SIGNS: [char; 5] = [',', ':', '=', '/', '+'];
/// Snippets that attacks are made of.
const SNIPPETS: [&str; 24] = [
    ",vidstabdetect=result=/tmp/x",
    ",movie=/etc/passwd[a];[a]overlay",
    "1:1,null",
    "'",
    "\\",
    ";",
    "[",
    "]",
    "%",
    " ",
    "\0",
    "\n",
    "\r",
    "-i",
    "file:/etc/passwd",
    "pipe:0",
    "concat:a|b",
    "4294967296",
    "-1",
    "0",
    "1e9",
    "é",
    "nan",
    ":",
];

/// Numbers that look like chance and are the same every time.
struct Chance(u64);

impl Chance {
    fn below(&mut self, count: usize) -> usize {
        // Source: G. Marsaglia, "Xorshift RNGs", 2003.
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % count.max(1) as u64) as usize
    }

    /// The same text with some harm done to it.
    fn spoil(&mut self, text: &[u8]) -> Vec<u8> {
        let mut bytes = text.to_vec();
        for _ in 0..=self.below(4) {
            let (at, end) = (self.below(bytes.len() + 1), self.below(bytes.len() + 1));
            match self.below(5) {
                0 => drop(bytes.splice(at..at, SNIPPETS[self.below(SNIPPETS.len())].bytes())),
                1 => drop(bytes.drain(at.min(end)..at.max(end).min(at.min(end) + 8))),
                2 => bytes.insert(at, self.below(256) as u8),
                3 => drop(bytes.splice(at..at, bytes[at.min(end)..end].to_vec())),
                _ => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << self.below(8)),
            }
        }
        bytes
    }
}

/// Arguments of both commands that a stream leads to.
fn arguments(stream: &Stream) -> Vec<Vec<String>> {
    let output = Path::new("out.mp4");
    let tracks = Tracks::default();
    let encoding = |times| Encoding {
        stream,
        channels: stream.channels(),
        more: Some(More { path: Path::new("in.mp4"), tracks: &tracks, start: 1.5 }),
        times,
        output,
        options: None,
    };
    let words = |command: &Command| command.get_args().map(|a| a.to_str().unwrap().to_owned()).collect();
    let decode = |origin| words(&decoder(origin, stream, Some(1.5), OnError::Fail));
    vec![
        decode(Origin::Raw((4, 4))),
        decode(Origin::Piped),
        decode(Origin::File(Path::new("in.mp4"))),
        words(&encoding(None).encoder(Some(output))),
        words(&encoding(Some(&Times { shown: vec![0.0, 0.5], last: None })).encoder(Some(output))),
    ]
}

/// Words that arguments may be made of.
fn known() -> BTreeSet<String> {
    let mut plain = Stream::of_frames((4, 4), super::closed::Ratio::ONE);
    let mut known: BTreeSet<String> = PIXELS.iter().map(|word| (*word).to_owned()).collect();
    known.extend(["auto", "unknown"].map(str::to_owned));
    for pairs in [&SPACES[..], &TRANSFERS, &PRIMARIES, &RANGES, &MATRICES] {
        known.extend(pairs.iter().map(|(_, word)| (*word).to_owned()));
    }
    for (fields, decoder) in [(None, None), (Some("tff"), Some("libvpx")), (Some("bff"), Some("libvpx-vp9"))]
    {
        for pixels in ["yuv420p", "rgba", "gbrp10le"] {
            (plain.fields, plain.decoder, plain.pixels) = (fields, decoder, pixels);
            let words = arguments(&plain).into_iter().flatten();
            words.for_each(|word| known.extend(word.split(SIGNS).map(str::to_owned)));
        }
    }
    known
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.len() <= 10 && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Makes sure that a stream leads to arguments of known words and numbers, put together as always.
fn check(stream: &Stream, known: &BTreeSet<String>, from: &str) {
    let filters = |words: &[String]| {
        let at = words.iter().position(|word| word == "-vf").unwrap() + 1;
        words[at].chars().filter(|c| SIGNS.contains(c)).collect::<String>()
    };
    let plain = Stream { fields: stream.fields, ..Stream::of_frames((4, 4), super::closed::Ratio::ONE) };
    for (words, plain) in arguments(stream).into_iter().zip(arguments(&plain)) {
        assert_eq!(filters(&words), filters(&plain), "{from}: {words:?}");
        for word in words {
            let is_size = word.split_once('x').is_some_and(|(w, h)| is_number(w) && is_number(h));
            let is_closed = is_size || word.split(SIGNS).all(|part| is_number(part) || known.contains(part));
            assert!(is_closed, "{from}: '{word}' reaches ffmpeg");
        }
    }
}

#[test]
fn no_text_of_a_stream_reaches_ffmpeg() {
    let bases: [&[u8]; 4] = [
        b"YUV4MPEG2 W64 H48 F30000:1001 Ip A4:3 C422p10 XCOLORRANGE=FULL",
        b"YUV4MPEG2 W64 H48 F25:1 It A1:1 C420jpeg XYSCSS=420JPEG XCOLORRANGE=LIMITED",
        b"YUV4MPEG2 W64 H48 F25:1 A1:1,vidstabdetect=result=/tmp/x C444alpha",
        b"YUV4MPEG2 W9 H7",
    ];
    let (mut chance, known) = (Chance(0x9E37_79B9_7F4A_7C15), known());
    let (mut understood, mut refused) = (0, 0);
    for turn in 0..20_000 {
        let mut line = chance.spoil(bases[turn % bases.len()]);
        line.extend(b"\nFRAME\n");
        let from = String::from_utf8_lossy(&line).into_owned();
        let Ok(header) = Header::read("standard input", &mut &line[..]) else {
            refused += 1;
            continue;
        };
        understood += 1;
        check(&header.stream(None), &known, &from);
        // What ffmpeg gets is a header that says the same.
        let anew = header.line();
        let again = Header::read("standard input", &mut anew.as_bytes()).unwrap();
        assert_eq!((again.line(), again.stream(None)), (anew.clone(), header.stream(None)), "{from}");
        let is_plain = |c: char| c.is_ascii_alphanumeric() || ": =?\n".contains(c);
        assert!(anew.chars().all(is_plain) && anew.matches('\n').count() == 1, "{from}: {anew}");
    }
    assert!(understood > 3000 && refused > 3000, "{understood} understood, {refused} refused");
}

#[test]
fn no_text_of_a_file_reaches_ffmpeg() {
    let plain = json!({
        "pix_fmt": "yuv420p10le", "avg_frame_rate": "30000/1001", "r_frame_rate": "30000/1001", "nb_frames": "50",
        "duration": "2.0", "time_base": "1/12800", "field_order": "tb", "codec_name": "vp9", "sample_aspect_ratio": "4:3", "color_range": "pc", "color_space": "bt2020nc",
        "color_transfer": "bt470bg", "color_primaries": "bt470m",
    });
    let (mut chance, known) = (Chance(0x2545_F491_4F6C_DD1D), known());
    let mut unknown = 0;
    for _ in 0..5_000 {
        let mut stream = plain.clone();
        for value in stream.as_object_mut().unwrap().values_mut() {
            if chance.below(3) == 0 {
                let bytes = chance.spoil(value.as_str().unwrap().as_bytes());
                *value = String::from_utf8_lossy(&bytes).into();
            }
        }
        (stream["width"], stream["height"]) = (64.into(), 48.into());
        let from = stream.to_string();
        let found = json!({"streams": [stream], "format": {"format_name": "mov", "nb_streams": 1}});
        let (stream, names) = probe::understand(Path::new("a.mp4"), &found).unwrap();
        unknown += names.len();
        check(&stream, &known, &from);
    }
    assert!(unknown > 1000, "{unknown} values are unknown");
    for bad in
        [Value::Null, json!([]), json!({"streams": {}}), json!({"streams": [{"width": -1, "height": "4"}]})]
    {
        assert!(probe::understand(Path::new("a.mp4"), &bad).is_err(), "{bad}");
    }
}
