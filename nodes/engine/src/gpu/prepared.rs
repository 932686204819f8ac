//! A program made ready for a device: pipelines, textures, one uniform buffer and bind groups.

use super::device::{Device, count};
use super::pipeline::{Pipeline, bound_size};
use super::texture::{Pool, create_texture, texture_bytes};
use super::timing::Timer;
use crate::cpu::PassTime;
use crate::error::{Error, Result};
use crate::program::{Format, Grid, Program, Role, SAMPLER_BINDING, Shader};
use std::num::NonZeroU64;
use std::ops::Range;
use std::sync::Arc;

/// One texture of the program.
#[derive(Debug)]
struct Slot {
    role: Role,
    format: Format,
    /// Texels that the program uses.
    size: [u32; 2],
    view: Option<wgpu::TextureView>,
    /// Made here, not bound by the caller.
    owned: bool,
}

#[derive(Debug)]
struct Pass {
    shader: Arc<Shader>,
    pipeline: Arc<Pipeline>,
    /// Made when all textures are bound; dropped when one of them changes.
    group: Option<wgpu::BindGroup>,
    inputs: Vec<u32>,
    outputs: Vec<u32>,
    workgroups: [u32; 3],
    size: [i32; 2],
    grid_at: u64,
    params_at: u64,
}

/// A [`Program`] ready to be recorded, again and again. Its scratch textures go back to the
/// executor's pool when it is dropped.
///
/// One submission may hold the commands of several prepared programs, but of each only once with
/// the same uniform bytes: [`Prepared::repack`] takes effect from the next submission on, for all
/// commands in it.
#[derive(Debug)]
pub struct Prepared {
    device: Arc<Device>,
    pool: Arc<Pool>,
    slots: Vec<Slot>,
    passes: Vec<Pass>,
    uniforms: wgpu::Buffer,
    bytes: Vec<u8>,
    scratch: Vec<u8>,
    timer: Option<Timer>,
}

impl Prepared {
    pub(super) fn new(device: &Arc<Device>, pool: &Arc<Pool>, program: &Program) -> Result<Self> {
        let alignment = u64::from(device.raw.limits().min_uniform_buffer_offset_alignment);
        let mut end = 0;
        let mut place = |size: u64| {
            let at = end;
            end += size.next_multiple_of(alignment);
            at
        };
        let mut passes = Vec::with_capacity(program.dispatches.len());
        for dispatch in &program.dispatches {
            passes.push(Pass {
                shader: Arc::clone(&dispatch.shader),
                pipeline: device.pipeline(&dispatch.shader)?,
                group: None,
                inputs: dispatch.inputs.clone(),
                outputs: dispatch.outputs.clone(),
                workgroups: dispatch.workgroups,
                size: dispatch.grid.size,
                grid_at: place(size_of::<Grid>() as u64),
                params_at: place(bound_size(dispatch.params.len())),
            });
        }
        let size = end.max(alignment);
        let uniforms = device.guarded("the uniform buffer", |raw| {
            raw.create_buffer(&wgpu::BufferDescriptor {
                label: Some("isophote uniforms"),
                size,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })?;
        count(&device.counters.buffers);
        let slots = program.textures.iter().map(|t| Slot {
            role: t.role.clone(),
            format: t.format,
            size: [t.window.width(), t.window.height()],
            view: None,
            owned: false,
        });
        let mut prepared = Self {
            device: Arc::clone(device),
            pool: Arc::clone(pool),
            slots: slots.collect(),
            passes,
            uniforms,
            bytes: Vec::new(),
            scratch: vec![0; size as usize],
            timer: None,
        };
        for slot in &mut prepared.slots {
            if slot.role == Role::Transient {
                slot.view = Some(pool.take(device, slot.size, slot.format)?);
                slot.owned = true;
            }
        }
        prepared.write_uniforms(program)?;
        prepared.make_groups()?;
        Ok(prepared)
    }

    /// Binds the caller's textures by the names of the program's inputs and outputs; those not
    /// named here keep what they have, names that the program does not use are ignored.
    ///
    /// A texture's texel (0, 0) is the first pixel of the window that the program names for it, and
    /// it may be larger. Inputs may have any format that reads as unfiltered float, without their own
    /// gamma where the plan expects encoded colour; outputs need [`texture_format`](super::texture_format) of their format
    /// and the usages `STORAGE_BINDING` and `TEXTURE_BINDING`. Binding the same views again costs
    /// nothing; a changed one makes the bind groups anew that hold it.
    ///
    /// # Errors
    /// [`Error::Input`] for a texture that is too small, [`Error::Device`] for one of an unfitting
    /// format or usage.
    pub fn bind(
        &mut self,
        inputs: &[(&str, &wgpu::TextureView)],
        outputs: &[(&str, &wgpu::TextureView)],
    ) -> Result<()> {
        for index in 0..self.slots.len() {
            let wanted = match &self.slots[index].role {
                Role::Input(name) => inputs.iter().find(|(n, _)| n == name),
                Role::Output(name) => outputs.iter().find(|(n, _)| n == name),
                Role::Transient => None,
            };
            if let Some((name, view)) = wanted {
                check_size(name, view, self.slots[index].size)?;
                self.set(index, view, false);
            }
        }
        self.make_groups()
    }

    /// The view of the input of this name, on a texture of the program's own unless one is bound.
    ///
    /// # Errors
    /// [`Error::Input`] when the program has no such input, [`Error::Memory`] when there is no room.
    pub fn own_input(&mut self, name: &str) -> Result<wgpu::TextureView> {
        self.own(&Role::Input(name.to_owned()))
    }

    /// The view of the output of this name, on a texture of the program's own unless one is bound.
    /// It can be sampled, and copied from.
    ///
    /// # Errors
    /// [`Error::Input`] when the program has no such output, [`Error::Memory`] when there is no room.
    pub fn own_output(&mut self, name: &str) -> Result<wgpu::TextureView> {
        self.own(&Role::Output(name.to_owned()))
    }

    fn own(&mut self, role: &Role) -> Result<wgpu::TextureView> {
        let Some(index) = self.slots.iter().position(|s| s.role == *role) else {
            return Err(Error::Input(format!("the program has no {role:?}")));
        };
        if let Some(view) = &self.slots[index].view {
            return Ok(view.clone());
        }
        let slot = &self.slots[index];
        let view = create_texture(&self.device, slot.size, slot.format)?;
        self.set(index, &view, true);
        self.make_groups()?;
        Ok(view)
    }

    fn set(&mut self, index: usize, view: &wgpu::TextureView, owned: bool) {
        let slot = &mut self.slots[index];
        if slot.view.as_ref() == Some(view) {
            return;
        }
        slot.view = Some(view.clone());
        slot.owned = owned;
        let index = index as u32;
        for pass in &mut self.passes {
            if pass.inputs.contains(&index) || pass.outputs.contains(&index) {
                pass.group = None;
            }
        }
    }

    /// Makes the missing bind groups of all passes whose textures are there.
    fn make_groups(&mut self) -> Result<()> {
        for pass in &mut self.passes {
            let textures = || pass.inputs.iter().chain(&pass.outputs).map(|i| &self.slots[*i as usize].view);
            if pass.group.is_some() || textures().any(Option::is_none) {
                continue;
            }
            let buffer = |offset, size| {
                wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &self.uniforms,
                    offset,
                    size: NonZeroU64::new(size),
                })
            };
            let mut entries = vec![wgpu::BindGroupEntry {
                binding: 0,
                resource: buffer(pass.grid_at, size_of::<Grid>() as u64),
            }];
            if pass.shader.params_size > 0 {
                let resource = buffer(pass.params_at, bound_size(pass.shader.params_size));
                entries.push(wgpu::BindGroupEntry { binding: 1, resource });
            }
            entries.extend((2..).zip(textures().flatten()).map(|(binding, view)| wgpu::BindGroupEntry {
                binding,
                resource: wgpu::BindingResource::TextureView(view),
            }));
            if !pass.shader.filtered.is_empty() {
                let resource = wgpu::BindingResource::Sampler(self.device.sampler());
                entries.push(wgpu::BindGroupEntry { binding: SAMPLER_BINDING, resource });
            }
            let what = format!("textures of kernel '{}'", pass.shader.name);
            let group = self.device.guarded(&what, |raw| {
                raw.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some(&pass.shader.name),
                    layout: &pass.pipeline.layout,
                    entries: &entries,
                })
            })?;
            count(&self.device.counters.bind_groups);
            pass.group = Some(group);
        }
        Ok(())
    }

    /// Takes over the uniform bytes of `program`, which must have the passes and connections of the
    /// one prepared and windows no larger than its textures. Unchanged bytes are not written.
    ///
    /// # Errors
    /// [`Error::Input`] when the program does not fit; it must then be prepared anew.
    pub fn repack(&mut self, program: &Program) -> Result<()> {
        if !self.fits(program) {
            return Err(Error::Input(
                "the program has other passes or larger textures than the one prepared: prepare it anew"
                    .into(),
            ));
        }
        for (slot, texture) in self.slots.iter_mut().zip(&program.textures) {
            slot.size = [texture.window.width(), texture.window.height()];
        }
        for (pass, dispatch) in self.passes.iter_mut().zip(&program.dispatches) {
            pass.workgroups = dispatch.workgroups;
            pass.size = dispatch.grid.size;
        }
        self.write_uniforms(program)
    }

    /// True where [`Prepared::repack`] accepts `program`.
    pub fn fits(&self, program: &Program) -> bool {
        let texture_fits = |(slot, texture): (&Slot, &crate::program::Texture)| {
            let (width, height) = (texture.window.width(), texture.window.height());
            let room = slot.view.as_ref().map_or(slot.size, |v| [v.texture().width(), v.texture().height()]);
            slot.role == texture.role
                && slot.format == texture.format
                && width <= room[0]
                && height <= room[1]
        };
        let pass_fits = |(pass, dispatch): (&Pass, &crate::program::Dispatch)| {
            pass.shader == dispatch.shader
                && pass.inputs == dispatch.inputs
                && pass.outputs == dispatch.outputs
        };
        self.slots.len() == program.textures.len()
            && self.passes.len() == program.dispatches.len()
            && self.slots.iter().zip(&program.textures).all(texture_fits)
            && self.passes.iter().zip(&program.dispatches).all(pass_fits)
    }

    fn write_uniforms(&mut self, program: &Program) -> Result<()> {
        for (pass, dispatch) in self.passes.iter().zip(&program.dispatches) {
            let mut put = |at: u64, bytes: &[u8]| {
                let at = at as usize;
                self.scratch[at..at + bytes.len()].copy_from_slice(bytes);
            };
            put(pass.grid_at, bytemuck::bytes_of(&dispatch.grid));
            put(pass.params_at, &dispatch.params);
        }
        if self.scratch == self.bytes {
            return Ok(());
        }
        self.bytes.clone_from(&self.scratch);
        self.device
            .guarded("uniforms", |_| self.device.queue.write_buffer(&self.uniforms, 0, &self.bytes))?;
        count(&self.device.counters.uniform_writes);
        Ok(())
    }

    /// Records all dispatches. Nothing is submitted, and nothing created.
    ///
    /// # Errors
    /// [`Error::Input`] naming the input or output that is not bound, [`Error::Device`] when the
    /// device is lost.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        self.encode_some(encoder, 0..self.passes.len())
    }

    /// Records some of the dispatches, which are timed only together with all others.
    pub(super) fn encode_some(&self, encoder: &mut wgpu::CommandEncoder, some: Range<usize>) -> Result<()> {
        self.device.check()?;
        if let Some(slot) = self.slots.iter().find(|s| s.view.is_none()) {
            return Err(Error::Input(format!("no texture is bound to the program's {:?}", slot.role)));
        }
        let record = |compute: &mut wgpu::ComputePass<'_>, pass: &Pass| {
            let [x, y, z] = pass.workgroups;
            compute.set_pipeline(&pass.pipeline.compute);
            compute.set_bind_group(0, &pass.group, &[]);
            compute.dispatch_workgroups(x, y, z);
        };
        let Some(timer) = self.timer.as_ref().filter(|_| some.len() == self.passes.len()) else {
            let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("isophote"),
                timestamp_writes: None,
            });
            self.passes[some].iter().for_each(|pass| record(&mut compute, pass));
            return Ok(());
        };
        for (index, pass) in self.passes.iter().enumerate() {
            let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(&pass.shader.name),
                timestamp_writes: Some(timer.writes(index)),
            });
            record(&mut compute, pass);
        }
        timer.resolve(encoder);
        Ok(())
    }

    /// Starts or stops timing every dispatch. While on, each dispatch is a compute pass of its own,
    /// so that the whole takes a little longer.
    ///
    /// # Errors
    /// [`Error::NoDevice`] when the device has no timestamps.
    pub fn record_times(&mut self, on: bool) -> Result<()> {
        if on && self.timer.is_none() {
            self.timer = Some(Timer::new(&self.device, self.passes.len())?);
        } else if !on {
            self.timer = None;
        }
        Ok(())
    }

    /// Times of the dispatches of the last submission; waits for them. Empty when nothing is recorded.
    ///
    /// # Errors
    /// [`Error::Device`] when the device fails meanwhile.
    pub fn times(&self) -> Result<Vec<PassTime>> {
        let Some(timer) = &self.timer else { return Ok(Vec::new()) };
        let times = timer.read()?;
        let entry = |(pass, time): (&Pass, _)| PassTime {
            kernel: pass.shader.name.to_string(),
            time,
            pixels: pass.size[0].unsigned_abs() as u64 * pass.size[1].unsigned_abs() as u64,
        };
        Ok(self.passes.iter().zip(times).map(entry).collect())
    }

    /// Bytes of all textures made here.
    pub fn bytes(&self) -> u64 {
        let owned = self.slots.iter().filter(|s| s.owned).filter_map(|s| s.view.as_ref());
        owned.map(|v| texture_bytes(v.texture())).sum()
    }
}

impl Drop for Prepared {
    fn drop(&mut self) {
        for slot in &mut self.slots {
            if slot.role == Role::Transient
                && let Some(view) = slot.view.take()
            {
                self.pool.put(view);
            }
        }
    }
}

fn check_size(name: &str, view: &wgpu::TextureView, needed: [u32; 2]) -> Result<()> {
    let texture = view.texture();
    if texture.width() < needed[0] || texture.height() < needed[1] {
        return Err(Error::Input(format!(
            "the texture bound to '{name}' has {}x{} texels; {}x{} are needed",
            texture.width(),
            texture.height(),
            needed[0],
            needed[1]
        )));
    }
    Ok(())
}
