//! Pages, the documents of the repository that are pages, and the ways from one to another.

/// A page before it is rendered.
#[derive(Clone, Debug)]
pub struct Page {
    /// Its place on the site, without its ending.
    pub path: String,
    /// Its name in the contents.
    pub title: String,
    /// The part of the contents that it stands in.
    pub part: &'static str,
    /// Markdown.
    pub text: String,
    /// The document of the repository that it is, by its path; links in it are relative to that.
    pub document: Option<&'static str>,
}

/// Documents of the repository that are pages, too: part, place, title, document.
pub const DOCUMENTS: [(&str, &str, &str, &str); 8] = [
    ("For compositors", "compositors/openfx", "Every host, in detail", "nodes/plugin/OPENFX.md"),
    ("For engine authors", "engines/rust", "From Rust", "nodes/library/README.md"),
    ("For engine authors", "engines/bevy", "In Bevy", "nodes/bevy/README.md"),
    ("For engine authors", "engines/godot", "In Godot", "nodes/godot/README.md"),
    ("For render TDs", "farms/farm", "Farms", "host-example/FARM.md"),
    ("For render TDs", "farms/benchmarks", "How fast the nodes are", "host-example/BENCHMARKS.md"),
    ("For the web", "web/package", "The npm package", "nodes/web/package/README.md"),
    ("For contributors", "contributors/contributing", "Contributing", "CONTRIBUTING.md"),
];

/// Parts in their order.
pub const PARTS: [&str; 11] = [
    "",
    "For artists",
    "Styles",
    "For compositors",
    "For engine authors",
    "For render TDs",
    "For Python programmers",
    "For Blender users",
    "For the web",
    "For contributors",
    "Nodes",
];

/// Path from a page in `path` to the top of the site.
pub fn to_top(path: &str) -> String {
    "../".repeat(path.matches('/').count())
}

/// The page that a document of the repository is, if it is one.
pub fn page_of(document: &str) -> Option<&'static str> {
    DOCUMENTS.iter().find(|(.., known)| *known == document).map(|(_, path, ..)| *path)
}

/// Text as HTML shows it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
