//! Vectors between the frames of a shot: of its files, of others, or estimated from its pictures.

use crate::apply::picture_request::PictureRequest;
use crate::processor::Processor;
use crate::stylize::style::Style;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::frames::Pattern;
use isophote_loader::{AsImage, Control, Library};
use isophote_pictures::exr::{self, Guide, Selection};
use isophote_pictures::pixels::Pixels;
use isophote_pictures::read::{self, Source, Unread};
use isophote_pictures::working::WorkingSpace;

/// Node that estimates them.
const NODE: &str = "optical_flow";

/// Source of the vectors of a shot.
pub struct Vectors {
    shot: Pattern,
    /// Files of vectors alone.
    files: Option<Pattern>,
    selection: Selection,
    estimate: Option<Estimate>,
    /// Frames that were read last.
    read: Vec<(i64, Source)>,
}

/// Optical flow of the pictures, for each way.
struct Estimate {
    library: Library,
    ways: [(Guide, Processor); 2],
}

impl Vectors {
    /// Those of the frames' own files, in a convention that `selection` may have, or of others.
    pub fn of_files(shot: Pattern, files: Option<Pattern>, selection: Selection) -> Self {
        let wanted = vec![Guide::Motion, Guide::MotionForward, Guide::ObjectId];
        Self { shot, files, selection: Selection { wanted, ..selection }, estimate: None, read: Vec::new() }
    }

    /// Those that are estimated from the pictures.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn estimated(shot: Pattern, library: &Library) -> Result<Self> {
        let way = || Processor::new(library, Style::any(library, NODE, &[])?);
        let ways = [(Guide::Motion, way()?), (Guide::MotionForward, way()?)];
        let estimate = Some(Estimate { library: library.clone(), ways });
        Ok(Self { shot, files: None, selection: Selection::default(), estimate, read: Vec::new() })
    }

    /// Pixels across and down of a frame.
    ///
    /// # Errors
    /// As reading it.
    pub fn size(&mut self, frame: i64) -> Result<(u32, u32)> {
        let source = self.frame(frame)?;
        let picture = source.pictures.first();
        Ok(picture.map_or((0, 0), |picture| (picture.pixels.width(), picture.pixels.height())))
    }

    /// Vectors of a frame to one of its neighbours, `there`; nothing where there are none.
    ///
    /// # Errors
    /// As reading the frames, and [`Error::Failure`] when the library fails.
    pub fn between(&mut self, frame: i64, there: i64) -> Result<Option<Vec<f32>>> {
        let way = if there < frame { Guide::Motion } else { Guide::MotionForward };
        if self.estimate.is_some() {
            return self.estimated_between(frame, there, way).map(Some);
        }
        self.guide(frame, way)
    }

    /// Numbers of the things in a frame, where its file has them.
    ///
    /// # Errors
    /// As reading it.
    pub fn things(&mut self, frame: i64) -> Result<Option<Vec<f32>>> {
        self.guide(frame, Guide::ObjectId)
    }

    fn guide(&mut self, frame: i64, guide: Guide) -> Result<Option<Vec<f32>>> {
        let source = self.frame(frame)?;
        let guides = source.pictures.first().map_or(&[][..], |picture| &picture.guides[..]);
        Ok(guides.iter().find(|(known, _)| *known == guide.id()).map(|(_, pixels)| pixels.to_f32()))
    }

    fn estimated_between(&mut self, frame: i64, there: i64, way: Guide) -> Result<Vec<f32>> {
        for number in [frame, there] {
            self.frame(number)?;
        }
        let Self { read, estimate: Some(Estimate { library, ways }), .. } = self else {
            return Ok(Vec::new());
        };
        let picture = |number: i64| {
            let (_, source) = read.iter().find(|(known, _)| *known == number)?;
            source.pictures.first()
        };
        let name = || format!("frame {frame}");
        let none = || Error::failure(format!("{} has no picture", name()), "leave it out");
        let own = picture(frame).ok_or_else(none)?;
        let working = WorkingSpace::of(None, own);
        let changed = [frame, there].map(|number| {
            let pixels = &picture(number)?.pixels;
            Some(working.there.as_ref().map_or_else(|| pixels.clone(), |there| there.apply(pixels).0))
        });
        // To the library time runs from there to here, whichever comes first.
        let numbers = if way == Guide::Motion { [frame, there] } else { [-frame, -there] };
        let size = (own.pixels.width(), own.pixels.height());
        let usual = library.request(size).map_err(|e| e.at(name(), "use a smaller picture"))?;
        let request = PictureRequest::of(own, working.space, Some(numbers[0])).request(usual);
        let image = |name: &str, number: i64| {
            let at = numbers.iter().position(|known| *known == number).filter(|_| name == "color")?;
            changed[at].as_ref().map(AsImage::image)
        };
        let Some((_, processor)) = ways.iter_mut().find(|(of, _)| *of == way) else { return Ok(Vec::new()) };
        let made = processor.process(&request, &image, &mut Control::default())?;
        // What is no picture comes with more numbers than it has.
        let numbers = made.as_ref().map(Pixels::to_f32).unwrap_or_default();
        Ok(numbers.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1]]).collect())
    }

    /// A frame as it was read, with its vectors.
    fn frame(&mut self, number: i64) -> Result<&Source> {
        if let Some(at) = self.read.iter().position(|(known, _)| *known == number) {
            return Ok(&self.read[at].1);
        }
        let path = self.shot.file(number);
        let mut source = read::read(&path, &self.selection)?;
        source.exr = None;
        source.pictures.truncate(1);
        if let (Some(files), Some(picture)) = (&self.files, source.pictures.first_mut()) {
            let path = files.file(number);
            // Before the first frame there often is none.
            if path.is_file() {
                let bytes = Unread::open(&path)?.bytes(&path)?;
                let found = exr::motion_of(&path, bytes, &self.selection, picture)?;
                picture.guides.retain(|(name, _)| *name == Guide::ObjectId.id());
                picture.guides.extend(found);
            }
        }
        // A frame and its neighbour are wanted together.
        self.read.drain(..self.read.len().saturating_sub(1));
        self.read.push((number, source));
        Ok(&self.read[self.read.len() - 1].1)
    }
}
