//! A video that was written, looked at again before it gets its name.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::container::{Y4M, container};
use super::process::{PROTOCOLS, Problem, Process, command, file};

/// Number of frames in a file of that container that was just written.
///
/// # Errors
/// [`Problem`] where it cannot be read, or there is no ffprobe.
pub fn frames(place: &Path, output: &Path, expected: u64) -> Result<u64, Problem> {
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

fn prober(output: &Path) -> Command {
    let mut command = command("ffprobe");
    command.args(["-v", "error", "-select_streams", "v:0"]).args(PROTOCOLS);
    // A file without its extension is known by what it was made as.
    let kind = match container(output).unwrap_or(Y4M) {
        "webm" => "matroska",
        kind => kind,
    };
    command.args(["-f", kind]);
    command
}

/// Makes sure before a long run that frames can be counted after it.
///
/// # Errors
/// [`Problem::Missing`].
pub fn check() -> Result<(), Problem> {
    Process::output(command("ffprobe").arg("-version")).map(drop)
}
