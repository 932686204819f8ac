//! One look on the device: built beside the window, edited in it.

use std::sync::Arc;

use super::look::{Knob, Look};
use super::worker::{Wake, Worker};
use crate::error::{Error, Result};
use crate::loader::Library;
use crate::loader::catalogue::Kind;
use crate::loader::contract::{IsophoteRequest, IsophoteSpace};
use crate::stylize::kernels::Kernels;
use crate::stylize::preset::Track;
use crate::stylize::style::Setting;
use crate::stylize::{Stylizer, frame_request};

/// What pictures a look is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asked {
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Size over that of the full picture.
    pub scale: f32,
    /// What the colours are.
    pub space: IsophoteSpace,
    /// Which guides there are.
    pub guides: u32,
}

/// What is to be built.
struct Job {
    library: Library,
    kernels: Arc<Kernels>,
    recipe: Recipe,
}

#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    look: Look,
    asked: Asked,
}

/// A look that can be recorded.
struct Ready {
    stylizer: Stylizer,
    recipe: Recipe,
    knobs: Vec<Knob>,
    /// Whether it reads what there is to read.
    bound: bool,
    /// Whether a picture has been recorded.
    drawn: bool,
}

/// A look on its way to the canvas.
pub struct Lane {
    worker: Worker<Job, (Recipe, Result<Ready>)>,
    kernels: Arc<Kernels>,
    ready: Option<Ready>,
    /// What was last asked of the worker, or refused.
    asked: Option<Recipe>,
    revision: u64,
}

impl Lane {
    /// A lane without a look.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(kernels: &Arc<Kernels>, wake: Wake) -> Result<Self> {
        let worker = Worker::new("look", wake, |job: Job| {
            let built = build(&job);
            (job.recipe, built)
        })?;
        Ok(Self { worker, kernels: Arc::clone(kernels), ready: None, asked: None, revision: 0 })
    }

    /// Follows `look` for pictures as `asked`: at once where only values change, and behind the picture otherwise.
    ///
    /// # Errors
    /// What the library or the device has against the look; the look before stays.
    pub fn follow(&mut self, library: &Library, look: &Look, asked: Asked) -> Result<()> {
        let answer = self.worker.answer();
        let wanted = Recipe { look: look.clone(), asked };
        if look.is_plain() {
            self.revision += u64::from(self.ready.is_some());
            (self.ready, self.asked) = (None, None);
            return Ok(());
        }
        if let Some((recipe, built)) = answer.filter(|_| self.asked.is_some()) {
            match built {
                Ok(ready) => {
                    self.ready = Some(ready);
                    self.revision += 1;
                }
                // It is not asked for again until something else is wanted.
                Err(error) if self.asked.as_ref() == Some(&recipe) => return Err(error),
                Err(_) => {}
            }
        }
        if self.ready.as_ref().is_some_and(|ready| ready.recipe == wanted) {
            // What was asked for meanwhile is wanted no more.
            self.asked = None;
            return Ok(());
        }
        if self.asked.as_ref() == Some(&wanted) {
            return Ok(());
        }
        let followed = self.ready.as_mut().map_or(Ok(false), |ready| ready.follow(&wanted));
        self.asked = Some(wanted.clone());
        if followed.inspect_err(|_| self.ready = None)? {
            self.revision += 1;
            self.asked = None;
            return Ok(());
        }
        self.worker.ask(Job { library: library.clone(), kernels: Arc::clone(&self.kernels), recipe: wanted });
        Ok(())
    }

    /// Whether the look that is wanted is being built.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy() && self.asked.is_some()
    }

    /// A number that grows with every change of what the lane gives.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// What the lane gave last, its kind, and what its colours are; none before the first picture.
    pub fn output(&self) -> Option<(&wgpu::TextureView, Kind, IsophoteSpace)> {
        let Ready { stylizer, recipe, .. } = self.ready.as_ref().filter(|ready| ready.drawn)?;
        Some((stylizer.output(), stylizer.kind(), recipe.asked.space))
    }

    /// Whether the look must see rest positions of pictures as `asked`.
    ///
    /// # Errors
    /// As [`Stylizer::wants_rest_positions`].
    pub fn wants_rest_positions(&self) -> Result<bool> {
        self.ready.as_ref().map_or(Ok(false), |ready| ready.stylizer.wants_rest_positions())
    }

    /// Records the look on a picture as `asked`, if it is for such; `bind` says what it reads.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device refuses.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        asked: Asked,
        frame: i64,
        bind: impl FnOnce(&mut Stylizer) -> Result<()>,
    ) -> Result<()> {
        let Some(ready) = self.ready.as_mut().filter(|ready| ready.recipe.asked == asked) else {
            return Ok(());
        };
        ready.stylizer.at_frame(frame)?;
        if ready.stylizer.update()? || !ready.bound {
            bind(&mut ready.stylizer)?;
            ready.bound = true;
        }
        ready.stylizer.encode(encoder)?;
        ready.drawn = true;
        Ok(())
    }

    /// The inputs are others now.
    pub fn unbind(&mut self) {
        if let Some(ready) = &mut self.ready {
            ready.bound = false;
        }
    }
}

impl Ready {
    /// Takes over what can be without building anything, and says whether that was all.
    fn follow(&mut self, wanted: &Recipe) -> Result<bool> {
        let (old, new) = (&self.recipe.look, &wanted.look);
        let is_same = old.preset.style == new.preset.style
            && old.preset.lengths == new.preset.lengths
            && old.style_name() == new.style_name();
        let asked = Asked { size: wanted.asked.size, scale: wanted.asked.scale, ..self.recipe.asked };
        if !is_same || asked != wanted.asked {
            return Ok(false);
        }
        let track = |look: &Look, knob: &Knob| {
            look.preset
                .params
                .iter()
                .rev()
                .find(|(name, _)| *name == knob.name)
                .map(|(_, track)| track.clone())
        };
        let mut settings = Vec::new();
        for knob in &self.knobs {
            let (before, after) = (track(old, knob), track(new, knob));
            if before == after {
                continue;
            }
            let is_still = |track: &Option<Track>| !matches!(track, Some(Track::Keys { .. }));
            if knob.param.structural || !is_still(&before) || !is_still(&after) {
                return Ok(false);
            }
            let (node, param) = match knob.name.rsplit_once('.') {
                Some((node, param)) => (Some(node.to_owned()), param),
                None => (None, knob.name.as_str()),
            };
            let value = new.value(knob).text();
            settings.push(Setting { node, param: param.to_owned(), value });
        }
        for setting in &settings {
            self.stylizer.set(setting)?;
        }
        if asked != self.recipe.asked {
            self.stylizer.resize_at_scale(asked.size, asked.scale)?;
            self.bound = false;
        }
        self.recipe = wanted.clone();
        Ok(true)
    }
}

fn build(job: &Job) -> Result<Ready> {
    let Job { library, kernels, recipe } = job;
    let Recipe { look, asked } = recipe;
    let missing = || Error::failure("the plain look has no style", "choose a style");
    let style = look.style(library)?.ok_or_else(missing)?;
    let request = frame_request(library, &style, asked.size)?;
    let request = IsophoteRequest { scale: asked.scale, space: asked.space, guides: asked.guides, ..request };
    let stylizer = Stylizer::with_request(kernels, library, style, request)?;
    stylizer.compile_all()?;
    Ok(Ready { stylizer, recipe: recipe.clone(), knobs: look.knobs(library)?, bound: false, drawn: false })
}
