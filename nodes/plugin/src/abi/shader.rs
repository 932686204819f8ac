//! Shaders of kernels in the languages that hosts ask for, translated once and kept.
//!
//! There are as many as there are kernels and languages, so that they are never freed: a host may
//! keep what it was given for as long as it likes.

use super::catalogue::lasting;
use super::failure::{Failure, Outcome};
use super::guard::lock;
use isophote::engine::program::Shader;
use isophote_abi::*;
use naga::back::pipeline_constants::process_overrides;
use naga::back::{glsl, hlsl, msl, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, ImageClass, Module, ResourceBinding, ShaderStage, TypeInner};
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex};

/// A shader that is never freed nor changed.
#[derive(Clone, Copy)]
struct Lasting(&'static IsophoteShader);

// SAFETY: all that the shader points to is leaked and constant.
unsafe impl Send for Lasting {}

static SHADERS: LazyLock<Mutex<HashMap<(String, IsophoteLanguage), Lasting>>> = LazyLock::new(Mutex::default);

/// The shader of a kernel in a language.
///
/// # Errors
/// Invalid argument for a language that is none, unsupported when it cannot express the kernel.
pub fn translated(kernel: &Shader, language: IsophoteLanguage) -> Outcome<&'static IsophoteShader> {
    if language > ISOPHOTE_LANGUAGE_GLSL {
        return Err(Failure::argument(format!("{language} is no shader language")));
    }
    if !kernel.filtered.is_empty() && !matches!(language, ISOPHOTE_LANGUAGE_WGSL | ISOPHOTE_LANGUAGE_SPIRV) {
        return Err(Failure::new(
            ISOPHOTE_ERROR_UNSUPPORTED,
            "shaders that interpolate by a sampler are offered in WGSL and SPIR-V: set ISOPHOTE_PRECISION_HALF for other \
             languages",
        ));
    }
    let key = (kernel.name.to_string(), language);
    if let Some(found) = lock(&SHADERS).get(&key) {
        return Ok(found.0);
    }
    // Not under the lock: a translation takes milliseconds, and two of the same are alike.
    let made = translate(kernel, language)?;
    let code = made.code.leak();
    let bindings: Vec<IsophoteBinding> = made
        .bindings
        .iter()
        .map(|b| IsophoteBinding { name: lasting(&b.name), binding: b.binding, kind: b.kind, slot: b.slot })
        .collect();
    let bindings = bindings.leak();
    let shader = Box::leak(Box::new(IsophoteShader {
        code: code.as_ptr().cast(),
        size: made.size,
        entry_point: lasting(&made.entry_point),
        bindings: bindings.as_ptr(),
        binding_count: bindings.len() as u32,
        language,
    }));
    Ok(lock(&SHADERS).entry(key).or_insert(Lasting(shader)).0)
}

struct Made {
    /// The code in words, so that SPIR-V is aligned; text has its closing zero in it.
    code: Vec<u32>,
    size: usize,
    entry_point: String,
    bindings: Vec<Bound>,
}

struct Bound {
    name: String,
    binding: u32,
    kind: IsophoteBindingKind,
    slot: u32,
}

impl Bound {
    fn resource(&self) -> ResourceBinding {
        ResourceBinding { group: 0, binding: self.binding }
    }
}

fn translate(kernel: &Shader, language: IsophoteLanguage) -> Outcome<Made> {
    let fail = |what: &str| refused(kernel, what);
    let (module, info, bindings) = parsed(kernel, true)?;
    let entry = module.entry_points.first().ok_or_else(|| fail("it has no entry point"))?;
    let mut made = Made { code: Vec::new(), size: 0, entry_point: entry.name.clone(), bindings };
    renumber(&mut made.bindings, language);
    let text = match language {
        ISOPHOTE_LANGUAGE_SPIRV => {
            made.code = spirv(&module, &info).map_err(|e| fail(&e))?;
            made.size = made.code.len() * 4;
            return Ok(made);
        }
        ISOPHOTE_LANGUAGE_HLSL => hlsl(&module, &info, &mut made).map_err(|e| fail(&e))?,
        ISOPHOTE_LANGUAGE_MSL => msl(&module, &info, &mut made).map_err(|e| fail(&e))?,
        ISOPHOTE_LANGUAGE_GLSL => glsl(&module, &info, &made).map_err(|e| fail(&e))?,
        _ => kernel.source.to_string(),
    };
    if language == ISOPHOTE_LANGUAGE_GLSL {
        // GLSL knows no other name.
        made.entry_point = "main".into();
    }
    made.size = text.len();
    let mut bytes = text.into_bytes();
    // The closing zero, and whole words.
    bytes.resize(bytes.len() / 4 * 4 + 4, 0);
    made.code = bytes.chunks_exact(4).map(|b| u32::from_ne_bytes([b[0], b[1], b[2], b[3]])).collect();
    Ok(made)
}

fn refused(kernel: &Shader, why: &str) -> Failure {
    Failure::new(ISOPHOTE_ERROR_UNSUPPORTED, format!("the shader of kernel '{}': {why}", kernel.name))
}

/// The kernel's module and bindings. Other languages have no constants left open, so that it is decided here whether
/// windows of neighbours are held in workgroup memory.
fn parsed(kernel: &Shader, shared_windows: bool) -> Outcome<(Module, ModuleInfo, Vec<Bound>)> {
    let fail = |what: &str| refused(kernel, what);
    let module = naga::front::wgsl::parse_str(&kernel.source).map_err(|e| fail(&e.to_string()))?;
    // The functions of WGSL that pack 16-bit floats into words need no 16-bit arithmetic.
    let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .validate(&module)
        .map_err(|e| fail(&e.to_string()))?;
    let bindings = bindings(&module);
    // Kernels without windows do not declare the constant.
    let declared = module.overrides.iter().filter_map(|(_, constant)| constant.name.as_ref());
    let windows = declared.filter(|name| *name == "shared_windows");
    let constants = windows.map(|name| (name.clone(), f64::from(u8::from(shared_windows)))).collect();
    let (module, info) =
        process_overrides(&module, &info, None, &constants).map_err(|e| fail(&e.to_string()))?;
    Ok((module.into_owned(), info.into_owned(), bindings))
}

/// SPIR-V 1.0 of a kernel in words, entry point `main`; its bindings are the kernel's. It holds windows of neighbours in
/// workgroup memory where it can and `shared_windows` says so.
///
/// # Errors
/// Unsupported when SPIR-V cannot express the kernel.
pub fn spirv_words(kernel: &Shader, shared_windows: bool) -> Outcome<Vec<u32>> {
    let (module, info, _) = parsed(kernel, shared_windows)?;
    spirv(&module, &info).map_err(|e| refused(kernel, &e))
}

/// The kernel's bindings in the order of their numbers.
fn bindings(module: &Module) -> Vec<Bound> {
    let mut found: Vec<Bound> = module
        .global_variables
        .iter()
        .filter_map(|(_, variable)| {
            let place = variable.binding.as_ref()?;
            let kind = match (&variable.space, &module.types[variable.ty].inner) {
                (AddressSpace::Uniform, _) => ISOPHOTE_BINDING_UNIFORM,
                (_, TypeInner::Image { class: ImageClass::Storage { .. }, .. }) => ISOPHOTE_BINDING_STORAGE,
                (_, TypeInner::Sampler { .. }) => ISOPHOTE_BINDING_SAMPLER,
                _ => ISOPHOTE_BINDING_SAMPLED,
            };
            let name = variable.name.clone().unwrap_or_default();
            Some(Bound { name, binding: place.binding, kind, slot: place.binding })
        })
        .collect();
    found.sort_by_key(|b| b.binding);
    found
}

/// Numbers the slots as each language has them.
fn renumber(bindings: &mut [Bound], language: IsophoteLanguage) {
    let (mut buffers, mut sampled, mut storage, mut textures) = (0, 0, 0, 0);
    let next = |counter: &mut u32| {
        *counter += 1;
        *counter - 1
    };
    for bound in bindings {
        bound.slot = match (language, bound.kind) {
            (ISOPHOTE_LANGUAGE_WGSL | ISOPHOTE_LANGUAGE_SPIRV, _) => bound.binding,
            (_, ISOPHOTE_BINDING_UNIFORM) => next(&mut buffers),
            // Metal counts all textures together.
            (ISOPHOTE_LANGUAGE_MSL, _) => next(&mut textures),
            (_, ISOPHOTE_BINDING_SAMPLED) => next(&mut sampled),
            _ => next(&mut storage),
        };
    }
}

/// Policy for reads outside an array or buffer: they give the nearest element. Kernels clamp texels themselves.
const BOUNDS: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Restrict,
    buffer: BoundsCheckPolicy::Restrict,
    image_load: BoundsCheckPolicy::Unchecked,
    binding_array: BoundsCheckPolicy::Unchecked,
};

/// Every loop of a kernel ends by the values that plans hold: compilers need no counters that prove it, which take
/// about six instructions a turn.
const BOUND_LOOPS: bool = false;

/// Kernels read no workgroup memory that they have not written.
const CLEAR_WORKGROUP_MEMORY: bool = false;

fn spirv(module: &Module, info: &ModuleInfo) -> Result<Vec<u32>, String> {
    let options = spv::Options {
        lang_version: (1, 0),
        // Compute shaders have no positions to adjust; names help in debuggers.
        flags: spv::WriterFlags::DEBUG,
        bounds_check_policies: BOUNDS,
        force_loop_bounding: BOUND_LOOPS,
        // As CLEAR_WORKGROUP_MEMORY.
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
        ..spv::Options::default()
    };
    spv::write_vec(module, info, &options, None).map_err(|e| e.to_string())
}

fn hlsl(module: &Module, info: &ModuleInfo, made: &mut Made) -> Result<String, String> {
    let target = |b: &Bound| hlsl::BindTarget { register: b.slot, ..hlsl::BindTarget::default() };
    let options = hlsl::Options {
        shader_model: hlsl::ShaderModel::V5_0,
        binding_map: made.bindings.iter().map(|b| (b.resource(), target(b))).collect(),
        fake_missing_bindings: false,
        zero_initialize_workgroup_memory: CLEAR_WORKGROUP_MEMORY,
        force_loop_bounding: BOUND_LOOPS,
        ..hlsl::Options::default()
    };
    let mut text = String::new();
    let pipeline = hlsl::PipelineOptions::default();
    let reflection = hlsl::Writer::new(&mut text, &options, &pipeline)
        .write(module, info, None)
        .map_err(|e| e.to_string())?;
    if let Some(Ok(name)) = reflection.entry_point_names.into_iter().next() {
        made.entry_point = name;
    }
    Ok(text)
}

fn msl(module: &Module, info: &ModuleInfo, made: &mut Made) -> Result<String, String> {
    let target = |b: &Bound| {
        // No kernel binds more than a dozen things.
        let slot = Some(b.slot as u8);
        let is_buffer = b.kind == ISOPHOTE_BINDING_UNIFORM;
        msl::BindTarget {
            buffer: slot.filter(|_| is_buffer),
            texture: slot.filter(|_| !is_buffer),
            mutable: b.kind == ISOPHOTE_BINDING_STORAGE,
            ..msl::BindTarget::default()
        }
    };
    let resources = msl::EntryPointResources {
        resources: made.bindings.iter().map(|b| (b.resource(), target(b))).collect(),
        ..msl::EntryPointResources::default()
    };
    let options = msl::Options {
        lang_version: (2, 0),
        per_entry_point_map: [(made.entry_point.clone(), resources)].into(),
        fake_missing_bindings: false,
        bounds_check_policies: BOUNDS,
        zero_initialize_workgroup_memory: CLEAR_WORKGROUP_MEMORY,
        force_loop_bounding: BOUND_LOOPS,
        ..msl::Options::default()
    };
    let (text, translation) = msl::write_string(module, info, &options, &msl::PipelineOptions::default())
        .map_err(|e| e.to_string())?;
    if let Some(Ok(name)) = translation.entry_point_names.into_iter().next() {
        made.entry_point = name;
    }
    Ok(text)
}

fn glsl(module: &Module, info: &ModuleInfo, made: &Made) -> Result<String, String> {
    let options = glsl::Options {
        version: glsl::Version::Desktop(430),
        writer_flags: glsl::WriterFlags::empty(),
        zero_initialize_workgroup_memory: CLEAR_WORKGROUP_MEMORY,
        binding_map: made.bindings.iter().map(|b| (b.resource(), b.slot as u8)).collect(),
    };
    let pipeline = glsl::PipelineOptions {
        shader_stage: ShaderStage::Compute,
        entry_point: made.entry_point.clone(),
        multiview: None,
    };
    let mut text = String::new();
    glsl::Writer::new(&mut text, module, info, &options, &pipeline, BOUNDS)
        .and_then(|mut writer| writer.write())
        .map_err(|e| e.to_string())?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote::engine::Rect;
    use isophote::engine::program::{Precision, Program, SAMPLER_BINDING};
    use isophote::{Graph, Planned, Request, registry};
    use std::ffi::CStr;
    use std::sync::Arc;

    /// Shaders of the nodes with their defaults.
    fn shaders(precision: Precision) -> Vec<Arc<Shader>> {
        let mut found: Vec<Arc<Shader>> = Vec::new();
        for node in registry::nodes() {
            let Ok(graph) = Graph::single(node.id) else { continue };
            let Ok(planned) = Planned::new(&graph, Request::new(64, 48)) else { continue };
            let program = Program::lower_as(planned.plan(), Rect::of_size(64, 48), precision).unwrap();
            for dispatch in program.dispatches {
                if !found.iter().any(|known| known.name == dispatch.shader.name) {
                    found.push(dispatch.shader);
                }
            }
        }
        assert!(!found.is_empty());
        found
    }

    #[test]
    fn samplers_are_offered_where_they_are_promised() {
        let filtered = shaders(Precision::Fast).into_iter().filter(|shader| !shader.filtered.is_empty());
        let filtered: Vec<Arc<Shader>> = filtered.collect();
        assert!(!filtered.is_empty());
        for shader in filtered {
            for language in [ISOPHOTE_LANGUAGE_WGSL, ISOPHOTE_LANGUAGE_SPIRV] {
                let made = translated(&shader, language).unwrap_or_else(|e| panic!("{e:?}"));
                // SAFETY: the array has the length beside it.
                let bindings =
                    unsafe { std::slice::from_raw_parts(made.bindings, made.binding_count as usize) };
                let sampler = bindings.last().unwrap();
                assert_eq!((sampler.kind, sampler.binding), (ISOPHOTE_BINDING_SAMPLER, SAMPLER_BINDING));
            }
            let refused = translated(&shader, ISOPHOTE_LANGUAGE_HLSL).map(|_| ()).unwrap_err();
            assert!(format!("{refused:?}").contains("ISOPHOTE_PRECISION_HALF"), "{refused:?}");
        }
    }

    #[test]
    fn every_kernel_speaks_every_language() {
        for kernel in [Precision::Exact, Precision::Half].into_iter().flat_map(shaders) {
            for language in ISOPHOTE_LANGUAGE_WGSL..=ISOPHOTE_LANGUAGE_GLSL {
                let shader = translated(&kernel, language).unwrap_or_else(|e| panic!("{e:?}"));
                let uniforms = 1 + usize::from(kernel.params_size > 0);
                assert_eq!(shader.binding_count as usize, uniforms + kernel.inputs + kernel.outputs.len());
                // SAFETY: the arrays have the lengths beside them, texts their closing zeros.
                let (code, bindings, entry) = unsafe {
                    (
                        std::slice::from_raw_parts(shader.code.cast::<u8>(), shader.size),
                        std::slice::from_raw_parts(shader.bindings, shader.binding_count as usize),
                        CStr::from_ptr(shader.entry_point).to_str().unwrap(),
                    )
                };
                if language == ISOPHOTE_LANGUAGE_SPIRV {
                    assert_eq!(code[..4], 0x0723_0203_u32.to_ne_bytes());
                    continue;
                }
                let text = std::str::from_utf8(code).unwrap();
                assert!(text.contains(&format!(" {entry}(")), "{}: {entry}\n{text}", kernel.name);
                for b in bindings {
                    let place = match (language, b.kind) {
                        (ISOPHOTE_LANGUAGE_WGSL, _) => format!("@binding({})", b.slot),
                        (ISOPHOTE_LANGUAGE_HLSL, ISOPHOTE_BINDING_UNIFORM) => {
                            format!("register(b{})", b.slot)
                        }
                        (ISOPHOTE_LANGUAGE_HLSL, ISOPHOTE_BINDING_SAMPLED) => {
                            format!("register(t{})", b.slot)
                        }
                        (ISOPHOTE_LANGUAGE_HLSL, _) => format!("register(u{})", b.slot),
                        (ISOPHOTE_LANGUAGE_MSL, ISOPHOTE_BINDING_UNIFORM) => {
                            format!("[[buffer({})]]", b.slot)
                        }
                        (ISOPHOTE_LANGUAGE_MSL, _) => format!("[[texture({})]]", b.slot),
                        _ => format!("binding = {}", b.slot),
                    };
                    assert!(text.contains(&place), "{}: {place} is missing in\n{text}", kernel.name);
                }
                assert!(std::ptr::eq(shader, translated(&kernel, language).unwrap()));
            }
        }
    }
}
