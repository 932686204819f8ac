//! A style on frames that a renderer has drawn, which are read back from its device and stylized on the CPU.

use std::collections::VecDeque;

use crate::directed::{Directed, Followed, Given};
use crate::processor::Processor;
use crate::stylize::frame_request;
use crate::stylize::style::Style;
use isophote_files::error::{Error, Result};
use isophote_loader::catalogue::Kind;
use isophote_loader::{AsImage, Control, Library};
use isophote_pictures::exr::Guide;
use isophote_pictures::floats::Picture;
use isophote_pictures::meaning::ImageState;
use isophote_pictures::mix::Encoding;
use isophote_pictures::pixels::{Pixels, Samples};
use isophote_pictures::space::Space;
use isophote_render::gpu::Gpu;
use isophote_render::readback::Readback;
use isophote_render::targets::{Target, Targets};

/// Meaning of the colours that renderers draw.
const LIGHT: Encoding = Encoding { is_premultiplied: true, space: Space::Linear };

/// A style, and the frames that it reads.
#[derive(Debug)]
pub struct ReadBack {
    library: Library,
    processor: Processor,
    /// Rules for things of the scene, if there are any.
    directed: Option<Directed>,
    /// The last frame that was drawn at the end, and those before that it depends on.
    frames: VecDeque<Drawn>,
    /// Paper and hatching that all frames lie on.
    materials: Vec<(&'static str, Pixels)>,
}

/// A frame in main memory.
#[derive(Debug)]
struct Drawn {
    number: i64,
    size: (u32, u32),
    images: Vec<(&'static str, Pixels)>,
    /// By rule for things, where its look is.
    masks: Vec<Pixels>,
}

impl ReadBack {
    /// A style on frames of one shot, with rules for its things.
    ///
    /// # Errors
    /// As [`Processor::new`].
    pub fn new(library: &Library, style: Style, directed: Option<Directed>) -> Result<Self> {
        let (library, processor) = (library.clone(), Processor::new(library, style)?);
        Ok(Self { library, processor, directed, frames: VecDeque::new(), materials: Vec::new() })
    }

    /// The same on materials of the frames' size.
    #[must_use]
    pub fn with_materials(self, materials: Vec<(&'static str, Pixels)>) -> Self {
        Self { materials, ..self }
    }

    /// Frames before its own that a frame depends on.
    ///
    /// # Errors
    /// As [`Processor::depth`].
    pub fn depth(&self) -> Result<usize> {
        self.processors().try_fold(0, |depth, processor| Ok(processor.depth()?.max(depth)))
    }

    /// The style, and looks that rules give to things.
    fn processors(&self) -> impl Iterator<Item = &Processor> {
        std::iter::once(&self.processor).chain(self.directed.iter().flat_map(Directed::looks))
    }

    /// Rules for things of the scene, which [follow](Self::follow) each frame that is taken.
    pub fn directed(&self) -> Option<&Directed> {
        self.directed.as_ref()
    }

    /// True where the renderer must [add rest positions](isophote_render::renderer::Renderer::add_rest_positions).
    ///
    /// # Errors
    /// As [`Style::can_use`].
    pub fn wants_rest_positions(&self) -> Result<bool> {
        self.processors()
            .try_fold(false, |wants, processor| Ok(wants | processor.style().can_use(Kind::Position)?))
    }

    /// Takes the next frame for the first: those before are of another shot.
    pub fn forget(&mut self) {
        self.frames.clear();
    }

    /// Reads the frame of a number from the device, with its colour in this state, as far as the style can use it.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device fails.
    pub fn take(
        &mut self,
        gpu: &Gpu,
        readback: &mut Readback,
        (targets, state): (&Targets, ImageState),
        number: i64,
    ) -> Result<()> {
        let mut read = |name, target: &Target| {
            let Picture { width, height, channels, data } = readback.read(gpu, &target.texture)?;
            let pixels = Pixels::new(width, height, channels as u32, Samples::F32(data));
            let unequal = || Error::failure("a picture of the renderer has too few pixels", "start again");
            pixels.map(|pixels| (name, pixels)).ok_or_else(unequal)
        };
        let mut images = vec![read("color", targets.color_in(state))?];
        for guide in Guide::ALL {
            // Lines between things follow the nearer one.
            let is_wanted = guide == Guide::Depth && self.directed.is_some()
                || self.processors().any(|processor| processor.guides().contains(&guide));
            if let Some(target) = drawn(guide, targets, state).filter(|_| is_wanted) {
                images.push(read(guide.id(), target)?);
            }
        }
        let size = (targets.width, targets.height);
        self.frames.push_back(Drawn { number, size, images, masks: Vec::new() });
        let most = self.depth()? + 1;
        self.frames.drain(..self.frames.len().saturating_sub(most));
        Ok(())
    }

    /// Lets the rules direct the frame that was taken last, whose things they are for cover so much of it.
    pub fn follow(&mut self, coverage: &[Vec<f32>]) {
        let (Some(directed), Some(own)) = (&self.directed, self.frames.back_mut()) else { return };
        let numbers = |guide: Guide| {
            let image = own.images.iter().find(|(name, _)| *name == guide.id());
            image.map(|(_, pixels)| pixels.to_f32())
        };
        let [control, line_paint, depth] = [Guide::Control, Guide::LinePaint, Guide::Depth].map(numbers);
        let given = Given {
            size: own.size,
            encoding: LIGHT,
            control: control.as_deref(),
            line_paint: line_paint.as_deref(),
            depth: depth.as_deref(),
        };
        let Followed { maps, masks } = directed.follow(coverage, &given);
        own.masks = masks;
        for (guide, map) in maps {
            own.images.retain(|(name, _)| *name != guide.id());
            own.images.push((guide.id(), map));
        }
    }

    /// The frame that was taken last in the style; `progress` is told the share of it that is done.
    ///
    /// # Errors
    /// As [`Processor::process`]; [`Error::Failure`] when no frame was taken.
    pub fn picture(&mut self, progress: &mut dyn FnMut(f32)) -> Result<Picture> {
        let nothing = || Error::failure("no frame was drawn", "start again");
        let own = self.frames.back().ok_or_else(nothing)?;
        let image = |name: &str, number: i64| {
            let frame = self.frames.iter().find(|frame| frame.number == number)?;
            let mut images = frame.images.iter().chain(&self.materials);
            images.find(|(known, _)| *known == name).map(|(_, pixels)| pixels.image())
        };
        let count = 1 + self.directed.iter().flat_map(Directed::looks).count();
        let mut done = 0;
        let library = &self.library;
        let mut process = |processor: &mut Processor| {
            let usual = frame_request(library, processor.style(), own.size)?;
            let request = isophote_loader::abi::IsophoteRequest { frame: own.number, ..usual };
            let mut report = |share: f32| progress((done as f32 + share) / count as f32);
            let mut control = Control { progress: Some(&mut report), ..Control::default() };
            let pixels = processor.process(&request, &image, &mut control)?;
            done += 1;
            Ok(pixels)
        };
        let mut pixels = process(&mut self.processor)?.ok_or_else(nothing)?;
        if let Some(directed) = &mut self.directed {
            pixels = directed.lay_over(pixels, (&own.masks, LIGHT), process)?.ok_or_else(nothing)?;
        }
        let (width, height, channels) = (pixels.width(), pixels.height(), pixels.channels() as usize);
        Ok(Picture { width, height, channels, data: pixels.to_f32() })
    }
}

/// The target that holds a guide beside the colour in this state, if the renderer draws it.
fn drawn(guide: Guide, targets: &Targets, state: ImageState) -> Option<&Target> {
    let [albedo, diffuse, specular] = targets.layers_in(state).map_or([None; 3], |layers| layers.map(Some));
    match guide {
        Guide::Normal => Some(&targets.normal),
        Guide::Depth => Some(&targets.depth),
        Guide::ObjectId => Some(&targets.object_id),
        Guide::Motion => Some(&targets.motion),
        Guide::RestPosition => targets.rest.as_ref(),
        Guide::Control => targets.control.as_ref(),
        Guide::MotionForward | Guide::Flow | Guide::Paper | Guide::Hatching | Guide::LinePaint => None,
        Guide::Albedo => albedo,
        Guide::Diffuse => diffuse,
        Guide::Specular => specular,
    }
}
