//! Kinds of files that can be exported, by the names that artists know them by, and what can be chosen of each.

use isophote_finishing::writing::{Codec, Depth, FileArgs, ResultArgs};
use isophote_pictures::resize::Resize;
use isophote_pictures::write::Format;

/// Quality of JPEG files where nobody chooses another.
const QUALITY: u8 = 95;
/// Pixels of a side where a size is chosen first.
const SIDE: u32 = 1920;

/// Kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileFormat {
    /// Name for people.
    pub name: &'static str,
    /// Extension of its files.
    pub extension: &'static str,
    /// Codec of a video, where it is not the usual one of its container.
    pub codec: Option<Codec>,
    /// True for videos.
    pub is_video: bool,
}

const fn picture(name: &'static str, extension: &'static str) -> FileFormat {
    FileFormat { name, extension, codec: None, is_video: false }
}

const fn video(name: &'static str, extension: &'static str, codec: Option<Codec>) -> FileFormat {
    FileFormat { name, extension, codec, is_video: true }
}

/// Kinds of pictures.
pub const PICTURES: [FileFormat; 4] =
    [picture("PNG", "png"), picture("JPEG", "jpg"), picture("TIFF", "tif"), picture("OpenEXR", "exr")];

/// Kinds of pictures that scenes are rendered to.
pub const RENDERS: [FileFormat; 2] = [PICTURES[0], PICTURES[3]];

/// Kinds of videos.
pub const VIDEOS: [FileFormat; 9] = [
    video("MP4 (H.264)", "mp4", None),
    video("MP4 (H.265)", "mp4", Some(Codec::H265)),
    video("MOV", "mov", None),
    video("MOV (ProRes 422 HQ)", "mov", Some(Codec::Prores)),
    video("MKV", "mkv", None),
    video("MKV (FFV1, nothing lost)", "mkv", Some(Codec::Ffv1)),
    video("WebM (VP9)", "webm", None),
    video("GIF", "gif", None),
    video("WebP, animated", "webp", None),
];

impl FileFormat {
    /// The kind as the writer of pictures knows it; none for videos.
    pub fn written(self) -> Option<Format> {
        match self.extension {
            "png" => Some(Format::Png),
            "jpg" => Some(Format::Jpeg),
            "tif" => Some(Format::Tiff),
            "exr" => Some(Format::Exr),
            _ => None,
        }
    }
}

/// The extension as it is written here.
pub fn usual_extension(extension: &str) -> String {
    match extension.to_lowercase().as_str() {
        "jpeg" => "jpg".to_owned(),
        "tiff" => "tif".to_owned(),
        other => other.to_owned(),
    }
}

/// Size of results in relation to pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scaling {
    /// As the picture.
    #[default]
    Same,
    /// Half of both sides.
    Half,
    /// So many pixels across.
    Width,
    /// So many pixels down.
    Height,
}

impl Scaling {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Same, "As the picture"),
        (Self::Half, "Half"),
        (Self::Width, "Width"),
        (Self::Height, "Height"),
    ];
}

/// Choices of files that are written.
#[derive(Clone, Debug, PartialEq)]
pub struct FileChoices {
    /// Quality of JPEG files.
    pub quality: u8,
    /// Bit depth, where it is not that which the picture deserves.
    pub depth: Option<Depth>,
    /// Size.
    pub scaling: Scaling,
    /// Pixels of the side that is chosen.
    pub side: u32,
}

impl Default for FileChoices {
    fn default() -> Self {
        Self { quality: QUALITY, depth: None, scaling: Scaling::Same, side: SIDE }
    }
}

impl FileChoices {
    /// Options for files of a kind, or of the kinds of their pictures.
    pub fn options(&self, format: Option<Format>, codec: Option<Codec>) -> ResultArgs {
        let depth =
            self.depth.filter(|depth| format.is_some_and(|format| Depth::of(format).any(|of| of == *depth)));
        let quality = Some(self.quality).filter(|q| format == Some(Format::Jpeg) && *q != QUALITY);
        let resize = match self.scaling {
            Scaling::Same => None,
            Scaling::Half => Some(Resize::Share(0.5)),
            Scaling::Width => Some(Resize::Width(self.side)),
            Scaling::Height => Some(Resize::Height(self.side)),
        };
        ResultArgs { file: FileArgs { depth, codec }, quality, resize, format: None }
    }
}

/// Files that are there already and would be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Replaced {
    /// What is open, or was chosen.
    Original,
    /// So many others.
    Others(usize),
}
