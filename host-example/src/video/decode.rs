//! Frames out of a video, as raw pictures of 16 bits from a process of ffmpeg.

use std::io::Read;
use std::path::Path;
use std::process::Stdio;

use super::container::{Y4M, is_pipe};
use super::process::{Problem, Process, command, file};
use super::stream::Stream;
use crate::pixels::{Pixels, Samples};

/// How ffmpeg changes between RGB and what videos hold.
pub const EXACT: &str = "flags=bicubic+accurate_rnd+full_chroma_int+full_chroma_inp";

/// Starts to decode `input`, which may be `-`, to its standard output: all of it, or from the first frame that is shown at
/// `from` seconds or later, counted from where the file begins.
///
/// # Errors
/// [`Problem::Missing`].
pub fn start(input: &Path, stream: &Stream, from: Option<f64>) -> Result<Process, Problem> {
    let mut command = command("ffmpeg");
    command.args(["-v", "error"]);
    if is_pipe(input) {
        command.args(["-f", Y4M, "-i", "pipe:0"]).stdin(Stdio::piped());
    } else {
        command.arg("-nostdin");
        if let Some(seconds) = from {
            command.args(["-ss", &format!("{seconds:.6}")]);
        }
        command.arg("-i").arg(file(input)).stdin(Stdio::null());
    }
    let Stream { rate, range, matrix, .. } = stream;
    let change = format!("scale=in_color_matrix={matrix}:in_range={range}:out_range=pc:{EXACT}");
    command.args(["-map", "0:v:0", "-vf", &change]);
    // Frames of unequal length are repeated or left out to last equally long.
    match stream.is_steady {
        true => command.args(["-fps_mode", "passthrough"]),
        false => command.args(["-fps_mode", "cfr", "-r", rate]),
    };
    command.args(["-pix_fmt", rgb(channels(stream)), "-f", "rawvideo", "pipe:1"]);
    Process::start(command.stdout(Stdio::piped()))
}

/// The next frame of a decoder; nothing at its end. A last frame that is cut short is one of a decoder that failed, which
/// says why.
pub fn frame(stream: &Stream, from: &mut impl Read) -> Option<Pixels> {
    let channels = channels(stream);
    let length = stream.width as usize * stream.height as usize * channels as usize;
    let mut samples = vec![0u16; length];
    from.read_exact(bytemuck::cast_slice_mut(&mut samples)).ok()?;
    Pixels::new(stream.width, stream.height, channels, Samples::U16(samples))
}

/// Channels of a stream's frames: with alpha or without.
pub fn channels(stream: &Stream) -> u32 {
    let has_alpha =
        ["yuva", "rgba", "bgra", "argb", "abgr", "gbrap", "ya"].iter().any(|a| stream.pixels.starts_with(a));
    if has_alpha { 4 } else { 3 }
}

/// The raw form of frames of so many channels of 16 bits.
pub fn rgb(channels: u32) -> &'static str {
    let is_little = cfg!(target_endian = "little");
    match (channels, is_little) {
        (1, true) => "gray16le",
        (1, false) => "gray16be",
        (4, true) => "rgba64le",
        (4, false) => "rgba64be",
        (_, true) => "rgb48le",
        (_, false) => "rgb48be",
    }
}
