//! No two files import each other, directly or around a circle.

use isophote_tests::imports::{between, circles};
use std::path::Path;

#[test]
fn no_two_files_import_each_other() {
    let circles = circles(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    assert!(
        circles.is_empty(),
        "files import each other:\n{}",
        circles.iter().map(|c| format!("{c}\n")).collect::<String>()
    );
}

#[test]
fn rooms_of_the_library_import_only_what_stands_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let between = |from: &str, to: &str| {
        let [from, to] = [from, to].map(|room| format!("nodes/library/src/{room}"));
        between(&root, &from, &to)
    };
    // Each with what may import it, and never the other way round.
    let rooms = ["kernels/simd", "kernels/shared", "kernels/trace", "stages", "nodes"];
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
    let mut wrong = between("nodes", "nodes");
    // What has a single user lies in a folder of its name.
    wrong.retain(|[node, other]| !other.starts_with(node.with_extension("")));
    assert!(wrong.is_empty(), "nodes import stages and kernels, never each other: {wrong:#?}");
}

/// Circles of a package with these files.
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("Cargo.toml"), "[package]\nname = \"made-up\"\n").unwrap();
    for (path, text) in files {
        let path = folder.path().join("src").join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    circles(folder.path())
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
