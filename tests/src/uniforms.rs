//! The numbers in the uniform blocks of kernels.

use isophote_engine::Kernel;
use isophote_engine::plan::Pass;
use naga::{ArraySize, Handle, Module, ScalarKind, Type, TypeInner};

/// Offsets of the floats of a kernel's uniform block, in bytes.
///
/// # Panics
/// For a shader that does not parse, which the build refuses.
pub fn floats(kernel: &Kernel) -> Vec<usize> {
    let module = match naga::front::wgsl::parse_str(kernel.shader) {
        Ok(module) => module,
        Err(error) => panic!("{}: {error}", kernel.name),
    };
    let params = module.global_variables.iter().find(|(_, global)| {
        global.binding.as_ref().is_some_and(|binding| (binding.group, binding.binding) == (0, 1))
    });
    let mut found = Vec::new();
    if let Some((_, params)) = params {
        collect(&module, params.ty, 0, &mut found);
    }
    found
}

fn collect(module: &Module, ty: Handle<Type>, at: usize, found: &mut Vec<usize>) {
    let (count, scalar) = match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => {
            for member in members {
                collect(module, member.ty, at + member.offset as usize, found);
            }
            return;
        }
        TypeInner::Array { base, size: ArraySize::Constant(count), stride } => {
            for index in 0..count.get() {
                collect(module, *base, at + (index * stride) as usize, found);
            }
            return;
        }
        TypeInner::Scalar(scalar) => (1, scalar),
        TypeInner::Vector { size, scalar } => (*size as usize, scalar),
        other => panic!("a uniform block with {other:?}"),
    };
    if scalar.kind == ScalarKind::Float {
        found.extend((0..count).map(|index| at + 4 * index));
    }
}

/// The floats at `places` of a pass that are not finite, with where they lie.
pub fn not_finite(pass: &Pass, places: &[usize]) -> Vec<(usize, f32)> {
    let read = |at: &usize| {
        let bytes = pass.params.get(*at..at + 4)?.try_into().ok()?;
        Some((*at, f32::from_le_bytes(bytes)))
    };
    places.iter().filter_map(read).filter(|(_, value)| !value.is_finite()).collect()
}
