//! Assembles every shader, validates it with naga and writes, into `OUT_DIR`, what the crate includes:
//! the WGSL text, the uniform block of each as a Rust struct, and the modules and the list of kernels.
//! A shader that is broken, or that has no Rust file of the same stem, fails the build.

#[path = "build/filtered.rs"]
mod filtered;
#[path = "build/imports.rs"]
mod imports;
#[path = "build/shader.rs"]
mod shader;
#[path = "build/uniform.rs"]
mod uniform;

use shader::Shader;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// What several shaders share, and its twins in Rust.
const SHARED: &str = "shared";

/// What only GPUs need, such as where a texture lies in the picture; it has no twins.
const GPU: &str = "gpu";

/// What only CPUs need, such as how pixels are read; it has no twins.
const SIMD: &str = "simd";

/// Group and stem of a file.
type Name = (String, String);

fn main() {
    let library = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let (shaders, twins) = (library.join("../../shaders"), library.join("src/kernels"));
    println!("cargo::rerun-if-changed={}", shaders.display());
    println!("cargo::rerun-if-changed={}", twins.display());

    let wgsl = files_in_groups(&shaders, "wgsl", GPU);
    let rust = files_in_groups(&twins, "rs", SIMD);
    let mut faults = without_twin(&wgsl, &rust);
    let mut kernels = BTreeMap::new();
    for (name, path) in &wgsl {
        println!("cargo::rerun-if-changed={}", path.display());
        if name.0 == SHARED {
            continue;
        }
        match Shader::read(&shaders, path) {
            Ok(shader) => drop(kernels.insert(name.clone(), shader)),
            Err(fault) => faults.push(format!("{}: {fault}", path.display())),
        }
    }
    // Never leave an older generated file behind for the crate to compile with.
    let target = out.join("kernels.rs");
    let _ = fs::remove_file(&target);
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
    let pairs = pairs(&shaders).expect("texts of pairs can be read");
    let text = shared_texts(&shaders, &kernels) + &generated(&kernels, &rust) + &pairs;
    fs::write(&target, text).expect("OUT_DIR is writable");
}

/// The files `DIR/<group>/<stem>.<ext>`, but for those of one group.
fn files_in_groups(dir: &Path, ext: &str, except: &str) -> BTreeMap<Name, PathBuf> {
    let mut files = BTreeMap::new();
    for group in fs::read_dir(dir).into_iter().flatten().flatten().filter(|g| g.file_name() != except) {
        for file in fs::read_dir(group.path()).into_iter().flatten().flatten() {
            let path = file.path();
            if path.extension().is_some_and(|e| e == ext) {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                files.insert((group.file_name().to_string_lossy().into_owned(), stem), path);
            }
        }
    }
    files
}

/// The files on either side that have no counterpart of their name on the other, and the stems that two groups
/// use for a kernel.
fn without_twin(wgsl: &BTreeMap<Name, PathBuf>, rust: &BTreeMap<Name, PathBuf>) -> Vec<String> {
    let mut faults = Vec::new();
    for (group, stem) in wgsl.keys().filter(|name| !rust.contains_key(name)) {
        faults.push(format!("shaders/{group}/{stem}.wgsl has no src/kernels/{group}/{stem}.rs"));
    }
    for (group, stem) in rust.keys().filter(|name| !wgsl.contains_key(name)) {
        faults.push(format!("src/kernels/{group}/{stem}.rs has no shaders/{group}/{stem}.wgsl"));
    }
    let mut stems = BTreeSet::new();
    for (_, stem) in wgsl.keys().filter(|(group, _)| group != SHARED) {
        if !stems.insert(stem) {
            faults.push(format!("two kernels are named {stem}"));
        }
    }
    faults
}

/// The texts that shaders share, as constants.
fn shared_texts(shaders: &Path, kernels: &BTreeMap<Name, Shader>) -> String {
    let names: BTreeSet<&String> = kernels.values().flat_map(|shader| &shader.imports).collect();
    let mut text = String::from("/// What shaders import.\npub mod imports {\n");
    for name in names {
        let wgsl = imports::imported(shaders, name).expect("it was read for a shader");
        let filtered = filtered::filtered(shaders, name).expect("it was read for a shader");
        let packed = imports::packed(shaders, name).expect("it can be read");
        let _ = write!(
            text,
            "/// `shaders/{name}.wgsl`.\npub static {}: isophote_engine::kernel::Import = \
             isophote_engine::kernel::Import {{ name: {name:?}, text: {wgsl:?}, filtered: {filtered:?}, packed: {packed:?} }};\n",
            constant(name),
        );
    }
    text.push_str("}\n");
    text
}

/// What the rows and columns of a separable window are in one dispatch, as constants: `shaders/gpu/<kernel>_pair.wgsl`.
fn pairs(shaders: &Path) -> Result<String, String> {
    let mut text = String::from("/// Rows and columns in one dispatch, by kernel.\npub mod pairs {\n");
    for file in fs::read_dir(shaders.join(GPU)).into_iter().flatten().flatten() {
        let name = file.file_name().to_string_lossy().into_owned();
        if let Some(stem) = name.strip_suffix("_pair.wgsl") {
            let imports::Text { imports, own, .. } = imports::Text::read(shaders, &file.path())?;
            let imported: Vec<String> =
                imports.iter().map(|name| format!("&super::imports::{}", constant(name))).collect();
            let _ = write!(
                text,
                "/// `shaders/gpu/{name}`.\npub mod {stem} {{\n\
                 /// What it imports.\n\
                 pub static IMPORTS: &[&isophote_engine::kernel::Import] = &[{}];\n\
                 /// Its own text.\npub const OWN: &str = {own:?};\n}}\n",
                imported.join(", ").replace("super::", "super::super::"),
            );
        }
    }
    text.push_str("}\n");
    Ok(text)
}

/// The constant that holds what is imported as `folder/name`.
fn constant(name: &str) -> String {
    name.replace('/', "_").to_uppercase()
}

/// The rest of the text of `kernels.rs`.
fn generated(kernels: &BTreeMap<Name, Shader>, rust: &BTreeMap<Name, PathBuf>) -> String {
    let mut text =
        String::from("/// WGSL text and reflected layout of every shader, by stem.\npub mod shaders {\n");
    for ((group, stem), shader) in kernels {
        let path = format!("shaders/{group}/{stem}.wgsl");
        let constants =
            shader.imports.iter().map(|name| format!("&super::super::imports::{}", constant(name)));
        let imported: Vec<String> = constants.collect();
        let _ = write!(
            text,
            "/// Reflected from `{path}`.\npub mod {stem} {{\n\
             /// Complete WGSL module.\npub const SOURCE: &str = {:?};\n\
             /// Number of sampled textures.\npub const INPUTS: usize = {};\n\
             /// Channels of the storage textures.\npub const OUTPUTS: &[u32] = &{:?};\n\
             /// Bytes of the uniform block; 0 for none.\npub const PARAMS_SIZE: usize = {};\n\
             /// What the module is put together from.\n\
             pub const PARTS: isophote_engine::kernel::Parts = isophote_engine::kernel::Parts {{\n\
             imports: &[{}],\nown: {:?},\nis_per_pixel: {},\naround: &{:?},\ncan_produce: {},\nfiltered: &{:?},\nwindowed: {:?},\ncan_lead: {} }};\n{}}}\n",
            shader.source,
            shader.inputs,
            shader.outputs,
            shader.params.as_ref().map_or(0, |block| block.size),
            imported.join(", "),
            shader.own,
            shader.is_per_pixel,
            shader.around,
            shader.can_produce,
            shader.filtered,
            shader.windowed,
            shader.can_lead,
            shader.params.as_ref().map_or_else(String::new, |block| block.rust(&path)),
        );
    }
    text.push_str("}\n");
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
