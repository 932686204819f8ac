//! Options of maps that artists paint, and of their materials.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use isophote_finishing::apply::filter::MaskedStyle;
use isophote_finishing::apply::painted::{PAINTED, Painted};
use isophote_pictures::exr::Guide;
use isophote_pictures::material::MaterialKind;

/// Maps that artists paint, and their materials.
#[derive(Clone, Debug, Default, Args)]
pub struct PaintedArgs {
    /// A painted flow map, along which the style draws: a file such as flow.png, or one for each frame (flow.####.exr). Red and
    /// green say where it leads, 0.5 for nowhere, and alpha how much it counts.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub flow: Option<PathBuf>,
    /// A control map, by which places are directed: a file such as control.png, or one for each frame (control.####.exr). Red is
    /// detail, green the width of lines, blue their amount and alpha the strength of marks and paint; 0.5 changes nothing,
    /// and alpha of 1 everywhere is none.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub control: Option<PathBuf>,
    /// Paper to draw or paint on: a picture, tiled over the frame, or one that ships, such as cold_press (see `isophote materials`).
    /// It is as large as its pixels on 1080 lines; what is darker than around it is deep.
    #[arg(long, value_name = "FILE|NAME", value_hint = ValueHint::FilePath)]
    pub paper: Option<PathBuf>,
    /// Hatching to draw tones with: a picture, tiled over the frame, or one that ships, such as pen (see `isophote materials`). Up
    /// to four tones, the lightest in red, then green, blue and alpha; white is paper.
    #[arg(long, value_name = "FILE|NAME", value_hint = ValueHint::FilePath)]
    pub hatching: Option<PathBuf>,
}

impl PaintedArgs {
    /// Files of the maps that there are.
    pub fn paths(&self) -> Vec<(&'static Painted, &Path)> {
        let path = |painted: &Painted| match painted.guide {
            Guide::Control => self.control.as_deref(),
            _ => self.flow.as_deref(),
        };
        PAINTED.iter().filter_map(|painted| Some((painted, path(painted)?))).collect()
    }

    /// Names and files of the materials that there are.
    pub fn materials(&self) -> Vec<(MaterialKind, &Path)> {
        let named = |kind| match kind {
            MaterialKind::Paper => self.paper.as_deref(),
            MaterialKind::Hatching => self.hatching.as_deref(),
        };
        MaterialKind::ALL.into_iter().filter_map(|kind| Some((kind, named(kind)?))).collect()
    }

    /// The maps and materials that there are, that of rules for things included.
    pub fn guides_of(&self, looks: &[MaskedStyle]) -> Vec<Guide> {
        let mut guides: Vec<Guide> = self.paths().into_iter().map(|(painted, _)| painted.guide).collect();
        let has_rules = looks.iter().any(|look| !look.style.objects.is_empty());
        guides.extend(self.materials().into_iter().map(|(kind, _)| kind.guide()));
        if has_rules && !guides.contains(&Guide::Control) {
            guides.push(Guide::Control);
        }
        guides
    }
}
