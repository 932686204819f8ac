//! A plan of the library on the host's own device, with nothing but wgpu: **the example to copy**.
//!
//! The library says what is to be computed, as data: textures, compute passes, uniform bytes and shaders. The
//! rest is up to the host, and all of it is here and in [`kernels`](crate::kernels), `passes.rs`, `textures.rs`
//! and `uniforms.rs`:
//!
//! 1. [`Kernels`] compiles the shader of a kernel when a plan first names it.
//! 2. [`PlanRunner::new`] makes the plan's textures and one buffer for all uniform blocks.
//! 3. [`PlanRunner::bind`] connects the host's textures. They are read where they are; nothing is copied.
//! 4. [`PlanRunner::encode`] records the passes into the host's command encoder. It makes no object and submits
//!    nothing, so that a frame is scene, style and presentation in one submission.
//! 5. Plans for frames in order name textures of frames before; [`Rings`] holds them.
//! 6. After a parameter has changed, [`PlanRunner::repack`] uploads a few bytes, or [`PlanRunner::rebuild`] takes
//!    over other passes, as `plan_update` says.
//!
//! Everything is bound in group 0: at 0 the grid, which says where textures lie in the picture, at 1 the kernel's
//! parameters, if it has any, from 2 the textures that are read and then those that are written, and where the shader says
//! so a sampler, in plans that are fast rather than exact. wgpu puts the
//! barriers between passes; `tests/c/vulkan.c` does the same work by hand.

use std::ops::Range;
use std::sync::Arc;

use crate::history::Rings;
use crate::kernels::{Kernels, mistaken, refused};
use crate::passes::{ReadyPass, unbound};
use crate::textures::{self, COPIED, Slot};
use crate::uniforms::Uniforms;
use isophote_files::error::Result;
use isophote_loader::Plan;
use isophote_loader::history::{self, Past};
use isophote_loader::plan::Role;
use isophote_loader::uniforms::Bytes;

/// The passes of a whole frame.
pub const ALL: Range<usize> = 0..usize::MAX;

/// A plan, ready to be recorded again and again.
///
/// One submission may hold it once only, since uniform bytes that are uploaded hold for all of a submission.
#[derive(Debug)]
pub struct PlanRunner {
    kernels: Arc<Kernels>,
    textures: Vec<Slot>,
    passes: Vec<ReadyPass>,
    past: Past,
    rings: Rings,
    uniforms: Uniforms,
}

impl PlanRunner {
    /// Compiles what `plan` needs and makes its textures, but for the inputs, which are the host's. `past` says what this
    /// and later plans read of frames before.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when the device refuses or has no memory.
    pub fn new(kernels: &Arc<Kernels>, plan: &Plan, past: Past) -> Result<Self> {
        let rings = Rings::new(&past);
        Self::build(kernels, plan, past, (Vec::new(), rings))
    }

    /// Takes over a plan whose structure has changed; textures of unchanged size are used again. The inputs must
    /// be bound anew.
    ///
    /// # Errors
    /// As [`PlanRunner::new`]; the runner must then be made anew.
    pub fn rebuild(&mut self, plan: &Plan, past: Past) -> Result<()> {
        let rings = if past == self.past { std::mem::take(&mut self.rings) } else { Rings::new(&past) };
        let old = (std::mem::take(&mut self.textures), rings);
        *self = Self::build(&self.kernels, plan, past, old)?;
        Ok(())
    }

    fn build(
        kernels: &Arc<Kernels>,
        plan: &Plan,
        past: Past,
        (old, mut rings): (Vec<Slot>, Rings),
    ) -> Result<Self> {
        let wanted = plan.textures().map_err(refused)?;
        let textures = textures::slots(kernels, &wanted, &past, old, &mut rings)?;
        let alignment = kernels.device().limits().min_uniform_buffer_offset_alignment;
        let mut uniforms = Bytes::new(alignment);
        let mut passes = Vec::new();
        for (index, pass) in (0..).zip(plan.passes().map_err(refused)?) {
            if pass.inputs.iter().chain(pass.outputs).any(|at| *at as usize >= wanted.len()) {
                return Err(mistaken(format!("kernel '{}' names an unknown texture", pass.kernel)));
            }
            passes.push(ReadyPass::new(kernels.get(plan, index, &pass, &wanted)?, &pass, &mut uniforms));
        }
        let uniforms = Uniforms::new(kernels, uniforms)?;
        let kernels = Arc::clone(kernels);
        let mut runner = Self { kernels, textures, passes, past, rings, uniforms };
        runner.repack(plan)?;
        Ok(runner)
    }

    /// Takes over the uniform bytes of the plan, after an update that changed nothing else: one small upload, or
    /// none where the bytes are the same.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when the library fails.
    pub fn repack(&mut self, plan: &Plan) -> Result<()> {
        let mut is_changed = false;
        for (ready, pass) in self.passes.iter().zip(plan.passes().map_err(refused)?) {
            is_changed |= self.uniforms.bytes.put(ready.grid, pass.grid);
            is_changed |= ready.params.is_some_and(|params| self.uniforms.bytes.put(params, pass.params));
        }
        if is_changed {
            self.uniforms.upload(&self.kernels);
        }
        Ok(())
    }

    /// Connects the host's textures with the plan's inputs of their names; those that the plan does not read are
    /// ignored, and the same ones again cost nothing.
    ///
    /// An input may have any format that is read as floats without filtering, and be larger than the plan says:
    /// its first texel is the window's.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) for an input that is missing or too small, and when the device refuses a view.
    pub fn bind(&mut self, inputs: &[(&str, &wgpu::TextureView)]) -> Result<()> {
        let given = |name: &str| {
            let found = inputs.iter().find(|(given, _)| *given == name).map(|(_, view)| *view);
            found.ok_or_else(|| mistaken(format!("no texture is given for '{name}'")))
        };
        for name in self.past.inputs() {
            let texture = given(name)?.texture();
            let (format, size) = (texture.format(), [texture.width(), texture.height()]);
            let make = || textures::create(&self.kernels, format, size, COPIED);
            self.rings.hold(name, format, size, Some(texture.clone()), make)?;
        }
        for (index, slot) in (0..).zip(&mut self.textures).filter(|(_, slot)| slot.role == Role::Input) {
            let views = match history::split(&slot.name) {
                Some((name, before)) => self
                    .rings
                    .views(name, before)
                    .ok_or_else(|| mistaken(format!("nothing is held of '{}'", slot.name)))?,
                None => vec![given(&slot.name)?.clone()],
            };
            let fits = |view: &wgpu::TextureView| {
                view.texture().width() >= slot.size[0] && view.texture().height() >= slot.size[1]
            };
            if !views.iter().all(fits) {
                return Err(mistaken(format!("the texture given for '{}' is too small", slot.name)));
            }
            if slot.views != views {
                slot.views = views;
                let mut readers = self.passes.iter_mut();
                readers.by_ref().filter(|p| p.textures.contains(&index)).for_each(|p| p.groups.clear());
            }
        }
        self.bind_passes()
    }

    /// Makes the bind groups of passes whose textures are others now.
    fn bind_passes(&mut self) -> Result<()> {
        let mut passes = self.passes.iter_mut().filter(|p| p.groups.is_empty());
        passes.try_for_each(|pass| pass.bind(&self.kernels, &self.uniforms, &self.textures))
    }

    /// Texture that the plan computes, until [`PlanRunner::rebuild`]; it can be sampled and copied from.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when the plan has no output.
    pub fn output(&self) -> Result<&wgpu::TextureView> {
        let mut outputs = self.textures.iter().filter(|slot| slot.role == Role::Output);
        let output = outputs.find(|slot| !history::is_stage(&slot.name));
        output.and_then(|slot| slot.views.first()).ok_or_else(|| mistaken("the plan has no output".into()))
    }

    /// Records passes of a frame, [all](ALL) or those of one of its submissions, and says whether the last is among them. The
    /// next call is of the next frame then.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when the inputs are not bound.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, passes: Range<usize>) -> Result<bool> {
        let end = passes.end.min(self.passes.len());
        let descriptor = wgpu::ComputePassDescriptor { label: Some("stylize"), timestamp_writes: None };
        let mut compute = encoder.begin_compute_pass(&descriptor);
        (passes.start..end).try_for_each(|index| self.encode_pass(&mut compute, index))?;
        drop(compute);
        let is_whole = end == self.passes.len();
        if is_whole {
            self.rings.encode_copies(encoder);
            self.rings.advance();
        }
        Ok(is_whole)
    }

    /// Records the pass of an index alone, for hosts that measure each.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when there is no such pass, or its inputs are not bound.
    pub fn encode_pass(&self, compute: &mut wgpu::ComputePass<'_>, index: usize) -> Result<()> {
        let pass = self.passes.get(index).ok_or_else(unbound)?;
        pass.encode(compute, if pass.groups.len() == self.rings.turns() { self.rings.turn() } else { 0 })
    }
}
