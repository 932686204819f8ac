//! `include/isophote.h` under the compilers and standards that hosts use: C11 and C17, C++11 and C++23.

use isophote_tests::library::root;
use std::process::{Command, Output};

const WARNINGS: [&str; 4] = ["-Wall", "-Wextra", "-Werror", "-pedantic"];
/// Compilers, each for C and for C++, with the standards as the oldest of them knows their names.
const COMPILERS: [(&str, [&str; 2]); 4] = [
    ("gcc", ["-std=c11", "-std=c17"]),
    ("clang", ["-std=c11", "-std=c17"]),
    ("g++", ["-std=c++11", "-std=c++23"]),
    ("clang++", ["-std=c++11", "-std=c++2b"]),
];

/// Compiles `tests/c/header.c` without making anything of it; nothing when the compiler is missing and may be.
fn compile(compiler: &str, options: &[&str]) -> Option<Output> {
    let language = if compiler.ends_with("++") { "c++" } else { "c" };
    let source = root().join("tests/c/header.c");
    let output = Command::new(compiler)
        .args(["-fsyntax-only", "-x", language])
        .args(options)
        .arg("-I")
        .arg(root().join("include"))
        .arg(source)
        .output();
    match output {
        Ok(output) => Some(output),
        Err(e) if std::env::var_os("CI").is_some() => panic!("{compiler} is missing: {e}"),
        Err(e) => {
            eprintln!("\n*** SKIPPED: {compiler} is missing: {e} ***\n");
            None
        }
    }
}

#[test]
fn compilers_take_it_without_a_warning() {
    for (compiler, standards) in COMPILERS {
        for standard in standards {
            let Some(output) = compile(compiler, &[&WARNINGS[..], &[standard]].concat()) else { continue };
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success() && said.is_empty(), "{compiler} {standard}:\n{said}");
        }
    }
}

#[test]
fn handles_are_of_types_of_their_own() {
    for (compiler, [standard, _]) in COMPILERS {
        let Some(output) = compile(compiler, &[standard, "-DWRONG"]) else { continue };
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains("graph = plan"), "{compiler}:\n{said}");
    }
}

/// Messages of compilers that are asked for more warnings are printed, and read when the header changes.
#[test]
fn what_stricter_warnings_say_is_shown() {
    for (compiler, [standard, _]) in COMPILERS {
        let Some(output) = compile(compiler, &[standard, "-Wconversion", "-Wpadded"]) else { continue };
        println!("{compiler} {standard}:\n{}", String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success(), "{compiler}");
    }
}
