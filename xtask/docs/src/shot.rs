//! One picture of the site: what is applied to what, and with which values.

/// One picture.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Stem of its file.
    pub name: String,
    /// The picture that is filtered.
    pub subject: Subject,
    /// A node, a look, or a graph.
    pub style: Style,
    /// Parameters with their values.
    pub set: Vec<(&'static str, String)>,
}

/// Picture that is filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A frame of the demo scene, with everything that guides filters.
    Scene,
    /// A photograph.
    Photo,
    /// A photograph of the gallery, by the stem of its file.
    Gallery(&'static str),
}

impl Subject {
    /// Its name in files and marks of pages.
    pub fn id(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Photo => "photo",
            Self::Gallery(stem) => stem,
        }
    }
}

/// Style that is applied.
#[derive(Clone, Debug)]
pub enum Style {
    /// The id of a node, or `look:ID`.
    Named(String),
    /// The text of a graph file.
    Graph(String),
}
