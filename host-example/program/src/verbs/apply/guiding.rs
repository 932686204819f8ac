//! Guides, masks and motion of a run of `isophote apply`: which a style can use, and which were found.

use super::super::material_args::must_follow;
use super::ApplyArgs;
use isophote_files::error::{Error, Result};
use isophote_files::frames::Pattern;
use isophote_files::output;
use isophote_finishing::apply::filter::MaskedStyle;
use isophote_finishing::apply::looks::Entry;
use isophote_finishing::apply::masks::{MaskChoice, Masks};
use isophote_finishing::apply::materials::Laid;
use isophote_finishing::apply::objects::Rule;
use isophote_finishing::apply::planner::Planner;
use isophote_finishing::apply::tasks::Tasks;
use isophote_loader::Library;
use isophote_pictures::exr::{Guide, MaskSource, Selection};
use isophote_pictures::read::Opened;

impl ApplyArgs {
    /// Guides that are looked for.
    pub(super) fn wanted(&self, library: &Library, looks: &[MaskedStyle]) -> Result<Vec<Guide>> {
        let mut wanted = Vec::new();
        for look in looks {
            wanted.extend(look.style.usable_guides(library)?);
        }
        wanted.retain(|guide| !(self.estimates_motion() && guide.is_motion()));
        Ok(wanted)
    }

    /// Masks of where it is done.
    pub(super) fn masks(&self, entries: &[Entry]) -> Vec<MaskChoice> {
        let choice = |source: &MaskSource| MaskChoice { source: source.clone(), invert: self.invert };
        let own = self.mask.iter().map(choice);
        own.chain(entries.iter().filter_map(|entry| entry.mask.clone())).collect()
    }

    /// Where the things are that the rules of the style's preset are for.
    ///
    /// # Errors
    /// As [`Style::things`](isophote_finishing::stylize::style::Style::things); [`Error::Input`] for rules of one of several looks.
    pub(super) fn things(&self, looks: &[MaskedStyle]) -> Result<Vec<MaskChoice>> {
        let Some(MaskedStyle { style, .. }) = looks.iter().find(|look| !look.style.objects.is_empty()) else {
            return Ok(Vec::new());
        };
        if self.layered.is_some() {
            let place = format!("{}: objects", style.name);
            let problem = "are rules of one of several looks";
            return Err(Error::input(place, problem, "give looks masks, or name the preset alone"));
        }
        Ok(style.things()?.into_iter().map(|source| MaskChoice { source, invert: false }).collect())
    }

    /// Maps over the pictures: masks, those that are painted, materials, and rules for things, whose masks are the last of the choices.
    ///
    /// # Errors
    /// As [`Masks::new`]; [`Error::Input`] for a map that no style would follow.
    pub(super) fn maps(&self, choices: &[MaskChoice], looks: &[MaskedStyle]) -> Result<Masks> {
        let (paths, styles) =
            (self.painted.paths(), looks.iter().map(|look| &look.style).collect::<Vec<_>>());
        for (painted, _) in &paths {
            must_follow(&styles, painted.guide, &format!("the style follows no {}", painted.name))?;
        }
        let laid = |material| Laid::new(material, self.space);
        let laid = self.painted.materials.open(&styles)?.into_iter().map(laid).collect();
        let rules = looks.iter().flat_map(|look| &look.style.objects);
        let rules = rules.map(Rule::from);
        let masks = Masks::new(choices, self.mask_from.as_deref(), self.on_unknown)?;
        Ok(masks.with_maps(&paths, self.space)?.with_materials(laid).with_rules(rules.collect(), self.space))
    }

    /// The files of motion vectors.
    ///
    /// # Errors
    /// [`Error::Input`] where they would not be used, and where none is there.
    pub(super) fn motion_files(&self, tasks: &Tasks, selection: &Selection) -> Result<Option<Pattern>> {
        let Some(path) = &self.motion else { return Ok(None) };
        let wrong = |problem: &str, fix: &str| Err(Error::input("--motion", problem, fix));
        if !tasks.is_sequence() {
            return wrong("a picture by itself has no neighbours", "name a sequence such as shot.####.exr");
        }
        if self.estimates_motion() {
            return Ok(None);
        }
        if selection.wanted.iter().all(|guide| !guide.is_motion()) {
            return wrong("the style reads no motion", "give --steadiness 0.5, or another style");
        }
        let Some(pattern) = Pattern::new(path)? else {
            return wrong("has no place for a frame number", "write mv.####.exr");
        };
        let mut frames = tasks.ready.iter().filter_map(|task| task.frame);
        match frames.find(|frame| pattern.file(*frame).is_file()) {
            Some(_) => Ok(Some(pattern)),
            None => Err(Error::file(path, "has none of the frames", "name files that exist")),
        }
    }

    /// The line that says which guides and which motion the first frame has for the style; empty where there is nothing to
    /// say. Warns where nothing will be steady for want of motion.
    ///
    /// # Errors
    /// As [`Planner::span`].
    pub(super) fn guides_found(
        &self,
        tasks: &Tasks,
        selection: &Selection,
        opened: Option<&Opened>,
        planner: &Planner,
    ) -> Result<String> {
        let is_one = tasks.is_sequence() || !tasks.are_several();
        let Some(opened) = opened.filter(|_| is_one) else { return Ok(String::new()) };
        let offers = opened.offers();
        let is_steady = planner.span(tasks.ready[0].frame)? > 1;
        let is_used = |guide: &Guide| selection.wanted.contains(guide) && (is_steady || !guide.is_motion());
        let has_files = self.motion.is_some();
        let is_of_file = |guide: &Guide| (has_files && guide.is_motion()) || self.painted.has(*guide);
        let found = offers.guides.iter().filter(|(guide, _)| is_used(guide) && !is_of_file(guide));
        let mut parts: Vec<String> =
            found.map(|(guide, channels)| format!("{} from {}", guide.id(), channels.join(", "))).collect();
        let files = self.painted.paths().into_iter();
        parts.extend(files.map(|(painted, path)| format!("{} from {}", painted.guide.id(), path.display())));
        match &self.motion {
            Some(_) if self.estimates_motion() => parts.push("motion estimated".into()),
            Some(files) if is_steady => parts.push(format!("motion from {}", files.display())),
            _ => {}
        }
        let has = |guide: Guide| is_of_file(&guide) || offers.guides.iter().any(|(other, _)| *other == guide);
        // Other files than EXR have none; what was left out by hand is not missed, nor what few files have.
        let is_missed = |guide: &Guide| {
            let is_named = selection.guides.iter().any(|choice| choice.guide == *guide);
            let is_rare = matches!(
                guide,
                Guide::Flow
                    | Guide::Control
                    | Guide::Paper
                    | Guide::Hatching
                    | Guide::LinePaint
                    | Guide::RestPosition
                    | Guide::MotionForward
            );
            !offers.layers.is_empty() && is_used(guide) && !(is_named || is_rare || has(*guide))
        };
        let missed: Vec<&str> = Guide::ALL.into_iter().filter(is_missed).map(Guide::id).collect();
        if !missed.is_empty() {
            parts.push(format!("no {}", missed.join(", ")));
        }
        let is_left_out = selection.guides.iter().any(|choice| choice.guide.is_motion());
        let wants =
            [Guide::Motion, Guide::MotionForward].iter().any(|guide| selection.wanted.contains(guide));
        let has_any = [Guide::Motion, Guide::MotionForward].into_iter().any(has);
        if is_steady && wants && !has_any && !is_left_out {
            output::warn(
                "the frames have no motion vectors, and nothing will be steady; add --motion estimate, or name files of \
                 motion vectors by --motion",
            );
        }
        let is_told = !(parts.is_empty() || self.json || self.quiet.quiet);
        Ok(if is_told { format!("guides: {}\n", parts.join("; ")) } else { String::new() })
    }
}
