//! The README's program in C: compiled and run as it is printed there, on pictures that are whole and that are not.

use isophote_tests::library;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// The block of the README that begins so, without its fences.
fn block<'a>(readme: &'a str, start: &str) -> &'a str {
    let begin =
        readme.find(start).unwrap_or_else(|| panic!("the README has no block that begins with {start}"));
    let inside = &readme[begin + start.find('\n').unwrap() + 1..];
    &inside[..inside.find("```").unwrap()]
}

/// Runs a line of the README in the shell.
fn shell(folder: &Path, line: &str) -> Output {
    Command::new("sh").arg("-c").arg(line).current_dir(folder).output().unwrap()
}

#[test]
fn the_program_of_the_readme_does_what_it_says() {
    if !cfg!(unix) {
        return;
    }
    let readme = std::fs::read_to_string(library::root().join("README.md")).unwrap();
    let program = block(&readme, "```c\n");
    let lines: Vec<&str> = block(&readme, "```sh\ncc ").lines().collect();
    let &[compile, run] = lines.as_slice() else {
        panic!("a line that compiles and a line that runs: {lines:?}")
    };

    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("stylize.c"), program).unwrap();
    std::os::unix::fs::symlink(library::root().join("include").canonicalize().unwrap(), at("include"))
        .unwrap();
    let strict = format!("{compile} -Wall -Wextra -pedantic -Werror");
    for line in [compile, &strict] {
        let compiled = shell(folder.path(), line);
        assert!(compiled.status.success(), "{line}\n{}", String::from_utf8_lossy(&compiled.stderr));
    }

    // The line names the library of a build for release.
    std::fs::create_dir_all(at("target/release")).unwrap();
    std::os::unix::fs::symlink(library::path(), at("target/release/libisophote.so")).unwrap();
    let pixels = (0..101_u32).flat_map(|y| (0..150_u32).flat_map(move |x| [x * 5 % 251, y * 2, 90]));
    let mut photo = b"P6\n150 101\n255\n".to_vec();
    photo.extend(pixels.map(|v| v as u8));
    std::fs::write(at("photo.ppm"), &photo).unwrap();
    std::fs::write(at("short.ppm"), &photo[..photo.len() / 2]).unwrap();
    let ran = shell(folder.path(), run);
    let said = String::from_utf8_lossy(&ran.stderr).into_owned();
    assert!(ran.status.success() && said.is_empty(), "{said}");
    let cartoon = std::fs::read(at("cartoon.ppm")).unwrap();
    assert!(cartoon.starts_with(&photo[..15]) && cartoon.len() == photo.len());
    let changed = cartoon.iter().zip(&photo).filter(|(a, b)| a != b).count();
    assert!(changed > 1000, "{changed} samples changed");

    for (from, to, why) in [
        ("photo.ppm", "missing.ppm", "missing.ppm: cannot be read as a binary PPM file"),
        ("photo.ppm", "stylize.c", "stylize.c: cannot be read as a binary PPM file"),
        ("photo.ppm", "short.ppm", "short.ppm: is larger than memory, or ends early"),
        ("cartoon.ppm", "missing/out.ppm", "missing/out.ppm: cannot be written"),
        ("cartoon.ppm", "", "stylize: give the library, a picture and the file for the result"),
        ("target/release/libisophote.so", "missing.so", "missing.so: cannot open shared object"),
    ] {
        let line = run.replacen(from, to, 1);
        let failed = shell(folder.path(), &line);
        let said = String::from_utf8_lossy(&failed.stderr).into_owned();
        assert_eq!(failed.status.code(), Some(1), "{line}: {said}");
        assert!(said.contains(why) && said.lines().count() == 1, "{line}: {said}");
    }
}
