//! Stylizing what the renderer has drawn, on the renderer's own device.
//!
//! The library plans, the host executes: the plan's passes are recorded into the host's own command encoder,
//! after the scene's, and read the renderer's textures directly. Once warm, a frame creates no GPU object and
//! is one submission.

pub mod preset;
pub mod style;

use std::sync::Arc;

use isophote_engine::gpu::{self, Executor, Prepared};
use isophote_engine::program::Program;

use self::style::{Setting, Style};
use crate::error::{Error, Result};
use crate::loader::catalogue::Kind;
use crate::loader::contract::{
    ISOPHOTE_GUIDE_DEPTH, ISOPHOTE_GUIDE_NORMAL, ISOPHOTE_GUIDE_OBJECT_ID, ISOPHOTE_SPACE_LINEAR,
    IsophoteRequest,
};
use crate::loader::plan::Change;
use crate::loader::{Library, Plan};
use crate::render::targets::Targets;

/// Name of the one output of every graph.
const OUTPUT: &str = "output";

/// A style for frames of one size, ready to be recorded.
#[derive(Debug)]
pub struct Stylizer {
    style: Style,
    request: IsophoteRequest,
    plan: Plan,
    program: Program,
    executor: Executor,
    prepared: Prepared,
    output: wgpu::TextureView,
    edited: bool,
}

impl Stylizer {
    /// Makes `style` ready for frames of `size`, with all guides that the renderer has. `device` is the
    /// renderer's, wrapped by [`gpu::Device::wrap`] once.
    ///
    /// # Errors
    /// [`Error::Input`] when an input that the style needs is open, [`Error::Failure`] when the device refuses.
    pub fn new(device: &Arc<gpu::Device>, library: &Library, style: Style, size: (u32, u32)) -> Result<Self> {
        let request = request(library, size)?;
        let plan = style.plan(&request)?;
        let program = plan.program().map_err(|e| e.at(&style.name, "choose another style"))?;
        let executor = Executor::new(Arc::clone(device));
        let (prepared, output) = prepare(&executor, &program)?;
        Ok(Self { style, request, plan, program, executor, prepared, output, edited: false })
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

    /// Gives animated parameters their values at a frame; they take effect with the next
    /// [`Stylizer::update`].
    ///
    /// # Errors
    /// As [`Style::at_frame`].
    pub fn at_frame(&mut self, frame: i64) -> Result<()> {
        self.edited |= self.style.at_frame(frame)?;
        Ok(())
    }

    /// Takes over what [`Stylizer::set`] has set, and says whether the output is another texture now and
    /// [`Stylizer::bind`] must be called. Parameters that are not structural cost one small upload.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device refuses; the style must then be made anew.
    pub fn update(&mut self) -> Result<bool> {
        if !std::mem::take(&mut self.edited) {
            return Ok(false);
        }
        let refused = |e: crate::loader::Refusal| e.at(&self.style.name, "choose another value");
        if self.plan.update(&self.style.graph).map_err(refused)? == Change::Uniforms {
            self.plan.repack(&mut self.program).map_err(refused)?;
            self.prepared.repack(&self.program).map_err(engine)?;
            return Ok(false);
        }
        self.prepare()?;
        Ok(true)
    }

    /// Changes the size of the frames; [`Stylizer::bind`] must be called then.
    ///
    /// # Errors
    /// [`Error::Input`] for impossible sizes, [`Error::Failure`] when the device refuses; the style must then be
    /// made anew.
    pub fn resize(&mut self, size: (u32, u32)) -> Result<()> {
        let request = IsophoteRequest { width: size.0, height: size.1, ..self.request };
        if request == self.request {
            return Ok(());
        }
        self.plan = self.style.plan(&request)?;
        self.request = request;
        self.edited = false;
        self.prepare()
    }

    fn prepare(&mut self) -> Result<()> {
        let program = self.plan.program().map_err(|e| e.at(&self.style.name, "choose another style"))?;
        (self.prepared, self.output) = prepare(&self.executor, &program)?;
        self.program = program;
        Ok(())
    }

    /// Reads these targets from now on, which must have the size given to [`Stylizer::new`]. The same ones
    /// again cost nothing.
    ///
    /// # Errors
    /// [`Error::Failure`] when they are too small or the device refuses.
    pub fn bind(&mut self, targets: &Targets) -> Result<()> {
        let inputs = [
            ("color", &targets.color.view),
            ("normal", &targets.normal.view),
            ("depth", &targets.depth.view),
            ("object_id", &targets.object_id.view),
        ];
        self.prepared.bind(&inputs, &[]).map_err(engine)
    }

    /// Records the whole style. Nothing is created and nothing submitted.
    ///
    /// # Errors
    /// [`Error::Failure`] when nothing is bound or the device is lost.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        self.prepared.encode(encoder).map_err(engine)
    }

    /// The passes with their textures.
    pub fn program(&self) -> &Program {
        &self.program
    }
}

impl Style {
    fn plan(&self, request: &IsophoteRequest) -> Result<Plan> {
        self.graph.plan(request).map_err(|e| {
            e.at(
                &self.name,
                "choose a style whose inputs are color, normal, depth or object_id, or another size",
            )
        })
    }
}

/// What the renderer's frames are: linear light, premultiplied, with guides.
fn request(library: &Library, size: (u32, u32)) -> Result<IsophoteRequest> {
    let request = library.request(size).map_err(|e| e.at("--size", "choose another size"))?;
    Ok(IsophoteRequest {
        space: ISOPHOTE_SPACE_LINEAR,
        guides: ISOPHOTE_GUIDE_NORMAL | ISOPHOTE_GUIDE_DEPTH | ISOPHOTE_GUIDE_OBJECT_ID,
        ..request
    })
}

fn prepare(executor: &Executor, program: &Program) -> Result<(Prepared, wgpu::TextureView)> {
    let mut prepared = executor.prepare(program).map_err(engine)?;
    let output = prepared.own_output(OUTPUT).map_err(engine)?;
    Ok((prepared, output))
}

/// The executor's errors are the device's.
fn engine(error: isophote_engine::Error) -> Error {
    Error::failure(error, "use a smaller picture or update the graphics driver")
}
