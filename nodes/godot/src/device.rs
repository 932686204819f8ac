//! Godot's rendering device, as far as looks need it.

use crate::error::Error;
use crate::spirv;
use godot::builtin::{Array, PackedByteArray, Rid};
use godot::classes::rendering_device::{
    DataFormat, SamplerFilter, ShaderStage, TextureUsageBits, UniformType,
};
use godot::classes::{
    RdSamplerState, RdShaderSpirv, RdTextureFormat, RdTextureView, RdUniform, RenderingDevice,
    RenderingServer,
};
use godot::obj::{Gd, NewGd, Singleton};
use isophote::engine::program::Format;
use std::collections::HashMap;

/// A compiled shader.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shader {
    shader: Rid,
    pipeline: Rid,
}

/// Something that a shader is given, at a binding of group 0.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Bound {
    Uniforms(Rid),
    Read(Rid),
    Written(Rid),
    Sampler(Rid),
}

/// The rendering device, and the shaders that were compiled on it.
pub(crate) struct Device {
    rd: Gd<RenderingDevice>,
    shaders: HashMap<String, Shader>,
    sampler: Option<Rid>,
}

/// The format of a program's texture.
pub(crate) fn format_of(format: Format) -> DataFormat {
    match format {
        Format::R32 => DataFormat::R32_SFLOAT,
        Format::Rg32 => DataFormat::R32G32_SFLOAT,
        Format::Rgba32 => DataFormat::R32G32B32A32_SFLOAT,
        Format::Rgba16 => DataFormat::R16G16B16A16_SFLOAT,
    }
}

impl Device {
    /// The device of the renderer; none for the Compatibility renderer, and without a display.
    pub(crate) fn of_renderer() -> Option<Self> {
        let rd = RenderingServer::singleton().get_rendering_device()?;
        Some(Self { rd, shaders: HashMap::new(), sampler: None })
    }

    /// The shader of this name, compiled when it is first named.
    pub(crate) fn shader(&mut self, name: &str, source: &str) -> Result<Shader, Error> {
        if let Some(found) = self.shaders.get(name) {
            return Ok(*found);
        }
        let mut spirv = RdShaderSpirv::new_gd();
        spirv.set_stage_bytecode(
            ShaderStage::COMPUTE,
            &PackedByteArray::from(spirv::bytes(name, source)?.as_slice()),
        );
        let shader = self.rd.shader_create_from_spirv(&spirv);
        let shader = made(shader, || format!("the shader of kernel '{name}'"))?;
        let pipeline = self.rd.compute_pipeline_create(shader);
        let pipeline = made(pipeline, || format!("the pipeline of kernel '{name}'"))?;
        let compiled = Shader { shader, pipeline };
        self.shaders.insert(name.to_owned(), compiled);
        Ok(compiled)
    }

    /// A texture that shaders write and read.
    pub(crate) fn texture(&mut self, [width, height]: [u32; 2], format: DataFormat) -> Result<Rid, Error> {
        let mut wanted = RdTextureFormat::new_gd();
        wanted.set_format(format);
        wanted.set_width(width);
        wanted.set_height(height);
        wanted.set_usage_bits(
            TextureUsageBits::SAMPLING_BIT
                | TextureUsageBits::STORAGE_BIT
                | TextureUsageBits::CAN_COPY_FROM_BIT,
        );
        let texture = self.rd.texture_create(&wanted, &RdTextureView::new_gd());
        made(texture, || format!("a texture of {width}x{height} pixels"))
    }

    /// A buffer for a uniform block of these bytes.
    pub(crate) fn uniforms(&mut self, bytes: &[u8]) -> Result<Rid, Error> {
        let size = bytes.len().next_multiple_of(16);
        let buffer = made(self.rd.uniform_buffer_create(size as u32), || "a uniform buffer".into())?;
        self.write(buffer, bytes);
        Ok(buffer)
    }

    /// Writes a uniform block anew.
    pub(crate) fn write(&mut self, buffer: Rid, bytes: &[u8]) {
        self.rd.buffer_update(buffer, 0, bytes.len() as u32, &PackedByteArray::from(bytes));
    }

    /// The sampler of plans that are fast rather than exact: linear, clamped to the border.
    pub(crate) fn sampler(&mut self) -> Result<Rid, Error> {
        if let Some(sampler) = self.sampler {
            return Ok(sampler);
        }
        let mut state = RdSamplerState::new_gd();
        state.set_min_filter(SamplerFilter::LINEAR);
        state.set_mag_filter(SamplerFilter::LINEAR);
        let sampler = made(self.rd.sampler_create(&state), || "a sampler".into())?;
        self.sampler = Some(sampler);
        Ok(sampler)
    }

    /// Resources of a shader, by the numbers of its bindings.
    pub(crate) fn set(&mut self, shader: Shader, bound: &[(u32, Bound)]) -> Result<Rid, Error> {
        let uniform = |(binding, bound): &(u32, Bound)| {
            let (kind, id) = match *bound {
                Bound::Uniforms(id) => (UniformType::UNIFORM_BUFFER, id),
                Bound::Read(id) => (UniformType::TEXTURE, id),
                Bound::Written(id) => (UniformType::IMAGE, id),
                Bound::Sampler(id) => (UniformType::SAMPLER, id),
            };
            let mut uniform = RdUniform::new_gd();
            uniform.set_uniform_type(kind);
            uniform.set_binding(*binding as i32);
            uniform.add_id(id);
            uniform
        };
        let uniforms: Array<Gd<RdUniform>> = bound.iter().map(uniform).collect();
        made(self.rd.uniform_set_create(&uniforms, shader.shader, 0), || "the textures of a kernel".into())
    }

    /// Records a dispatch. Godot puts barriers between those that depend on each other.
    pub(crate) fn dispatch(&mut self, shader: Shader, set: Rid, [x, y, z]: [u32; 3]) {
        let list = self.rd.compute_list_begin();
        self.rd.compute_list_bind_compute_pipeline(list, shader.pipeline);
        self.rd.compute_list_bind_uniform_set(list, set, 0);
        self.rd.compute_list_dispatch(list, x, y, z);
        self.rd.compute_list_end();
    }

    /// Texels of a texture, when the device is done with it.
    pub(crate) fn read(&mut self, texture: Rid) -> PackedByteArray {
        self.rd.texture_get_data(texture, 0)
    }

    /// Gives things back. Sets go with what they hold.
    pub(crate) fn free(&mut self, ids: impl IntoIterator<Item = Rid>) {
        ids.into_iter().for_each(|id| self.rd.free_rid(id));
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // A pipeline goes with its shader.
        let shaders: Vec<Rid> = self.shaders.values().map(|compiled| compiled.shader).collect();
        self.free(shaders.into_iter().chain(self.sampler));
    }
}

fn made(id: Rid, what: impl FnOnce() -> String) -> Result<Rid, Error> {
    if id.is_valid() { Ok(id) } else { Err(Error::Device(what())) }
}
