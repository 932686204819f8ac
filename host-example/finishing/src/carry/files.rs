//! Files of the maps of all frames.

use std::path::PathBuf;

use super::{Carried, Key, Taker};
use isophote_files::error::Result;
use isophote_files::files::Existing;
use isophote_files::frames::Pattern;
use isophote_pictures::meaning::Meaning;
use isophote_pictures::pixels::{Pixels, Precision};
use isophote_pictures::read::Source;
use isophote_pictures::write::{self, Format, Options};

/// Writer of the maps of all frames, which tells of each.
pub struct MapFiles<'s> {
    out: &'s Pattern,
    existing: Existing,
    precision: Precision,
    told: &'s mut dyn FnMut(Carried),
}

impl<'s> MapFiles<'s> {
    /// Files as precise as the finest maps of `keys`, where their format has that; `existing` is what becomes of those that are there.
    pub fn new(out: &'s Pattern, existing: Existing, keys: &[Key], told: &'s mut dyn FnMut(Carried)) -> Self {
        let mut precisions = keys.iter().map(|key| key.map.precision());
        let precision = precisions.find(|precision| *precision != Precision::U8).unwrap_or(Precision::U8);
        Self { out, existing, precision, told }
    }
}

impl Taker for MapFiles<'_> {
    fn take(&mut self, carried: Carried, map: Pixels) -> Result<()> {
        let path: PathBuf = self.out.file(carried.frame);
        let format = Format::of(&path)?;
        let precision = if format == Format::Exr { Precision::F32 } else { self.precision };
        let pixels = map.converted(precision);
        let meaning = Meaning::display();
        let source = Source::alone(pixels.clone(), meaning.clone());
        let format = (format, Options::default());
        write::write(&path, self.existing, format, vec![pixels], &meaning, &source, None)?;
        (self.told)(carried);
        Ok(())
    }
}
