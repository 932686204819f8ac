//! Workspaces of their own: their locks name all that the library imports, or no build that keeps to them succeeds.

use super::root;

/// Locks of workspaces that the library is built in, too.
const LOCKS: [&str; 2] = ["nodes/bevy/Cargo.lock", "nodes/godot/Cargo.lock"];
/// Crates of the library, with their folders.
const CRATES: [(&str, &str); 3] = [
    ("isophote", "nodes/library"),
    ("isophote-engine", "nodes/engine"),
    ("isophote-cryptomatte", "nodes/cryptomatte"),
];

/// Names of what a manifest imports, for itself and for its build, whatever its features.
fn imports(manifest: &str) -> Vec<&str> {
    let tables = manifest.split("\n[").filter(|table| {
        ["dependencies]", "build-dependencies]"].iter().any(|title| table.starts_with(title))
    });
    let lines =
        tables.flat_map(|table| table.lines().skip(1)).filter(|line| !line.contains("optional = true"));
    let names = lines.filter_map(|line| line.split(['.', ' ']).next());
    names.filter(|name| !name.is_empty() && !name.starts_with('#')).collect()
}

/// What a lock says that a crate imports.
fn locked<'l>(lock: &'l str, name: &str) -> Option<&'l str> {
    lock.split("[[package]]").find(|package| package.contains(&format!("\nname = \"{name}\"\n")))
}

#[test]
fn locks_of_other_workspaces_name_what_the_library_imports() {
    let mut missing = Vec::new();
    for path in LOCKS {
        let lock = std::fs::read_to_string(root().join(path)).unwrap();
        for (name, folder) in CRATES {
            let manifest = std::fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
            let known = locked(&lock, name).unwrap_or_default();
            let is_missing = |import: &&str| {
                !known.contains(&format!("\"{import}\"")) && !known.contains(&format!("\"{import} "))
            };
            missing.extend(
                imports(&manifest).into_iter().filter(is_missing).map(|i| format!("{path}: {name}: {i}")),
            );
            if known.is_empty() {
                missing.push(format!("{path}: {name}"));
            }
        }
    }
    assert!(missing.is_empty(), "run cargo in those folders without --locked:\n{}", missing.join("\n"));
}
