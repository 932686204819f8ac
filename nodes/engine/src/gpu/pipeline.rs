//! Compute pipelines, made once per shader and shared by everything that runs on a device.

use super::device::{Device, count};
use crate::error::Result;
use crate::kernel::Kernel;
use crate::program::Grid;
use std::collections::HashMap;
use std::num::NonZeroU64;
use std::sync::{Arc, Mutex, PoisonError};

/// Format of a texture with so many stored channels (1, 2 or 4; three are stored as four).
pub fn texture_format(channels: u32) -> wgpu::TextureFormat {
    match channels {
        1 => wgpu::TextureFormat::R32Float,
        2 => wgpu::TextureFormat::Rg32Float,
        _ => wgpu::TextureFormat::Rgba32Float,
    }
}

/// Bytes that a uniform block of `params` bytes is bound with: WGSL rounds a struct's size up to
/// its alignment, which is at most 16.
pub(super) fn bound_size(params: usize) -> u64 {
    params.next_multiple_of(16) as u64
}

#[derive(Debug)]
pub(super) struct Pipeline {
    pub compute: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
}

/// Everything of a kernel that its pipeline depends on.
#[derive(Debug, PartialEq, Eq, Hash)]
struct Key {
    shader: &'static str,
    inputs: usize,
    outputs: &'static [u32],
    params_size: usize,
}

#[derive(Debug, Default)]
pub(super) struct Pipelines(Mutex<HashMap<Key, Arc<Pipeline>>>);

impl Device {
    /// The pipeline of `kernel`, compiled at the first request.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) with the compiler's words when the shader is refused.
    pub(super) fn pipeline(&self, kernel: &'static Kernel) -> Result<Arc<Pipeline>> {
        let key = Key {
            shader: kernel.shader,
            inputs: kernel.inputs,
            outputs: kernel.outputs,
            params_size: kernel.params_size,
        };
        let mut known = self.pipelines.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = known.get(&key) {
            return Ok(Arc::clone(pipeline));
        }
        let what = format!("kernel '{}'", kernel.name);
        let pipeline = Arc::new(self.guarded(&what, |device| create(device, kernel))?);
        count(&self.counters.pipelines);
        known.insert(key, Arc::clone(&pipeline));
        Ok(pipeline)
    }
}

fn create(device: &wgpu::Device, kernel: &Kernel) -> Pipeline {
    let label = Some(kernel.name);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label,
        source: wgpu::ShaderSource::Wgsl(kernel.shader.into()),
    });
    let layout = device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries(kernel) });
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
        compilation_options: Default::default(),
        cache: None,
    });
    Pipeline { compute, layout }
}

fn entries(kernel: &Kernel) -> Vec<wgpu::BindGroupLayoutEntry> {
    let uniform = |size: u64| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: NonZeroU64::new(size),
    };
    let sampled = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let mut types = vec![(0, uniform(size_of::<Grid>() as u64))];
    if kernel.params_size > 0 {
        types.push((1, uniform(bound_size(kernel.params_size))));
    }
    let first_output = 2 + kernel.inputs as u32;
    types.extend((2..first_output).map(|binding| (binding, sampled)));
    types.extend((first_output..).zip(kernel.outputs).map(|(binding, channels)| {
        let storage = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: texture_format(*channels),
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        (binding, storage)
    }));
    let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    types.into_iter().map(entry).collect()
}
