//! Options of files that are written: size, quality, bit depth, kind and codec. They are declared here once, read from command
//! lines by `apply` and `render`, and written as command lines by the window. Without any, files are as their sources ask for.

use std::path::Path;

use clap::{Args, ValueEnum};

use crate::options::words;
use crate::video;
use isophote_files::error::{Error, Result};
use isophote_pictures::pixels::Precision;
use isophote_pictures::resize::Resize;
use isophote_pictures::write::{self, Format};

/// Bit depth of the samples of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Depth {
    /// Integers of 8 bits: PNG, JPEG and TIFF.
    #[value(name = "8")]
    Eight,
    /// Integers of 16 bits: PNG and TIFF.
    #[value(name = "16")]
    Sixteen,
    /// Floats of 16 bits: EXR.
    Half,
    /// Floats of 32 bits: EXR and TIFF.
    Float,
}

impl Depth {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Eight, Self::Sixteen, Self::Half, Self::Float];

    /// Precision of samples.
    pub const fn precision(self) -> Precision {
        match self {
            Self::Eight => Precision::U8,
            Self::Sixteen => Precision::U16,
            Self::Half => Precision::F16,
            Self::Float => Precision::F32,
        }
    }

    /// As options have it.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Eight => "8",
            Self::Sixteen => "16",
            Self::Half => "half",
            Self::Float => "float",
        }
    }

    /// Name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Eight => "8 bits",
            Self::Sixteen => "16 bits",
            Self::Half => "Half float (16 bits)",
            Self::Float => "Float (32 bits)",
        }
    }

    /// Those that a kind of file can have.
    pub fn of(format: Format) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |depth| format.depths().contains(&depth.precision()))
    }
}

/// Kind of the files of several pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FileKind {
    /// PNG: nothing is lost.
    Png,
    /// JPEG: small files.
    Jpeg,
    /// TIFF: nothing is lost.
    Tiff,
    /// OpenEXR: light as floats.
    Exr,
}

impl FileKind {
    /// Extension of its files.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpg",
            Self::Tiff => "tif",
            Self::Exr => "exr",
        }
    }

    /// The kind whose files have an extension.
    pub fn of(extension: &str) -> Option<Self> {
        [Self::Png, Self::Jpeg, Self::Tiff, Self::Exr].into_iter().find(|kind| kind.extension() == extension)
    }

    /// As options have it.
    const fn id(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpeg",
            Self::Tiff => "tiff",
            Self::Exr => "exr",
        }
    }
}

/// Codec of a video.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Codec {
    /// H.264, which everything plays: .mp4, .mov and .mkv.
    H264,
    /// H.265, smaller and younger: .mp4, .mov and .mkv.
    H265,
    /// Apple ProRes 422 HQ, for editing: .mov.
    Prores,
    /// VP9, for the web: .webm and .mkv.
    Vp9,
    /// FFV1, of which nothing is lost: .mkv.
    Ffv1,
}

impl Codec {
    /// As options have it.
    pub const fn id(self) -> &'static str {
        match self {
            Self::H264 => "h264",
            Self::H265 => "h265",
            Self::Prores => "prores",
            Self::Vp9 => "vp9",
            Self::Ffv1 => "ffv1",
        }
    }

    /// Extensions of the videos that can have it.
    const fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::H264 | Self::H265 => &["mp4", "m4v", "mov", "mkv"],
            Self::Prores => &["mov"],
            Self::Vp9 => &["webm", "mkv"],
            Self::Ffv1 => &["mkv"],
        }
    }

    /// Options of ffmpeg's encoder.
    const fn encoder(self) -> &'static str {
        match self {
            Self::H264 => "-c:v libx264 -crf 14 -preset medium",
            Self::H265 => "-c:v libx265 -crf 16 -preset medium -x265-params log-level=error",
            Self::Prores => "-c:v prores_ks -profile:v 3 -pix_fmt yuv422p10le",
            Self::Vp9 => "-c:v libvpx-vp9 -crf 18 -b:v 0 -row-mt 1",
            Self::Ffv1 => "-c:v ffv1 -level 3",
        }
    }
}

/// Options of files that `apply` and `render` write alike.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct FileArgs {
    /// Bit depth of the picture [default: what the source deserves].
    #[arg(long, value_enum)]
    pub depth: Option<Depth>,
    /// Codec of a video [default: what loses little in its container].
    #[arg(long, value_enum, conflicts_with = "encode")]
    pub codec: Option<Codec>,
}

impl FileArgs {
    /// The command line's words for them.
    pub fn words(&self) -> Vec<String> {
        words::<Self>(|id| match id {
            "depth" => self.depth.map(|depth| depth.id().to_owned()),
            "codec" => self.codec.map(|codec| codec.id().to_owned()),
            _ => None,
        })
    }

    /// Refuses what a result of this name cannot have.
    ///
    /// # Errors
    /// [`Error::Input`] with what it can have.
    pub fn check(&self, output: &Path) -> Result<()> {
        let is_video = video::becomes_video(output);
        let extension = output.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match self.codec {
            Some(_) if !is_video => return Err(useless("--codec", "is for videos")),
            Some(codec) if !codec.extensions().contains(&extension.as_str()) => {
                let problem = format!("{} is not for .{extension} files", codec.id());
                let fix = format!("name a video that ends in .{}", codec.extensions().join(" or ."));
                return Err(Error::input("--codec", problem, fix));
            }
            _ => {}
        }
        let Some(depth) = self.depth else { return Ok(()) };
        if is_video {
            return Err(useless("--depth", "is for pictures"));
        }
        let format = Format::of(output)?;
        if !format.depths().contains(&depth.precision()) {
            let known: Vec<&str> = Depth::of(format).map(Depth::id).collect();
            let problem = format!("{} is not for .{extension} files", depth.id());
            return Err(Error::input("--depth", problem, format!("choose {}", known.join(" or "))));
        }
        Ok(())
    }

    /// Options of ffmpeg's encoder: those that are given, or those of the codec.
    pub fn encode<'a>(&self, given: Option<&'a str>) -> Option<&'a str> {
        given.or(self.codec.map(Codec::encoder))
    }
}

/// Options of results of pictures, sequences and videos.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct ResultArgs {
    /// Options that renders have, too.
    #[command(flatten)]
    pub file: FileArgs,
    /// Quality of JPEG files, from 1 to 100 [default: 95].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=100))]
    pub quality: Option<u8>,
    /// Size of the result, which is made smaller or larger after the style: 50%, 1920x for a width in pixels, or x1080 for a
    /// height [default: the picture's].
    #[arg(long, value_name = "SIZE")]
    pub resize: Option<Resize>,
    /// Kind of the files in a folder of results [default: that of each picture].
    #[arg(long, value_enum, value_name = "KIND")]
    pub format: Option<FileKind>,
}

impl ResultArgs {
    /// The command line's words for them.
    pub fn words(&self) -> Vec<String> {
        let own = words::<Self>(|id| match id {
            "quality" => self.quality.map(|quality| quality.to_string()),
            "resize" => self.resize.map(|resize| resize.to_string()),
            "format" => self.format.map(|kind| kind.id().to_owned()),
            _ => None,
        });
        [self.file.words(), own].concat()
    }

    /// Options of the files.
    pub fn options(&self) -> write::Options {
        let Self { quality, resize, .. } = *self;
        write::Options { quality, depth: self.file.depth.map(Depth::precision), resize }
    }

    /// True where results hold more than integers of 8 bits, whatever the picture has.
    pub fn is_precise(&self) -> bool {
        self.file.depth.is_some_and(|depth| depth != Depth::Eight)
    }

    /// Refuses what the result of an input cannot have.
    ///
    /// # Errors
    /// As [`FileArgs::check`]; [`Error::Input`] for a quality of other files than JPEG, and another size of EXR files that
    /// go into themselves.
    pub fn check(&self, input: &Path, output: &Path) -> Result<()> {
        self.file.check(output)?;
        let format = if video::becomes_video(output) { None } else { Some(Format::of(output)?) };
        if self.quality.is_some() && format != Some(Format::Jpeg) {
            return Err(useless("--quality", "is for JPEG files"));
        }
        let is_in_place = format == Some(Format::Exr) && Format::of(input).is_ok_and(|of| of == Format::Exr);
        match [("--resize", self.resize.is_some()), ("--depth", self.file.depth.is_some())] {
            [(option, true), _] | [_, (option, true)] if is_in_place => {
                Err(useless(option, "is not for EXR files made of EXR files, whose other layers are kept"))
            }
            _ => Ok(()),
        }
    }
}

fn useless(option: &str, problem: &str) -> Error {
    Error::input(option, problem, "leave it out")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_refused_where_files_cannot_have_them() {
        let file = |depth, codec| FileArgs { depth, codec };
        for (file, output, is_fine) in [
            (file(Some(Depth::Sixteen), None), "a.png", true),
            (file(Some(Depth::Sixteen), None), "a.jpg", false),
            (file(Some(Depth::Float), None), "a.TIFF", true),
            (file(Some(Depth::Half), None), "a.tif", false),
            (file(Some(Depth::Half), None), "a.exr", true),
            (file(Some(Depth::Eight), None), "a.mp4", false),
            (file(None, Some(Codec::Prores)), "a.mov", true),
            (file(None, Some(Codec::Prores)), "a.mp4", false),
            (file(None, Some(Codec::H264)), "a.png", false),
            (file(None, None), "a.gif", true),
        ] {
            assert_eq!(file.check(Path::new(output)).is_ok(), is_fine, "{file:?} {output}");
        }
        let half = ResultArgs { resize: Some(Resize::Share(0.5)), ..ResultArgs::default() };
        for (input, output, is_fine) in
            [("a.exr", "b.exr", false), ("a.png", "b.exr", true), ("a.mp4", "b.mov", true)]
        {
            assert_eq!(half.check(Path::new(input), Path::new(output)).is_ok(), is_fine, "{input}");
        }
        let loud = ResultArgs { quality: Some(60), ..ResultArgs::default() };
        assert!(loud.check(Path::new("a.png"), Path::new("b.png")).is_err());
    }

    #[test]
    fn words_are_those_of_the_command_line() {
        let file = FileArgs { depth: Some(Depth::Eight), codec: None };
        let (quality, resize) = (Some(80), Some(Resize::Width(1920)));
        let all = ResultArgs { file, quality, resize, format: Some(FileKind::Jpeg) };
        assert_eq!(all.words().join(" "), "--depth 8 --quality 80 --resize 1920x --format jpeg");
        assert!(ResultArgs::default().words().is_empty());
    }
}
