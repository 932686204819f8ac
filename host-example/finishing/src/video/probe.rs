//! Asking ffprobe what a video is, and taking its answers for numbers and words of closed lists.

use std::path::Path;

use serde_json::Value;

use super::closed::{
    FIELDS, HIDDEN_ALPHA, MATRICES, PIXELS, PRIMARIES, RANGES, Ratio, SPACES, TRANSFERS, second,
    usual_matrix, word,
};
use super::process::{self, Problem, Process};
use super::stream::{Promise, Stream, is_rgb};
use isophote_files::error::{Error, Result};
use isophote_files::output;
use isophote_pictures::read::check_size;

/// Share by which the mean rate of frames that last equally long may be off.
const STEADY: f64 = 0.1;
/// Most frames a second to which others are fitted.
const MOST_GRID: f64 = 300.0;
/// Complaint of ffmpeg where a file is of no kind that it may read.
const REFUSED: &str = "not on whitelist";
/// Entries that are asked for.
const WANTED: &str = "stream=index,codec_name,width,height,pix_fmt,avg_frame_rate,r_frame_rate,nb_frames,duration,\
    time_base,field_order,sample_aspect_ratio,color_range,color_space,color_transfer,color_primaries:\
    stream_side_data=rotation:stream_tags=DURATION,alpha_mode,ALPHA_MODE:format=format_name,nb_streams,duration";

/// The first stream of pictures of a file.
///
/// # Errors
/// [`Error::Input`] for files without pictures and for playlists, [`Error::Failure`] where there is no ffmpeg.
pub fn probe(path: &Path) -> Result<Stream> {
    let mut command = process::command("ffprobe");
    command.args(["-v", "error", "-select_streams", "V:0", "-show_entries", WANTED, "-of", "json"]);
    process::read(&mut command, path);
    let text = Process::output(&mut command).map_err(|problem| match problem {
        Problem::Said(text) if text.contains(REFUSED) => Error::file(
            path,
            "is a playlist, or of a kind that is not read as a video",
            "name the video itself, or pack it into an .mp4 or .mkv file by ffmpeg",
        ),
        problem => problem.of(path, "name a video that ffmpeg reads"),
    })?;
    let (stream, unknown) = understand(path, &serde_json::from_str(&text).unwrap_or_default())?;
    warn_of(path, &unknown);
    warn_of_fields(path, &stream);
    Ok(stream)
}

/// Warns of facts that a video does not tell in a way that is known here.
pub fn warn_of(path: &Path, unknown: &[&str]) {
    if !unknown.is_empty() {
        let (path, what) = (path.display(), unknown.join(", "));
        output::warn(format_args!(
            "{path}: says nothing that is known of its {what}, and the usual is taken"
        ));
    }
}

/// Warns of frames of two fields, which become whole pictures.
pub fn warn_of_fields(path: &Path, stream: &Stream) {
    if stream.fields.is_some() {
        output::warn(format_args!(
            "{}: is interlaced; its frames become whole pictures, and the result is not interlaced (for a frame of every \
             field, pass it through ffmpeg's filter bwdif first)",
            path.display()
        ));
    }
}

/// An answer of ffprobe's as numbers and known words, and names of what is unknown in it.
///
/// # Errors
/// [`Error::Input`] where there are no pictures, or they are too large.
pub fn understand(path: &Path, found: &Value) -> Result<(Stream, Vec<&'static str>)> {
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
    let mut unknown = Vec::new();
    let [mean, exact] = rates(stream, &mut unknown);
    // Containers round the times of frames, so that the mean is not what was meant.
    let is_steady = (exact.value() / mean.value() - 1.0).abs() < STEADY;
    let rate = if is_steady { exact } else { mean };
    let (pixels, decoder) = pixels(stream, &mut unknown);
    let aspect = said(stream, "sample_aspect_ratio").map(|aspect| Ratio::parse(aspect, ':'));
    if aspect == Some(None) {
        unknown.push("aspect");
    }
    let aspect = aspect.flatten().unwrap_or(Ratio::ONE);
    let matrix = said(stream, "color_space").map(|name| second(&MATRICES, name));
    if matrix == Some(None) && !is_rgb(pixels) {
        unknown.push("matrix of colours");
    }
    let tags = tags(stream, &mut unknown);
    let is_full = tags.contains(&["-color_range", "pc"]) || pixels.starts_with("yuvj") || is_rgb(pixels);
    let promise = promise(found, mean);
    let stream = Stream {
        index: number("index").unwrap_or(0),
        width,
        height,
        rate,
        grid: if exact.value() <= MOST_GRID { exact } else { rate },
        tick: said(stream, "time_base").and_then(|tick| Ratio::parse(tick, '/')).unwrap_or(rate.inverse()),
        fields: said(stream, "field_order").and_then(|order| second(&FIELDS, order)),
        decoder,
        is_animation: said(stream, "codec_name").is_some_and(|codec| matches!(codec, "gif" | "apng")),
        frames: frames(found, promise, rate),
        promise,
        pixels,
        aspect: if is_turned { aspect.inverse() } else { aspect },
        range: if is_full { "pc" } else { "tv" },
        matrix: matrix.flatten().unwrap_or_else(|| usual_matrix(height)),
        tags,
    };
    Ok((stream, unknown))
}

/// Form of a stream's pixels, and the decoder that sees them so, where the usual one does not.
fn pixels(stream: &Value, unknown: &mut Vec<&'static str>) -> (&'static str, Option<&'static str>) {
    let pixels = said(stream, "pix_fmt").and_then(|name| word(&PIXELS, name)).unwrap_or_else(|| {
        unknown.push("pixels");
        "yuv420p"
    });
    let is_tagged = ["alpha_mode", "ALPHA_MODE"].iter().any(|tag| stream["tags"][tag] == "1");
    match said(stream, "codec_name").and_then(|codec| second(&HIDDEN_ALPHA, codec)) {
        Some(decoder) if is_tagged && pixels == "yuv420p" => ("yuva420p", Some(decoder)),
        _ => (pixels, None),
    }
}

/// A property of a stream as text; nothing where it is not said.
fn said<'a>(stream: &'a Value, name: &str) -> Option<&'a str> {
    const NOTHING: [&str; 6] = ["unknown", "reserved", "N/A", "0/0", "0:1", ""];
    stream[name].as_str().filter(|value| !NOTHING.contains(value))
}

/// Frames a second: the mean, and what frames are meant to have.
fn rates(stream: &Value, unknown: &mut Vec<&'static str>) -> [Ratio; 2] {
    let [mean, exact] = ["avg_frame_rate", "r_frame_rate"]
        .map(|name| said(stream, name).and_then(|rate| Ratio::parse(rate, '/')?.as_rate()));
    let mean = mean.or(exact).unwrap_or_else(|| {
        unknown.push("rate of frames");
        Ratio::USUAL_RATE
    });
    [mean, exact.unwrap_or(mean)]
}

/// Tags that a stream gives of its colours, by the options that give them to another.
fn tags(stream: &Value, unknown: &mut Vec<&'static str>) -> Vec<[&'static str; 2]> {
    let tags: [(_, _, _, &[(&str, &str)]); 4] = [
        ("color_range", "-color_range", "range of colours", &RANGES),
        ("color_space", "-colorspace", "matrix of colours", &SPACES),
        ("color_transfer", "-color_trc", "transfer function", &TRANSFERS),
        ("color_primaries", "-color_primaries", "primaries", &PRIMARIES),
    ];
    let known = |(name, option, what, list)| {
        let value = second(list, said(stream, name)?);
        if value.is_none() && !unknown.contains(&what) {
            unknown.push(what);
        }
        Some([option, value?])
    };
    tags.into_iter().filter_map(known).collect()
}

/// Number of frames, or time, that a container says that it holds.
fn promise(found: &Value, mean: Ratio) -> Promise {
    let (stream, format) = (&found["streams"][0], &found["format"]);
    let count: Option<u64> = stream["nb_frames"].as_str().and_then(|n| n.parse().ok()).filter(|n| *n > 0);
    let own = stream["duration"].as_str().and_then(seconds);
    let tagged = stream["tags"]["DURATION"].as_str().and_then(clock);
    // Where there is more than pictures, that may last longer.
    let is_alone = format["nb_streams"].as_u64() == Some(1);
    let all = format["duration"].as_str().and_then(seconds).filter(|_| is_alone);
    let is_of = |kind: &str| format["format_name"].as_str().is_some_and(|n| n.split(',').any(|n| n == kind));
    match (count, own.or(tagged).or(all)) {
        (Some(count), _) if is_of("mov") => Promise::Frames { count, slack: 0 },
        // Its frames may be there twice, or not at all.
        (Some(count), _) => Promise::Frames { count, slack: 1 + count / 100 },
        // A duration counts frames there.
        (None, Some(seconds)) if is_of("mxf") => {
            Promise::Frames { count: (seconds * mean.value()).round() as u64, slack: 1 }
        }
        (None, Some(seconds)) => Promise::Seconds(seconds),
        (None, None) => Promise::None,
    }
}

/// Number of frames there are, about.
fn frames(found: &Value, promise: Promise, rate: Ratio) -> u64 {
    match promise {
        Promise::Frames { count, .. } => count,
        Promise::Seconds(seconds) => (seconds * rate.value()).round() as u64,
        Promise::None => found["format"]["duration"]
            .as_str()
            .and_then(seconds)
            .map_or(0, |seconds| (seconds * rate.value()).round() as u64),
    }
}

/// A time that can be.
fn seconds(text: &str) -> Option<f64> {
    text.parse().ok().filter(|seconds| (0.0..1e9).contains(seconds))
}

/// A time as clocks have it: 00:00:02.023000000.
fn clock(text: &str) -> Option<f64> {
    let mut parts = text.trim().rsplitn(3, ':').map(seconds);
    let (second, minute, hour) = (parts.next()??, parts.next()??, parts.next()??);
    Some(hour * 3600.0 + minute * 60.0 + second).filter(|seconds| *seconds > 0.0)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn understood(stream: Value, format: Value) -> (Stream, Vec<&'static str>) {
        let found = json!({"streams": [stream], "format": format});
        understand(Path::new("a.mp4"), &found).unwrap()
    }

    #[test]
    fn answers_become_numbers_and_known_words() {
        let mov = json!({"format_name": "mov,mp4,m4a,3gp,3g2,mj2", "nb_streams": 2, "duration": "2.1"});
        let full = json!({
            "width": 64, "height": 48, "pix_fmt": "gbrp", "avg_frame_rate": "30000/1001", "r_frame_rate": "30000/1001",
            "nb_frames": "50", "duration": "2.0", "sample_aspect_ratio": "4:3", "color_range": "pc", "color_space": "gbr",
            "color_transfer": "bt470bg", "color_primaries": "ebu3213", "field_order": "tb", "side_data_list": [{"rotation": -90}],
        });
        let (stream, unknown) = understood(full.clone(), mov.clone());
        assert_eq!((stream.width, stream.height, unknown.len()), (48, 64, 0));
        assert_eq!((stream.rate.to_string().as_str(), stream.fields), ("30000/1001", Some("tff")));
        // A quarter of a turn changes the sides of pixels.
        assert_eq!((stream.aspect.with('/').as_str(), stream.pixels, stream.range), ("3/4", "gbrp", "pc"));
        let tags = [
            ["-color_range", "pc"],
            ["-colorspace", "rgb"],
            ["-color_trc", "gamma28"],
            ["-color_primaries", "jedec-p22"],
        ];
        assert_eq!((stream.tags.as_slice(), stream.matrix), (&tags[..], "smpte170m"));
        assert_eq!((stream.promise, stream.frames), (Promise::Frames { count: 50, slack: 0 }, 50));
        // What is unknown is named once, and stays out.
        let mut odd = full;
        for name in [
            "pix_fmt",
            "avg_frame_rate",
            "r_frame_rate",
            "sample_aspect_ratio",
            "color_space",
            "color_transfer",
        ] {
            odd[name] = "1:1,movie=/etc/passwd".into();
        }
        let (stream, unknown) = understood(odd, mov);
        assert_eq!(unknown, ["rate of frames", "pixels", "aspect", "matrix of colours", "transfer function"]);
        assert_eq!((stream.pixels, stream.aspect, stream.rate), ("yuv420p", Ratio::ONE, Ratio::USUAL_RATE));
    }

    #[test]
    fn containers_promise_frames_or_seconds() {
        let stream = |more: Value| {
            let mut stream = json!({"width": 64, "height": 48, "pix_fmt": "gray", "avg_frame_rate": "25/1"});
            more.as_object().unwrap().iter().for_each(|(name, value)| stream[name] = value.clone());
            stream
        };
        let format =
            |name: &str, streams: u32| json!({"format_name": name, "nb_streams": streams, "duration": "9.0"});
        let promise = |more: Value, format: Value| understood(stream(more), format).0.promise;
        assert_eq!(
            promise(json!({"nb_frames": "250", "duration": "0.8"}), format("avi", 2)),
            Promise::Frames { count: 250, slack: 3 }
        );
        assert_eq!(
            promise(json!({"duration": "2.0"}), format("mxf", 1)),
            Promise::Frames { count: 50, slack: 1 }
        );
        let tag = json!({"tags": {"DURATION": "01:00:02.500000000"}});
        assert_eq!(promise(tag, format("matroska,webm", 2)), Promise::Seconds(3602.5));
        assert_eq!(promise(json!({}), format("matroska,webm", 1)), Promise::Seconds(9.0));
        assert_eq!(promise(json!({}), format("matroska,webm", 2)), Promise::None);
        for bad in ["-1", "1:2", "a:b:c", "nan:0:0", "0:0:1e300"] {
            assert_eq!(promise(json!({"tags": {"DURATION": bad}}), format("x", 2)), Promise::None, "{bad}");
        }
    }
}
