//! Stylizing what the renderer has drawn, on the renderer's own device.
//!
//! The library plans, the host executes: the plan's passes are recorded into the host's own command encoder,
//! after the scene's, and read the renderer's textures directly. Once warm, a frame creates no GPU object and
//! is one submission.

pub mod lengths;
pub mod looks;
pub mod precision;
pub mod preset;
pub mod source;
pub mod style;
pub mod title;

use std::sync::Arc;

use self::style::{Setting, Style};
use isophote_example::history::Past;
use isophote_example::kernels::Kernels;
use isophote_example::plan_runner::{Counts, PlanRunner};
use isophote_files::error::{AtPlace, Result};
use isophote_loader::abi::{
    ISOPHOTE_GUIDE_DEPTH, ISOPHOTE_GUIDE_MOTION, ISOPHOTE_GUIDE_NORMAL, ISOPHOTE_GUIDE_OBJECT_ID,
    ISOPHOTE_GUIDE_REST_POSITION, ISOPHOTE_SPACE_LINEAR, IsophoteHistory, IsophoteRequest,
};
use isophote_loader::catalogue::Kind;
use isophote_loader::plan::{Change, Role};
use isophote_loader::{Library, Plan};
use isophote_render::targets::{Target, Targets};

/// A style for frames of one size, ready to be recorded.
#[derive(Debug)]
pub struct Stylizer {
    library: Library,
    style: Style,
    request: IsophoteRequest,
    plan: Plan,
    /// What plans read of frames before, once enough are known.
    past: Past,
    /// Frames before the next one that were recorded, at most those that the style depends on.
    known: usize,
    /// How many of them the plan reads.
    planned: usize,
    runner: PlanRunner,
    output: wgpu::TextureView,
    edited: bool,
}

impl Stylizer {
    /// Makes `style` ready for frames of `size`, with all guides that the renderer has. `kernels` are
    /// those of the renderer's device.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] when an input that the style needs is open, [`isophote_files::error::Error::Failure`] when the device refuses.
    pub fn new(kernels: &Arc<Kernels>, library: &Library, style: Style, size: (u32, u32)) -> Result<Self> {
        let request = frame_request(library, &style, size)?;
        Self::with_request(kernels, library, style, request)
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
        let past = style.past(library, &request)?;
        let plan = style.plan(library, &request, 0)?;
        let runner = PlanRunner::new(kernels, &plan, past.clone())?;
        let output = runner.output()?.clone();
        let library = library.clone();
        Ok(Self { library, style, request, plan, past, known: 0, planned: 0, runner, output, edited: false })
    }

    /// Frames before its own that a frame depends on.
    pub fn depth(&self) -> usize {
        self.past.frames
    }

    /// Whether the renderer must [add rest positions](isophote_render::renderer::Renderer::add_rest_positions) before targets are bound.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the library fails.
    pub fn wants_rest_positions(&self) -> Result<bool> {
        self.style.can_use(Kind::Position)
    }

    /// Takes the next frame for the first: those before are of another shot.
    pub fn forget(&mut self) {
        self.known = 0;
    }

    /// Whether the output is a colour (linear Rec.709, premultiplied alpha, `Rgba32Float`) or a scalar
    /// (`R32Float`).
    pub fn kind(&self) -> Kind {
        self.style.kind
    }

    /// What [`Stylizer::encode`] writes. Another one after [`Stylizer::resize`], and after
    /// [`Stylizer::update`] when that says so.
    pub fn output(&self) -> &wgpu::TextureView {
        &self.output
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

    /// Gives animated parameters their values at a frame, and noise that is held its look; both take effect with the next
    /// [`Stylizer::update`].
    ///
    /// # Errors
    /// As [`Style::at_frame`].
    pub fn at_frame(&mut self, frame: i64) -> Result<()> {
        self.edited |= self.style.at_frame(frame)? || self.request.frame != frame;
        self.request.frame = frame;
        Ok(())
    }

    /// Takes over what [`Stylizer::set`] has set and which frames are known now, and says whether the output is another
    /// texture and [`Stylizer::bind`] must be called. Parameters that are not structural cost one small upload.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device refuses; the style must then be made anew.
    pub fn update(&mut self) -> Result<bool> {
        let is_edited = std::mem::take(&mut self.edited);
        if is_edited {
            let past = self.style.past(&self.library, &self.request)?;
            if past != self.past {
                (self.past, self.known) = (past, 0);
                self.replan(0)?;
                return Ok(true);
            }
        }
        if self.known != self.planned {
            self.replan(self.known)?;
            return Ok(true);
        }
        if !is_edited {
            return Ok(false);
        }
        let refused = |e: isophote_loader::Error| e.at(&self.style.name, "choose another value");
        if self.plan.update(&self.style.graph, &self.request).map_err(refused)? == Change::Uniforms {
            self.runner.repack(&self.plan)?;
            return Ok(false);
        }
        self.rebuild()?;
        Ok(true)
    }

    /// Plans for so many known frames before.
    fn replan(&mut self, known: usize) -> Result<()> {
        self.plan = self.style.plan(&self.library, &self.request, known)?;
        self.planned = known;
        self.rebuild()
    }

    /// Changes the size of the frames; [`Stylizer::bind`] must be called then.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for impossible sizes, [`isophote_files::error::Error::Failure`] when the device refuses; the style must then be
    /// made anew.
    pub fn resize(&mut self, size: (u32, u32)) -> Result<()> {
        self.resize_at_scale(size, self.request.scale)
    }

    /// As [`Stylizer::resize`], where `scale` is the size over that of the full picture.
    ///
    /// # Errors
    /// As [`Stylizer::resize`].
    pub fn resize_at_scale(&mut self, size: (u32, u32), scale: f32) -> Result<()> {
        let request = IsophoteRequest { width: size.0, height: size.1, scale, ..self.request };
        if request == self.request {
            return Ok(());
        }
        self.past = self.style.past(&self.library, &request)?;
        self.request = request;
        self.edited = false;
        self.forget();
        self.replan(0)
    }

    /// Compiles what later frames need too, where they look at those before, so that none of them waits for it.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device refuses.
    pub fn compile_all(&self) -> Result<()> {
        (1..=self.past.frames).try_for_each(|known| {
            self.runner.kernels().compile(&self.style.plan(&self.library, &self.request, known)?)
        })
    }

    fn rebuild(&mut self) -> Result<()> {
        self.runner.rebuild(&self.plan, self.past.clone())?;
        self.output = self.runner.output()?.clone();
        Ok(())
    }

    /// Reads these targets from now on, with the colour that is display-referred, which must have the size given
    /// to [`Stylizer::new`]. The same ones again cost nothing.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when they are too small or the device refuses.
    pub fn bind(&mut self, targets: &Targets) -> Result<()> {
        self.bind_with(&targets.color, targets)
    }

    /// As [`Stylizer::bind`], with the colour that is scene-referred; so is the result then.
    ///
    /// # Errors
    /// As [`Stylizer::bind`].
    pub fn bind_scene_referred(&mut self, targets: &Targets) -> Result<()> {
        self.bind_with(&targets.radiance, targets)
    }

    /// Reads pictures of these names, as large as was asked for or larger.
    ///
    /// # Errors
    /// As [`Stylizer::bind`].
    pub fn bind_inputs(&mut self, inputs: &[(&str, &wgpu::TextureView)]) -> Result<()> {
        self.runner.bind(inputs)
    }

    fn bind_with(&mut self, color: &Target, targets: &Targets) -> Result<()> {
        // Where nobody wants rest positions no plan reads them, and anything may stand for them.
        let rest = targets.rest.as_ref().unwrap_or(&targets.normal);
        let inputs = [
            ("color", &color.view),
            ("normal", &targets.normal.view),
            ("depth", &targets.depth.view),
            ("object_id", &targets.object_id.view),
            ("motion", &targets.motion.view),
            ("rest_position", &rest.view),
        ];
        self.runner.bind(&inputs)
    }

    /// Records the whole style on a frame; the next call is of the next one. Nothing is created and nothing submitted.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when nothing is bound.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        self.runner.encode(encoder)?;
        self.known = (self.planned + 1).min(self.past.frames);
        Ok(())
    }

    /// As [`Stylizer::encode`], so many passes from one on; says whether the last was among them.
    ///
    /// # Errors
    /// As [`Stylizer::encode`].
    pub fn encode_some(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        from: usize,
        count: usize,
    ) -> Result<bool> {
        let is_whole = self.runner.encode_some(encoder, from, count)?;
        if is_whole {
            self.known = (self.planned + 1).min(self.past.frames);
        }
        Ok(is_whole)
    }

    /// The passes with their textures.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// What was made on the device for this style so far.
    pub fn counts(&self) -> Counts {
        self.runner.counts()
    }
}

impl Style {
    /// The plan of a frame where so many frames before it are known.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] when an input that the style needs is open.
    pub fn plan(&self, library: &Library, request: &IsophoteRequest, known: usize) -> Result<Plan> {
        let history = IsophoteHistory { past: known as u32, max_motion: 0.0 };
        let plan = match library.frames(&self.graph) {
            Ok([0, 0]) => self.graph.plan(request),
            Ok(_) => library.plan_in_order(&self.graph, request, &history),
            Err(refusal) => Err(refusal),
        };
        plan.map_err(|e| {
            e.at(
                &self.name,
                "choose a style whose inputs are color, normal, depth, object_id, motion or rest_position, or another size",
            )
        })
    }

    /// What frames read of those before, where all are known.
    ///
    /// # Errors
    /// As [`Style::plan`].
    pub fn past(&self, library: &Library, request: &IsophoteRequest) -> Result<Past> {
        let refused = |e: isophote_loader::Error| e.at(&self.name, "choose another style");
        let [frames, _] = library.frames(&self.graph).map_err(refused)?;
        if frames == 0 {
            return Ok(Past::default());
        }
        let plan = self.plan(library, request, frames as usize)?;
        let textures = plan.textures().map_err(refused)?;
        let inputs = textures.iter().filter(|t| t.role == Role::Input).map(|t| t.name);
        Ok(Past::of(inputs))
    }
}

/// What the renderer's frames are: linear light, premultiplied, with guides.
///
/// # Errors
/// [`isophote_files::error::Error::Input`] for impossible sizes.
pub fn frame_request(library: &Library, style: &Style, size: (u32, u32)) -> Result<IsophoteRequest> {
    let request = style.request(library, size).map_err(|e| e.at("--size", "choose another size"))?;
    Ok(IsophoteRequest {
        space: ISOPHOTE_SPACE_LINEAR,
        guides: ISOPHOTE_GUIDE_NORMAL
            | ISOPHOTE_GUIDE_DEPTH
            | ISOPHOTE_GUIDE_OBJECT_ID
            | ISOPHOTE_GUIDE_MOTION
            | ISOPHOTE_GUIDE_REST_POSITION,
        ..request
    })
}
