//! The table of formats in the documentation, compared with the lists of extensions by which files are read and written.

use crate::tools::root;

/// The page with the table.
const PAGE: &str = "xtask/docs/pages/farms/formats.md";
/// Files with a list of extensions, and the line on which it begins.
const LISTS: [(&str, &str); 4] = [
    ("host-example/files/src/frames.rs", "const KINDS:"),
    ("host-example/finishing/src/video/container.rs", "const CONTAINERS:"),
    ("host-example/program/src/info/mod.rs", "const SCENES:"),
    ("host-example/pictures/src/write.rs", "match extension.to_ascii_lowercase().as_str() {"),
];

/// The texts in quotes of a list, up to its end; of pairs the first.
fn listed(text: &str, begins: &str) -> Vec<String> {
    let (_, rest) = text.split_once(begins).unwrap_or_else(|| panic!("there is no '{begins}'"));
    let end = rest.find("];").unwrap_or(rest.len()).min(rest.find("_ => Err").unwrap_or(rest.len()));
    let line = |line: &str| -> Vec<String> {
        let line = line.split_once("=>").map_or(line, |(names, _)| names);
        let names = line.split('"').skip(1).step_by(2).map(str::to_owned);
        names.take(if line.trim_start().starts_with('(') { 1 } else { usize::MAX }).collect()
    };
    rest[..end].lines().flat_map(line).collect()
}

#[test]
fn every_extension_that_is_known_stands_in_the_table() {
    let read = |path: &str| std::fs::read_to_string(root().join(path)).unwrap();
    let page = read(PAGE);
    for (path, begins) in LISTS {
        let found = listed(&read(path), begins);
        assert!(found.len() >= 3, "{path}: {found:?}");
        for extension in found {
            assert!(page.contains(&format!("`.{extension}`")), "{path}: .{extension} is not in {PAGE}");
        }
    }
    // Textures are told by their first bytes; a sentence names their formats.
    let decode = read("host-example/scene/src/decode.rs");
    let formats = listed(&decode, "pub const FORMATS: &str =");
    // The list with the decoders of a feature comes before that without.
    let all = formats.iter().find(|text| text.starts_with("PNG")).unwrap_or_else(|| panic!("{formats:?}"));
    let words: Vec<&str> = all.split([',', ' ']).filter(|word| word.len() > 2).collect();
    assert!(words.len() > 5 && words.contains(&"KTX2"), "{formats:?}");
    for word in words.into_iter().filter(|word| !matches!(*word, "and" | "are")) {
        assert!(page.contains(word), "{word} is not in {PAGE}");
    }
}
