//! Stylizing what the renderer has drawn, on the renderer's own device.
//!
//! The library plans, the host executes: the plan's passes are recorded into the host's own command encoder,
//! after the scene's, and read the renderer's textures directly. Once warm, a frame creates no GPU object and
//! is one submission.

pub mod palette;
pub mod precision;
pub mod preset;
pub mod source;
pub mod style;
pub mod suggest;
pub mod things;
pub mod value;

use std::ops::Range;
use std::sync::Arc;

use self::style::{Setting, Style};
use self::value::Value;
use isophote_example::frame_runner::{FrameRunner, Named};
use isophote_example::guides;
use isophote_example::kernels::{Kernels, refused};
use isophote_files::error::{AtPlace, Result};
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::catalogue::Kind;
use isophote_loader::{Library, Plan};
use isophote_pictures::meaning::ImageState;
use isophote_render::targets::Targets;

/// A style for frames of one size, ready to be recorded.
#[derive(Debug)]
pub struct Stylizer {
    style: Style,
    frames: FrameRunner,
    edited: bool,
    /// Paper and hatching beside what the renderer has.
    materials: Vec<(&'static str, wgpu::TextureView)>,
    /// State of the renderer's colours that it reads.
    state: ImageState,
}

impl Stylizer {
    /// Makes `style` ready for display-referred frames as large as `targets`, with all guides that the renderer has there. `kernels` are
    /// those of its device.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] when an input that the style needs is open, [`isophote_files::error::Error::Failure`] when the device refuses.
    pub fn new(kernels: &Arc<Kernels>, library: &Library, style: Style, targets: &Targets) -> Result<Self> {
        let state = ImageState::DisplayReferred;
        Self::on_materials(kernels, library, style, (targets, state), Vec::new())
    }

    /// Makes `style` ready for pictures as `request` says. `kernels` are those of the device that they are on.
    ///
    /// # Errors
    /// As [`Stylizer::new`].
    pub fn with_request(
        kernels: &Arc<Kernels>,
        library: &Library,
        style: Style,
        request: IsophoteRequest,
    ) -> Result<Self> {
        let frames = FrameRunner::new(kernels, library, style.named(), request)?;
        let state = ImageState::DisplayReferred;
        Ok(Self { style, frames, edited: false, materials: Vec::new(), state })
    }

    /// As [`Stylizer::new`], for frames in one of the two states, on materials of their size. Results are in the same state.
    ///
    /// # Errors
    /// As [`Stylizer::new`].
    pub fn on_materials(
        kernels: &Arc<Kernels>,
        library: &Library,
        style: Style,
        (targets, state): (&Targets, ImageState),
        materials: Vec<(&'static str, wgpu::TextureView)>,
    ) -> Result<Self> {
        let usual = frame_request(library, &style, (targets.width, targets.height))?;
        let bits = library.guide_bits(materials.iter().map(|(name, _)| *name)).map_err(refused)?;
        let request = IsophoteRequest { guides: guides::known(targets, state) | bits, ..usual };
        Ok(Self { materials, state, ..Self::with_request(kernels, library, style, request)? })
    }

    /// Frames before its own that a frame depends on.
    pub fn depth(&self) -> usize {
        self.frames.depth()
    }

    /// True where the renderer must [add rest positions](isophote_render::renderer::Renderer::add_rest_positions)
    /// before targets are bound.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the library fails.
    pub fn wants_rest_positions(&self) -> Result<bool> {
        self.style.can_use(Kind::Position)
    }

    /// Takes the next frame for the first: those before are of another shot.
    pub fn forget(&mut self) {
        self.frames.forget();
    }

    /// Kind of the output: a colour (linear Rec.709, premultiplied alpha, `Rgba32Float`) or a scalar
    /// (`R32Float`).
    pub fn kind(&self) -> Kind {
        self.style.kind
    }

    /// Texture that [`Stylizer::encode`] writes. Another one after [`Stylizer::resize`], and after
    /// [`Stylizer::update`] when that says so.
    pub fn output(&self) -> &wgpu::TextureView {
        self.frames.output()
    }

    /// Sets a parameter; it takes effect with the next [`Stylizer::update`].
    ///
    /// # Errors
    /// As [`Style::set`].
    pub fn set(&mut self, setting: &Setting) -> Result<()> {
        self.style.set(setting)?;
        self.edited = true;
        Ok(())
    }

    /// Sets the parameter `id` of a node, which has no keyframes, by a value of its type; it takes effect with the next
    /// [`Stylizer::update`]. `name` is what presets call it.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] when there is no such parameter, or it cannot have this value.
    pub fn set_value(&mut self, name: &str, node: u32, id: &str, value: &Value) -> Result<()> {
        let set = value.put(&self.style.graph, node, id);
        set.map_err(|e| e.at(format!("--set {name}={}", value.text()), "see the graph's nodes"))?;
        self.edited = true;
        Ok(())
    }

    /// Gives animated parameters their values at a frame, and noise that is held its look; both take effect with the next
    /// [`Stylizer::update`].
    ///
    /// # Errors
    /// As [`Style::at_frame`].
    pub fn at_frame(&mut self, frame: i64) -> Result<()> {
        self.edited |= self.style.at_frame(frame)? || self.frames.request().frame != frame;
        self.frames.number(frame);
        Ok(())
    }

    /// Takes over what [`Stylizer::set`] has set and which frames are known now, and says whether the output is another
    /// texture and [`Stylizer::bind`] must be called. Parameters that are not structural cost one small upload.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device refuses; the style must then be made anew.
    pub fn update(&mut self) -> Result<bool> {
        let is_edited = std::mem::take(&mut self.edited);
        self.frames.update(self.style.named(), is_edited)
    }

    /// Changes the size of the frames; [`Stylizer::bind`] must be called then.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for impossible sizes, [`isophote_files::error::Error::Failure`] when the device refuses; the style must then be
    /// made anew.
    pub fn resize(&mut self, size: (u32, u32)) -> Result<()> {
        self.resize_at_scale(size, self.frames.request().scale)
    }

    /// As [`Stylizer::resize`], where `scale` is the size over that of the full picture.
    ///
    /// # Errors
    /// As [`Stylizer::resize`].
    pub fn resize_at_scale(&mut self, size: (u32, u32), scale: f32) -> Result<()> {
        if self.frames.resize(self.style.named(), size, scale)? {
            self.edited = false;
        }
        Ok(())
    }

    /// Compiles what later frames need too, where they look at those before, so that none of them waits for it. `kernels` and
    /// `library` are those that it was made with.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device refuses.
    pub fn compile_all(&self, kernels: &Kernels, library: &Library) -> Result<()> {
        for known in 1..=self.depth() {
            let plan = self.style.named().plan(library, self.frames.request(), known)?;
            let textures = plan.textures().map_err(refused)?;
            for (index, pass) in (0..).zip(plan.passes().map_err(refused)?) {
                kernels.get(&plan, index, &pass, &textures)?;
            }
        }
        Ok(())
    }

    /// Reads these targets from now on, which must have the size given to [`Stylizer::new`]. The same ones again cost nothing.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when they are too small or the device refuses.
    pub fn bind(&mut self, targets: &Targets) -> Result<()> {
        let mut inputs = guides::inputs(targets, self.state);
        inputs.extend(self.materials.iter().map(|(name, view)| (*name, view)));
        self.frames.bind(&inputs)
    }

    /// Reads pictures of these names, as large as was asked for or larger.
    ///
    /// # Errors
    /// As [`Stylizer::bind`].
    pub fn bind_inputs(&mut self, inputs: &[(&str, &wgpu::TextureView)]) -> Result<()> {
        self.frames.bind(inputs)
    }

    /// Records passes of the style on a frame, [all](isophote_example::plan_runner::ALL) or some; says whether the last is
    /// among them, and the next call is of the next frame then. Nothing is created and nothing submitted.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when nothing is bound.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, passes: Range<usize>) -> Result<bool> {
        self.frames.encode(encoder, passes)
    }

    /// The passes with their textures.
    pub fn plan(&self) -> &Plan {
        self.frames.plan()
    }
}

impl Style {
    /// Graph with its name, to be planned.
    pub fn named(&self) -> Named<'_> {
        Named { name: &self.name, graph: &self.graph }
    }
}

/// Request of the renderer's frames: linear light, premultiplied, with the guides of every scene.
///
/// # Errors
/// [`isophote_files::error::Error::Input`] for impossible sizes.
pub fn frame_request(library: &Library, style: &Style, size: (u32, u32)) -> Result<IsophoteRequest> {
    guides::request(library, size, style.lengths.reference_height())
        .map_err(|e| e.at("--size", "choose another size"))
}
