//! Raw frames with their times on the way to ffmpeg: Matroska of one track without compression, made as it is needed.
//!
//! Source: IETF RFC 8794 (EBML) and RFC 9559 (Matroska).

use super::closed::Ratio;
use super::decode::rgb;

/// Nanoseconds by which times are told.
const TICK: f64 = 1000.0;
/// Size of a part that ends with the stream.
const OPEN: [u8; 8] = [0x01, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF];

/// Times of frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Times {
    /// Seconds from the first frame.
    pub shown: Vec<f64>,
    /// Seconds that the last frame lasts; nothing where nobody knows.
    pub last: Option<f64>,
}

impl Times {
    /// Time of the frame of this index, of frames that last so long where nothing is known.
    pub fn of(&self, index: u64, length: f64) -> f64 {
        let last = self.shown.len().saturating_sub(1);
        let known = usize::try_from(index).unwrap_or(usize::MAX).min(last);
        let beyond = index.saturating_sub(last as u64) as f64;
        self.shown.get(known).copied().unwrap_or(0.0) + beyond * length
    }
}

/// Start of a stream of frames of this size, of so many channels of 16 bits.
pub fn header((width, height): (u32, u32), channels: u32, rate: Ratio) -> Vec<u8> {
    let kind = [
        number(&[0x42, 0x86], 1),
        number(&[0x42, 0xF7], 1),
        number(&[0x42, 0xF2], 4),
        number(&[0x42, 0xF3], 8),
        part(&[0x42, 0x82], b"matroska"),
        number(&[0x42, 0x87], 4),
        number(&[0x42, 0x85], 2),
    ];
    let picture = [
        number(&[0xB0], width.into()),
        number(&[0xBA], height.into()),
        part(&[0x2E, 0xB5, 0x24], &form(channels)),
    ];
    let track = [
        number(&[0xD7], 1),
        number(&[0x73, 0xC5], 1),
        number(&[0x83], 1),
        part(&[0x86], b"V_UNCOMPRESSED"),
        // Encoders are told how long frames last about.
        number(&[0x23, 0xE3, 0x83], (1e9 / rate.value()).max(1.0) as u64),
        part(&[0xE0], &picture.concat()),
    ];
    [
        part(&[0x1A, 0x45, 0xDF, 0xA3], &kind.concat()),
        [&[0x18, 0x53, 0x80, 0x67], &OPEN[..]].concat(),
        part(&[0x15, 0x49, 0xA9, 0x66], &number(&[0x2A, 0xD7, 0xB1], TICK as u64)),
        part(&[0x16, 0x54, 0xAE, 0x6B], &part(&[0xAE], &track.concat())),
    ]
    .concat()
}

/// Start of a frame of so many bytes that is shown at `seconds`.
pub fn before_frame(seconds: f64, bytes: usize) -> Vec<u8> {
    let time = number(&[0xE7], (seconds.max(0.0) * 1e9 / TICK).round() as u64);
    // Track 1, at the time of the cluster, a key frame.
    let block = [0x81, 0, 0, 0x80];
    let block_size = size(bytes + block.len());
    let cluster = size(time.len() + 1 + block_size.len() + block.len() + bytes);
    [&[0x1F, 0x43, 0xB6, 0x75], &cluster[..], &time, &[0xA3], &block_size, &block].concat()
}

/// Letters by which ffmpeg knows raw frames.
fn form(channels: u32) -> [u8; 4] {
    let little = match channels {
        1 => [b'Y', b'1', 0, 16],
        4 => [b'R', b'B', b'A', 64],
        _ => [b'R', b'G', b'B', 48],
    };
    let [a, b, c, d] = little;
    if rgb(channels).ends_with("le") { little } else { [d, c, b, a] }
}

fn part(name: &[u8], content: &[u8]) -> Vec<u8> {
    [name, &size(content.len()), content].concat()
}

fn number(name: &[u8], value: u64) -> Vec<u8> {
    part(name, &value.to_be_bytes())
}

fn size(bytes: usize) -> [u8; 8] {
    (bytes as u64 | 1 << 56).to_be_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_say_their_size() {
        assert_eq!(part(&[0x86], b"ab"), [0x86, 1, 0, 0, 0, 0, 0, 0, 2, b'a', b'b']);
        let start = before_frame(0.5, 6);
        let time = 500_000_u64.to_be_bytes();
        assert_eq!(&start[..5], [0x1F, 0x43, 0xB6, 0x75, 1]);
        assert_eq!(start[11], (start.len() - 12 + 6) as u8);
        assert!(start.windows(8).any(|bytes| bytes == time));
        assert!(header((2, 1), 3, Ratio::USUAL_RATE).windows(4).any(|bytes| bytes == form(3)));
    }
}
