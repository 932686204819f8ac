//! Bind group layouts of the renderer, and short forms of the descriptors that recur.

/// Layouts of the four groups of the scene's passes.
#[derive(Debug)]
pub struct Layouts {
    /// Group 0: frame, instances, joints, morph weights, lights.
    pub frame: wgpu::BindGroupLayout,
    /// Group 1: skin influences and morph deltas of a primitive.
    pub geometry: wgpu::BindGroupLayout,
    /// Group 2: a material.
    pub material: wgpu::BindGroupLayout,
    /// Group 3: the shadow maps.
    pub shadow: wgpu::BindGroupLayout,
    /// Group 3 of the shadow pass: which map is drawn.
    pub cascade: wgpu::BindGroupLayout,
    /// Group 3 of the pass of control maps: values of the vertices.
    pub control: wgpu::BindGroupLayout,
}

impl Layouts {
    /// Makes the layouts.
    pub fn new(device: &wgpu::Device) -> Self {
        let (vertex, fragment) = (wgpu::ShaderStages::VERTEX, wgpu::ShaderStages::FRAGMENT);
        let make = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let color = wgpu::TextureSampleType::Float { filterable: true };
        let mut material = vec![uniform(0, fragment)];
        material.extend((1..6).map(|binding| texture(binding, color)));
        material.extend((6..11).map(|binding| sampler(binding, wgpu::SamplerBindingType::Filtering)));
        Self {
            frame: make(
                "frame",
                &[
                    uniform(0, vertex | fragment),
                    storage(1, vertex),
                    storage(2, vertex),
                    storage(3, vertex),
                    storage(4, fragment),
                ],
            ),
            geometry: make("geometry", &[storage(0, vertex), storage(1, vertex)]),
            material: make("material", &material),
            shadow: make("shadow", &[depth_array(0), sampler(1, wgpu::SamplerBindingType::Comparison)]),
            cascade: make("cascade", &[uniform(0, vertex)]),
            control: make("control", &[storage(0, vertex)]),
        }
    }
}

fn buffer(
    binding: u32,
    stages: wgpu::ShaderStages,
    ty: wgpu::BufferBindingType,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: stages,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

/// A uniform buffer.
pub fn uniform(binding: u32, stages: wgpu::ShaderStages) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, stages, wgpu::BufferBindingType::Uniform)
}

fn storage(binding: u32, stages: wgpu::ShaderStages) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, stages, wgpu::BufferBindingType::Storage { read_only: true })
}

/// A two-dimensional texture of the fragment stage.
pub fn texture(binding: u32, sample_type: wgpu::TextureSampleType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

/// The shadow maps.
fn depth_array(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        },
        ..texture(binding, wgpu::TextureSampleType::Depth)
    }
}

/// A sampler of the fragment stage.
pub fn sampler(binding: u32, kind: wgpu::SamplerBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Sampler(kind),
        count: None,
    }
}

/// Binds a view.
pub fn bind_view(binding: u32, view: &wgpu::TextureView) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) }
}

/// Binds a sampler.
pub fn bind_sampler(binding: u32, sampler: &wgpu::Sampler) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::Sampler(sampler) }
}

/// Binds a whole buffer.
pub fn bind_buffer(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }
}

/// A colour attachment that begins with one value and is kept.
pub fn cleared(view: &wgpu::TextureView, color: wgpu::Color) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(color), store: wgpu::StoreOp::Store },
    }
}

/// A depth attachment that begins with one value.
pub fn depth(
    view: &wgpu::TextureView,
    clear: f32,
    store: wgpu::StoreOp,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store }),
        stencil_ops: None,
    }
}
