//! One shader: its text put together, validated, and what it says about itself.

use crate::imports::assembled;
use crate::uniform::Block;
use naga::front::wgsl::{Frontend, Options};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{ImageClass, StorageFormat, TypeInner};
use std::path::Path;

/// What reflection finds in one shader.
pub struct Shader {
    /// The complete WGSL module.
    pub source: String,
    /// Number of sampled textures.
    pub inputs: usize,
    /// Channels of the storage textures.
    pub outputs: Vec<u32>,
    /// The uniform block at binding 1; kernels without parameters have none.
    pub params: Option<Block>,
}

impl Shader {
    /// Reads the shader at `path`, with what it imports from the folder `shaders`.
    ///
    /// # Errors
    /// What is wrong, as naga says it, or the rule of the house that it breaks.
    pub fn read(shaders: &Path, path: &Path) -> Result<Self, String> {
        reflect(assembled(shaders, path)?)
    }
}

fn reflect(source: String) -> Result<Shader, String> {
    let mut options = Options::new();
    options.parse_doc_comments = true;
    let module = Frontend::new_with_options(options).parse(&source).map_err(|e| e.emit_to_string(&source))?;
    // Exactly what every WebGPU device can do: no optional capability.
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|e| e.emit_to_string(&source))?;
    let [entry] = module.entry_points.as_slice() else {
        return Err("a kernel has exactly one entry point".into());
    };
    if entry.name != "main" || entry.workgroup_size != [8, 8, 1] {
        return Err("the entry point must be `main` with @workgroup_size(8, 8)".into());
    }
    let mut bindings: Vec<_> =
        module.global_variables.iter().filter_map(|(_, v)| v.binding.map(|b| (b.binding, v.ty))).collect();
    bindings.sort();
    let mut shader = Shader { source, inputs: 0, outputs: Vec::new(), params: None };
    // The grid and the parameters; the place of parameters that a kernel has not stays empty.
    let textures = bindings.iter().filter(|(binding, _)| *binding > 1).zip(2..);
    if let Some(((binding, _), expected)) =
        textures.clone().find(|((binding, _), expected)| binding != expected)
    {
        return Err(format!("textures must be bound at 2, 3, ...: {expected} is missing before {binding}"));
    }
    if bindings.first().is_none_or(|(binding, _)| *binding != 0) {
        return Err("a kernel needs the grid, shaders/gpu/grid.wgsl".into());
    }
    if let Some((_, ty)) = bindings.iter().find(|(binding, _)| *binding == 1) {
        shader.params = Some(Block::read(&module, *ty)?);
    }
    for ((binding, ty), _) in textures {
        match &module.types[*ty].inner {
            TypeInner::Image { class: ImageClass::Sampled { .. }, .. } if shader.outputs.is_empty() => {
                shader.inputs += 1;
            }
            TypeInner::Image { class: ImageClass::Storage { format, .. }, .. } => {
                shader.outputs.push(match format {
                    StorageFormat::R32Float => 1,
                    StorageFormat::Rg32Float => 2,
                    StorageFormat::Rgba32Float => 4,
                    other => return Err(format!("storage format {other:?} is not portable enough")),
                });
            }
            other => return Err(format!("binding {binding} is not allowed to be {other:?}")),
        }
    }
    if shader.outputs.is_empty() {
        return Err("a kernel needs at least one output".into());
    }
    Ok(shader)
}
