//! One picture of the site: what is applied, and with which values.

/// One picture.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Stem of its file.
    pub name: String,
    /// A node, a look, or a graph.
    pub style: Style,
    /// Parameters with their values.
    pub set: Vec<(&'static str, String)>,
}

/// Style that is applied.
#[derive(Clone, Debug)]
pub enum Style {
    /// The id of a node, or `look:ID`.
    Named(String),
    /// The text of a graph file.
    Graph(String),
}
