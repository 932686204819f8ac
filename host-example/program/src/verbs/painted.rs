//! Options of maps that artists paint, and of their materials.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use isophote_finishing::apply::filter::MaskedStyle;
use isophote_finishing::apply::painted::{PAINTED, Painted};
use isophote_pictures::exr::Guide;

use super::material_args::MaterialArgs;

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
    /// Colours of lines: a picture such as lines.png, or one for each frame (lines.####.exr). A line has the colour that is
    /// painted where it lies, as far as that is opaque, and its own where nothing is painted.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub line_paint: Option<PathBuf>,
    #[command(flatten)]
    pub materials: MaterialArgs,
}

impl PaintedArgs {
    /// Files of the maps that there are.
    pub fn paths(&self) -> Vec<(&'static Painted, &Path)> {
        let path = |painted: &Painted| match painted.guide {
            Guide::Control => self.control.as_deref(),
            Guide::LinePaint => self.line_paint.as_deref(),
            _ => self.flow.as_deref(),
        };
        PAINTED.iter().filter_map(|painted| Some((painted, path(painted)?))).collect()
    }

    /// The maps and materials that there are, that of rules for things included.
    pub fn guides_of(&self, looks: &[MaskedStyle]) -> Vec<Guide> {
        let mut guides: Vec<Guide> = self.paths().into_iter().map(|(painted, _)| painted.guide).collect();
        let has_rules = looks.iter().any(|look| !look.style.objects.is_empty());
        guides.extend(self.materials.named().into_iter().map(|(kind, _)| kind.guide()));
        if has_rules && !guides.contains(&Guide::Control) {
            guides.push(Guide::Control);
        }
        guides
    }
}
