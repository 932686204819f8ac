//! Geometry and materials of a scene on the GPU.

use glam::Vec3;

use crate::buffers::filled_buffer;
use crate::layouts::{Layouts, bind_buffer, bind_sampler, bind_view};
use crate::textures::TextureStore;
use crate::uniforms::MaterialBlock;
use isophote_files::error::{Error, Result};
use isophote_scene::{Influence, Material, MorphDelta, Primitive, Scene};

/// A primitive on the GPU.
#[derive(Debug)]
pub struct GpuPrimitive {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub index_count: u32,
    pub bind_group: wgpu::BindGroup,
    /// Middle and radius in the space of the mesh, at rest.
    pub sphere: (Vec3, f32),
    /// True where joints or morph targets move its vertices out of that sphere.
    pub deforms: bool,
}

/// Uploads one primitive.
///
/// # Errors
/// [`Error::Input`] when it is larger than a buffer of the device may be.
pub fn primitive(
    device: &wgpu::Device,
    layouts: &Layouts,
    name: &str,
    source: &Primitive,
) -> Result<GpuPrimitive> {
    let deltas: Vec<MorphDelta> = source.morph_targets.iter().flatten().copied().collect();
    let influences: &[Influence] =
        if source.influences.is_empty() { &[Influence::default()] } else { &source.influences };
    let deltas = if deltas.is_empty() { vec![MorphDelta::default()] } else { deltas };
    let make = |label, bytes: &[u8], usage| buffer(device, name, (label, bytes), usage);
    let influences = make("joints", bytemuck::cast_slice(influences), wgpu::BufferUsages::STORAGE)?;
    let deltas = make("morph targets", bytemuck::cast_slice(&deltas), wgpu::BufferUsages::STORAGE)?;
    Ok(GpuPrimitive {
        vertices: make("vertices", bytemuck::cast_slice(&source.vertices), wgpu::BufferUsages::VERTEX)?,
        indices: make("indices", bytemuck::cast_slice(&source.indices), wgpu::BufferUsages::INDEX)?,
        index_count: source.indices.len() as u32,
        sphere: source.sphere(),
        deforms: !(source.influences.is_empty() && source.morph_targets.is_empty()),
        bind_group: device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("geometry"),
            layout: &layouts.geometry,
            entries: &[bind_buffer(0, &influences), bind_buffer(1, &deltas)],
        }),
    })
}

/// Uploads data of a mesh, with a label that says what it is.
///
/// # Errors
/// [`Error::Input`] when it is larger than a buffer of the device may be.
pub fn buffer(
    device: &wgpu::Device,
    mesh: &str,
    (label, bytes): (&str, &[u8]),
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer> {
    let limits = device.limits();
    let most = if usage.contains(wgpu::BufferUsages::STORAGE) {
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    } else {
        limits.max_buffer_size
    };
    if bytes.len() as u64 > most {
        return Err(Error::input(
            format!("mesh '{mesh}'"),
            format!("has {} bytes of {label}, more than this device takes at once ({most})", bytes.len()),
            "split the mesh",
        ));
    }
    Ok(filled_buffer(device, label, bytes, usage))
}

/// Uploads one material with its textures.
///
/// # Errors
/// As [`TextureStore::get`].
pub fn material(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    layouts: &Layouts,
    textures: &mut TextureStore,
    scene: &Scene,
    source: &Material,
) -> Result<wgpu::BindGroup> {
    let block = MaterialBlock::new(source);
    let uniform = filled_buffer(device, "material", bytemuck::bytes_of(&block), wgpu::BufferUsages::UNIFORM);
    let mut bound = Vec::with_capacity(5);
    for (use_, space) in source.textures() {
        bound.push(textures.get(device, queue, scene, use_, space)?);
    }
    let mut entries = vec![bind_buffer(0, &uniform)];
    for (index, (view, sampler)) in bound.iter().enumerate() {
        entries.push(bind_view(1 + index as u32, view));
        entries.push(bind_sampler(6 + index as u32, sampler));
    }
    Ok(device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("material"),
        layout: &layouts.material,
        entries: &entries,
    }))
}
