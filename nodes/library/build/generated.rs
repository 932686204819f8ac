//! The text of `kernels.rs`, which the crate includes: shaders, uniform blocks, modules and the list of kernels.

use crate::imports::{GPU, Name, SHARED, Text, imported, packed};
use crate::shader::{Fusible, Shader, StructParams, parse};
use crate::{filtered, pieces};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The whole text.
///
/// # Errors
/// Files that cannot be read, and rows and columns that do not fit their kernel.
pub fn text(
    shaders: &Path,
    kernels: &BTreeMap<Name, Shader>,
    rust: &BTreeMap<Name, PathBuf>,
) -> Result<String, String> {
    let mut text = shared_texts(shaders, kernels)?;
    text.push_str("/// WGSL text and reflected layout of every shader, by stem.\npub mod shaders {\n");
    text.push_str("use isophote_engine::kernel::Fusible as F;\n");
    for ((group, stem), shader) in kernels {
        text.push_str(&kernel(shaders, group, stem, shader)?);
    }
    text.push_str("}\n");
    Ok(text + &modules(kernels, rust))
}

/// The texts that shaders share, as constants.
fn shared_texts(shaders: &Path, kernels: &BTreeMap<Name, Shader>) -> Result<String, String> {
    let names: BTreeSet<&String> = kernels.values().flat_map(|shader| &shader.imports).collect();
    let mut text = String::from(
        "/// Texts that shaders import.\npub mod imports {\nuse isophote_engine::wgsl::{Import, Piece as P};\n",
    );
    for name in names {
        let cut = |text: String| rust(pieces::shared(&text).iter().map(|piece| format!("{piece:?}")));
        let other =
            |other: Option<String>| other.map_or("None".to_owned(), |text| format!("Some({})", cut(text)));
        let _ = write!(
            text,
            "/// `shaders/{name}.wgsl`.\npub static {}: Import = Import {{\nname: {name:?},\ntext: {},\nfiltered: {},\npacked: {} }};\n",
            constant(name),
            cut(imported(shaders, name)?),
            other(filtered::filtered(shaders, name)?),
            other(packed(shaders, name)?),
        );
    }
    text.push_str("}\n");
    Ok(text)
}

/// The module of one kernel.
fn kernel(shaders: &Path, group: &str, stem: &str, shader: &Shader) -> Result<String, String> {
    let path = format!("shaders/{group}/{stem}.wgsl");
    let mut text = format!(
        "/// Reflected from `{path}`.\npub mod {stem} {{\nuse isophote_engine::wgsl::{{Piece as P, Pieces}};\n\
         /// Complete WGSL module.\npub const SOURCE: &str = {:?};\n\
         /// Number of sampled textures.\npub const INPUTS: usize = {};\n\
         /// Channels of the storage textures.\npub const OUTPUTS: &[u32] = &{:?};\n\
         /// Bytes of the uniform block; 0 for none.\npub const PARAMS_SIZE: usize = {};\n\
         const OWN: &[P] = {};\n",
        shader.source,
        shader.textures.len(),
        shader.outputs,
        shader.params.as_ref().map_or(0, |block| block.size),
        rust(shader.own.iter().cloned()),
    );
    let _ = writeln!(
        text,
        "/// The module in pieces.\npub const PIECES: Pieces = Pieces {{\n\
         imports: {},\nown: OWN,\nentry: {},\ntextures: &{:?},\nfiltered: &{:?},\nwindowed: {:?} }};",
        imported_names(&shader.imports),
        rust(shader.entry.iter().cloned()),
        shader.textures,
        shader.filtered,
        shader.windowed,
    );
    text.push_str(&fusible(shaders, stem, shader)?);
    text.push_str(&shader.params.as_ref().map_or_else(String::new, |block| block.rust(&path)));
    text.push_str("}\n");
    Ok(text)
}

/// Part that a kernel can take in a dispatch of several: a constant, or, where `shaders/gpu/<kernel>_pair.wgsl` has its rows and columns in one
/// dispatch, a function of the test which passes are such.
fn fusible(shaders: &Path, stem: &str, shader: &Shader) -> Result<String, String> {
    let path = shaders.join(GPU).join(format!("{stem}_pair.wgsl"));
    let case = match &shader.fusible {
        Fusible::First if path.exists() => {
            let in_pair = |fault| format!("{}: {fault}", path.display());
            let text = Text::read(shaders, &path).map_err(in_pair)?;
            let block = shader.struct_params.as_ref().ok_or("windows have parameters")?;
            check_pair(&text, block).map_err(in_pair)?;
            return Ok(format!(
                "const PAIR_IMPORTS: &[&isophote_engine::wgsl::Import] = {};\n\
                 /// Part that it can take in a dispatch of several; `fits` is true for the rows and the columns of a window.\n\
                 pub const fn fusible(fits: fn(&[u8], &[u8]) -> bool) -> super::F {{\n\
                 super::F::Window(isophote_engine::kernel::Pair {{\nimports: PAIR_IMPORTS,\n\
                 block: OWN.split_at({}).1.split_at({}).0,\nown: {},\nfits }})\n}}\n",
                imported_names(&text.imports),
                block.before,
                block.pieces,
                rust(pieces::pair(&text.own).iter().map(|piece| format!("{piece:?}"))),
            ));
        }
        _ if path.exists() => {
            return Err(format!("{}: the kernel stores its only result in one place", path.display()));
        }
        Fusible::Never => "Never".to_owned(),
        Fusible::First => "First".to_owned(),
        Fusible::BeforeWindow(pieces) => format!("BeforeWindow {{ anywhere: OWN.split_at({pieces}).0 }}"),
        Fusible::SinglePixels(around) => format!("SinglePixels {{ around: &{around:?} }}"),
    };
    Ok(format!(
        "/// Part that it can take in a dispatch of several.\npub const FUSIBLE: super::F = super::F::{case};\n"
    ))
}

/// Validates rows and columns in one dispatch, with stand-ins for what the engine gives them.
fn check_pair(text: &Text, block: &StructParams) -> Result<(), String> {
    let given = "
@group(0) @binding(1) var<uniform> rows_params: Params;
@group(0) @binding(2) var<uniform> columns_params: Params;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;
fn pair_source(p: vec2i) -> vec4f { return vec4f(vec2f(p), 0.0, 1.0); }
fn pair_hold(first: vec2i, size: vec2i, index: i32) { }
";
    parse(&[&text.shared, &block.text, given, &text.own].concat()).map(drop)
}

/// The modules of kernels, and their list.
fn modules(kernels: &BTreeMap<Name, Shader>, rust: &BTreeMap<Name, PathBuf>) -> String {
    let mut text = String::new();
    let groups: BTreeSet<&str> = rust.keys().map(|(group, _)| group.as_str()).collect();
    for group in groups {
        let what = if group == SHARED { "What kernels share: the twins of" } else { "The kernels of" };
        let _ = writeln!(text, "/// {what} `shaders/{group}`.\npub mod {group} {{");
        for ((_, stem), path) in rust.iter().filter(|((of, _), _)| of == group) {
            let _ = writeln!(text, "    #[path = {path:?}]\n    pub mod {stem};");
        }
        text.push_str("}\n");
    }
    text.push_str("/// Every kernel, by group and name.\n");
    text.push_str("pub static KERNELS: &[&isophote_engine::Kernel] = &[\n");
    for (group, stem) in kernels.keys() {
        let _ = writeln!(text, "    &{group}::{stem}::KERNEL,");
    }
    text.push_str("];\n");
    text
}

/// Pieces as Rust has them.
fn rust(pieces: impl Iterator<Item = String>) -> String {
    format!("&[{}]", pieces.map(|piece| format!("P::{piece}")).collect::<Vec<_>>().join(", "))
}

/// Constants of what is imported under these names, in a module of `shaders`.
fn imported_names(names: &[String]) -> String {
    let constants = names.iter().map(|name| format!("&super::super::imports::{}", constant(name)));
    format!("&[{}]", constants.collect::<Vec<_>>().join(", "))
}

/// The constant that holds what is imported as `folder/name`.
fn constant(name: &str) -> String {
    name.replace('/', "_").to_uppercase()
}
