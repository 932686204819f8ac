//! Rules of a preset for the things of a scene, on frames that a renderer draws of it: what `apply` makes of rules by the
//! Cryptomattes of a file.

use std::path::Path;

use crate::apply::objects::{Rule, Ruled};
use crate::processor::Processor;
use crate::stylize::style::Style;
use isophote_files::error::Result;
use isophote_loader::Library;
use isophote_pictures::exr::{Guide, OnUnknown};
use isophote_pictures::meaning::{Alpha, Meaning};
use isophote_pictures::mix::{self, Encoding};
use isophote_pictures::pixels::{Pixels, Samples};
use isophote_scene::Scene;

/// Rules of a style for the things of one scene.
#[derive(Debug)]
pub struct Directed {
    rules: Vec<Rule>,
    /// By rule and by thing of a scene: true where the rule is for it.
    things: Vec<Vec<bool>>,
    /// Looks that rules give to things, each with the place of its rule. The last lies over those before it.
    looks: Vec<(usize, Processor)>,
}

/// Numbers of a frame that rules are followed on, by pixel.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    /// Columns and rows.
    pub size: (u32, u32),
    /// Meaning of its colours.
    pub encoding: Encoding,
    /// A control map that was painted for it.
    pub control: Option<&'a [f32]>,
    /// Colours of lines that were painted for it.
    pub line_paint: Option<&'a [f32]>,
    /// Distances.
    pub depth: Option<&'a [f32]>,
}

/// What rules say of a frame.
#[derive(Debug)]
pub struct Followed {
    /// The control map and the colours of lines that they are, as far as they ask for such.
    pub maps: Vec<(Guide, Pixels)>,
    /// By rule, where its look is.
    pub masks: Vec<Pixels>,
}

impl Directed {
    /// The rules of a style for the scene in `file`, with the looks that they give to [things](crate::stylize::things::looks); nothing
    /// where it has none.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for rules that the style does not follow, for names that no thing of the scene has unless
    /// `on_unknown` lets them cover nothing, and where looks are no colours.
    pub fn new(
        library: &Library,
        style: &Style,
        looks: Vec<(usize, Style)>,
        (scene, file): (&Scene, &Path),
        on_unknown: OnUnknown,
    ) -> Result<Option<Self>> {
        if style.objects.is_empty() {
            return Ok(None);
        }
        let (objects, materials) = (scene.object_names(), scene.material_names());
        let sources = style.things()?.into_iter();
        let names = [objects.as_slice(), &materials];
        let things = sources.map(|source| source.among(file, names, on_unknown)).collect::<Result<_>>()?;
        Ok(Some(Self { things, ..Self::covered(library, style, looks)? }))
    }

    /// The rules of a style for pictures of which is known what their things cover, with the looks that they give to things.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] where looks are no colours.
    pub fn covered(library: &Library, style: &Style, looks: Vec<(usize, Style)>) -> Result<Self> {
        if !looks.is_empty() {
            style.must_cover()?;
        }
        let made = |(number, look): (usize, Style)| {
            look.must_cover()?;
            Ok((number, Processor::new(library, look)?))
        };
        let looks = looks.into_iter().map(made).collect::<Result<_>>()?;
        let rules = style.objects.iter().map(Rule::from).collect();
        Ok(Self { rules, things: Vec::new(), looks })
    }

    /// The looks of things.
    pub fn looks(&self) -> impl Iterator<Item = &Processor> {
        self.looks.iter().map(|(_, look)| look)
    }

    /// Adds to what things of each rule cover of pixels one of `samples` samples: `numbers` are those of the things that it shows, from 1,
    /// and 0 of none.
    pub fn count(&self, coverage: &mut Vec<Vec<f32>>, numbers: &[f32], samples: u32) {
        coverage.resize(self.rules.len(), vec![0.0; numbers.len()]);
        let share = 1.0 / samples as f32;
        for (covered, things) in coverage.iter_mut().zip(&self.things) {
            for (covered, number) in covered.iter_mut().zip(numbers) {
                let thing = (*number as usize).checked_sub(1).and_then(|index| things.get(index));
                if thing == Some(&true) {
                    *covered += share;
                }
            }
        }
    }

    /// What the rules say of a frame, by what their things cover of it, over what was painted for it.
    pub fn follow(&self, coverage: &[Vec<f32>], given: &Given<'_>) -> Followed {
        let Given { size, encoding, control, line_paint, depth } = *given;
        let mask = |mask: &Vec<f32>| Pixels::new(size.0, size.1, 1, Samples::F32(mask.clone()));
        let masks = coverage.iter().filter_map(mask).collect();
        let coverage: Vec<Option<&[f32]>> = coverage.iter().map(|mask| Some(mask.as_slice())).collect();
        let alpha = if encoding.is_premultiplied { Alpha::Premultiplied } else { Alpha::Straight };
        let meaning = Meaning { alpha, ..Meaning::display().named(Some(encoding.space)) };
        let ruled = Ruled { rules: &self.rules, coverage: &coverage, size, depth };
        let maps = [
            (Guide::Control, ruled.control(control)),
            (Guide::LinePaint, ruled.line_paint(&meaning, line_paint)),
        ];
        Followed { maps: maps.into_iter().filter_map(|(guide, map)| Some((guide, map?))).collect(), masks }
    }

    /// A frame of this encoding with the looks of things over it, of which `process` makes each; nothing where that was cancelled.
    ///
    /// # Errors
    /// Those of `process`.
    pub fn lay_over(
        &mut self,
        frame: Pixels,
        (masks, encoding): (&[Pixels], Encoding),
        mut process: impl FnMut(&mut Processor) -> Result<Option<Pixels>>,
    ) -> Result<Option<Pixels>> {
        let mut below = frame;
        for (number, look) in &mut self.looks {
            let Some(above) = process(look)? else { return Ok(None) };
            if let Some(mask) = masks.get(*number) {
                below = mix::mixed(&below, above, mask, encoding);
            }
        }
        Ok(Some(below))
    }
}
