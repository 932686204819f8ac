//! Pipelines of the two passes around a look.

use isophote::engine::gpu::wgpu;
use wgpu::{BindGroupLayoutEntry as Entry, BindingType, ShaderStages, TextureFormat, TextureSampleType};

/// Layout of bindings from 0 on, all for one stage.
pub(crate) fn layout(
    device: &wgpu::Device,
    label: &str,
    visibility: ShaderStages,
    types: &[BindingType],
) -> wgpu::BindGroupLayout {
    let entry = |(binding, ty): (u32, &BindingType)| Entry { binding, visibility, ty: *ty, count: None };
    let entries: Vec<Entry> = (0..).zip(types).map(entry).collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// A pipeline's layout of one group.
pub(crate) fn pipeline_layout(
    device: &wgpu::Device,
    label: &str,
    group: &wgpu::BindGroupLayout,
) -> wgpu::PipelineLayout {
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &[Some(group)],
        immediate_size: 0,
    })
}

/// A shader of this text.
pub(crate) fn module(device: &wgpu::Device, label: &str, text: String) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(text.into());
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source })
}

/// A uniform block.
pub(crate) const UNIFORMS: BindingType = BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};

/// A texture that is read texel by texel.
pub(crate) const fn texture(sample_type: TextureSampleType, multisampled: bool) -> BindingType {
    BindingType::Texture { sample_type, view_dimension: wgpu::TextureViewDimension::D2, multisampled }
}

/// Numbers that are not filtered.
pub(crate) const FLOATS: TextureSampleType = TextureSampleType::Float { filterable: false };

/// A texture that is written.
pub(crate) const fn written(format: TextureFormat) -> BindingType {
    BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format,
        view_dimension: wgpu::TextureViewDimension::D2,
    }
}

/// A buffer with these bytes for a uniform block.
pub(crate) fn uniforms(device: &wgpu::Device, label: &str, size: usize) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// The resources of a group, from binding 0 on.
pub(crate) fn group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    uniforms: &wgpu::Buffer,
    views: &[&wgpu::TextureView],
) -> wgpu::BindGroup {
    let first = wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() };
    let textures = (1..).zip(views).map(|(binding, view)| wgpu::BindGroupEntry {
        binding,
        resource: wgpu::BindingResource::TextureView(view),
    });
    let entries: Vec<wgpu::BindGroupEntry> = std::iter::once(first).chain(textures).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}
