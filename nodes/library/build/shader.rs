//! One shader: its text put together, validated, and what it says about itself.

use crate::filtered::filtered_inputs;
use crate::imports::{OF_PIXEL, STORE, Text, sampled};
use crate::uniform::Block;
use naga::front::wgsl::{Frontend, Options};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{ImageClass, Module, StorageFormat, TypeInner};
use std::path::Path;

/// The function of a shader that can be computed anywhere for the window of another kernel.
const AT_PLACE: &str = "fn at_place(p: vec2i) -> vec4f {";

/// What reflection finds in one shader.
pub struct Shader {
    /// The complete WGSL module.
    pub source: String,
    /// Names of what it imports, in order.
    pub imports: Vec<String>,
    /// Its own text, without what it imports and without an entry point that was written for it.
    pub own: String,
    /// Whether it computes each pixel from the same pixel of its textures.
    pub is_per_pixel: bool,
    /// Inputs that such a shader reads itself.
    pub around: Vec<usize>,
    /// Whether it can be computed anywhere for the window of another kernel.
    pub can_produce: bool,
    /// Inputs that are interpolated by functions of which there are filtered ones.
    pub filtered: Vec<usize>,
    /// The input of which its windows hold pixels as they are.
    pub windowed: Option<usize>,
    /// Whether it stores its only result in one place, by the usual words.
    pub can_lead: bool,
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
        let text = Text::read(shaders, path)?;
        let filtered = filtered_inputs(&text.own, shaders, &text.imports)?;
        let source = text.module()?;
        let mut options = Options::new();
        options.parse_doc_comments = true;
        let module =
            Frontend::new_with_options(options).parse(&source).map_err(|e| e.emit_to_string(&source))?;
        // Exactly what every WebGPU device can do: no optional capability.
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .map_err(|e| e.emit_to_string(&source))?;
        let (inputs, outputs, params) = bindings(&module)?;
        let stores_once = text.own.matches("textureStore(").count() == 1 && text.own.contains(STORE);
        let is_per_pixel = text.is_per_pixel();
        let around = if is_per_pixel { text.around() } else { Vec::new() };
        let can_produce = text.own.contains(AT_PLACE) && sampled(&text.own).eq(["source"]);
        let windowed = text.windowed();
        let can_lead = (is_per_pixel || stores_once) && outputs.len() == 1;
        let Text { imports, own, .. } = text;
        Ok(Self {
            source,
            imports,
            own,
            is_per_pixel,
            around,
            can_produce,
            filtered,
            windowed,
            can_lead,
            inputs,
            outputs,
            params,
        })
    }
}

/// Sampled textures, channels of the storage textures and the uniform block of a module.
fn bindings(module: &Module) -> Result<(usize, Vec<u32>, Option<Block>), String> {
    let [entry] = module.entry_points.as_slice() else {
        return Err(format!("a kernel has exactly one entry point, or `{OF_PIXEL}` in its place"));
    };
    if entry.name != "main" || entry.workgroup_size != [8, 8, 1] {
        return Err("the entry point must be `main` with @workgroup_size(8, 8)".into());
    }
    let mut bindings: Vec<_> =
        module.global_variables.iter().filter_map(|(_, v)| v.binding.map(|b| (b.binding, v.ty))).collect();
    bindings.sort();
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
    let params = bindings.iter().find(|(binding, _)| *binding == 1);
    let params = params.map(|(_, ty)| Block::read(module, *ty)).transpose()?;
    let (mut inputs, mut outputs) = (0, Vec::new());
    for ((binding, ty), _) in textures {
        match &module.types[*ty].inner {
            TypeInner::Image { class: ImageClass::Sampled { .. }, .. } if outputs.is_empty() => inputs += 1,
            TypeInner::Image { class: ImageClass::Storage { format, .. }, .. } => {
                outputs.push(match format {
                    StorageFormat::R32Float => 1,
                    StorageFormat::Rg32Float => 2,
                    StorageFormat::Rgba32Float => 4,
                    other => return Err(format!("storage format {other:?} is not portable enough")),
                });
            }
            other => return Err(format!("binding {binding} is not allowed to be {other:?}")),
        }
    }
    if outputs.is_empty() {
        return Err("a kernel needs at least one output".into());
    }
    Ok((inputs, outputs, params))
}
