//! `isophote-header [--check]`, run by `cargo xtask header`: writes `include/isophote.h` from the Rust
//! declarations.
//!
//! The header is committed, so that nobody needs this tool to use the library; `--check` compares
//! instead of writing, and fails when the two have drifted apart.

use cbindgen::{Builder, Config, DocumentationStyle, Language};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

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

/// Why the header was not written, or is not true.
#[derive(Debug, thiserror::Error)]
enum Error {
    #[error("cannot read the declarations: {0}")]
    Declarations(#[from] cbindgen::Error),
    #[error("the header is not text: {0}")]
    Text(#[from] std::string::FromUtf8Error),
    #[error("cannot read or write {}: {source}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    #[error(
        "include/isophote.h is not what include/rust declares, from line {0} on: run `cargo xtask header`"
    )]
    Stale(usize),
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let check = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => false,
        ["--check"] => true,
        _ => {
            eprintln!("usage: isophote-header [--check]");
            return ExitCode::from(2);
        }
    };
    match run(check) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-header: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the header or, with `check`, compares it.
fn run(check: bool) -> Result<(), Error> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = root.join("include/isophote.h");
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::File { path, source }
    };
    let text = generate(&root)?;
    if !check {
        let beside = target.with_extension("h.new");
        fs::write(&beside, text).map_err(at(&beside))?;
        return fs::rename(&beside, &target).map_err(at(&target));
    }
    let found = fs::read_to_string(&target).map_err(at(&target))?;
    if found == text {
        return Ok(());
    }
    Err(Error::Stale(found.lines().zip(text.lines()).take_while(|(a, b)| a == b).count() + 1))
}

fn generate(root: &Path) -> Result<String, Error> {
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
    let bindings = builder.generate()?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    Ok(String::from_utf8(text)?)
}
