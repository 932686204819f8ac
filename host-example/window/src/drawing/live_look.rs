//! One look on the device: built beside the window, edited in it.

use std::sync::Arc;

use super::origin::Origin;
use super::shown::Output;
use crate::jobs::worker::{Wake, Worker};
use crate::state::look::{EditedLook, Parameter};
use isophote_example::kernels::Kernels;
use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::Stylizer;
use isophote_finishing::stylize::precision::Precision;
use isophote_loader::Library;
use isophote_loader::abi::{IsophoteRequest, IsophoteSpace};
use isophote_loader::catalogue::Kind;

/// A look to be built.
struct BuildJob {
    library: Library,
    kernels: Arc<Kernels>,
    recipe: Recipe,
}

#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    look: EditedLook,
    precision: Precision,
    /// Request of the pictures that the look is for; the reference of lengths is the look's own affair, and frames
    /// come later.
    request: IsophoteRequest,
}

/// A look that can be recorded.
struct Ready {
    stylizer: Stylizer,
    recipe: Recipe,
    parameters: Vec<Parameter>,
    /// True where it reads what there is to read.
    bound: bool,
    /// Number of the last frame that was recorded.
    number: Option<i64>,
    /// Passes of a picture that were recorded, while it is not whole.
    done: usize,
}

/// The part of a picture that is recorded at once.
#[derive(Clone, Copy, Debug)]
pub struct Part<'p> {
    /// True for the first.
    pub begins: bool,
    /// Most passes.
    pub passes: usize,
    /// Number of the frame, where frames follow one another.
    pub number: Option<i64>,
    /// Origin of the picture.
    pub origin: &'p Origin,
}

/// A look on its way to the canvas.
pub struct LiveLook {
    worker: Worker<BuildJob, (Recipe, Result<Ready>)>,
    kernels: Arc<Kernels>,
    ready: Option<Ready>,
    /// The look for pictures of another scale, which are shown while something moves.
    spare: Option<Ready>,
    /// Recipe that was last asked of the worker, or refused.
    requested: Option<Recipe>,
    revision: u64,
    /// The last picture that was whole, its origin, its kind, and what its colours are.
    shown: Option<(wgpu::TextureView, Origin, Kind, IsophoteSpace)>,
}

impl LiveLook {
    /// No look yet.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(kernels: &Arc<Kernels>, wake: Wake) -> Result<Self> {
        let worker = Worker::new("look", wake, |job: BuildJob| {
            let built = build(&job);
            (job.recipe, built)
        })?;
        let kernels = Arc::clone(kernels);
        Ok(Self { worker, kernels, ready: None, spare: None, requested: None, revision: 0, shown: None })
    }

    /// Follows `look` for pictures of this `request`: at once where only values change, and behind the picture otherwise.
    ///
    /// # Errors
    /// Errors of the library or the device about the look; the look before stays.
    pub fn follow(
        &mut self,
        library: &Library,
        look: &EditedLook,
        precision: Precision,
        request: IsophoteRequest,
    ) -> Result<()> {
        let answer = self.worker.answer();
        let wanted = Recipe { look: look.clone(), precision, request };
        if look.is_plain() {
            self.revision += u64::from(self.ready.is_some());
            self.forget();
            (self.requested, self.shown) = (None, None);
            return Ok(());
        }
        if let Some((recipe, built)) = answer.filter(|_| self.requested.is_some()) {
            match built {
                Ok(ready) => self.take(ready),
                // It is not asked for again until something else is wanted.
                Err(error) if self.requested.as_ref() == Some(&recipe) => return Err(error),
                Err(_) => {}
            }
        }
        if !self.is_for(request) && self.spare.as_ref().is_some_and(|spare| spare.recipe.request == request) {
            std::mem::swap(&mut self.ready, &mut self.spare);
            self.revision += 1;
        }
        if self.ready.as_ref().is_some_and(|ready| ready.recipe == wanted) {
            // What was asked for meanwhile is wanted no more.
            self.requested = None;
            return Ok(());
        }
        if self.requested.as_ref() == Some(&wanted) {
            return Ok(());
        }
        let followed = self.ready.as_mut().map_or(Ok(false), |ready| ready.follow(&wanted));
        self.requested = Some(wanted.clone());
        if followed.inspect_err(|_| self.forget())? {
            self.revision += 1;
            self.requested = None;
            return Ok(());
        }
        self.worker.ask(BuildJob {
            library: library.clone(),
            kernels: Arc::clone(&self.kernels),
            recipe: wanted,
        });
        Ok(())
    }

    /// Records this from now on. What was recorded before is kept if it is for pictures of another scale.
    fn take(&mut self, ready: Ready) {
        let scale = ready.recipe.request.scale;
        for old in [self.ready.replace(ready), self.spare.take()].into_iter().flatten() {
            if self.spare.is_none() && old.recipe.request.scale != scale {
                self.spare = Some(old);
            }
        }
        self.revision += 1;
    }

    /// Lets go of what was built.
    fn forget(&mut self) {
        (self.ready, self.spare) = (None, None);
    }

    fn is_for(&self, request: IsophoteRequest) -> bool {
        self.ready.as_ref().is_some_and(|ready| ready.recipe.request == request)
    }

    /// True while the look that is wanted is being built.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy() && self.requested.is_some()
    }

    /// A number that grows with every change of what it gives.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The last picture that was whole, if it may stand for what is open `now`, its kind, and what its colours are.
    pub fn output(&self, now: &Origin) -> Option<Output> {
        let (view, origin, kind, space) = self.shown.as_ref()?;
        origin.stands_for(now).then(|| (view.clone(), *kind, *space))
    }

    /// True where the look must see rest positions of pictures of this `request`.
    ///
    /// # Errors
    /// As [`Stylizer::wants_rest_positions`].
    pub fn wants_rest_positions(&self) -> Result<bool> {
        self.ready.as_ref().map_or(Ok(false), |ready| ready.stylizer.wants_rest_positions())
    }

    /// Records a part of the look on a picture of this `request`, if it is for such; `bind` says what it reads. Says whether the
    /// picture is whole.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device refuses.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        request: IsophoteRequest,
        part: Part<'_>,
        bind: impl FnOnce(&mut Stylizer) -> Result<()>,
    ) -> Result<bool> {
        let Some(ready) = self.ready.as_mut().filter(|ready| ready.recipe.request == request) else {
            return Ok(true);
        };
        let Ready { stylizer, bound, number, done, .. } = ready;
        // A look that was built meanwhile begins by itself.
        if part.begins || !*bound {
            *done = 0;
            if part.number.is_some() && part.number != number.map(|number| number + 1) {
                stylizer.forget();
            }
            *number = part.number;
            stylizer.at_frame(part.number.unwrap_or_default())?;
            if stylizer.update()? || !*bound {
                bind(stylizer)?;
                *bound = true;
            }
        } else if *done == usize::MAX {
            return Ok(true);
        }
        let end = done.saturating_add(part.passes);
        let is_whole = stylizer.encode(encoder, *done..end)?;
        *done = if is_whole { usize::MAX } else { end };
        if is_whole {
            let view = stylizer.output().clone();
            self.shown = Some((view, part.origin.clone(), stylizer.kind(), request.space));
        }
        Ok(is_whole)
    }

    /// The inputs are others now.
    pub fn unbind(&mut self) {
        self.ready.iter_mut().chain(&mut self.spare).for_each(|ready| ready.bound = false);
    }
}

impl Ready {
    /// Takes over what can be without building anything, and says whether that was all.
    fn follow(&mut self, wanted: &Recipe) -> Result<bool> {
        let (old, new) = (&self.recipe.look, &wanted.look);
        let is_same = old.preset.style == new.preset.style
            && old.preset.lengths == new.preset.lengths
            && old.has_graph_of(new)
            && old.style_name() == new.style_name();
        if !is_same || (self.recipe.request, self.recipe.precision) != (wanted.request, wanted.precision) {
            return Ok(false);
        }
        let mut changed = Vec::new();
        for parameter in &self.parameters {
            let [before, after] = [old, new].map(|look| look.preset.params.get(&parameter.name));
            if before == after {
                continue;
            }
            if parameter.param.structural || old.is_animated(parameter) || new.is_animated(parameter) {
                return Ok(false);
            }
            changed.push(parameter);
        }
        for parameter in changed {
            let Parameter { name, node, param, .. } = parameter;
            self.stylizer.set_value(name, *node, param.id, &new.value(parameter))?;
        }
        self.recipe = wanted.clone();
        Ok(true)
    }
}

fn build(job: &BuildJob) -> Result<Ready> {
    let BuildJob { library, kernels, recipe } = job;
    let Recipe { look, precision, request } = recipe;
    let missing = || Error::failure("the plain look has no style", "choose a style");
    let style = look.style(library)?.ok_or_else(missing)?;
    precision.apply(&style)?;
    let request = IsophoteRequest { reference_height: style.lengths.reference_height(), ..*request };
    let stylizer = Stylizer::with_request(kernels, library, style, request)?;
    stylizer.compile_all(kernels, library)?;
    Ok(Ready {
        stylizer,
        recipe: recipe.clone(),
        parameters: look.parameters(library)?,
        bound: false,
        number: None,
        done: 0,
    })
}
