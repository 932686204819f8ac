//! What a video says of itself.

use std::io::Read;
use std::path::Path;

use serde_json::Value;

use super::process::{self, Process};
use crate::apply::read::check_size;
use crate::error::{Error, Result};
use crate::output;

/// Longest first line of a YUV4MPEG stream.
const MOST_HEADER: usize = 1024;

/// Share by which the mean rate of frames that last equally long may be off.
const STEADY: f64 = 0.1;

/// The first stream of pictures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    /// Columns, as they are shown.
    pub width: u32,
    /// Rows, as they are shown.
    pub height: u32,
    /// Frames per second, a fraction such as 30000/1001.
    pub rate: String,
    /// Whether all frames last as long.
    pub is_steady: bool,
    /// Frames, about; 0 where nobody knows.
    pub frames: usize,
    /// Form of its pixels, such as yuv420p.
    pub pixels: String,
    /// Ratio of a pixel's sides, such as 1:1.
    pub aspect: String,
    /// From black to white: `tv` or `pc`.
    pub range: &'static str,
    /// The matrix between RGB and luma with chroma, as ffmpeg's filter names it.
    pub matrix: String,
    /// What the file says of its colours, by the options that say so of another.
    pub tags: Vec<[String; 2]>,
}

impl Stream {
    /// Of a file.
    ///
    /// # Errors
    /// [`Error::Input`] for files without pictures, [`Error::Failure`] where there is no ffmpeg.
    pub fn of_file(path: &Path) -> Result<Self> {
        const WANTED: &str = "stream=width,height,pix_fmt,avg_frame_rate,r_frame_rate,nb_frames,duration,\
            sample_aspect_ratio,color_range,color_space,color_transfer,color_primaries:stream_side_data=rotation";
        let mut command = process::command("ffprobe");
        command.args(["-v", "error", "-select_streams", "v:0", "-show_entries", WANTED, "-of", "json"]);
        let text = Process::output(command.arg("-i").arg(process::file(path)))
            .map_err(|problem| problem.of(path, "name a video that ffmpeg reads"))?;
        let found: Value = serde_json::from_str(&text).unwrap_or_default();
        let stream = &found["streams"][0];
        let none = || Error::file(path, "has no pictures", "name a video");
        let number = |name: &str| stream[name].as_u64().and_then(|n| u32::try_from(n).ok());
        let (width, height) = number("width").zip(number("height")).ok_or_else(none)?;
        let is_turned = stream["side_data_list"]
            .as_array()
            .into_iter()
            .flatten()
            .any(|side| side["rotation"].as_i64().is_some_and(|degrees| degrees.rem_euclid(180) == 90));
        let (width, height) = if is_turned { (height, width) } else { (width, height) };
        check_size(path, width.into(), height.into())?;
        let text =
            |name: &str| stream[name].as_str().filter(|v| !["unknown", "N/A", "0/0", "0:1"].contains(v));
        let [mean, exact] = ["avg_frame_rate", "r_frame_rate"].map(|name| text(name).unwrap_or("25/1"));
        // Containers round the times of frames, so that the mean is not what was meant.
        let is_steady = (fraction(exact) / fraction(mean) - 1.0).abs() < STEADY;
        let rate = if is_steady { exact } else { mean }.to_owned();
        let frames = text("nb_frames").and_then(|n| n.parse().ok());
        let seconds = text("duration").and_then(|n| n.parse::<f64>().ok());
        let tags = [
            ("-color_range", "color_range"),
            ("-colorspace", "color_space"),
            ("-color_trc", "color_transfer"),
            ("-color_primaries", "color_primaries"),
        ];
        let tags =
            tags.into_iter().filter_map(|(option, name)| Some([option.to_owned(), text(name)?.to_owned()]));
        if matches!(text("color_transfer"), Some("smpte2084" | "arib-std-b67")) {
            output::warn(format_args!("{}: is HDR and is filtered as it is encoded", path.display()));
        }
        Ok(Self {
            width,
            height,
            frames: frames.unwrap_or_else(|| seconds.map_or(0, |s| (s * fraction(&rate)) as usize)),
            rate,
            is_steady,
            pixels: text("pix_fmt").unwrap_or("yuv420p").to_owned(),
            aspect: text("sample_aspect_ratio").unwrap_or("1:1").to_owned(),
            range: if text("color_range") == Some("pc") || is_full(text("pix_fmt")) { "pc" } else { "tv" },
            matrix: matrix(text("color_space"), height),
            tags: tags.collect(),
        })
    }

    /// Of frames of our own, as most players take them: so many a second, of an even number of rows and columns.
    pub fn of_frames((width, height): (u32, u32), rate: f64) -> Self {
        const HD: &str = "bt709";
        let tags =
            [("-color_range", "tv"), ("-colorspace", HD), ("-color_trc", HD), ("-color_primaries", HD)];
        Self {
            width,
            height,
            rate: format!("{rate:.3}"),
            is_steady: true,
            frames: 0,
            pixels: "yuv420p".into(),
            aspect: "1:1".into(),
            range: "tv",
            matrix: HD.into(),
            tags: tags.map(|(option, value)| [option.into(), value.into()]).into(),
        }
    }

    /// Frames per second as a number.
    pub fn frames_per_second(&self) -> f64 {
        fraction(&self.rate)
    }

    /// Of a YUV4MPEG stream, with its first line.
    ///
    /// # Errors
    /// [`Error::Input`] for anything else.
    pub fn of_y4m(from: &mut impl Read) -> Result<(Self, Vec<u8>)> {
        let wrong = |problem: &str| {
            Error::input(
                "standard input",
                problem,
                "pipe YUV4MPEG into it, as ffmpeg -f yuv4mpegpipe writes it",
            )
        };
        let (mut line, mut byte) = (Vec::new(), [0]);
        while line.last() != Some(&b'\n') {
            let is_read = matches!(from.read(&mut byte), Ok(1));
            if !is_read || line.len() == MOST_HEADER {
                return Err(wrong("is no YUV4MPEG stream"));
            }
            line.push(byte[0]);
        }
        let text = String::from_utf8_lossy(&line).into_owned();
        let mut words = text.trim_end().split(' ');
        if words.next() != Some("YUV4MPEG2") {
            return Err(wrong("is no YUV4MPEG stream"));
        }
        let words: Vec<&str> = words.collect();
        let word = |letter: char| words.iter().find_map(|word| word.strip_prefix(letter));
        let size = |letter| word(letter).and_then(|n| n.parse::<u32>().ok());
        let (width, height) = size('W').zip(size('H')).ok_or_else(|| wrong("says no size"))?;
        check_size(Path::new("standard input"), width.into(), height.into())?;
        let is_full = words.contains(&"XCOLORRANGE=FULL");
        let stream = Self {
            width,
            height,
            rate: word('F').unwrap_or("25:1").replace(':', "/"),
            frames: 0,
            is_steady: true,
            pixels: y4m_pixels(word('C').unwrap_or("420"))
                .ok_or_else(|| wrong("has pixels of an unknown form"))?,
            aspect: word('A').filter(|a| *a != "0:0").unwrap_or("1:1").to_owned(),
            range: if is_full { "pc" } else { "tv" },
            matrix: matrix(None, height),
            tags: vec![["-color_range".into(), if is_full { "pc".into() } else { "tv".into() }]],
        };
        Ok((stream, line))
    }
}

/// Whether pixels of this form use all numbers.
fn is_full(pixels: Option<&str>) -> bool {
    pixels.is_some_and(|name| name.starts_with("yuvj") || name.contains("rgb") || name.starts_with("gb"))
}

/// The matrix of a name; without one that which players take for this size.
fn matrix(name: Option<&str>, height: u32) -> String {
    match name {
        Some("bt470bg" | "smpte170m") => "smpte170m".into(),
        Some("bt2020nc" | "bt2020c") => "bt2020".into(),
        Some(known @ ("bt709" | "fcc" | "smpte240m")) => known.into(),
        _ => {
            if height >= 720 {
                "bt709".into()
            } else {
                "smpte170m".into()
            }
        }
    }
}

fn y4m_pixels(name: &str) -> Option<String> {
    let known = match name {
        "420" | "420jpeg" | "420mpeg2" | "420paldv" => "yuv420p",
        "422" => "yuv422p",
        "444" => "yuv444p",
        "411" => "yuv411p",
        "mono" => "gray",
        "420p10" => "yuv420p10le",
        "422p10" => "yuv422p10le",
        "444p10" => "yuv444p10le",
        "420p12" => "yuv420p12le",
        "422p12" => "yuv422p12le",
        "444p12" => "yuv444p12le",
        "mono16" => "gray16le",
        _ => return None,
    };
    Some(known.to_owned())
}

fn fraction(text: &str) -> f64 {
    let (above, below) = text.split_once('/').unwrap_or((text, "1"));
    above.parse().unwrap_or(0.0) / below.parse().unwrap_or(1.0_f64).max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_streams_are_read() {
        let line = b"YUV4MPEG2 W64 H48 F30000:1001 Ip A1:1 C422p10 XCOLORRANGE=FULL\nFRAME\n";
        let (stream, read) = Stream::of_y4m(&mut &line[..]).unwrap();
        assert_eq!((stream.width, stream.height, stream.rate.as_str()), (64, 48, "30000/1001"));
        assert_eq!((stream.pixels.as_str(), stream.range), ("yuv422p10le", "pc"));
        assert_eq!(read.len(), line.len() - 6);
        for bad in [
            &b""[..],
            b"RIFF....",
            b"YUV4MPEG2 W64\n",
            b"YUV4MPEG2 W0 H4\n",
            b"YUV4MPEG2 W4 H4 Codd\n",
            &[b'Y'; 5000],
        ] {
            assert!(Stream::of_y4m(&mut &bad[..]).is_err(), "{:?}", String::from_utf8_lossy(bad));
        }
    }
}
