//! The library's one error enum.

use thiserror::Error;

/// Error of building, reading or planning a graph.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A node, parameter, port or choice of that name does not exist; names the nearest that does.
    #[error("{0}")]
    Unknown(String),
    /// A value of the wrong type, out of range or not finite.
    #[error("{0}")]
    Value(String),
    /// Ports that do not fit, a cycle, or a required input left open.
    #[error("{0}")]
    Connection(String),
    /// A graph file that cannot be read as one.
    #[error("{0}")]
    Format(String),
    /// An error of the engine.
    #[error(transparent)]
    Engine(#[from] isophote_engine::Error),
}

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// The known name nearest to a misspelt one, as a hint for a message; empty when none is near.
pub(crate) fn nearest<'a>(wanted: &str, known: impl Iterator<Item = &'a str>) -> String {
    nearest_name(wanted, known).map_or_else(String::new, |name| format!("; did you mean '{name}'?"))
}

/// The known name nearest to a misspelt one, unless none is near.
pub(crate) fn nearest_name<'a>(wanted: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let (far, name) = known.map(|name| (distance(wanted, name), name)).min()?;
    (far <= (wanted.chars().count() / 2).max(2)).then_some(name)
}

/// Levenshtein distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut corner = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let change = corner + usize::from(ca != *cb);
            corner = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(corner + 1);
        }
    }
    row[b.len()]
}
