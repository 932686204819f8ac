//! Assembles every shader, validates it with naga and writes, into `OUT_DIR`, what the crate includes:
//! the WGSL text, whole and in the pieces that fusion joins, the uniform block of each as a Rust struct, and the modules
//! and the list of kernels.
//! A shader that is broken, or that has no Rust file of the same stem, fails the build.

#[path = "build/directives.rs"]
mod directives;
#[path = "build/filtered.rs"]
mod filtered;
#[path = "build/generated.rs"]
mod generated;
#[path = "build/imports.rs"]
mod imports;
#[path = "build/pieces.rs"]
mod pieces;
#[path = "build/shader.rs"]
mod shader;
#[path = "build/uniform.rs"]
mod uniform;

use imports::{GPU, Name, SHARED};
use shader::Shader;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Folders for CPUs alone: how pixels are read and lines followed; they have no twins.
const CPU: [&str; 2] = ["simd", "trace"];

fn main() {
    let library = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let (shaders, twins) = (isophote_shaders::folder(), library.join("src/kernels"));
    println!("cargo::rerun-if-changed={}", shaders.display());
    println!("cargo::rerun-if-changed={}", twins.display());

    let wgsl = files_in_groups(shaders, "wgsl", &[GPU]);
    let rust = files_in_groups(&twins, "rs", &CPU);
    let mut faults = without_twin(&wgsl, &rust);
    let mut kernels = BTreeMap::new();
    for (name, path) in &wgsl {
        println!("cargo::rerun-if-changed={}", path.display());
        if name.0 == SHARED {
            continue;
        }
        match Shader::read(shaders, path) {
            Ok(shader) => drop(kernels.insert(name.clone(), shader)),
            Err(fault) => faults.push(format!("{}: {fault}", path.display())),
        }
    }
    // Never leave an older generated file behind for the crate to compile with.
    let target = out.join("kernels.rs");
    let _ = fs::remove_file(&target);
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
    let text = generated::text(shaders, &kernels, &rust);
    fs::write(&target, text.unwrap_or_else(|fault| panic!("\n{fault}\n"))).expect("OUT_DIR is writable");
}

/// The files `DIR/<group>/<stem>.<ext>`, but for those of some groups.
fn files_in_groups(dir: &Path, ext: &str, except: &[&str]) -> BTreeMap<Name, PathBuf> {
    let mut files = BTreeMap::new();
    for group in fs::read_dir(dir)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|g| !except.iter().any(|name| g.file_name() == *name))
    {
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
