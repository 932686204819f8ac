//! A program made ready for a host's device: pipelines, intermediate images, uniforms and bindings.

use super::context::Context;
use super::device::{Device, format_of, refused};
use super::images::Given;
use super::objects::{Kernel, Texture, Uniforms};
use crate::abi::failure::{Failure, Outcome};
use ash::vk;
use isophote::engine::program::{Format, Grid, Program, Role};
use isophote_abi::*;
use std::sync::Arc;

/// An image of the program.
pub struct Slot {
    role: Role,
    format: Format,
    size: [u32; 2],
    /// The library's own: of transient images, and of outputs that are blitted to the host's.
    own: Option<Texture>,
}

/// One dispatch.
pub struct Pass {
    /// Kernel that it runs.
    pub kernel: Arc<Kernel>,
    /// Workgroups in x, y and z.
    pub workgroups: [u32; 3],
    /// True where it must wait for passes before it.
    pub waits: bool,
    inputs: Vec<u32>,
    outputs: Vec<u32>,
    grid_at: u64,
    params_at: u64,
    params_size: u64,
}

/// Bindings of all passes, for one recording at a time.
struct Bindings {
    device: Arc<Device>,
    pool: vk::DescriptorPool,
    sets: Vec<vk::DescriptorSet>,
    /// Value that the timeline has when the last recording with it has been executed.
    value: u64,
}

impl Drop for Bindings {
    fn drop(&mut self) {
        // SAFETY: no recording with it is being executed any more.
        unsafe { self.device.raw.destroy_descriptor_pool(self.pool, None) };
    }
}

/// A host's image and how a recording uses it.
#[derive(Clone, Copy)]
pub struct Port {
    /// The host's image.
    pub given: Given,
    /// The layout that it is used in.
    pub layout: vk::ImageLayout,
    /// The image to blit from, for outputs that are blitted.
    pub blit_from: Option<vk::Image>,
    /// Texels of the program's image.
    pub size: [u32; 2],
    /// Index of the program's image.
    slot: usize,
    /// View that the passes read or write.
    view: vk::ImageView,
}

/// A program ready to be recorded.
pub struct Passes {
    context: Arc<Context>,
    slots: Vec<Slot>,
    passes: Vec<Pass>,
    uniforms: Uniforms,
    bytes: Vec<u8>,
    bindings: Vec<Bindings>,
}

impl Passes {
    /// Compiles what `program` needs, and allocates its intermediate images.
    ///
    /// # Errors
    /// Geometry for images larger than the device has; those of the shaders and of memory.
    pub fn new(context: &Arc<Context>, program: &Program) -> Outcome<Self> {
        let device = &context.device;
        let limits = &device.properties.limits;
        let most = limits.max_image_dimension2_d;
        // Commands write buffers in words.
        let alignment = limits.min_uniform_buffer_offset_alignment.max(16);
        let mut end = 0;
        let mut place = |size: usize| {
            let at = end;
            end += (size as u64).next_multiple_of(alignment);
            at
        };
        let mut passes = Vec::with_capacity(program.dispatches.len());
        for dispatch in &program.dispatches {
            passes.push(Pass {
                kernel: context.kernel(&dispatch.shader)?,
                workgroups: dispatch.workgroups,
                waits: false,
                inputs: dispatch.inputs.clone(),
                outputs: dispatch.outputs.clone(),
                grid_at: place(size_of::<Grid>()),
                params_at: place(dispatch.params.len()),
                params_size: (dispatch.params.len() as u64).next_multiple_of(16),
            });
        }
        order(&mut passes);
        let uniforms = Uniforms::new(device, end.max(alignment))?;
        let mut slots = Vec::with_capacity(program.textures.len());
        for texture in &program.textures {
            let size = [texture.window.width(), texture.window.height()];
            if size[0] > most || size[1] > most {
                let [width, height] = size;
                return Err(Failure::geometry(format!(
                    "{width}x{height} texels are more than images of the device '{}' have, {most}x{most}",
                    device.name()
                )));
            }
            let is_own = texture.role == Role::Transient;
            let own = if is_own { Some(Texture::new(device, size, texture.format)?) } else { None };
            slots.push(Slot { role: texture.role.clone(), format: texture.format, size, own });
        }
        let bytes = vec![0; end as usize];
        let bindings = Vec::new();
        let mut made = Self { context: Arc::clone(context), slots, passes, uniforms, bytes, bindings };
        made.repack(program);
        Ok(made)
    }

    /// Takes over the uniform bytes of the program, whose passes are the same.
    pub fn repack(&mut self, program: &Program) {
        for (pass, dispatch) in self.passes.iter().zip(&program.dispatches) {
            let mut put = |at: u64, bytes: &[u8]| {
                let at = at as usize;
                self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
            };
            put(pass.grid_at, bytemuck::bytes_of(&dispatch.grid));
            put(pass.params_at, &dispatch.params);
        }
    }

    /// All dispatches.
    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// The uniform buffer, and what it is to hold.
    pub fn uniforms(&self) -> (vk::Buffer, &[u8]) {
        (self.uniforms.buffer, &self.bytes)
    }

    /// The intermediate images, whose contents do not survive a recording.
    pub fn own_images(&self) -> impl Iterator<Item = vk::Image> {
        self.slots.iter().filter_map(|slot| slot.own.as_ref()).map(|texture| texture.image)
    }

    /// The last value of the timeline that a recording was made for.
    pub fn last_value(&self) -> u64 {
        self.bindings.iter().map(|b| b.value).max().unwrap_or_default()
    }

    /// Finds the host's image for everything that enters and leaves.
    ///
    /// # Errors
    /// Input when one is missing or does not do; out of memory.
    pub fn ports(&mut self, images: &[Given]) -> Outcome<Vec<Port>> {
        let mut ports = Vec::new();
        for (index, slot) in self.slots.iter_mut().enumerate() {
            let name = match &slot.role {
                Role::Input(name) | Role::Output(name) => name.as_str(),
                Role::Transient => continue,
            };
            let Some(given) = images.iter().find(|given| given.name() == name) else {
                return Err(Failure::new(ISOPHOTE_ERROR_INPUT, format!("the image '{name}' is missing")));
            };
            given.must_hold(slot.size)?;
            if slot.format == Format::Rgba16 && given.input.is_some() {
                // It is read through a sampler.
                self.context.device.must_filter(given.format, name)?;
            }
            let (layout, view, blit_from) = match given.input {
                Some(_) => (given.read_layout(), given.view, None),
                None => slot.output(&self.context.device, given)?,
            };
            ports.push(Port { given: *given, layout, blit_from, size: slot.size, slot: index, view });
        }
        Ok(ports)
    }

    /// Binds the images for a recording; says which bindings it has.
    ///
    /// # Errors
    /// Out of memory, also when too many recordings are in flight.
    pub fn bind(&mut self, ports: &[Port], reached: u64) -> Outcome<usize> {
        let free = self.bindings.iter().position(|b| b.value <= reached);
        let index = match free {
            Some(index) => index,
            None if self.bindings.len() as u32 == ISOPHOTE_VULKAN_MOST_IN_FLIGHT => {
                return Err(Failure::new(
                    ISOPHOTE_ERROR_OUT_OF_MEMORY,
                    format!(
                        "{ISOPHOTE_VULKAN_MOST_IN_FLIGHT} recordings of the effect wait to be executed; the timeline \
                         stands at {reached}"
                    ),
                ));
            }
            None => {
                let made = self.new_bindings()?;
                self.bindings.push(made);
                self.bindings.len() - 1
            }
        };
        let sets = &self.bindings[index].sets;
        self.write_images(sets, |slot| {
            ports.iter().find(|port| port.slot == slot).map(|port| {
                let is_input = port.given.input.is_some();
                (port.view, if is_input { port.layout } else { vk::ImageLayout::GENERAL })
            })
        });
        Ok(index)
    }

    /// Notes the value of the timeline at which a recording has been executed; 0 when it never will be.
    pub fn recorded(&mut self, bindings: usize, value: u64) {
        self.bindings[bindings].value = value;
    }

    /// The sets of one recording, in the order of the passes.
    pub fn sets(&self, bindings: usize) -> &[vk::DescriptorSet] {
        &self.bindings[bindings].sets
    }

    /// Sets for all passes, with what no host's image is at.
    fn new_bindings(&self) -> Outcome<Bindings> {
        let device = &self.context.device;
        let fail = |e| refused(e, "the bindings of a recording");
        let count = |of: fn(&Pass) -> usize| self.passes.iter().map(of).sum::<usize>().max(1) as u32;
        let sizes = [
            (vk::DescriptorType::UNIFORM_BUFFER, count(|_| 2)),
            (vk::DescriptorType::SAMPLED_IMAGE, count(|pass| pass.inputs.len())),
            (vk::DescriptorType::STORAGE_IMAGE, count(|pass| pass.outputs.len())),
            (vk::DescriptorType::SAMPLER, count(|_| 1)),
        ]
        .map(|(kind, count)| vk::DescriptorPoolSize::default().ty(kind).descriptor_count(count));
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(count(|_| 1)).pool_sizes(&sizes);
        // SAFETY: the host keeps the device.
        let pool = unsafe { device.raw.create_descriptor_pool(&info, None) }.map_err(fail)?;
        let mut made = Bindings { device: Arc::clone(device), pool, sets: Vec::new(), value: 0 };
        let layouts: Vec<_> = self.passes.iter().map(|pass| pass.kernel.set_layout).collect();
        if !layouts.is_empty() {
            let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
            // SAFETY: as above; the pool has room for them.
            made.sets = unsafe { device.raw.allocate_descriptor_sets(&info) }.map_err(fail)?;
        }
        self.write_uniforms(&made.sets);
        self.write_images(&made.sets, |slot| {
            let is_kept = self.slots[slot].role == Role::Transient;
            let own = self.slots[slot].own.as_ref().filter(|_| is_kept);
            own.map(|texture| (texture.view, vk::ImageLayout::GENERAL))
        });
        Ok(made)
    }

    fn write_uniforms(&self, sets: &[vk::DescriptorSet]) {
        let block = |at, size| {
            [vk::DescriptorBufferInfo::default().buffer(self.uniforms.buffer).offset(at).range(size)]
        };
        for (pass, set) in self.passes.iter().zip(sets) {
            let (grid, params) =
                (block(pass.grid_at, size_of::<Grid>() as u64), block(pass.params_at, pass.params_size));
            let write = vk::WriteDescriptorSet::default()
                .dst_set(*set)
                .descriptor_type(vk::DescriptorType::UNIFORM_BUFFER);
            let writes = [write.dst_binding(0).buffer_info(&grid), write.dst_binding(1).buffer_info(&params)];
            // Kernels without parameters have no block for them.
            let count = if pass.params_size > 0 { 2 } else { 1 };
            // SAFETY: the sets are of these layouts, and no recording with them is being executed.
            unsafe { self.context.device.raw.update_descriptor_sets(&writes[..count], &[]) };
        }
    }

    /// Writes those images into the sets that `view` knows.
    fn write_images(
        &self,
        sets: &[vk::DescriptorSet],
        view: impl Fn(usize) -> Option<(vk::ImageView, vk::ImageLayout)>,
    ) {
        let mut places = Vec::new();
        let mut infos = Vec::new();
        for (pass, set) in self.passes.iter().zip(sets) {
            let inputs = pass.inputs.iter().map(|slot| (slot, vk::DescriptorType::SAMPLED_IMAGE));
            let outputs = pass.outputs.iter().map(|slot| (slot, vk::DescriptorType::STORAGE_IMAGE));
            for (binding, (slot, kind)) in (2..).zip(inputs.chain(outputs)) {
                if let Some((view, layout)) = view(*slot as usize) {
                    places.push((*set, binding, kind));
                    infos.push([vk::DescriptorImageInfo::default().image_view(view).image_layout(layout)]);
                }
            }
        }
        let mut writes = Vec::with_capacity(infos.len());
        for ((set, binding, kind), info) in places.into_iter().zip(&infos) {
            let write = vk::WriteDescriptorSet::default().dst_set(set).dst_binding(binding);
            writes.push(write.descriptor_type(kind).image_info(info));
        }
        // SAFETY: as for uniforms; the views are alive.
        unsafe { self.context.device.raw.update_descriptor_sets(&writes, &[]) };
    }
}

impl Slot {
    /// Use of a host's output, its view or one of the library's own, and the image to blit from.
    fn output(
        &mut self,
        device: &Arc<Device>,
        given: &Given,
    ) -> Outcome<(vk::ImageLayout, vk::ImageView, Option<vk::Image>)> {
        let result = format_of(self.format);
        if given.is_written_directly(result) {
            return Ok((vk::ImageLayout::GENERAL, given.view, None));
        }
        given.must_take_blits()?;
        if !device.can_blit(result, given.format) {
            return Err(Failure::new(
                ISOPHOTE_ERROR_UNSUPPORTED,
                format!(
                    "the queue family {} of the device '{}' cannot blit to an image of {:?}; give one of {result:?} \
                     with VK_IMAGE_USAGE_STORAGE_BIT and VK_IMAGE_USAGE_SAMPLED_BIT",
                    device.family,
                    device.name(),
                    given.format
                ),
            ));
        }
        if self.own.is_none() {
            self.own = Some(Texture::new(device, self.size, self.format)?);
        }
        let own = self.own.as_ref().map(|texture| (texture.view, texture.image));
        let (view, image) = own.unwrap_or_default();
        Ok((vk::ImageLayout::TRANSFER_DST_OPTIMAL, view, Some(image)))
    }
}

/// Marks the passes that must wait: those that read what was written since the last wait, or write what was used since.
fn order(passes: &mut [Pass]) {
    let (mut read, mut written) = (Vec::new(), Vec::new());
    for pass in passes {
        let is_written = |slot: &u32| written.contains(slot);
        let is_used = |slot: &u32| read.contains(slot) || written.contains(slot);
        pass.waits = pass.inputs.iter().any(is_written) || pass.outputs.iter().any(is_used);
        if pass.waits {
            read.clear();
            written.clear();
        }
        read.extend_from_slice(&pass.inputs);
        written.extend_from_slice(&pass.outputs);
    }
}
