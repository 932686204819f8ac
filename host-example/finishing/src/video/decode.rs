//! Frames out of a video, as raw pictures of 16 bits from a process of ffmpeg.

use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

use clap::ValueEnum;

use super::container::Y4M;
use super::process::{self, PROTOCOLS, command};
use super::stream::Stream;
use isophote_pictures::pixels::{Pixels, Samples};

/// Options by which ffmpeg changes between RGB and what videos hold.
pub const EXACT: &str = "flags=bicubic+accurate_rnd+full_chroma_int+full_chroma_inp";

/// Treatment of a video that is damaged or cut short.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OnError {
    /// Stop, and write nothing.
    Fail,
    /// Write what can be read of it, and warn.
    Skip,
}

/// Origin of a video.
#[derive(Clone, Copy, Debug)]
pub enum Origin<'a> {
    /// A file.
    File(&'a Path),
    /// YUV4MPEG on the decoder's standard input.
    Piped,
    /// Raw pictures of this size there, of 8 bits with alpha.
    Raw((u32, u32)),
}

/// The command that decodes a video to its standard output: all of it, or from the first frame that is shown at `from`
/// seconds or later, counted from where the file begins. It ends at the first error that ffmpeg counts as one unless
/// errors are skipped.
pub fn decoder(origin: Origin<'_>, stream: &Stream, from: Option<f64>, on_error: OnError) -> Command {
    let mut command = command("ffmpeg");
    command.args(["-v", "error"]);
    if on_error == OnError::Fail {
        command.arg("-xerror");
    }
    match origin {
        Origin::Piped => {
            command.args(PROTOCOLS).args(["-f", Y4M, "-i", "pipe:0"]).stdin(Stdio::piped());
        }
        Origin::Raw((width, height)) => {
            command.args(PROTOCOLS).args(["-f", "rawvideo", "-pix_fmt", "rgba"]);
            command.args(["-s", &format!("{width}x{height}"), "-i", "pipe:0"]).stdin(Stdio::piped());
        }
        Origin::File(path) => {
            command.arg("-nostdin");
            if let Some(seconds) = from {
                command.args(["-ss", &format!("{seconds:.6}")]);
            }
            if let Some(decoder) = stream.decoder {
                command.args(["-c:v", decoder]);
            }
            process::read(&mut command, path);
            command.stdin(Stdio::null());
        }
    }
    let Stream { range, matrix, .. } = stream;
    let whole =
        stream.fields.map_or_else(String::new, |first| format!("bwdif=mode=send_frame:parity={first},"));
    let change = format!("{whole}scale=in_color_matrix={matrix}:in_range={range}:out_range=pc:{EXACT}");
    // Every frame once, however long it lasts.
    command.args(["-map", "0:V:0", "-vf", &change, "-fps_mode", "passthrough"]);
    command.args(["-pix_fmt", rgb(stream.channels()), "-f", "rawvideo", "pipe:1"]);
    command.stdout(Stdio::piped());
    command
}

/// The next frame of a decoder; nothing at its end. A last frame that is cut short is one of a decoder that failed, which
/// says why.
pub fn frame(stream: &Stream, from: &mut impl Read) -> Option<Pixels> {
    let mut samples = vec![0u16; stream.samples()];
    from.read_exact(bytemuck::cast_slice_mut(&mut samples)).ok()?;
    Pixels::new(stream.width, stream.height, stream.channels(), Samples::U16(samples))
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
