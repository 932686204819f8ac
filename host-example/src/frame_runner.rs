//! A graph on frames in order, each of which may depend on those before it.
//!
//! Many styles take every frame by itself, and then this is a plan and its [`PlanRunner`]. A style that is steady over
//! time reads what the frames before left in [rings](crate::history), so that the first frames after a cut have plans of
//! their own: one where nothing is known, one where one frame is, and so on. [`FrameRunner::update`] takes the next
//! plan when there is one, and follows parameters that were changed.

use std::ops::Range;
use std::sync::Arc;

use crate::kernels::Kernels;
use crate::plan_runner::PlanRunner;
use isophote_files::error::{AtPlace, Result};
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::history::Past;
use isophote_loader::plan::Change;
use isophote_loader::{Graph, Library, Plan};

/// Way to mend a graph that cannot be planned.
const FIX: &str = "choose a style whose inputs are color, normal, depth, object_id, motion or rest_position, or another size";

/// Graph with the name that messages have for it.
#[derive(Clone, Copy, Debug)]
pub struct Named<'g> {
    /// The name.
    pub name: &'g str,
    /// The graph.
    pub graph: &'g Graph,
}

impl Named<'_> {
    /// The plan of a frame where so many frames before it are known.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) when an input that the graph needs is open.
    pub fn plan(&self, library: &Library, request: &IsophoteRequest, known: usize) -> Result<Plan> {
        library.plan_frame(self.graph, request, known as u32).map_err(|e| e.at(self.name, FIX))
    }

    /// Images of frames before that frames read, where all are known.
    ///
    /// # Errors
    /// As [`Named::plan`].
    pub fn past(&self, library: &Library, request: &IsophoteRequest) -> Result<Past> {
        library.past(self.graph, request).map_err(|e| e.at(self.name, FIX))
    }
}

/// Runner of a graph on frames of one size.
#[derive(Debug)]
pub struct FrameRunner {
    library: Library,
    request: IsophoteRequest,
    plan: Plan,
    /// Textures of past frames that plans read, once enough are known.
    past: Past,
    /// Frames before the next one that were recorded, at most those that the graph depends on.
    known: usize,
    /// Number of them that the plan reads.
    planned: usize,
    runner: PlanRunner,
    output: wgpu::TextureView,
}

impl FrameRunner {
    /// Plans the first frame and makes its textures. `kernels` are those of the device that frames are on.
    ///
    /// # Errors
    /// As [`Named::plan`]; [`Error::Failure`](isophote_files::error::Error::Failure) when the device refuses.
    pub fn new(
        kernels: &Arc<Kernels>,
        library: &Library,
        graph: Named<'_>,
        request: IsophoteRequest,
    ) -> Result<Self> {
        let past = graph.past(library, &request)?;
        let plan = graph.plan(library, &request, 0)?;
        let runner = PlanRunner::new(kernels, &plan, past.clone())?;
        let output = runner.output()?.clone();
        Ok(Self { library: library.clone(), request, plan, past, known: 0, planned: 0, runner, output })
    }

    /// Frames before its own that a frame depends on.
    pub fn depth(&self) -> usize {
        self.past.frames
    }

    /// Request of the frame at hand.
    pub fn request(&self) -> &IsophoteRequest {
        &self.request
    }

    /// Takes the next frame for the first: those before are of another shot.
    pub fn forget(&mut self) {
        self.known = 0;
    }

    /// Texture that [`FrameRunner::encode`] writes. Another one after [`FrameRunner::resize`], and after
    /// [`FrameRunner::update`] when that says so.
    pub fn output(&self) -> &wgpu::TextureView {
        &self.output
    }

    /// Gives the next frame its number, which noise that moves depends on. Where it is another one, the next
    /// [`FrameRunner::update`] is of an edited graph.
    pub fn number(&mut self, frame: i64) {
        self.request.frame = frame;
    }

    /// Follows the graph, whose parameters or frame number were changed where it `is_edited`, and the frames that are
    /// known now. Says whether the output is another texture and [`FrameRunner::bind`] must be called. Parameters that
    /// are not structural cost one small upload.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when the device refuses; the runner must then be made
    /// anew.
    pub fn update(&mut self, graph: Named<'_>, is_edited: bool) -> Result<bool> {
        if is_edited {
            let past = graph.past(&self.library, &self.request)?;
            if past != self.past {
                (self.past, self.known) = (past, 0);
                self.replan(graph, 0)?;
                return Ok(true);
            }
        }
        if self.known != self.planned {
            self.replan(graph, self.known)?;
            return Ok(true);
        }
        if !is_edited {
            return Ok(false);
        }
        let refused = |e: isophote_loader::Error| e.at(graph.name, "choose another value");
        if self.plan.update(graph.graph, &self.request).map_err(refused)? == Change::Uniforms {
            self.runner.repack(&self.plan)?;
            return Ok(false);
        }
        self.rebuild()?;
        Ok(true)
    }

    /// Plans for so many known frames before.
    fn replan(&mut self, graph: Named<'_>, known: usize) -> Result<()> {
        self.plan = graph.plan(&self.library, &self.request, known)?;
        self.planned = known;
        self.rebuild()
    }

    fn rebuild(&mut self) -> Result<()> {
        self.runner.rebuild(&self.plan, self.past.clone())?;
        self.output = self.runner.output()?.clone();
        Ok(())
    }

    /// Changes the request to one of another size; says whether it is another one, and then [`FrameRunner::bind`] must be
    /// called.
    ///
    /// # Errors
    /// As [`FrameRunner::new`]; the runner must then be made anew.
    pub fn resize(&mut self, graph: Named<'_>, size: (u32, u32), scale: f32) -> Result<bool> {
        let request = IsophoteRequest { width: size.0, height: size.1, scale, ..self.request };
        if request == self.request {
            return Ok(false);
        }
        self.past = graph.past(&self.library, &request)?;
        self.request = request;
        self.forget();
        self.replan(graph, 0)?;
        Ok(true)
    }

    /// Reads pictures of these names, as large as was asked for or larger. The same ones again cost nothing.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when one is missing or too small, or the device refuses.
    pub fn bind(&mut self, inputs: &[(&str, &wgpu::TextureView)]) -> Result<()> {
        self.runner.bind(inputs)
    }

    /// Records passes on a frame, [all](crate::plan_runner::ALL) or some; says whether the last is among them, and the next
    /// call is of the next frame then. Nothing is created and nothing submitted.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when nothing is bound.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, passes: Range<usize>) -> Result<bool> {
        let is_whole = self.runner.encode(encoder, passes)?;
        if is_whole {
            self.known = (self.planned + 1).min(self.past.frames);
        }
        Ok(is_whole)
    }

    /// The passes with their textures.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
}
