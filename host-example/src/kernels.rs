//! The shaders of the library's kernels, compiled for the host's device.

use std::collections::HashMap;
use std::num::NonZeroU64;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use isophote_files::error::{AtPlace, Error, Result};
use isophote_loader::Plan;
use isophote_loader::plan::{Format, Pass, Texture};
use isophote_loader::uniforms::block_size;

/// Numbers of what was made and uploaded on a device so far. A warm frame makes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Textures, buffers, bind groups and pipelines made.
    pub objects: u64,
    /// Uploads of uniform bytes.
    pub uploads: u64,
}

/// The kernels that were compiled for a device; all runners of the device share them.
#[derive(Debug)]
pub struct Kernels {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// True where kernels hold windows of neighbours in workgroup memory, which pays on hardware alone.
    shared_windows: bool,
    sampler: wgpu::Sampler,
    /// By name, and by which of the textures that are read have half precision: samplers read no others.
    compiled: Mutex<HashMap<(String, Vec<bool>), Kernel>>,
    objects: AtomicU64,
    uploads: AtomicU64,
}

/// A compiled kernel, and what it binds.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// The pipeline.
    pub pipeline: wgpu::ComputePipeline,
    /// The layout of its only group.
    pub layout: wgpu::BindGroupLayout,
    /// Binding of a sampler, for kernels that interpolate by one.
    pub sampler: Option<u32>,
}

impl Kernels {
    /// No kernels yet. Errors that come later than the calls here are for the device's own handler.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue) -> Arc<Self> {
        let shared_windows = device.adapter_info().device_type != wgpu::DeviceType::Cpu;
        // Clamped to the edge, as samplers are unless they say otherwise.
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("stylize"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let (compiled, objects, uploads) = Default::default();
        Arc::new(Self { device, queue, shared_windows, sampler, compiled, objects, uploads })
    }

    /// The device that they are for.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The sampler of kernels that interpolate by one.
    pub fn sampler(&self) -> &wgpu::Sampler {
        &self.sampler
    }

    /// Makes an object on the device.
    ///
    /// # Errors
    /// As `make`, or [`Error::Failure`] when the device refuses or has no memory.
    pub fn make<T>(&self, make: impl FnOnce() -> Result<T>) -> Result<T> {
        self.objects.fetch_add(1, Ordering::Relaxed);
        checked(&self.device, make)
    }

    /// Uploads the bytes of a buffer.
    pub fn upload(&self, buffer: &wgpu::Buffer, bytes: &[u8]) {
        self.uploads.fetch_add(1, Ordering::Relaxed);
        self.queue.write_buffer(buffer, 0, bytes);
    }

    /// Objects made and uploads so far.
    pub fn counts(&self) -> Counts {
        let [objects, uploads] = [&self.objects, &self.uploads].map(|count| count.load(Ordering::Relaxed));
        Counts { objects, uploads }
    }

    /// The kernel of pass `index`.
    pub fn get(&self, plan: &Plan, index: u32, pass: &Pass<'_>, textures: &[Texture<'_>]) -> Result<Kernel> {
        let mut compiled = self.compiled.lock().unwrap_or_else(PoisonError::into_inner);
        let half = |at: &u32| textures.get(*at as usize).is_some_and(|t| t.format == Format::Rgba16Float);
        let key = (pass.kernel.to_owned(), pass.inputs.iter().map(half).collect());
        if let Some(kernel) = compiled.get(&key) {
            return Ok(kernel.clone());
        }
        let shader = plan.wgsl(index).map_err(refused)?;
        let label = Some(pass.kernel);
        let kernel = self.make(|| {
            let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label,
                source: wgpu::ShaderSource::Wgsl(shader.source.into()),
            });
            let entries = layout_entries(pass, textures, shader.sampler);
            let layout = self
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
            let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label,
                bind_group_layouts: &[Some(&layout)],
                ..Default::default()
            });
            // Constants may be given to shaders only that declare them.
            let constants = [("shared_windows", f64::from(u8::from(self.shared_windows)))];
            let count = usize::from(shader.source.contains("override shared_windows:"));
            let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label,
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(shader.entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants[..count],
                    // Kernels read no workgroup memory that they have not written.
                    zero_initialize_workgroup_memory: false,
                },
                cache: None,
            });
            Ok(Kernel { pipeline, layout, sampler: shader.sampler })
        })?;
        compiled.insert(key, kernel.clone());
        Ok(kernel)
    }
}

/// Bindings of a kernel, as its first pass shows them; `textures` are those of the plan, `sampler` is the binding of
/// one.
fn layout_entries(
    pass: &Pass<'_>,
    textures: &[Texture<'_>],
    sampler: Option<u32>,
) -> Vec<wgpu::BindGroupLayoutEntry> {
    let format = |at: &u32| textures.get(*at as usize).map_or(Format::Rgba32Float, |texture| texture.format);
    let uniform = |block: &[u8]| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: NonZeroU64::new(block_size(block) as u64),
    };
    let sampled = |at: &u32| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float {
            filterable: sampler.is_some() && format(at) == Format::Rgba16Float,
        },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let storage = |at: &u32| wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format: texture_format(format(at)),
        view_dimension: wgpu::TextureViewDimension::D2,
    };
    let params = Some(pass.params).filter(|p| !p.is_empty());
    let bound = pass.inputs.iter().map(sampled).chain(pass.outputs.iter().map(storage));
    let sampler = sampler.map(|at| (at, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)));
    [(0, uniform(pass.grid))]
        .into_iter()
        .chain(params.map(|p| (1, uniform(p))))
        .chain((2..).zip(bound))
        .chain(sampler)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        })
        .collect()
}

/// The format in the words of wgpu.
pub fn texture_format(format: Format) -> wgpu::TextureFormat {
    match format {
        Format::R32Float => wgpu::TextureFormat::R32Float,
        Format::Rg32Float => wgpu::TextureFormat::Rg32Float,
        Format::Rgba32Float => wgpu::TextureFormat::Rgba32Float,
        Format::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
    }
}

/// Result of `make`, or what the device has to say against it: wgpu reports errors to scopes, and panics where
/// nobody listens.
///
/// # Errors
/// As `make`, or [`Error::Failure`].
pub fn checked<T>(device: &wgpu::Device, make: impl FnOnce() -> Result<T>) -> Result<T> {
    use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
    let scopes = [Validation, Internal, OutOfMemory].map(|filter| device.push_error_scope(filter));
    let made = make();
    // Scopes end in the reverse of the order in which they began.
    let errors = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop()));
    match errors.last() {
        Some(error) => Err(Error::failure(error, "use a smaller picture or update the graphics driver")),
        None => made,
    }
}

/// Error of the library about a plan, as an error of the host.
pub fn refused(error: isophote_loader::Error) -> Error {
    error.at("the plan", "choose another style")
}

/// The error of what cannot be, unless the program is wrong.
pub fn mistaken(problem: String) -> Error {
    Error::failure(problem, "this is a mistake in the program; please report it")
}
