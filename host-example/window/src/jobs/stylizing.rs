//! Looks on pictures in main memory, computed by the library on the CPU: the faster way where the graphics driver computes
//! there itself.

use std::collections::VecDeque;
use std::sync::Arc;

use super::ruled::{Ruled, Rules};
use crate::state::document::frame::Frame;
use crate::state::document::reduce;
use crate::state::look::EditedLook;
use crate::state::things::Things;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::limits;
use isophote_finishing::apply::memory::{self, Bytes};
use isophote_finishing::directed::Directed;
use isophote_finishing::processor::Processor;
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::{Control, Image, Library, Sample};
use isophote_pictures::exr::Guide;
use isophote_pictures::pixels::Pixels;

/// A look to be computed.
#[derive(Clone, Debug)]
pub struct Task {
    /// The look, which is not the plain one.
    pub look: EditedLook,
    /// The picture.
    pub frame: Arc<Frame>,
    /// Things in it, where rules of looks may be for them.
    pub things: Option<Things>,
    /// Its size over that of the file's.
    pub share: f32,
    /// Size of the result, at most that of the picture.
    pub size: (u32, u32),
    /// Number of what is open: frames of something else are no neighbours.
    pub shot: u64,
}

/// Computes looks, one after the other.
pub struct Stylist {
    library: Library,
    /// The look that was computed last.
    known: Option<Known>,
    rules: Rules,
    /// The picture that was made smaller last, and what came of it.
    reduced: Option<(Arc<Frame>, Arc<Frame>)>,
    /// Frames before the next one, in order, where looks read them.
    past: VecDeque<Arc<Frame>>,
    room: Room,
}

/// Images of inputs, by their names and the numbers of frames.
type Images<'a, 'i> = &'a (dyn Fn(&str, i64) -> Option<Image<'i>> + 'a);

/// A look that can be computed.
#[derive(Debug)]
struct Known {
    look: EditedLook,
    /// Number of what is open.
    shot: u64,
    processor: Processor,
    /// Its rules for things there.
    directed: Option<Directed>,
}

/// Memory that there is.
#[derive(Debug, Default)]
struct Room {
    /// Number of what was open when it was said that there is too little.
    told: Option<u64>,
}

impl Stylist {
    /// One that knows nothing yet.
    pub fn new(library: Library) -> Self {
        let rules = Rules::new(library.clone());
        Self { library, known: None, rules, reduced: None, past: VecDeque::new(), room: Room::default() }
    }

    /// Sentences about rules of looks that are for nothing in what is open, each once.
    pub fn take_news(&mut self) -> Vec<String> {
        self.rules.take_news()
    }

    /// The picture in its look; nothing where it was cancelled, or where memory is too short for so large a picture.
    ///
    /// # Errors
    /// Errors of the library about the look; [`Error::Failure`] when memory is short, the first time for what is open.
    pub fn stylize(&mut self, task: &Task, control: &mut Control<'_>) -> Result<Option<Pixels>> {
        let Task { look, share, size, .. } = task;
        self.know(task)?;
        let Some(Known { processor, directed, .. }) = &self.known else { return Ok(None) };
        let ruled = match (directed, &task.things) {
            (Some(directed), Some(things)) => {
                self.rules.follow(directed, (look, processor.style()), (&task.frame, things))?
            }
            _ => None,
        };
        let whole = ruled.as_ref().map_or(&task.frame, |ruled| &ruled.frame);
        let frame = self.as_small(whole, *size);
        self.keep_past_of(&frame);
        let past: Vec<Arc<Frame>> = self.past.iter().map(|frame| reduced(frame, *size)).collect();
        let Some(known) = &mut self.known else { return Ok(None) };
        let usual = self.library.request(*size);
        let usual = usual.map_err(|e| e.at(&look.name, "choose another picture"))?;
        let scale = share * size.0 as f32 / task.frame.width as f32;
        let request = frame.request(IsophoteRequest { scale, ..usual });
        if !self.room.has(known.memory(&request)?, task)? {
            return Ok(None);
        }
        let own = request.frame;
        let image = |name: &str, number: i64| {
            let of = past.iter().find(|before| before.number == Some(number));
            let of = if number == own { Some(&frame) } else { of };
            of.and_then(|frame| image(frame, name))
        };
        let result = known.made((&request, &image), ruled.as_ref(), control)?;
        let depth = known.depth()?;
        if result.is_some() && depth > 0 {
            self.past.push_back(Arc::clone(whole));
            self.past.drain(..self.past.len().saturating_sub(depth));
        }
        Ok(result)
    }

    /// Makes ready for the look of a task; nothing is known where it is a plain one.
    fn know(&mut self, task: &Task) -> Result<()> {
        let Task { look, things, shot, .. } = task;
        if self.known.as_ref().is_some_and(|known| (&known.look, known.shot) == (look, *shot)) {
            return Ok(());
        }
        // Frames before are kept as rules direct them.
        let goes_on = self
            .known
            .take()
            .is_some_and(|known| known.shot == *shot && known.look.preset.objects == look.preset.objects);
        if !goes_on {
            self.past.clear();
        }
        let Some(style) = look.style(&self.library)? else { return Ok(()) };
        let directed = self.rules.directed(look, &style, things.as_ref())?;
        if directed.is_none() {
            self.rules.rest();
        }
        let processor = Processor::new(&self.library, style)?;
        self.known = Some(Known { look: look.clone(), shot: *shot, processor, directed });
        Ok(())
    }

    /// The picture as small as a result.
    fn as_small(&mut self, frame: &Arc<Frame>, size: (u32, u32)) -> Arc<Frame> {
        if (frame.width, frame.height) == size {
            return Arc::clone(frame);
        }
        let is_known = |(of, small): &&(Arc<Frame>, Arc<Frame>)| {
            Arc::ptr_eq(of, frame) && (small.width, small.height) == size
        };
        if let Some((_, small)) = self.reduced.as_ref().filter(is_known) {
            return Arc::clone(small);
        }
        let small = reduced(frame, size);
        self.reduced = Some((Arc::clone(frame), Arc::clone(&small)));
        small
    }

    /// Forgets frames that are none before this one.
    fn keep_past_of(&mut self, frame: &Frame) {
        // The same frame may come once more, at another size.
        self.past.retain(|before| before.number < frame.number);
        let last = self.past.back().and_then(|last| last.number);
        if last.map(|last| last + 1) != frame.number {
            self.past.clear();
        }
    }
}

impl Known {
    /// The look, and those that its rules give to things.
    fn processors(&self) -> impl Iterator<Item = &Processor> {
        std::iter::once(&self.processor).chain(self.directed.iter().flat_map(Directed::looks))
    }

    /// Bytes that a frame takes at most, one look after the other.
    fn memory(&self, request: &IsophoteRequest) -> Result<u64> {
        self.processors().try_fold(0, |most, processor| Ok(processor.memory(request)?.max(most)))
    }

    /// Frames before its own that a frame depends on.
    fn depth(&self) -> Result<usize> {
        self.processors().try_fold(0, |most, processor| Ok(processor.depth()?.max(most)))
    }

    /// A frame in the look, with those of things over it; nothing where it was cancelled.
    fn made<'i>(
        &mut self,
        (request, image): (&IsophoteRequest, Images<'_, 'i>),
        ruled: Option<&Ruled>,
        control: &mut Control<'_>,
    ) -> Result<Option<Pixels>> {
        let Some((directed, ruled)) = self.directed.as_mut().zip(ruled) else {
            return self.processor.process(request, image, control);
        };
        let count = 1 + directed.looks().count();
        let mut done = 0;
        let Control { threads, cancelled, progress, .. } = control;
        let (threads, cancelled) = (*threads, *cancelled);
        let mut process = |processor: &mut Processor| {
            let mut report = |share: f32| {
                progress.iter_mut().for_each(|told| told((done as f32 + share) / count as f32));
            };
            let mut own = Control { threads, cancelled, progress: Some(&mut report), ..Control::default() };
            let made = processor.process(request, image, &mut own)?;
            done += 1;
            Ok(made)
        };
        let Some(below) = process(&mut self.processor)? else { return Ok(None) };
        let size = (request.width, request.height);
        let (masks, encoding) = ruled.places(size, reduce::whole(size));
        directed.lay_over(below, (&masks, encoding), process)
    }
}

impl Room {
    /// True where there is memory for this.
    fn has(&mut self, bytes: u64, task: &Task) -> Result<bool> {
        let most = memory::half();
        if bytes <= most.0 {
            limits::must_have(bytes, &task.look.name)?;
            return Ok(true);
        }
        if self.told.replace(task.shot) == Some(task.shot) {
            return Ok(false);
        }
        let (bytes, name) = (Bytes(bytes), &task.look.name);
        let problem = format!("{name} takes about {bytes} for all of the picture, which is shown smaller");
        Err(Error::failure(problem, "scale it down"))
    }
}

/// A frame as small as a result.
fn reduced(frame: &Arc<Frame>, size: (u32, u32)) -> Arc<Frame> {
    match (frame.width, frame.height) == size {
        true => Arc::clone(frame),
        false => Arc::new(reduce::reduced(frame, size, reduce::whole(size))),
    }
}

/// An input of a frame.
fn image<'f>(frame: &'f Frame, name: &str) -> Option<Image<'f>> {
    let size = (frame.width, frame.height);
    let (channels, numbers) = match name {
        "color" => (4, frame.color.as_flattened()),
        "mask" => (1, frame.mask.as_ref()?.as_slice()),
        _ => {
            let guide = Guide::ALL.into_iter().find(|guide| guide.id() == name)?;
            frame.guide(guide).map(|image| (image.channels, image.data.as_slice()))?
        }
    };
    Image::new(bytemuck::cast_slice(numbers), size, channels, Sample::F32)
}
