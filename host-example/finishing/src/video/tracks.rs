//! Sound, subtitles and metadata of a video on their way to another container: kept as they are where it holds them, else
//! made anew in a form that it holds, else left out and named.

use std::path::Path;

use serde_json::Value;

use super::container::Y4M;
use super::process::{self, Process, at};
use isophote_files::error::Result;
use isophote_files::output;

/// Advice about a video whose tracks cannot be told.
const FIX: &str = "name a video that ffmpeg reads";
/// Entries that are asked for.
const WANTED: &str =
    "stream=index,codec_type,codec_name,codec_tag_string,sample_rate:stream_disposition=attached_pic";
/// Subtitles of letters, which one form of them can be made of another.
const TEXTS: [&str; 6] = ["subrip", "ass", "ssa", "mov_text", "webvtt", "text"];
/// Tags of the pictures that are no longer true of others.
const STALE: [&str; 14] = [
    "encoder",
    "alpha_mode",
    "ALPHA_MODE",
    "DURATION",
    "BPS",
    "NUMBER_OF_FRAMES",
    "NUMBER_OF_BYTES",
    "_STATISTICS_TAGS",
    "_STATISTICS_WRITING_APP",
    "_STATISTICS_WRITING_DATE_UTC",
    "BPS-eng",
    "DURATION-eng",
    "NUMBER_OF_FRAMES-eng",
    "NUMBER_OF_BYTES-eng",
];
/// Data that is no more than a time code, which goes with the metadata, or the names of chapters.
const TOLD_ELSEWHERE: [&str; 2] = ["tmcd", "text"];

/// Forms of sound and subtitles that a container holds.
struct Holds {
    containers: &'static [&'static str],
    /// Sound that is kept; one that ends with `_` stands for all that begin so.
    sound: &'static [&'static str],
    /// The encoder of other sound, with its options for all of a track; none where it holds no sound.
    encoder: &'static [[&'static str; 2]],
    /// Subtitles that are kept.
    subtitles: &'static [&'static str],
    /// The encoder of other subtitles of letters.
    text: Option<&'static str>,
}

const AAC: &[[&str; 2]] = &[["-c", "aac"], ["-b", "192k"]];

const HOLDS: [Holds; 11] = [
    Holds {
        containers: &["mp4"],
        sound: &["aac", "ac3", "eac3", "mp3", "mp2", "alac", "opus", "flac", "dts"],
        encoder: AAC,
        subtitles: &["mov_text"],
        text: Some("mov_text"),
    },
    Holds {
        containers: &["mov"],
        sound: &["aac", "ac3", "eac3", "mp3", "mp2", "alac", "pcm_s16", "pcm_s24", "pcm_s32", "pcm_f32"],
        encoder: AAC,
        subtitles: &["mov_text"],
        text: Some("mov_text"),
    },
    Holds {
        containers: &["3gp", "3g2"],
        sound: &["aac", "amr_nb", "amr_wb"],
        encoder: AAC,
        subtitles: &["mov_text"],
        text: Some("mov_text"),
    },
    Holds {
        containers: &["matroska"],
        sound: &[
            "aac",
            "ac3",
            "eac3",
            "mp3",
            "mp2",
            "alac",
            "opus",
            "vorbis",
            "flac",
            "dts",
            "truehd",
            "mlp",
            "tta",
            "wavpack",
            "pcm_s16le",
            "pcm_s24le",
            "pcm_s32le",
            "pcm_f32le",
            "pcm_f64le",
            "pcm_u8",
            "wmav2",
        ],
        encoder: &[["-c", "flac"]],
        subtitles: &["subrip", "ass", "ssa", "webvtt", "dvd_subtitle", "hdmv_pgs_subtitle", "dvb_subtitle"],
        text: Some("subrip"),
    },
    Holds {
        containers: &["webm"],
        sound: &["opus", "vorbis"],
        encoder: &[["-c", "libopus"], ["-b", "192k"]],
        subtitles: &["webvtt"],
        text: Some("webvtt"),
    },
    Holds {
        containers: &["avi"],
        sound: &["mp3", "mp2", "ac3", "pcm_s16le", "pcm_u8"],
        encoder: &[["-c", "libmp3lame"], ["-b", "256k"]],
        subtitles: &[],
        text: None,
    },
    Holds {
        containers: &["mxf"],
        // At 48000 samples a second.
        sound: &["pcm_s16le", "pcm_s24le"],
        encoder: &[["-c", "pcm_s24le"], ["-ar", "48000"]],
        subtitles: &[],
        text: None,
    },
    Holds {
        containers: &["mpegts"],
        sound: &["aac", "ac3", "eac3", "mp3", "mp2", "opus", "dts"],
        encoder: AAC,
        subtitles: &["dvb_subtitle", "dvb_teletext"],
        text: None,
    },
    Holds {
        containers: &["vob"],
        sound: &["mp2", "ac3", "mp3"],
        encoder: &[["-c", "mp2"], ["-b", "256k"]],
        subtitles: &["dvd_subtitle"],
        text: None,
    },
    Holds {
        containers: &["asf"],
        sound: &["wmav1", "wmav2", "mp3"],
        encoder: &[["-c", "wmav2"], ["-b", "256k"]],
        subtitles: &[],
        text: None,
    },
    Holds {
        containers: &["ogv"],
        sound: &["vorbis", "opus", "flac"],
        encoder: &[["-c", "libvorbis"], ["-q", "6"]],
        subtitles: &[],
        text: None,
    },
];

/// Tracks of a file beside its pictures, as a container takes them over.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracks {
    /// Options of ffmpeg, where the file is its second input: numbers and words of closed lists.
    pub options: Vec<String>,
    /// Names of what is left out.
    left_out: Vec<String>,
}

impl Tracks {
    /// Asks ffprobe which there are, for a result in this container.
    ///
    /// # Errors
    /// The complaint of ffprobe.
    pub fn of(path: &Path, container: &'static str) -> Result<Self> {
        let mut command = process::command("ffprobe");
        command.args(["-v", "error", "-show_entries", WANTED, "-of", "json"]);
        process::read(&mut command, path);
        let text = at(Process::output(&mut command), path, FIX)?;
        Ok(Self::understand(&serde_json::from_str(&text).unwrap_or_default(), container))
    }

    /// Names in one warning everything of the input that is not in the output.
    pub fn warn(&self, input: &Path, output: &Path) {
        if !self.left_out.is_empty() {
            let (what, input) = (self.left_out.join(", "), input.display());
            output::warn(format_args!(
                "{input}: {what}: left out, since {} cannot hold it",
                output.display()
            ));
        }
    }

    fn understand(found: &Value, container: &'static str) -> Self {
        let mut tracks = Self::default();
        let holds = HOLDS.iter().find(|holds| holds.containers.contains(&container));
        let (mut sounds, mut texts, mut has_pictures) = (0, 0, false);
        for stream in found["streams"].as_array().into_iter().flatten() {
            let Some(index) = stream["index"].as_u64() else { continue };
            let word = |name: &str| stream[name].as_str().unwrap_or("unknown");
            let (kind, codec) = (word("codec_type"), word("codec_name"));
            let mut options = Vec::new();
            match kind {
                "video" if stream["disposition"]["attached_pic"] == 1 => {}
                // The first ones are those that are filtered.
                "video" if !has_pictures => {
                    has_pictures = true;
                    continue;
                }
                "audio" => options = holds.map_or_else(Vec::new, |holds| holds.sound(stream, codec, sounds)),
                "subtitle" => options = holds.map_or_else(Vec::new, |holds| holds.subtitles(codec, texts)),
                "attachment" if container == "matroska" => options = vec!["-c:t".into(), "copy".into()],
                "data" if TOLD_ELSEWHERE.contains(&word("codec_tag_string")) => continue,
                _ => {}
            }
            if options.is_empty() {
                tracks.left_out.push(name(stream, kind, codec, index));
                continue;
            }
            sounds += usize::from(kind == "audio");
            texts += usize::from(kind == "subtitle");
            tracks.options.extend(["-map".to_owned(), format!("1:{index}")]);
            tracks.options.extend(options);
        }
        if container != Y4M {
            let kept = ["-map_metadata", "1", "-map_metadata:s:v:0", "1:s:V:0", "-map_chapters", "1"];
            tracks.options.extend(kept.map(str::to_owned));
            for tag in STALE {
                tracks.options.extend(["-metadata:s:v:0".to_owned(), format!("{tag}=")]);
            }
        }
        tracks
    }
}

impl Holds {
    /// Options for the sound of this number; none where it is left out.
    fn sound(&self, stream: &Value, codec: &str, number: usize) -> Vec<String> {
        let is_slow = self.containers == ["mxf"] && stream["sample_rate"] != "48000";
        if !is_slow && self.sound.iter().any(|kept| codec.starts_with(kept)) {
            return vec![format!("-c:a:{number}"), "copy".into()];
        }
        if codec == "unknown" {
            return Vec::new();
        }
        let each = self.encoder.iter();
        each.flat_map(|[option, value]| [format!("{option}:a:{number}"), (*value).to_owned()]).collect()
    }

    /// Options for the subtitles of this number; none where they are left out.
    fn subtitles(&self, codec: &str, number: usize) -> Vec<String> {
        let encoder = match self.text {
            _ if self.subtitles.contains(&codec) => "copy",
            Some(encoder) if TEXTS.contains(&codec) => encoder,
            _ => return Vec::new(),
        };
        vec![format!("-c:s:{number}"), encoder.into()]
    }
}

/// A track's name for people.
fn name(stream: &Value, kind: &str, codec: &str, index: u64) -> String {
    let what = match kind {
        "video" if stream["disposition"]["attached_pic"] == 1 => "cover picture",
        "video" => "more pictures",
        "audio" => "sound",
        "subtitle" => "subtitles",
        "attachment" => "attached file",
        _ => "data",
    };
    format!("{what} ({codec}, track {index})")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn tracks_are_kept_made_anew_or_left_out() {
        let found = json!({"streams": [
            {"index": 0, "codec_type": "video", "codec_name": "h264"},
            {"index": 1, "codec_type": "audio", "codec_name": "aac"},
            {"index": 2, "codec_type": "audio", "codec_name": "pcm_s16le", "sample_rate": "44100"},
            {"index": 3, "codec_type": "subtitle", "codec_name": "ass"},
            {"index": 4, "codec_type": "subtitle", "codec_name": "hdmv_pgs_subtitle"},
            {"index": 5, "codec_type": "data", "codec_tag_string": "tmcd"},
            {"index": 6, "codec_type": "video", "codec_name": "png", "disposition": {"attached_pic": 1}},
        ]});
        for (container, options, left_out) in [
            (
                "mp4",
                "-map 1:1 -c:a:0 copy -map 1:2 -c:a:1 aac -b:a:1 192k -map 1:3 -c:s:0 mov_text",
                "subtitles (hdmv_pgs_subtitle, track 4), cover picture (png, track 6)",
            ),
            (
                "matroska",
                "-map 1:1 -c:a:0 copy -map 1:2 -c:a:1 copy -map 1:3 -c:s:0 copy -map 1:4 -c:s:1 copy",
                "cover picture (png, track 6)",
            ),
            (
                "mxf",
                "-map 1:1 -c:a:0 pcm_s24le -ar:a:0 48000 -map 1:2 -c:a:1 pcm_s24le -ar:a:1 48000",
                "subtitles (ass, track 3), subtitles (hdmv_pgs_subtitle, track 4), cover picture (png, track 6)",
            ),
        ] {
            let tracks = Tracks::understand(&found, container);
            let all = tracks.options.join(" ");
            assert_eq!(all.split(" -map_metadata").next(), Some(options), "{container}");
            assert_eq!(tracks.left_out.join(", "), left_out, "{container}");
        }
        let none = Tracks::understand(&found, Y4M);
        assert_eq!((none.options.len(), none.left_out.len()), (0, 5));
        // Whatever a file calls its parts stays out of what ffmpeg is told.
        let odd = json!({"streams": [{"index": 1, "codec_type": "audio", "codec_name": "aac -f x"},
            {"index": 2, "codec_type": "-i", "codec_name": "file:/etc/passwd"}]});
        let options = Tracks::understand(&odd, "mp4").options.join(" ");
        assert!(options.starts_with("-map 1:1 -c:a:0 copy -map_metadata") && !options.contains("passwd"));
    }
}
