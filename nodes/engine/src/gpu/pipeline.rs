//! Compute pipelines, made once per shader and shared by everything that runs on a device.

use crate::error::Result;
use crate::program::{Format, Grid, SAMPLER_BINDING, Shader};
use std::collections::HashMap;
use std::num::NonZeroU64;
use std::sync::{Arc, Mutex, PoisonError};

/// A format of a program in the words of wgpu.
pub fn texture_format(format: Format) -> wgpu::TextureFormat {
    match format {
        Format::R32 => wgpu::TextureFormat::R32Float,
        Format::Rg32 => wgpu::TextureFormat::Rg32Float,
        Format::Rgba32 => wgpu::TextureFormat::Rgba32Float,
        Format::Rgba16 => wgpu::TextureFormat::Rgba16Float,
    }
}

/// Bytes that a uniform block of `params` bytes is bound with: WGSL rounds a struct's size up to
/// its alignment, which is at most 16.
pub(super) fn bound_size(params: usize) -> u64 {
    params.next_multiple_of(16) as u64
}

/// The constant of shaders that can hold windows of neighbours in workgroup memory.
const SHARED_WINDOWS: &str = "shared_windows";

#[derive(Debug)]
pub(super) struct Pipeline {
    pub compute: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
}

#[derive(Debug, Default)]
pub(super) struct Pipelines(Mutex<HashMap<Arc<Shader>, Arc<Pipeline>>>);

impl Pipelines {
    /// The pipeline of `shader`, made at the first request.
    pub fn get(
        &self,
        shader: &Arc<Shader>,
        create: impl FnOnce() -> Result<Pipeline>,
    ) -> Result<Arc<Pipeline>> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = known.get(shader) {
            return Ok(Arc::clone(pipeline));
        }
        let pipeline = Arc::new(create()?);
        known.insert(Arc::clone(shader), Arc::clone(&pipeline));
        Ok(pipeline)
    }
}

/// Compiles `shader`, which holds windows of neighbours in workgroup memory where it can and
/// `shared_windows` says so.
pub(super) fn create(device: &wgpu::Device, shader: &Shader, shared_windows: bool) -> Pipeline {
    // A shader must not be given constants that it does not declare.
    let has_windows = shader.source.contains(&format!("override {SHARED_WINDOWS}:"));
    let constants = [(SHARED_WINDOWS, f64::from(u8::from(shared_windows)))];
    let constants = if has_windows { &constants[..] } else { &[] };
    let label = Some(shader.name.as_ref());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label,
        source: wgpu::ShaderSource::Wgsl(shader.source.as_ref().into()),
    });
    let layout = device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries(shader) });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &[Some(&layout)],
        ..Default::default()
    });
    let compute = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions {
            constants,
            // Kernels read no workgroup memory that they have not written.
            zero_initialize_workgroup_memory: false,
        },
        cache: None,
    });
    Pipeline { compute, layout }
}

fn entries(shader: &Shader) -> Vec<wgpu::BindGroupLayoutEntry> {
    let uniform = |size: u64| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: NonZeroU64::new(size),
    };
    let sampled = |filterable| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let mut types = vec![(0, uniform(size_of::<Grid>() as u64))];
    if shader.params_size > 0 {
        types.push((1, uniform(bound_size(shader.params_size))));
    }
    let first_output = 2 + shader.inputs as u32;
    let inputs = (0..shader.inputs).map(|input| sampled(shader.filtered.contains(&input)));
    types.extend((2..first_output).zip(inputs));
    types.extend((first_output..).zip(shader.outputs.iter()).map(|(binding, format)| {
        let storage = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: texture_format(*format),
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        (binding, storage)
    }));
    if !shader.filtered.is_empty() {
        types.push((SAMPLER_BINDING, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)));
    }
    let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    types.into_iter().map(entry).collect()
}
