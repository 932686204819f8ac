//! Vulkan objects of the library's on a host's device. Each destroys itself when it is dropped, which must be after the
//! commands that use it have been executed.

use super::device::{Device, format_of, refused};
use crate::abi::failure::{Failure, Outcome};
use crate::abi::shader;
use ash::vk;
use isophote::engine::program::{Format, SAMPLER_BINDING, Shader};
use isophote_abi::ISOPHOTE_ERROR_OUT_OF_MEMORY;
use std::sync::Arc;

/// An image with one level and layer, its memory and a view of it.
pub struct Texture {
    device: Arc<Device>,
    memory: vk::DeviceMemory,
    /// The image.
    pub image: vk::Image,
    /// The view of all of it.
    pub view: vk::ImageView,
}

/// The one level and layer of an image.
pub const WHOLE: vk::ImageSubresourceRange = vk::ImageSubresourceRange {
    aspect_mask: vk::ImageAspectFlags::COLOR,
    base_mip_level: 0,
    level_count: 1,
    base_array_layer: 0,
    layer_count: 1,
};

impl Texture {
    /// An image that shaders read and write, and from which can be blitted.
    ///
    /// # Errors
    /// Out of memory; what Vulkan answers.
    pub fn new(device: &Arc<Device>, size: [u32; 2], format: Format) -> Outcome<Self> {
        let what = format!("an image of {}x{} texels", size[0], size[1]);
        let fail = |e| refused(e, &what);
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format_of(format))
            .extent(vk::Extent3D { width: size[0], height: size[1], depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(
                vk::ImageUsageFlags::SAMPLED
                    | vk::ImageUsageFlags::STORAGE
                    | vk::ImageUsageFlags::TRANSFER_SRC,
            );
        let (memory, image, view) = (vk::DeviceMemory::null(), vk::Image::null(), vk::ImageView::null());
        let mut made = Self { device: Arc::clone(device), memory, image, view };
        let raw = &device.raw;
        // SAFETY: the host keeps the device; what is made is bound to memory of its own and viewed as it was created.
        unsafe {
            made.image = raw.create_image(&info, None).map_err(fail)?;
            made.memory = allocate(device, raw.get_image_memory_requirements(made.image), &what)?;
            raw.bind_image_memory(made.image, made.memory, 0).map_err(fail)?;
            let info = vk::ImageViewCreateInfo::default()
                .image(made.image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(info.format)
                .subresource_range(WHOLE);
            made.view = raw.create_image_view(&info, None).map_err(fail)?;
        }
        Ok(made)
    }
}

impl Drop for Texture {
    fn drop(&mut self) {
        // SAFETY: nothing that is executed uses it any more; what was never made is null, which is ignored.
        unsafe {
            self.device.raw.destroy_image_view(self.view, None);
            self.device.raw.destroy_image(self.image, None);
            self.device.raw.free_memory(self.memory, None);
        }
    }
}

/// Memory of a device.
///
/// # Safety
/// The device must be alive.
unsafe fn allocate(device: &Device, needed: vk::MemoryRequirements, what: &str) -> Outcome<vk::DeviceMemory> {
    let Some(index) = device.memory_type(needed.memory_type_bits) else {
        let message = format!("{what}: the graphics device has no memory for it");
        return Err(Failure::new(ISOPHOTE_ERROR_OUT_OF_MEMORY, message));
    };
    let info = vk::MemoryAllocateInfo::default().allocation_size(needed.size).memory_type_index(index);
    // SAFETY: as the caller promised.
    unsafe { device.raw.allocate_memory(&info, None) }.map_err(|e| refused(e, what))
}

/// The uniform blocks of all passes, which commands write and shaders read.
pub struct Uniforms {
    device: Arc<Device>,
    memory: vk::DeviceMemory,
    /// The buffer.
    pub buffer: vk::Buffer,
}

impl Uniforms {
    /// A buffer of `size` bytes.
    ///
    /// # Errors
    /// Out of memory; what Vulkan answers.
    pub fn new(device: &Arc<Device>, size: u64) -> Outcome<Self> {
        const WHAT: &str = "the uniform buffer";
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        let info = vk::BufferCreateInfo::default().size(size).usage(usage);
        let (memory, buffer) = (vk::DeviceMemory::null(), vk::Buffer::null());
        let mut made = Self { device: Arc::clone(device), memory, buffer };
        let raw = &device.raw;
        // SAFETY: the host keeps the device; the memory is of the size that the buffer needs.
        unsafe {
            made.buffer = raw.create_buffer(&info, None).map_err(|e| refused(e, WHAT))?;
            made.memory = allocate(device, raw.get_buffer_memory_requirements(made.buffer), WHAT)?;
            raw.bind_buffer_memory(made.buffer, made.memory, 0).map_err(|e| refused(e, WHAT))?;
        }
        Ok(made)
    }
}

impl Drop for Uniforms {
    fn drop(&mut self) {
        // SAFETY: as for textures.
        unsafe {
            self.device.raw.destroy_buffer(self.buffer, None);
            self.device.raw.free_memory(self.memory, None);
        }
    }
}

/// The pipeline of a shader, with its layouts.
pub struct Kernel {
    device: Arc<Device>,
    /// Layout of set 0.
    pub set_layout: vk::DescriptorSetLayout,
    /// Layout of the pipeline.
    pub layout: vk::PipelineLayout,
    /// The pipeline.
    pub pipeline: vk::Pipeline,
    /// Sampler that it interpolates by, if it does; a part of the layout.
    sampler: vk::Sampler,
}

impl Kernel {
    /// Compiles `shader`. Drivers that compute on the CPU hold no windows of neighbours in workgroup memory, since they
    /// read it lane by lane.
    ///
    /// # Errors
    /// Unsupported when SPIR-V cannot express it; out of memory; what Vulkan answers.
    pub fn new(device: &Arc<Device>, shader: &Shader) -> Outcome<Self> {
        let words = shader::spirv_words(shader, !device.is_software())?;
        let what = format!("kernel '{}'", shader.name);
        let fail = |e| refused(e, &what);
        let mut bindings = bindings(shader);
        let raw = &device.raw;
        let mut made = Self {
            device: Arc::clone(device),
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
            sampler: vk::Sampler::null(),
        };
        // SAFETY: the host keeps the device and its cache; naga has validated the shader, whose bindings are these.
        unsafe {
            if !shader.filtered.is_empty() {
                made.sampler = raw.create_sampler(&linear(), None).map_err(fail)?;
            }
            let samplers = [made.sampler];
            if !shader.filtered.is_empty() {
                bindings.push(
                    vk::DescriptorSetLayoutBinding::default()
                        .binding(SAMPLER_BINDING)
                        .descriptor_type(vk::DescriptorType::SAMPLER)
                        .descriptor_count(1)
                        .stage_flags(vk::ShaderStageFlags::COMPUTE)
                        .immutable_samplers(&samplers),
                );
            }
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            made.set_layout = raw.create_descriptor_set_layout(&info, None).map_err(fail)?;
            let set_layouts = [made.set_layout];
            let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layouts);
            made.layout = raw.create_pipeline_layout(&info, None).map_err(fail)?;
            let info = vk::ShaderModuleCreateInfo::default().code(&words);
            let module = raw.create_shader_module(&info, None).map_err(fail)?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(c"main");
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(made.layout);
            let pipelines = raw.create_compute_pipelines(device.cache, &[info], None);
            raw.destroy_shader_module(module, None);
            let pipelines = pipelines.map_err(|(_, e)| fail(e))?;
            made.pipeline = pipelines.first().copied().unwrap_or_default();
        }
        Ok(made)
    }
}

impl Drop for Kernel {
    fn drop(&mut self) {
        // SAFETY: as for textures.
        unsafe {
            self.device.raw.destroy_pipeline(self.pipeline, None);
            self.device.raw.destroy_pipeline_layout(self.layout, None);
            self.device.raw.destroy_descriptor_set_layout(self.set_layout, None);
            self.device.raw.destroy_sampler(self.sampler, None);
        }
    }
}

/// A sampler that is linear in both directions and clamped to the edge, without mip levels.
fn linear() -> vk::SamplerCreateInfo<'static> {
    const EDGE: vk::SamplerAddressMode = vk::SamplerAddressMode::CLAMP_TO_EDGE;
    vk::SamplerCreateInfo::default()
        .mag_filter(vk::Filter::LINEAR)
        .min_filter(vk::Filter::LINEAR)
        .address_mode_u(EDGE)
        .address_mode_v(EDGE)
        .address_mode_w(EDGE)
}

/// The bindings of a shader, as programs number them, but for that of a sampler.
fn bindings(shader: &Shader) -> Vec<vk::DescriptorSetLayoutBinding<'static>> {
    let uniforms = 1 + u32::from(shader.params_size > 0);
    let first_output = 2 + shader.inputs as u32;
    let types = (0..uniforms)
        .map(|binding| (binding, vk::DescriptorType::UNIFORM_BUFFER))
        .chain((2..first_output).map(|binding| (binding, vk::DescriptorType::SAMPLED_IMAGE)))
        .chain(
            (first_output..).zip(shader.outputs.iter()).map(|(b, _)| (b, vk::DescriptorType::STORAGE_IMAGE)),
        );
    types
        .map(|(binding, kind)| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::COMPUTE)
        })
        .collect()
}

/// Command buffers of an effect's own, which are used again when they have been executed.
pub struct Commands {
    device: Arc<Device>,
    pool: vk::CommandPool,
    /// Each with the value that the timeline has when it has been executed.
    buffers: Vec<(vk::CommandBuffer, u64)>,
}

impl Commands {
    /// None yet.
    ///
    /// # Errors
    /// Out of memory; what Vulkan answers.
    pub fn new(device: &Arc<Device>) -> Outcome<Self> {
        let info = vk::CommandPoolCreateInfo::default()
            .queue_family_index(device.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        // SAFETY: the host keeps the device.
        let pool = unsafe { device.raw.create_command_pool(&info, None) }
            .map_err(|e| refused(e, "a pool of command buffers"))?;
        Ok(Self { device: Arc::clone(device), pool, buffers: Vec::new() })
    }

    /// A command buffer that is in the recording state, once its last commands have been executed.
    ///
    /// # Errors
    /// Out of memory; what Vulkan answers.
    pub fn begin(&mut self, reached: u64) -> Outcome<vk::CommandBuffer> {
        let fail = |e| refused(e, "a command buffer");
        let raw = &self.device.raw;
        let buffer = match self.buffers.iter().find(|(_, value)| *value <= reached) {
            Some((buffer, _)) => *buffer,
            None => {
                let info = vk::CommandBufferAllocateInfo::default()
                    .command_pool(self.pool)
                    .level(vk::CommandBufferLevel::PRIMARY)
                    .command_buffer_count(1);
                // SAFETY: the host keeps the device; the caller has the pool for itself.
                let made = unsafe { raw.allocate_command_buffers(&info) }.map_err(fail)?;
                let buffer = made.first().copied().unwrap_or_default();
                self.buffers.push((buffer, 0));
                buffer
            }
        };
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: as above; the buffer is not being executed.
        unsafe { raw.begin_command_buffer(buffer, &info) }.map_err(fail)?;
        Ok(buffer)
    }

    /// Ends recording.
    ///
    /// # Errors
    /// Out of memory; what Vulkan answers.
    pub fn end(&self, buffer: vk::CommandBuffer) -> Outcome<()> {
        // SAFETY: the buffer is in the recording state.
        unsafe { self.device.raw.end_command_buffer(buffer) }.map_err(|e| refused(e, "a command buffer"))
    }

    /// Notes that the buffer was submitted.
    pub fn submitted(&mut self, buffer: vk::CommandBuffer, value: u64) {
        if let Some(entry) = self.buffers.iter_mut().find(|(b, _)| *b == buffer) {
            entry.1 = value;
        }
    }
}

impl Drop for Commands {
    fn drop(&mut self) {
        // SAFETY: none of its buffers is being executed any more.
        unsafe { self.device.raw.destroy_command_pool(self.pool, None) };
    }
}
