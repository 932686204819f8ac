//! `cargo xtask header`: writes `include/isophote.h` from the Rust declarations.
//!
//! The header is committed, so that nobody needs this tool to use the library; `--check` compares
//! instead of writing, and fails when the two have drifted apart.

use crate::error::{Context, Failure, Result};
use cbindgen::{Builder, Config, DocumentationStyle, Language};
use clap::Args;
use std::fs;
use std::path::Path;

/// Options of the chore.
#[derive(Args)]
pub struct Options {
    /// Compare with the committed header instead of writing it
    #[arg(long)]
    pub check: bool,
}

/// The files that declare the contract, in the order of the header.
const SOURCES: [&str; 4] = [
    "include/rust/constants.rs",
    "include/rust/types.rs",
    "include/rust/table.rs",
    "nodes/plugin/src/abi/entry.rs",
];

const PREAMBLE: &str = "\
/* Isophote: structure-adaptive stylization filters.
 *
 * The library exports one symbol, isophote_api; look it up with dlsym or GetProcAddress, ask it for
 * ISOPHOTE_ABI_VERSION, and call everything else through the table that it returns.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */";

const WARNING: &str = "/* Generated from include/rust by `cargo xtask header`. Do not edit. */";

/// Writes or checks the header.
pub fn run(options: &Options) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = root.join("include/isophote.h");
    let text = generate(&root)?;
    if !options.check {
        let beside = target.with_extension("h.new");
        return fs::write(&beside, text)
            .and_then(|()| fs::rename(&beside, &target))
            .context(|| format!("cannot write {}", target.display()));
    }
    let found = fs::read_to_string(&target).context(|| format!("cannot read {}", target.display()))?;
    if found == text {
        return Ok(());
    }
    let line = found.lines().zip(text.lines()).take_while(|(a, b)| a == b).count() + 1;
    Err(Failure(format!(
        "include/isophote.h is not what include/rust declares, from line {line} on: run `cargo xtask header`"
    )))
}

fn generate(root: &Path) -> Result<String> {
    let mut config = Config {
        language: Language::C,
        cpp_compat: true,
        header: Some(PREAMBLE.into()),
        autogen_warning: Some(WARNING.into()),
        include_guard: Some("ISOPHOTE_H".into()),
        no_includes: true,
        sys_includes: vec!["stddef.h".into(), "stdint.h".into()],
        usize_is_size_t: true,
        line_length: 100,
        documentation_style: DocumentationStyle::C99,
        ..Config::default()
    };
    // Only the documents name the type of the entry point.
    config.export.include = vec!["IsophoteEntry".into()];
    let mut builder = Builder::new().with_config(config);
    for source in SOURCES {
        builder = builder.with_src(root.join(source));
    }
    let bindings = builder.generate().context(|| "cannot read the declarations".into())?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    String::from_utf8(text).context(|| "the header is not text".into())
}
