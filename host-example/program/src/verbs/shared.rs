//! Arguments that several verbs have.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueHint};

use isophote_files::error::Result;
use isophote_files::files::Existing;
use isophote_files::output;
use isophote_files::replacing::Consent;
use isophote_finishing::staging::ReadingArgs;
use isophote_finishing::stylize::palette::{self, Colours};
use isophote_finishing::stylize::precision::Precision;
use isophote_finishing::stylize::preset::Lengths;
use isophote_finishing::stylize::style::Style;
use isophote_loader::Library;
use isophote_pictures::pixels::MOST_PIXELS;
use isophote_scene::Scene;

/// The scene of `render`.
#[derive(Args, Clone, Debug)]
pub struct SceneArgs {
    /// The scene: .gltf, .glb or .obj.
    pub scene: PathBuf,
    /// Options of reading it.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

impl SceneArgs {
    /// Loads the scene and prints its warnings.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load(&self) -> Result<Scene> {
        self.reading.load(&self.scene)
    }
}

/// Meaning of a style's lengths.
#[derive(Args, Clone, Copy, Debug)]
pub struct LengthArgs {
    /// Picture that lengths, such as the width of lines, are meant for: one 1080 lines high, so that every size gets the same
    /// look, or the picture itself [default: what the preset says, else relative].
    #[arg(long, value_parser = lengths())]
    pub lengths: Option<Lengths>,
}

/// Reads the words for lengths.
fn lengths() -> impl TypedValueParser<Value = Lengths> {
    let word = |lengths: Lengths| {
        PossibleValue::new(lengths.id()).help(match lengths {
            Lengths::Relative => {
                "Pixels of a picture 1080 lines high: pictures of all sizes get the same look"
            }
            Lengths::Pixels => "Pixels of the picture itself",
        })
    };
    let of = |word: String| Lengths::ALL.into_iter().find(|lengths| lengths.id() == word);
    PossibleValuesParser::new(Lengths::ALL.map(word)).try_map(move |word| of(word).ok_or("write a word"))
}

impl LengthArgs {
    /// Lets lengths mean what was asked for.
    pub fn apply(self, style: &mut Style) {
        style.lengths = self.lengths.unwrap_or(style.lengths);
    }
}

/// Precision in which graphics devices compute a style.
#[derive(Args, Clone, Copy, Debug)]
pub struct PrecisionArgs {
    /// Accuracy of a graphics card; the CPU is always exact.
    #[arg(long, value_enum, default_value_t)]
    pub precision: Precision,
}

/// Colours that a style draws with.
#[derive(Args, Clone, Debug)]
pub struct PaletteArgs {
    /// A file whose colours the result has and no others: a palette (.gpl of GIMP, .hex, .ase, .aco, .pal or .json), or a
    /// picture, such as a strip of colours or a photograph; or one that ships, by its id, such as gouache, which styles with a
    /// palette of their own draw or print with. Others get the node palette at their end; --set palette.dither=bayer and the like
    /// say how it draws.
    #[arg(long, value_name = "FILE|NAME", value_hint = ValueHint::FilePath)]
    pub palette: Option<PathBuf>,
    /// Number of colours that are taken from the palette or found in the picture [default: all of a palette, 8 of a photograph].
    #[arg(long, value_name = "N", requires = "palette", value_parser = clap::value_parser!(u16).range(2..))]
    pub palette_count: Option<u16>,
}

impl PaletteArgs {
    /// The file, if one is named: a palette that ships is none.
    pub fn file(&self) -> Option<&Path> {
        self.palette.as_deref().filter(|name| palette::is_file(name))
    }

    /// Reads the colours, where some are named, and warns of what is to be said of them.
    ///
    /// # Errors
    /// As [`palette::read`].
    pub fn read(&self, library: &Library) -> Result<Option<Colours>> {
        let Some(path) = &self.palette else { return Ok(None) };
        let palette = palette::read(library, path, self.palette_count.map(usize::from))?;
        warn_of(path, palette.notes());
        Ok(Some(palette))
    }
}

/// Warns of what is to be said of a palette.
pub fn warn_of(path: &Path, notes: &[String]) {
    for note in notes {
        output::warn(format_args!("{}: {note}", path.display()));
    }
}

/// Treatment of files that are there already.
#[derive(Args, Clone, Copy, Debug)]
pub struct ForceArgs {
    /// Overwrites files that exist; without it the command stops before it touches one.
    #[arg(long)]
    pub force: bool,
}

impl ForceArgs {
    /// Consent that was given.
    pub fn consent(self) -> Consent {
        Consent::forced(self.force)
    }

    /// Treatment of a file that is there.
    pub fn existing(self) -> Existing {
        if self.force { Existing::Replace } else { Existing::Keep }
    }
}

/// Silence on what goes well.
#[derive(Args, Clone, Copy, Debug)]
pub struct QuietArgs {
    /// Prints nothing when all goes well.
    #[arg(long)]
    pub quiet: bool,
}

/// Width and height in pixels, such as `1280x720`.
///
/// # Errors
/// Advice what to write instead.
pub fn parse_size(text: &str) -> std::result::Result<(u32, u32), String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        Some((width.trim().parse::<u32>().ok()?, height.trim().parse::<u32>().ok()?))
    };
    parse()
        .filter(|(width, height)| (1..=MOST_PIXELS).contains(&(u64::from(*width) * u64::from(*height))))
        .ok_or_else(|| {
            format!("write width and height such as 1280x720; at most {MOST_PIXELS} pixels in all")
        })
}

/// A number of frames a second.
///
/// # Errors
/// Advice what to write instead.
pub fn parse_rate(text: &str) -> std::result::Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (0.001..=1000.0).contains(rate));
    rate.ok_or_else(|| "write frames per second such as 24".into())
}

/// True where a result is a folder: one that is there, or whose name ends as those of folders do.
pub fn is_folder(output: &Path) -> bool {
    let ends = |byte: &u8| std::path::is_separator(char::from(*byte));
    output.is_dir() || output.as_os_str().as_encoded_bytes().last().is_some_and(ends)
}

/// Does something to all looks that can have it. Of several, one is enough.
///
/// # Errors
/// The first refusal where all refuse.
pub fn of_any<T>(looks: impl IntoIterator<Item = T>, to: impl FnMut(T) -> Result<()>) -> Result<()> {
    let (mut is_done, mut refused) = (false, None);
    for result in looks.into_iter().map(to) {
        match result {
            Ok(()) => is_done = true,
            Err(refusal) => refused = refused.or(Some(refusal)),
        }
    }
    refused.filter(|_| !is_done).map_or(Ok(()), Err)
}
