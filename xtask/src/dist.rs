//! `cargo xtask dist`: all that users install, for the system and the machine that it runs on.

use crate::bundle;
use crate::error::{Context, Result};
use crate::packing;
use crate::python::{self, RELEASED};
use crate::setup::{self, C_COMPILER, NODE, PYTHON, WASM};
use crate::tools::{build_with_host, heading, program, root, run as run_command, target_dir};
use crate::web;
use std::path::PathBuf;

/// Options of `cargo xtask dist`.
#[derive(clap::Args)]
pub struct Options {
    /// Folder that the archives and their checksums go to
    #[arg(long, value_name = "DIR", default_value = "target/packages")]
    pub out: PathBuf,
    /// The profile of the build: `dev` tries the packing with what the tests have built
    #[arg(long, value_name = "NAME", default_value = RELEASED)]
    profile: String,
}

impl Options {
    /// True where binaries are not those that users get.
    pub fn is_draft(&self) -> bool {
        self.profile != RELEASED
    }
}

/// Builds all that is packed, and packs it.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &PYTHON, &WASM, &NODE])?;
    heading("build");
    // The folder of this profile has another name.
    let profile = if options.profile == "dev" { "debug" } else { &options.profile };
    build_with_host(profile, &[bundle::ICONS, packing::PACKAGE])?;
    let bundle = target_dir("packed-bundle").join(bundle::FOLDER);
    bundle::write(&bundle, profile)?;
    let icons = target_dir("packed-icons");
    std::fs::create_dir_all(&icons).context(|| format!("cannot create {}", icons.display()))?;
    run_command(program(bundle::ICONS, profile).arg("program").arg(&icons))?;
    let packed = target_dir("packed");
    heading("Python");
    python::pack(profile, &packed)?;
    web::pack(profile, &packed)?;
    heading("archives");
    let mut pack = program(packing::PACKAGE, profile);
    pack.arg("pack")
        .arg("--built")
        .arg(target_dir(profile))
        .arg("--bundle")
        .arg(bundle)
        .arg("--icons")
        .arg(icons)
        .arg("--packed")
        .arg(packed);
    pack.arg("--out").arg(root().join(&options.out)).args(options.is_draft().then_some("--draft"));
    run_command(&mut pack)
}
