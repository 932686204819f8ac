//! Kernels as SPIR-V.

use crate::error::Error;
use naga::back::pipeline_constants::process_overrides;
use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Constant of kernels that can hold windows of neighbours in workgroup memory.
const WINDOWS: &str = "shared_windows";

/// SPIR-V 1.0 of a kernel, in bytes; its bindings are the kernel's, and its entry point is `main` as the text has it.
pub(crate) fn bytes(name: &str, source: &str) -> Result<Vec<u8>, Error> {
    let fail = |what: &dyn ToString| Error::Shader(name.to_owned(), what.to_string());
    let module = naga::front::wgsl::parse_str(source).map_err(|e| fail(&e))?;
    // The functions of WGSL that pack 16-bit floats into words need no 16-bit arithmetic.
    let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .validate(&module)
        .map_err(|e| fail(&e))?;
    let declared = module.overrides.iter().any(|(_, constant)| constant.name.as_deref() == Some(WINDOWS));
    let constants = declared.then(|| (WINDOWS.to_owned(), 1.0)).into_iter().collect();
    let (module, info) = process_overrides(&module, &info, None, &constants).map_err(|e| fail(&e))?;
    let options = spv::Options {
        lang_version: (1, 0),
        flags: spv::WriterFlags::DEBUG,
        // Kernels clamp texels themselves, their loops end by what plans hold, and they read no workgroup memory that they have
        // not written.
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            buffer: BoundsCheckPolicy::Restrict,
            image_load: BoundsCheckPolicy::Unchecked,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        force_loop_bounding: false,
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
        ..spv::Options::default()
    };
    let words = spv::write_vec(&module, &info, &options, None).map_err(|e| fail(&e))?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}
