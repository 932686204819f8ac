//! No two files and no two folders import each other, directly or around a circle, and none is taken from another package by
//! its path.

use isophote_tests::imports::{between, circles, folder_circles, taken_from_elsewhere};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn no_two_files_import_each_other() {
    let circles = circles(&root());
    assert!(
        circles.is_empty(),
        "files import each other:\n{}",
        circles.iter().map(|c| format!("{c}\n")).collect::<String>()
    );
}

#[test]
fn no_two_folders_import_each_other() {
    let circles = folder_circles(&root());
    assert!(circles.is_empty(), "folders import each other:\n{}", circles.join("\n"));
}

#[test]
fn no_file_is_taken_from_another_package() {
    let taken = taken_from_elsewhere(&root());
    assert!(taken.is_empty(), "import these by the name of their crate:\n{}", taken.join("\n"));
}

/// Holds that rooms below `source` import only those before them in the list.
fn import_only_what_stands_below(source: &str, rooms: &[&str]) {
    let root = root();
    let between = |from: &str, to: &str| {
        let [from, to] = [from, to].map(|room| format!("{source}/{room}"));
        between(&root, &from, &to)
    };
    for (at, above) in rooms.iter().enumerate() {
        let below = &rooms[..at];
        assert!(
            at == 0 || below.iter().any(|room| !between(above, room).is_empty()),
            "{above} imports nothing"
        );
        for room in below {
            let wrong = between(room, above);
            assert!(wrong.is_empty(), "{room} stands below {above}: {wrong:#?}");
        }
    }
}

#[test]
fn floors_of_the_window_import_only_what_stands_below_them() {
    let source = "host-example/window/src";
    let floors = ["state", "jobs", "drawing", "widgets", "app"];
    import_only_what_stands_below(source, &floors);
    // The window's events are in a file and a folder of one name, and nothing imports the crate's root.
    for floor in floors {
        for top in ["app.rs", "lib.rs"] {
            let wrong = between(&root(), &format!("{source}/{floor}"), &format!("{source}/{top}"));
            assert!(floor == "app" || wrong.is_empty(), "{floor} stands below {top}: {wrong:#?}");
        }
    }
    // A module beside the floors would stand on none.
    let text = std::fs::read_to_string(root().join(source).join("lib.rs")).unwrap();
    let modules = text.lines().filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod "));
    let mut modules: Vec<&str> = modules.map(|module| module.trim_end_matches(';')).collect();
    modules.sort_by_key(|module| floors.iter().position(|floor| floor == module));
    assert_eq!(modules, floors);
}

#[test]
fn rooms_of_the_library_import_only_what_stands_below_them() {
    let source = "nodes/library/src";
    import_only_what_stands_below(
        source,
        &["kernels/simd", "kernels/shared", "kernels/trace", "stages", "nodes"],
    );
    let nodes = format!("{source}/nodes");
    let mut wrong = between(&root(), &nodes, &nodes);
    // What has a single user lies in a folder of its name.
    wrong.retain(|[node, other]| !other.starts_with(node.with_extension("")));
    assert!(wrong.is_empty(), "nodes import stages and kernels, never each other: {wrong:#?}");
}

/// A package with these files below `src`.
fn package(folder: &Path, files: &[(&str, &str)]) {
    std::fs::create_dir_all(folder).unwrap();
    std::fs::write(folder.join("Cargo.toml"), "[package]\nname = \"made-up\"\n").unwrap();
    for (path, text) in files {
        let path = folder.join("src").join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
}

/// Circles of a package with these files.
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    package(folder.path(), files);
    circles(folder.path())
}

#[test]
fn a_circle_of_folders_is_found_where_no_two_files_make_one() {
    let lib = ("lib.rs", "mod a;\nmod b;\nmod c;\n");
    let files = [
        lib,
        ("a/mod.rs", "pub mod one;\npub mod two;\n"),
        ("a/one.rs", "use crate::b::B;\n"),
        ("a/two.rs", "pub struct Two;\n"),
        ("b.rs", "pub struct B;\n"),
        ("c.rs", "use crate::a::two::Two;\n"),
    ];
    let folder = tempfile::tempdir().unwrap();
    package(folder.path(), &files);
    assert!(folder_circles(folder.path()).is_empty());
    package(folder.path(), &[("b.rs", "pub struct B(crate::a::two::Two);\n")]);
    assert!(circles(folder.path()).is_empty());
    assert_eq!(
        folder_circles(folder.path()),
        ["src/a, src/b\n  src/a imports from src/b: one.rs: crate::b::B in line 1\n  \
          src/b imports from src/a: b.rs: crate::a::two::Two in line 1"]
    );
}

#[test]
fn code_of_another_package_is_found_with_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let near = "#[path = \"inner/near.rs\"]\nmod near;\n// #[path = \"../../b/src/far.rs\"]\n";
    package(&folder.path().join("a"), &[("lib.rs", near), ("inner/near.rs", "")]);
    package(&folder.path().join("b"), &[("far.rs", "")]);
    assert!(taken_from_elsewhere(folder.path()).is_empty());
    for far in ["#[path = \"../../b/src/far.rs\"]\nmod far;\n", "\ninclude!(\"../../b/src/far.rs\");\n"] {
        package(&folder.path().join("a"), &[("lib.rs", far)]);
        let line = 1 + usize::from(far.starts_with('\n'));
        assert_eq!(
            taken_from_elsewhere(folder.path()),
            [format!("a/src/lib.rs takes ../../b/src/far.rs in line {line}")]
        );
    }
}

#[test]
fn a_circle_is_found_with_its_lines() {
    let found = circles_of(&[
        ("lib.rs", "mod a;\nmod b;\nmod c;\nmod d;\n"),
        ("a.rs", "//! use crate::d::D;\nuse crate::{\n    b::{B, other::X as Y},\n};\n"),
        ("b.rs", "pub struct B;\npub mod other { pub struct X; }\nfn f() { super::c::g::<u8>() }\n"),
        ("c.rs", "use crate::a;\npub fn g() { a::h() }\n"),
        ("d.rs", "use super::{a, b};\n"),
    ]);
    assert_eq!(
        found,
        ["src/a.rs, src/b.rs, src/c.rs\n  \
          src/a.rs imports from src/b.rs: crate::b::B in line 3, crate::b::other::X in line 3\n  \
          src/b.rs imports from src/c.rs: super::c::g in line 3\n  \
          src/c.rs imports from src/a.rs: crate::a in line 1, a::h in line 2"]
    );
}

#[test]
fn a_module_and_its_child_can_make_a_circle() {
    let child = ("a/child.rs", "use super::A;\npub fn f() {}\n");
    let lib = ("lib.rs", "mod a;");
    assert!(circles_of(&[lib, ("a.rs", "mod child;\npub struct A;"), child]).is_empty());
    for parent in [
        "pub mod child;\npub use child::f;",
        "mod child { }\nfn g() { child::f() }",
        "mod child;\nfn g() { self::child::f() }",
    ] {
        let expected = usize::from(!parent.contains("{ }"));
        assert_eq!(circles_of(&[lib, ("a.rs", parent), child]).len(), expected, "{parent}");
    }
    // As a path that an attribute gives, from a file that no module declares in plain words.
    let declared = (
        "a/mod.rs",
        "generated!();\n#[path = \"odd/place.rs\"]\npub(in crate::a) mod child;\nuse child::f;\n",
    );
    assert_eq!(circles_of(&[("lib.rs", ""), declared, ("a/odd/place.rs", child.1)]).len(), 1);
}

#[test]
fn a_macro_is_imported_from_the_file_that_defines_it() {
    let a = ("a.rs", "#[macro_export]\nmacro_rules! made { () => { 1 } }\n");
    let b = ("b.rs", "use crate::made;\npub const B: i32 = made!();\n");
    assert!(circles_of(&[("lib.rs", "mod a;\nmod b;\npub use b::B;\n"), a, b]).is_empty());
    let a = ("a.rs", "macro_rules! made { () => { $crate::b::B } }\n");
    assert_eq!(circles_of(&[("lib.rs", "mod a;\nmod b;\n"), a, b]).len(), 1);
}

#[test]
fn tests_comments_and_names_of_other_things_are_no_imports() {
    let b = "use crate::a::A;\npub fn a() {}\n";
    for a in [
        "pub struct A;\n// use crate::b::a;\n/* crate::b::a(); */\nconst S: &str = \"crate::b::a\";",
        "pub struct A;\n#[cfg(test)]\nmod tests { use super::*; use crate::b; fn f() { b::a() } }",
        "pub struct A;\nfn f(b: A) { std::b::c(b.crate_b); other::b::a() }",
        "pub(in crate::b) struct A;",
    ] {
        assert!(circles_of(&[("lib.rs", "mod a;\nmod b;"), ("a.rs", a), ("b.rs", b)]).is_empty(), "{a}");
    }
}
