//! Assembles every shader, validates it with naga and writes, into `OUT_DIR`, what the crate
//! includes: the WGSL text, the layout of each uniform block, and the modules and the list of
//! kernels. A shader that is broken, or that has no Rust file of the same stem, fails the build.

use naga::valid::{Capabilities, ValidationFlags, Validator};
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

/// What reflection finds in one shader.
struct Shader {
    group: String,
    source: String,
    inputs: usize,
    outputs: Vec<u32>,
    params_size: u32,
    fields: Vec<(String, u32)>,
}

fn main() {
    let library = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let shaders = library.join("../../shaders");
    println!("cargo::rerun-if-changed={}", shaders.display());
    println!("cargo::rerun-if-changed={}", library.join("src/kernels").display());

    let mut found = BTreeMap::new();
    let mut shared = BTreeSet::new();
    let mut failed = false;
    for (group, path) in files_in_groups(&shaders, "wgsl") {
        println!("cargo::rerun-if-changed={}", path.display());
        if group == SHARED {
            shared.insert(stem(&path));
        }
        if group == SHARED || group == GPU {
            continue;
        }
        let name = stem(&path);
        match assemble(&shaders, &path).and_then(|source| reflect(&group, source)) {
            Ok(shader) => {
                found.insert(name, shader);
            }
            Err(message) => {
                eprintln!("{}: {message}", path.display());
                failed = true;
            }
        }
    }
    let mut twins = BTreeMap::new();
    let mut shared_twins = BTreeMap::new();
    for (group, path) in files_in_groups(&library.join("src/kernels"), "rs") {
        match group.as_str() {
            SIMD => {}
            SHARED => drop(shared_twins.insert(stem(&path), path)),
            _ => drop(twins.insert(stem(&path), (group, path))),
        }
    }
    for name in &shared {
        if !shared_twins.contains_key(name) {
            eprintln!("shaders/{SHARED}/{name}.wgsl has no src/kernels/{SHARED}/{name}.rs");
            failed = true;
        }
    }
    for name in shared_twins.keys() {
        if !shared.contains(name) {
            eprintln!("src/kernels/{SHARED}/{name}.rs has no shaders/{SHARED}/{name}.wgsl");
            failed = true;
        }
    }
    for (name, shader) in &found {
        if twins.get(name).is_none_or(|(group, _)| *group != shader.group) {
            eprintln!("shaders/{}/{name}.wgsl has no src/kernels/{}/{name}.rs", shader.group, shader.group);
            failed = true;
        }
    }
    for (name, (group, _)) in &twins {
        if !found.contains_key(name) && !failed {
            eprintln!("src/kernels/{group}/{name}.rs has no shaders/{group}/{name}.wgsl");
            failed = true;
        }
    }
    // Never leave an older generated file behind for the crate to compile with.
    let target = out.join("kernels.rs");
    let _ = fs::remove_file(&target);
    assert!(!failed, "the shaders and their twins must be mended first");
    fs::write(&target, generated(&found, &twins, &shared_twins)).expect("OUT_DIR is writable");
}

/// The files `DIR/<group>/<stem>.<ext>`, in a fixed order.
fn files_in_groups(dir: &Path, ext: &str) -> Vec<(String, PathBuf)> {
    let mut files = Vec::new();
    for group in fs::read_dir(dir).into_iter().flatten().flatten() {
        for file in fs::read_dir(group.path()).into_iter().flatten().flatten() {
            if file.path().extension().is_some_and(|e| e == ext) {
                files.push((group.file_name().to_string_lossy().into_owned(), file.path()));
            }
        }
    }
    files.sort();
    files
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The shader's text with every `#import folder/name` replaced by `folder/name.wgsl`, each file once.
fn assemble(shaders: &Path, path: &Path) -> Result<String, String> {
    fn include(
        shaders: &Path,
        path: &Path,
        done: &mut Vec<PathBuf>,
        text: &mut String,
    ) -> Result<(), String> {
        if done.iter().any(|d| d == path) {
            return Ok(());
        }
        done.push(path.to_owned());
        let own = fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
        for line in own.lines() {
            if let Some(name) = line.strip_prefix("#import ") {
                include(shaders, &shaders.join(format!("{}.wgsl", name.trim())), done, text)?;
            } else {
                text.push_str(line);
                text.push('\n');
            }
        }
        Ok(())
    }
    let mut text = String::new();
    include(shaders, path, &mut Vec::new(), &mut text)?;
    Ok(text)
}

fn reflect(group: &str, source: String) -> Result<Shader, String> {
    let module = naga::front::wgsl::parse_str(&source).map_err(|e| e.emit_to_string(&source))?;
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
    let mut shader = Shader {
        group: group.into(),
        source,
        inputs: 0,
        outputs: Vec::new(),
        params_size: 0,
        fields: Vec::new(),
    };
    let mut bindings: Vec<_> =
        module.global_variables.iter().filter_map(|(_, v)| v.binding.map(|b| (b.binding, v))).collect();
    bindings.sort_by_key(|(binding, _)| *binding);
    for (expected, (binding, variable)) in bindings.iter().enumerate() {
        if *binding as usize != expected {
            return Err(format!("bindings must be 0, 1, 2, ...: {expected} is missing"));
        }
        match &module.types[variable.ty].inner {
            naga::TypeInner::Struct { members, span } if *binding == 1 => {
                shader.params_size = *span;
                shader.fields =
                    members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect();
            }
            naga::TypeInner::Struct { .. } if *binding == 0 => {}
            naga::TypeInner::Image { class: naga::ImageClass::Sampled { .. }, .. }
                if shader.outputs.is_empty() =>
            {
                shader.inputs += 1;
            }
            naga::TypeInner::Image { class: naga::ImageClass::Storage { format, .. }, .. } => {
                shader.outputs.push(match format {
                    naga::StorageFormat::R32Float => 1,
                    naga::StorageFormat::Rg32Float => 2,
                    naga::StorageFormat::Rgba32Float => 4,
                    other => return Err(format!("storage format {other:?} is not portable enough")),
                });
            }
            other => return Err(format!("binding {binding} is not allowed to be {other:?}")),
        }
    }
    if shader.params_size == 0 || shader.outputs.is_empty() {
        return Err("a kernel needs uniform blocks at bindings 0 and 1 and at least one output".into());
    }
    Ok(shader)
}

fn generated(
    found: &BTreeMap<String, Shader>,
    twins: &BTreeMap<String, (String, PathBuf)>,
    shared: &BTreeMap<String, PathBuf>,
) -> String {
    let mut text =
        String::from("/// WGSL text and reflected layout of every shader, by stem.\npub mod shaders {\n");
    for (name, shader) in found {
        let _ = write!(
            text,
            "/// Reflected from `shaders/{}/{name}.wgsl`.\npub mod {name} {{\n\
             /// Complete WGSL module.\npub const SOURCE: &str = {:?};\n\
             /// Number of sampled textures.\npub const INPUTS: usize = {};\n\
             /// Channels of the storage textures.\npub const OUTPUTS: &[u32] = &{:?};\n\
             /// Bytes of the uniform block.\npub const PARAMS_SIZE: usize = {};\n\
             /// Fields of the uniform block and their offsets.\npub const PARAMS: &[(&str, usize)] = &{:?};\n}}\n",
            shader.group, shader.source, shader.inputs, shader.outputs, shader.params_size, shader.fields
        );
    }
    text.push_str("}\n");
    let _ = writeln!(text, "/// What kernels share: the twins of `shaders/{SHARED}`.\npub mod {SHARED} {{");
    for (name, path) in shared {
        let _ = writeln!(text, "#[path = {path:?}]\npub mod {name};");
    }
    text.push_str("}\n");
    let mut groups: BTreeMap<&str, Vec<(&str, &Path)>> = BTreeMap::new();
    for (name, (group, path)) in twins {
        groups.entry(group).or_default().push((name, path));
    }
    for (group, kernels) in &groups {
        let _ = writeln!(text, "/// Kernels of the group `{group}`.\npub mod {group} {{");
        for (name, path) in kernels {
            let _ = writeln!(text, "#[path = {path:?}]\npub mod {name};");
        }
        text.push_str("}\n");
    }
    text.push_str(
        "/// Every kernel, by group and name.\npub static KERNELS: &[&isophote_engine::Kernel] = &[\n",
    );
    for (group, kernels) in &groups {
        for (name, _) in kernels {
            let _ = writeln!(text, "    &{group}::{name}::KERNEL,");
        }
    }
    text.push_str("];\n");
    text
}
