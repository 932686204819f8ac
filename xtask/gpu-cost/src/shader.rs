//! Shaders as the driver gets them: the SPIR-V that wgpu would give it. Their constants have their defaults, which are
//! those of graphics cards.

use crate::error::{Error, Result};
use crate::filtered::{filtered, filtered_inputs};
use crate::imports::{Text, imported, packed};
use naga::back::{PipelineConstants, pipeline_constants::process_overrides, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, ImageClass, Module, ShaderStage, TypeInner};
use std::fs;
use std::path::{Path, PathBuf};

/// Folders of `shaders` whose files are no kernels.
const NO_KERNELS: [&str; 2] = ["shared", "gpu"];

/// A kernel's shader.
pub struct Kernel {
    /// Stem of its file, and behind a stroke in which way it reads 16-bit floats.
    pub name: String,
    /// Its text, complete.
    pub source: String,
}

/// A shader in SPIR-V.
pub struct Spirv {
    /// The module; its entry point is `main`.
    pub words: Vec<u32>,
    /// What it binds.
    pub bindings: Vec<Binding>,
}

/// Something that a shader binds.
pub struct Binding {
    /// Its number, in group 0.
    pub number: u32,
    /// What it is.
    pub kind: BindingKind,
}

/// What a shader can bind.
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

/// All kernels of the folder `shaders`, by name; those that read 16-bit floats in ways of their own, in these ways besides.
///
/// # Errors
/// Files that cannot be read.
pub fn kernels(shaders: &Path) -> Result<Vec<Kernel>> {
    let mut found = Vec::new();
    for group in entries(shaders)? {
        if !group.is_dir() || NO_KERNELS.iter().any(|name| group.ends_with(name)) {
            continue;
        }
        for path in entries(&group)?.into_iter().filter(|path| path.extension().is_some_and(|e| e == "wgsl"))
        {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let variants = Text::read(shaders, &path).and_then(|text| variants(shaders, &name, &text));
            found.extend(variants.map_err(|reason| Error::Shader { name, reason })?);
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

/// A kernel as it is, and as it reads 16-bit floats.
fn variants(shaders: &Path, name: &str, text: &Text) -> std::result::Result<Vec<Kernel>, String> {
    let mut found = vec![Kernel { name: name.to_owned(), source: text.module()? }];
    let with = |other: &dyn Fn(&str) -> std::result::Result<Option<String>, String>| {
        let shared = text.imports.iter().map(|import| match other(import)? {
            Some(text) => Ok(text),
            None => imported(shaders, import),
        });
        Ok::<_, String>(shared.collect::<std::result::Result<String, String>>()? + &text.own)
    };
    if !text.is_per_pixel() && !filtered_inputs(&text.own, shaders, &text.imports)?.is_empty() {
        let source = with(&|import| filtered(shaders, import))?;
        found.push(Kernel { name: format!("{name}/filtered"), source });
    }
    if text.windowed().is_some() {
        let source = with(&|import| packed(shaders, import))?;
        let source = source.replace("@workgroup_size(8, 8)", "@workgroup_size(16, 16)");
        found.push(Kernel { name: format!("{name}/packed"), source });
    }
    Ok(found)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let at = |source| Error::File { path: folder.to_owned(), source };
    fs::read_dir(folder).map_err(at)?.map(|entry| Ok(entry.map_err(at)?.path())).collect()
}

/// Translates a kernel as wgpu does.
///
/// # Errors
/// What naga says of the shader.
pub fn translate(kernel: &Kernel) -> Result<Spirv> {
    let fail = |reason: String| Error::Shader { name: kernel.name.clone(), reason };
    let module =
        naga::front::wgsl::parse_str(&kernel.source).map_err(|e| fail(e.emit_to_string(&kernel.source)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .validate(&module)
        .map_err(|e| fail(e.emit_to_string(&kernel.source)))?;
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
