//! Shaders as the driver gets them: the SPIR-V that wgpu would give it. Their constants have their defaults, which are
//! those of graphics cards.

use crate::error::{Error, Result};
use isophote::engine::program::Shader;
use isophote::kernels::KERNELS;
use naga::back::{PipelineConstants, pipeline_constants::process_overrides, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, ImageClass, Module, ShaderStage, TypeInner};

/// A shader in SPIR-V.
pub struct Spirv {
    /// The module; its entry point is `main`.
    pub words: Vec<u32>,
    /// Bindings of the shader.
    pub bindings: Vec<Binding>,
}

/// Something that a shader binds.
pub struct Binding {
    /// Its number, in group 0.
    pub number: u32,
    /// Kind of the binding.
    pub kind: BindingKind,
}

/// Kinds of what a shader can bind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BindingKind {
    /// A uniform block.
    Uniform,
    /// A texture to read.
    Sampled,
    /// A sampler.
    Sampler,
    /// A texture to write.
    Storage,
}

/// Shaders of all kernels, by name; those that read 16-bit floats in ways of their own, in these ways besides.
pub fn shaders() -> Vec<Shader> {
    let mut found: Vec<Shader> = KERNELS.iter().flat_map(|kernel| Shader::variants(kernel)).collect();
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

/// Translates a shader as wgpu does.
///
/// # Errors
/// The error of naga about the shader.
pub fn translate(shader: &Shader) -> Result<Spirv> {
    let fail = |reason: String| Error::Shader { name: shader.name.to_string(), reason };
    let module =
        naga::front::wgsl::parse_str(&shader.source).map_err(|e| fail(e.emit_to_string(&shader.source)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .validate(&module)
        .map_err(|e| fail(e.emit_to_string(&shader.source)))?;
    let entry_point = Some((ShaderStage::Compute, "main"));
    let (module, info) = process_overrides(&module, &info, entry_point, &PipelineConstants::default())
        .map_err(|e| fail(e.to_string()))?;
    let bindings = bindings(&module);
    let pipeline = spv::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: "main".into() };
    let words =
        spv::write_vec(&module, &info, &options(), Some(&pipeline)).map_err(|e| fail(e.to_string()))?;
    Ok(Spirv { words, bindings })
}

/// wgpu's options on a driver of Vulkan 1.3 that checks the bounds of buffers and images itself, as RADV does.
fn options() -> spv::Options<'static> {
    spv::Options {
        lang_version: (1, 6),
        flags: spv::WriterFlags::empty(),
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Unchecked,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
        ..spv::Options::default()
    }
}

fn bindings(module: &Module) -> Vec<Binding> {
    let found = module.global_variables.iter().filter_map(|(_, variable)| {
        let kind = match (&variable.space, &module.types[variable.ty].inner) {
            (AddressSpace::Uniform, _) => BindingKind::Uniform,
            (_, TypeInner::Image { class: ImageClass::Storage { .. }, .. }) => BindingKind::Storage,
            (_, TypeInner::Sampler { .. }) => BindingKind::Sampler,
            _ => BindingKind::Sampled,
        };
        Some(Binding { number: variable.binding.as_ref()?.binding, kind })
    });
    found.collect()
}
