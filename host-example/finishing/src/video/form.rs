//! Forms of pixels in results: which encoder a container gets where nobody names one, and what it is handed.

use super::closed::{PIXELS, usual_matrix, word};
use super::container::{WEBP, Y4M};
use super::stream::{Stream, depth, is_rgb};

/// Encoders that hold no alpha.
const OPAQUE: [&str; 13] = [
    "libx264",
    "libx264rgb",
    "libx265",
    "mpeg4",
    "mpeg2video",
    "mpeg1video",
    "wmv2",
    "libtheora",
    "dvvideo",
    "libsvtav1",
    "libaom-av1",
    "mjpeg",
    "h264_nvenc",
];
/// Containers that are made to be played anywhere.
const PLAYED: [&str; 6] = ["mp4", "3gp", "3g2", "mpegts", "webm", "avi"];
/// Options by which an encoder is named.
const NAMING: [&str; 5] = ["-c:v", "-codec:v", "-vcodec", "-c:v:0", "-c"];
const X264: &[&str] = &["-c:v", "libx264", "-crf", "14", "-preset", "medium"];
const EXACT_X264: &[&str] = &["-c:v", "libx264rgb", "-qp", "0", "-preset", "medium"];

/// Pixels as an encoder gets them.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// Options of the encoder; none where others are given.
    pub options: Vec<&'static str>,
    /// Form of the pixels.
    pub pixels: &'static str,
    /// Range from black to white: `tv` or `pc`.
    pub range: &'static str,
    /// The matrix between RGB and luma with chroma.
    pub matrix: &'static str,
    /// Tags of the colours.
    pub tags: Vec<[&'static str; 2]>,
    /// True where it holds alpha.
    pub has_alpha: bool,
    /// Size, where a last odd row or column is left out.
    pub size: (u32, u32),
}

impl Form {
    /// The form for pictures like a stream's of so many channels, in this container, by the encoder that options name or the usual.
    pub fn of(container: &'static str, stream: &Stream, channels: u32, options: Option<&str>) -> Self {
        // Few players show red, green and blue in these.
        let is_plain = stream.is_animation && PLAYED.contains(&container);
        let is_red_green_blue = is_rgb(stream.pixels) && !is_plain;
        let is_deep = depth(stream.pixels) > 8;
        let mut form = Self {
            options: Vec::new(),
            pixels: stream.pixels,
            range: stream.range,
            matrix: stream.matrix,
            tags: stream.tags.clone(),
            has_alpha: channels == 4,
            size: (stream.width, stream.height),
        };
        if options.is_none() {
            form.options = usual(container, (is_red_green_blue, is_deep, channels == 4)).to_vec();
        }
        let named = options.map_or_else(
            || form.options.get(1).copied().unwrap_or_default(),
            |options| {
                let words: Vec<&str> = options.split_whitespace().collect();
                words.windows(2).rev().find(|two| NAMING.contains(&two[0])).map_or("", |two| two[1])
            },
        );
        form.has_alpha &= !OPAQUE.contains(&named) && !matches!(container, "mp4" | "vob" | "mpegts" | "dv");
        let own = own(named, container, is_red_green_blue, depth(stream.pixels), form.has_alpha);
        match own.and_then(|pixels| word(&PIXELS, &pixels)) {
            Some(pixels) => form.take(pixels, stream),
            None if is_plain => form.take("yuv420p", stream),
            None if is_red_green_blue && !form.has_alpha => {
                form.take(if is_deep { deep("yuv444p10") } else { "yuv444p" }, stream);
            }
            None => {}
        }
        form.fit_size(named);
        form
    }

    /// Takes another form of pixels than the stream's, which may need other tags.
    fn take(&mut self, pixels: &'static str, stream: &Stream) {
        let was_rgb = is_rgb(stream.pixels);
        self.pixels = pixels;
        if is_rgb(pixels) {
            self.range = "pc";
            self.tag("-color_range", "pc");
            self.tag("-colorspace", "rgb");
        } else if was_rgb {
            self.range = "tv";
            self.matrix = usual_matrix(stream.height);
            self.tag("-color_range", "tv");
            self.tag("-colorspace", self.matrix);
        }
    }

    /// A filter that takes away what the source does not say of its colours. From its version 7 on ffmpeg writes down what it
    /// converts to, and players show a file by that where they would have supposed something else.
    pub fn unsaid(&self) -> String {
        let kept = |option| {
            let is_said = self.tags.iter().any(|[known, _]| *known == option);
            if is_said { "auto" } else { "unknown" }
        };
        format!("setparams=range={}:colorspace={}", kept("-color_range"), kept("-colorspace"))
    }

    fn tag(&mut self, option: &'static str, value: &'static str) {
        self.tags.retain(|[known, _]| *known != option);
        self.tags.push([option, value]);
    }

    /// Chooses a form in which an encoder takes a last odd row or column, or leaves that out.
    fn fit_size(&mut self, encoder: &str) {
        let (width, height) = self.size;
        if width.is_multiple_of(2) && height.is_multiple_of(2) {
            return;
        }
        match encoder {
            "libx264" | "libx265"
                if !self.pixels.starts_with("gray")
                    && !self.pixels.contains("444")
                    && !is_rgb(self.pixels) =>
            {
                let full = ["420", "422", "411", "410", "440"]
                    .iter()
                    .find(|sampling| self.pixels.contains(*sampling) && self.pixels.starts_with("yuv"))
                    .and_then(|sampling| word(&PIXELS, &self.pixels.replace(*sampling, "444")));
                self.pixels = full.unwrap_or("yuv444p");
            }
            "wmv2" | "wmv1" | "msmpeg4" | "h263" => self.size = (width & !1, height & !1),
            _ => {}
        }
    }
}

/// Name of a form of more than 8 bits in the machine's order of bytes.
fn deep(pixels: &str) -> &'static str {
    let end = if cfg!(target_endian = "little") { "le" } else { "be" };
    word(&PIXELS, &format!("{pixels}{end}")).unwrap_or("yuv444p")
}

/// The form that an encoder takes instead of the stream's; nothing where it takes that or ffmpeg finds one.
fn own(encoder: &str, container: &str, is_rgb: bool, bits: u32, has_alpha: bool) -> Option<String> {
    let is_deep = bits > 8;
    let a = if has_alpha { "a" } else { "" };
    // Bits of planes that encoders know.
    let plane = |most: u32| match bits.min(most) {
        ..=8 => None,
        9 | 10 => Some(10),
        11 | 12 => Some(12),
        13 | 14 if !has_alpha => Some(14),
        _ => Some(16),
    };
    let planes = |most| {
        Some(
            plane(most).map_or_else(|| format!("gbr{a}p"), |bits| deep(&format!("gbr{a}p{bits}")).to_owned()),
        )
    };
    let name = match (encoder, is_rgb, has_alpha, is_deep) {
        ("gif" | "libwebp" | "libwebp_anim", ..) => "bgra",
        ("png" | "apng", _, false, false) => "rgb24",
        ("png" | "apng", _, true, false) => "rgba",
        ("png" | "apng", _, false, true) => "rgb48be",
        ("png" | "apng", _, true, true) => "rgba64be",
        ("qtrle", _, false, _) => "rgb24",
        ("qtrle", _, true, _) => "argb",
        ("libx264rgb", ..) => "bgr24",
        ("ffv1", true, false, false) => "bgr0",
        ("ffv1", true, true, false) => "bgra",
        ("ffv1", true, ..) => return planes(16),
        ("prores_ks", _, true, _) => deep("yuva444p10"),
        ("libvpx-vp9" | "libvpx", _, true, _) => "yuva420p",
        ("libvpx-vp9" | "libx265", true, false, _) => return planes(12),
        ("utvideo", true, ..) => return planes(8),
        ("huffyuv" | "ffvhuff", true, false, _) => "rgb24",
        ("huffyuv" | "ffvhuff", true, true, _) => "bgra",
        _ if container == Y4M && has_alpha => "yuva444p",
        _ => return None,
    };
    Some(name.to_owned())
}

/// The encoder of a container and its options, where none is given: little is lost, and of red, green and blue nothing
/// where the container can.
fn usual(container: &str, (is_rgb, is_deep, has_alpha): (bool, bool, bool)) -> &'static [&'static str] {
    match (container, is_rgb, has_alpha) {
        ("mov", true, _) => &["-c:v", "png"],
        ("mov", false, true) => &["-c:v", "prores_ks", "-profile:v", "4444", "-alpha_bits", "16"],
        ("mp4" | "3gp" | "3g2", true, _) if !is_deep => EXACT_X264,
        ("mpegts", true, _) if !is_deep => EXACT_X264,
        ("mp4" | "mov" | "3gp" | "3g2", ..) | ("mpegts", ..) => X264,
        ("matroska" | "avi", true, _) | ("matroska" | "avi", _, true) => &["-c:v", "ffv1", "-level", "3"],
        ("matroska", ..) => X264,
        ("webm", true, false) => &["-c:v", "libvpx-vp9", "-lossless", "1", "-row-mt", "1"],
        ("webm", ..) => &["-c:v", "libvpx-vp9", "-crf", "18", "-b:v", "0", "-row-mt", "1"],
        ("avi", ..) => &["-c:v", "mpeg4", "-q:v", "2"],
        ("mxf" | "vob", ..) => &["-c:v", "mpeg2video", "-q:v", "2"],
        ("asf", ..) => &["-c:v", "wmv2", "-q:v", "2"],
        ("ogv", ..) => &["-c:v", "libtheora", "-q:v", "10"],
        ("dv", ..) => &["-c:v", "dvvideo"],
        ("gif", ..) => &["-c:v", "gif"],
        ("apng", ..) => &["-c:v", "apng"],
        (WEBP, ..) => &["-c:v", "libwebp_anim", "-lossless", "1"],
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::video::closed::Ratio;

    fn form(container: &'static str, pixels: &'static str, size: (u32, u32), options: Option<&str>) -> Form {
        let mut stream = Stream::of_frames(size, Ratio::USUAL_RATE);
        stream.pixels = pixels;
        Form::of(container, &stream, stream.channels(), options)
    }

    #[test]
    fn encoders_get_pixels_that_they_take() {
        let even = (160, 90);
        for (container, pixels, encoder, taken) in [
            ("mp4", "yuv420p", "libx264", "yuv420p"),
            ("mp4", "gbrp", "libx264rgb", "bgr24"),
            ("mp4", "gbrp10le", "libx264", deep("yuv444p10")),
            ("mov", "rgb24", "png", "rgb24"),
            ("mov", "argb", "png", "rgba"),
            ("mov", "yuva444p12le", "prores_ks", deep("yuva444p10")),
            ("matroska", "bgr0", "ffv1", "bgr0"),
            ("matroska", "gbrp12le", "ffv1", deep("gbrp12")),
            ("matroska", "yuva420p", "ffv1", "yuva420p"),
            ("webm", "yuva420p", "libvpx-vp9", "yuva420p"),
            ("webm", "rgb24", "libvpx-vp9", "gbrp"),
            ("gif", "yuv420p", "gif", "bgra"),
            ("vob", "rgb24", "mpeg2video", "yuv444p"),
        ] {
            let form = form(container, pixels, even, None);
            assert_eq!((form.options[1], form.pixels), (encoder, taken), "{pixels} in {container}");
            let is_rgb = is_rgb(taken);
            assert_eq!(form.range, if is_rgb { "pc" } else { "tv" }, "{pixels} in {container}");
            assert_eq!(form.tags.contains(&["-colorspace", "rgb"]), is_rgb, "{pixels} in {container}");
        }
        // Encoders that are named have forms of their own.
        assert_eq!(form("mov", "rgb24", even, Some("-c:v libx264 -crf 3")).pixels, "yuv444p");
        assert_eq!(form("matroska", "rgb24", even, Some("-c:v nonsense")).pixels, "yuv444p");
        assert_eq!(form("matroska", "rgba", even, Some("-vcodec utvideo")).pixels, "gbrap");
    }

    #[test]
    fn alpha_and_odd_sizes_are_kept_where_they_can_be() {
        for (container, pixels, keeps) in [
            ("mp4", "yuva420p", false),
            ("mov", "yuva420p", true),
            ("avi", "bgra", true),
            ("gif", "bgra", true),
        ] {
            let form = form(container, pixels, (4, 4), None);
            assert_eq!(form.has_alpha, keeps, "{container}");
        }
        let odd = (161, 91);
        for (container, pixels, taken, size) in [
            ("mp4", "yuv420p", "yuv444p", odd),
            ("matroska", "yuv422p10le", "yuv444p10le", odd),
            ("mp4", "nv12", "yuv444p", odd),
            ("webm", "yuv420p", "yuv420p", odd),
            ("asf", "yuv420p", "yuv420p", (160, 90)),
        ] {
            let form = form(container, pixels, odd, None);
            assert_eq!((form.pixels, form.size), (taken, size), "{pixels} in {container}");
        }
    }
}
