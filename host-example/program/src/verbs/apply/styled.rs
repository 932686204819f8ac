//! Looks of a run of `isophote apply`, as its command line and the files that this names say.

use std::path::Path;

use super::ApplyArgs;
use isophote_files::error::{Error, Result};
use isophote_finishing::apply::filter::MaskedStyle;
use isophote_finishing::apply::looks::{self, Entry};
use isophote_finishing::stylize::style::Style;
use isophote_loader::Library;
use isophote_pictures::palette::Palette;

/// What files say of the looks. They are read once, since looks are made several times.
pub(super) struct Written {
    /// The looks of a file; none where there is a style.
    pub entries: Vec<Entry>,
    /// Colours to draw with.
    palette: Option<Palette>,
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
            let own = style.own_looks(library)?;
            if self.mask.is_some() && !own.is_empty() {
                let problem = "the preset's rules give things looks of their own, which no mask covers";
                return Err(Error::input("--mask", problem, "leave it out, or list looks by --layered"));
            }
            let mask = self.mask.as_ref().and_then(|_| masks.next());
            let mut looks = vec![MaskedStyle { style, mask }];
            for (rule, mut style) in own {
                palette.map_or(Ok(()), |palette| style.end_in(palette))?;
                looks.push(MaskedStyle { style, mask: Some(rule) });
            }
            looks
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

/// Does something to all looks that can have it. Of several, one is enough.
///
/// # Errors
/// The first refusal where all refuse.
fn of_any<T>(looks: impl IntoIterator<Item = T>, to: impl FnMut(T) -> Result<()>) -> Result<()> {
    let (mut is_done, mut refused) = (false, None);
    for result in looks.into_iter().map(to) {
        match result {
            Ok(()) => is_done = true,
            Err(refusal) => refused = refused.or(Some(refusal)),
        }
    }
    refused.filter(|_| !is_done).map_or(Ok(()), Err)
}
