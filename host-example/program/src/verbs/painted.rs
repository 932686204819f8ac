//! Options of maps that artists paint, of colours and light in files of their own, and of materials.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use isophote_finishing::apply::filter::MaskedStyle;
use isophote_finishing::apply::painted::{PAINTED, Painted};
use isophote_finishing::stylize::things;
use isophote_pictures::exr::Guide;

use super::material_args::MaterialArgs;

/// Maps that artists paint, colours and light in files of their own, and materials.
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
    /// Colours of surfaces without light, a file or one for each frame (albedo.####.exr), in the place of the layer.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub albedo: Option<PathBuf>,
    /// Light that surfaces reflect in all directions, in their colours: a file or one for each frame (diffuse.####.exr).
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub diffuse: Option<PathBuf>,
    /// Light that surfaces mirror: a file or one for each frame (specular.####.exr).
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub specular: Option<PathBuf>,
    #[command(flatten)]
    pub materials: MaterialArgs,
}

impl PaintedArgs {
    /// Files of the maps that there are.
    pub fn paths(&self) -> Vec<(&'static Painted, &Path)> {
        let path = |painted: &Painted| match painted.guide {
            Guide::Control => self.control.as_deref(),
            Guide::LinePaint => self.line_paint.as_deref(),
            Guide::Albedo => self.albedo.as_deref(),
            Guide::Diffuse => self.diffuse.as_deref(),
            Guide::Specular => self.specular.as_deref(),
            _ => self.flow.as_deref(),
        };
        PAINTED.iter().filter_map(|painted| Some((painted, path(painted)?))).collect()
    }

    /// True for a guide that has files of its own.
    pub fn has(&self, guide: Guide) -> bool {
        self.paths().iter().any(|(painted, _)| painted.guide == guide)
    }

    /// The maps and materials that there are, that of rules for things included.
    pub fn guides_of(&self, looks: &[MaskedStyle]) -> Vec<Guide> {
        let mut guides: Vec<Guide> = self.paths().into_iter().map(|(painted, _)| painted.guide).collect();
        let has_rules = looks.iter().any(|look| !look.style.objects.is_empty());
        guides.extend(self.materials.named().into_iter().map(|(kind, _)| kind.guide()));
        let has_colors =
            looks.iter().flat_map(|look| &look.style.objects).any(|rule| things::line_color(rule).is_some());
        for (guide, _) in
            [(Guide::Control, has_rules), (Guide::LinePaint, has_colors)].iter().filter(|(_, has)| *has)
        {
            if !guides.contains(guide) {
                guides.push(*guide);
            }
        }
        guides
    }
}
