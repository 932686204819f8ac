//! Options of materials that styles draw on and with.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::style::Style;
use isophote_pictures::exr::Guide;
use isophote_pictures::material::{Material, MaterialKind};

/// Paper and hatching.
#[derive(Clone, Debug, Default, Args)]
pub struct MaterialArgs {
    /// Paper to draw or paint on: a picture, tiled over the frame, or one that ships, such as cold_press (see `isophote materials`).
    /// It is as large as its pixels on 1080 lines; what is darker than around it is deep.
    #[arg(long, value_name = "FILE|NAME", value_hint = ValueHint::FilePath)]
    pub paper: Option<PathBuf>,
    /// Hatching to draw tones with: a picture, tiled over the frame, or one that ships, such as pen (see `isophote materials`). Up
    /// to four tones, the lightest in red, then green, blue and alpha; white is paper.
    #[arg(long, value_name = "FILE|NAME", value_hint = ValueHint::FilePath)]
    pub hatching: Option<PathBuf>,
}

impl MaterialArgs {
    /// Names and files of those that there are.
    pub fn named(&self) -> Vec<(MaterialKind, &Path)> {
        let named = |kind| match kind {
            MaterialKind::Paper => self.paper.as_deref(),
            MaterialKind::Hatching => self.hatching.as_deref(),
        };
        MaterialKind::ALL.into_iter().filter_map(|kind| Some((kind, named(kind)?))).collect()
    }

    /// The files among them: those that ship are none.
    pub fn files(&self) -> impl Iterator<Item = (MaterialKind, &Path)> {
        self.named().into_iter().filter(|(kind, name)| !kind.ships(name))
    }

    /// The materials, for styles one of which must take each.
    ///
    /// # Errors
    /// [`Error::Input`] where none does, and for files that cannot be read.
    pub fn open(&self, styles: &[&Style]) -> Result<Vec<Material>> {
        let open = |(kind, name): (MaterialKind, &Path)| {
            let guide = kind.guide();
            must_follow(styles, guide, &format!("the style has no {} of its own to replace", guide.id()))?;
            kind.open(name)
        };
        self.named().into_iter().map(open).collect()
    }
}

/// Makes sure that one of the styles takes a guide.
///
/// # Errors
/// [`Error::Input`] with this problem where none does.
pub fn must_follow(styles: &[&Style], guide: Guide, problem: &str) -> Result<()> {
    let id = guide.id();
    for style in styles {
        if style.takes(id)? {
            return Ok(());
        }
    }
    Err(Error::input(
        format!("--{id}"),
        problem,
        format!("choose another style, or connect @{id} in its graph"),
    ))
}
