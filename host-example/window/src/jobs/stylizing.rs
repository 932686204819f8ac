//! Looks on pictures in main memory, computed by the library on the CPU: the faster way where the graphics driver computes
//! there itself.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::state::document::frame::Frame;
use crate::state::document::reduce;
use crate::state::look::EditedLook;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::limits;
use isophote_finishing::apply::memory::{self, Bytes};
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
    /// The look that was computed last, and of what is open by which number.
    known: Option<(EditedLook, u64, Processor)>,
    /// The picture that was made smaller last, and what came of it.
    reduced: Option<(Arc<Frame>, Arc<Frame>)>,
    /// Frames before the next one, in order, where looks read them.
    past: VecDeque<Arc<Frame>>,
    room: Room,
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
        Self { library, known: None, reduced: None, past: VecDeque::new(), room: Room::default() }
    }

    /// The picture in its look; nothing where it was cancelled, or where memory is too short for so large a picture.
    ///
    /// # Errors
    /// Errors of the library about the look; [`Error::Failure`] when memory is short, the first time for what is open.
    pub fn stylize(&mut self, task: &Task, control: &mut Control<'_>) -> Result<Option<Pixels>> {
        let Task { look, share, size, shot, .. } = task;
        if self.known.as_ref().is_none_or(|(known, of, _)| (known, of) != (look, shot)) {
            let Some(style) = look.style(&self.library)? else { return Ok(None) };
            let is_of_shot = self.known.as_ref().is_some_and(|(_, of, _)| of == shot);
            if !is_of_shot {
                self.past.clear();
            }
            self.known = Some((look.clone(), *shot, Processor::new(&self.library, style)?));
        }
        let frame = self.as_small(&task.frame, *size);
        self.keep_past_of(&frame);
        let past: Vec<Arc<Frame>> = self.past.iter().map(|frame| reduced(frame, *size)).collect();
        let Some((_, _, processor)) = &mut self.known else { return Ok(None) };
        let usual = self.library.request(*size);
        let usual = usual.map_err(|e| e.at(&look.name, "choose another picture"))?;
        let scale = share * size.0 as f32 / task.frame.width as f32;
        let request = frame.request(IsophoteRequest { scale, ..usual });
        if !self.room.has(processor.memory(&request)?, task)? {
            return Ok(None);
        }
        let own = request.frame;
        let image = |name: &str, number: i64| {
            let of = past.iter().find(|before| before.number == Some(number));
            let of = if number == own { Some(&frame) } else { of };
            of.and_then(|frame| image(frame, name))
        };
        let result = processor.process(&request, &image, control)?;
        let depth = processor.depth()?;
        if result.is_some() && depth > 0 {
            self.past.push_back(Arc::clone(&task.frame));
            self.past.drain(..self.past.len().saturating_sub(depth));
        }
        Ok(result)
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
