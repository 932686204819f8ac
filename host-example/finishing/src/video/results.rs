//! Results of a video's frames: another video, or numbered pictures.

use std::path::Path;

use super::encode::Encoder;
use crate::apply::filter::Filtered;
use isophote_files::error::{Error, Result};
use isophote_files::frames::{FrameList, Pattern};
use isophote_files::replacing::{Consent, Made};
use isophote_pictures::pixels::Precision;
use isophote_pictures::read::{self, Source};
use isophote_pictures::resize::resized;
use isophote_pictures::write::{self, Format};

/// Pictures that the frames of a video become, numbered from 1.
#[derive(Clone, Copy, Debug)]
pub struct Numbered<'a> {
    /// Their names.
    pub pattern: &'a Pattern,
    /// Kind of their files.
    pub format: Format,
    /// Options of their files.
    pub options: write::Options,
    /// Numbers of those that are made; all where there is none.
    pub frames: Option<&'a FrameList>,
    /// Consent to replace files.
    pub consent: Consent,
}

/// Part of a frame in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// It is filtered.
    Made,
    /// Its result is there already.
    There,
    /// Nobody asked for it.
    Passed,
    /// Nobody asked for it or for any after it.
    Over,
}

/// Place where results go.
pub enum Results<'a> {
    /// A video of frames of a size, whose encoder is started for so many channels.
    Video(&'a dyn Fn(u32) -> Result<Encoder>, (u32, u32), Option<Encoder>),
    /// Numbered pictures, which are made from this file.
    Pictures(Numbered<'a>, &'a Path),
}

impl Numbered<'_> {
    /// Number of the last that is asked for; nothing where all are.
    pub fn last(&self) -> Option<i64> {
        self.frames.and_then(|list| list.frames().iter().max().copied())
    }

    fn turn(&self, number: i64) -> Turn {
        let is_there = || self.consent.skip_existing && read::is_whole(&self.pattern.file(number));
        match self.frames.map(FrameList::frames) {
            Some(_) if self.last().is_some_and(|last| number > last) => Turn::Over,
            Some(frames) if !frames.contains(&number) => Turn::Passed,
            _ if is_there() => Turn::There,
            _ => Turn::Made,
        }
    }
}

impl Results<'_> {
    /// Kind of picture that the filter makes.
    pub fn format(&self) -> Format {
        match self {
            Self::Video(..) => Format::Png,
            Self::Pictures(numbered, _) => numbered.format,
        }
    }

    /// Part of the frame of this number.
    pub fn turn(&self, number: i64) -> Turn {
        match self {
            Self::Video(..) => Turn::Made,
            Self::Pictures(numbered, _) => numbered.turn(number),
        }
    }

    /// Takes the result of a frame, and says whether more are taken; [`Results::end`] says why not.
    ///
    /// # Errors
    /// As [`write::write()`], and those of starting an encoder.
    pub fn put(&mut self, number: i64, filtered: Filtered, source: &Source) -> Result<bool> {
        match self {
            Self::Video(start, size, encoder) => {
                let none = || {
                    Error::failure("filtering stopped", "this is a mistake in the program; please report it")
                };
                let result = filtered.results.into_iter().next().ok_or_else(none)?.converted(Precision::U16);
                let is_sized = (result.width(), result.height()) == *size;
                let result = if is_sized { result } else { resized(&result, *size, false) };
                let encoder = match encoder {
                    Some(encoder) => encoder,
                    None => encoder.insert(start(result.channels())?),
                };
                Ok(encoder.put(&result))
            }
            Self::Pictures(Numbered { pattern, format, options, consent, .. }, input) => {
                let path = pattern.file(number);
                let made = Made { from: Some(input), to: &path };
                let Filtered { results, meaning, .. } = filtered;
                let write = |existing| {
                    write::write(&path, existing, (*format, *options), results, &meaning, source, None)
                };
                consent.write(made, read::is_whole, write).map(|_| true)
            }
        }
    }

    /// True where every frame was taken.
    pub fn is_open(&self) -> bool {
        match self {
            Self::Video(_, _, encoder) => encoder.as_ref().is_none_or(Encoder::is_open),
            Self::Pictures(..) => true,
        }
    }

    /// Ends what was made of so many frames.
    ///
    /// # Errors
    /// As [`Encoder::end`]; [`Error::Input`] where the input, of this name, has fewer frames than were asked for.
    pub fn end(self, count: i64, input: &Path) -> Result<()> {
        match self {
            _ if count == 0 => Err(Error::file(input, "has no frames that can be decoded", "name a video")),
            Self::Video(_, _, encoder) => encoder.map_or(Ok(()), Encoder::end),
            Self::Pictures(numbered, _) => match numbered.last() {
                Some(last) if last > count => {
                    let problem = format!("ends with frame {count} and has no frame {last}");
                    Err(Error::file(input, problem, "give other --frames"))
                }
                _ => Ok(()),
            },
        }
    }
}
