//! A video that was written, looked at again before it gets its name.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::container::{WEBP, Y4M, container, read_as};
use super::process::{PROTOCOLS, Problem, Process, command, file};

/// Number of frames in a file of that container that was just written.
///
/// # Errors
/// [`Problem`] where it cannot be read, or there is no ffprobe.
pub fn frames(place: &Path, output: &Path, expected: u64) -> Result<u64, Problem> {
    if container(output) == Some(WEBP) {
        return Ok(webp(place).unwrap_or(0));
    }
    let count = |how: &str, name: &str| {
        let mut command = prober(output);
        command.args([how, "-show_entries", &format!("stream={name}"), "-of", "json", "-i"]);
        let text = Process::output(command.arg(file(place)))?;
        let found: Value = serde_json::from_str(&text).unwrap_or_default();
        let count = found["streams"][0][name].as_str().and_then(|n| n.parse().ok());
        Ok(count.unwrap_or(0))
    };
    match count("-count_packets", "nb_read_packets")? {
        packets if packets == expected => Ok(packets),
        // Some codecs have packets that show nothing.
        _ => count("-count_frames", "nb_read_frames"),
    }
}

/// Number of frames in a WebP file, which ffprobe does not count.
fn webp(place: &Path) -> io::Result<u64> {
    let mut file = BufReader::new(File::open(place)?);
    let (mut moving, mut still) = (0, 0);
    file.seek_relative(12)?;
    loop {
        let mut head = [0; 8];
        if file.read_exact(&mut head).is_err() {
            return Ok(if moving > 0 { moving } else { still });
        }
        let [name @ .., a, b, c, d] = head;
        match &name {
            b"ANMF" => moving += 1,
            b"VP8 " | b"VP8L" => still = 1,
            _ => {}
        }
        let size = i64::from(u32::from_le_bytes([a, b, c, d]));
        file.seek_relative(size + size % 2)?;
    }
}

fn prober(output: &Path) -> Command {
    let mut command = command("ffprobe");
    command.args(["-v", "error", "-select_streams", "v:0"]).args(PROTOCOLS);
    // A file without its extension is known by what it was made as.
    command.args(["-f", read_as(container(output).unwrap_or(Y4M))]);
    command
}

/// Makes sure before a long run that frames can be counted after it.
///
/// # Errors
/// [`Problem::Missing`].
pub fn check() -> Result<(), Problem> {
    Process::output(command("ffprobe").arg("-version")).map(drop)
}
