//! Looks of a run of `isophote apply`, as its command line and the files that this names say.

use std::path::Path;

use super::super::shared::of_any;
use super::ApplyArgs;
use isophote_files::error::{Error, Result};
use isophote_finishing::apply::filter::MaskedStyle;
use isophote_finishing::apply::looks::{self, Entry};
use isophote_finishing::stylize::palette::Colours;
use isophote_finishing::stylize::style::Style;
use isophote_finishing::stylize::things;
use isophote_loader::Library;

/// What files say of the looks. They are read once, since looks are made several times.
pub(super) struct Written {
    /// The looks of a file; none where there is a style.
    pub entries: Vec<Entry>,
    /// Colours to draw with.
    palette: Option<Colours>,
}

impl ApplyArgs {
    /// The looks of a file, with the colours to draw with.
    ///
    /// # Errors
    /// As [`PaletteArgs::read`](super::PaletteArgs::read).
    pub(super) fn written(&self, library: &Library, entries: Vec<Entry>) -> Result<Written> {
        Ok(Written { entries, palette: self.palette.read(library)? })
    }

    /// The looks of a file; none where there is a style.
    ///
    /// # Errors
    /// As [`looks::read`].
    pub(super) fn entries(&self) -> Result<Vec<Entry>> {
        self.layered.as_deref().map_or_else(|| Ok(Vec::new()), looks::read)
    }

    /// Looks that every picture gets: those of a file, or else the style.
    ///
    /// # Errors
    /// As [`Style::load_in`].
    pub(super) fn looks(
        &self,
        library: &Library,
        name: &Path,
        written: &Written,
    ) -> Result<Vec<MaskedStyle>> {
        let mut masks = 0..;
        let Written { entries, palette } = written;
        let palette = palette.as_ref();
        let looks = if entries.is_empty() {
            let style = Style::load_in(library, name, palette, &self.set)?;
            let things = self.looks_of_things(library, palette, &style)?;
            let mask = self.mask.as_ref().and_then(|_| masks.next());
            std::iter::once(MaskedStyle { style, mask }).chain(things).collect()
        } else {
            let look = |entry: &Entry| {
                let style = entry.style(library)?;
                Ok(MaskedStyle { style, mask: entry.mask.as_ref().and_then(|_| masks.next()) })
            };
            let looks: Vec<_> = entries.iter().map(look).collect::<Result<_>>()?;
            of_any(&looks, |look| palette.map_or(Ok(()), |palette| look.style.colour_by(palette)))?;
            looks
        };
        self.timed(looks)
    }

    /// Looks that rules of the style's preset give to things, whose masks are those of the rules.
    ///
    /// # Errors
    /// As [`things::looks`]; [`Error::Input`] beside a mask.
    fn looks_of_things(
        &self,
        library: &Library,
        palette: Option<&Colours>,
        style: &Style,
    ) -> Result<Vec<MaskedStyle>> {
        let looks = things::looks(library, palette, style)?;
        if self.mask.is_some() && !looks.is_empty() {
            let problem = "the preset's rules give things looks of their own, which no mask covers";
            return Err(Error::input("--mask", problem, "leave it out, or list looks by --layered"));
        }
        Ok(looks.into_iter().map(|(number, style)| MaskedStyle { style, mask: Some(number) }).collect())
    }

    /// The looks with what the command line says of time and lengths.
    fn timed(&self, mut looks: Vec<MaskedStyle>) -> Result<Vec<MaskedStyle>> {
        for MaskedStyle { style, .. } in &mut looks {
            self.lengths.apply(style);
            self.precision.precision.apply(style)?;
        }
        of_any(&mut looks, |look| {
            self.steadiness.map_or(Ok(()), |steadiness| look.style.steady(steadiness))
        })?;
        if self.estimates_motion() {
            looks.iter_mut().try_for_each(|look| look.style.estimate_motion())?;
        }
        Ok(looks)
    }
}
