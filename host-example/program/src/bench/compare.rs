//! Measurements of another day, to set today's against.

use std::path::Path;

use serde_json::Value;

use super::entry::Entry;
use isophote_files::error::{Error, Result};
use isophote_files::input;

/// Most bytes of a saved run; real ones have some hundred thousands.
const MOST_BYTES: u64 = 64 << 20;

/// Measurements of a run saved with `--save` or printed with `--json`.
#[derive(Debug)]
pub struct Saved {
    threads: u64,
    entries: Vec<SavedEntry>,
}

#[derive(Debug)]
struct SavedEntry {
    node: String,
    backend: String,
    size: (u64, u64),
    seconds: f64,
    passes: Vec<(String, f64)>,
}

impl Saved {
    /// Reads a saved run.
    ///
    /// # Errors
    /// [`Error::Input`] when the file cannot be read or is none.
    pub fn read(path: &Path) -> Result<Self> {
        let fix = "give a file written by `isophote bench --save`";
        let text = input::text(path, MOST_BYTES).map_err(|e| Error::file(path, e, fix))?;
        Self::parse(&text).map_err(|problem| Error::file(path, problem, fix))
    }

    fn parse(text: &str) -> std::result::Result<Self, String> {
        let root: Value = serde_json::from_str(text).map_err(|e| format!("no JSON: {e}"))?;
        let results = root["results"].as_array().ok_or("has no results")?;
        let entries = results.iter().map(entry).collect::<Option<Vec<_>>>();
        Ok(Self {
            threads: root["threads"].as_u64().unwrap_or(0),
            entries: entries.ok_or("a result lacks its node, backend, size or milliseconds")?,
        })
    }

    /// Threads of the machine that it was measured on.
    pub fn threads(&self) -> u64 {
        self.threads
    }

    /// Ratio of the time that `entry` takes now to that before, and those of its passes; none where it was not
    /// measured, and no passes where they are others now.
    pub fn ratios(&self, entry: &Entry) -> Option<(f64, Vec<f64>)> {
        let before = self.entries.iter().find(|e| {
            e.node == entry.node
                && e.backend == entry.backend
                && e.size == (u64::from(entry.size.0), u64::from(entry.size.1))
        })?;
        let now = entry.passes.iter().map(|p| p.kernel.as_str());
        let same = now.eq(before.passes.iter().map(|(kernel, _)| kernel.as_str()));
        let passes = entry.passes.iter().zip(&before.passes).filter(|_| same);
        Some((entry.seconds / before.seconds, passes.map(|(now, (_, then))| now.seconds / then).collect()))
    }
}

fn entry(value: &Value) -> Option<SavedEntry> {
    let seconds = |value: &Value| {
        value["milliseconds"].as_f64().map(|ms| ms * 1e-3).filter(|s| s.is_finite() && *s >= 0.0)
    };
    let pass = |value: &Value| Some((value["kernel"].as_str()?.to_owned(), seconds(value)?));
    Some(SavedEntry {
        node: value["node"].as_str()?.to_owned(),
        backend: value["backend"].as_str()?.to_owned(),
        size: (value["width"].as_u64()?, value["height"].as_u64()?),
        seconds: seconds(value)?,
        passes: value["passes"].as_array()?.iter().map(pass).collect::<Option<_>>()?,
    })
}

/// The geometric mean of some ratios, which counts twice as fast as much as twice as slow; none of none.
pub fn mean(ratios: &[f64]) -> Option<f64> {
    let sum: f64 = ratios.iter().map(|r| r.ln()).sum();
    (!ratios.is_empty()).then(|| (sum / ratios.len() as f64).exp())
}

#[cfg(test)]
mod tests {
    use super::super::entry::PassEntry;
    use super::*;

    const SAVED: &str = r#"{"threads": 4, "results": [
        {"node": "gaussian", "backend": "cpu", "width": 8, "height": 6, "milliseconds": 4.0,
         "passes": [{"kernel": "rows", "milliseconds": 1.0}, {"kernel": "columns", "milliseconds": 3.0}]}
    ]}"#;

    fn now(size: (u32, u32), kernels: [&str; 2]) -> Entry {
        let pass = |kernel: &str| PassEntry {
            kernel: kernel.into(),
            seconds: 1e-3,
            pixels: 48,
            bytes: None,
            work: None,
        };
        Entry {
            node: "gaussian".into(),
            backend: "cpu",
            size,
            seconds: 2e-3,
            call_seconds: None,
            transfers: None,
            bytes: None,
            memory: None,
            passes: kernels.map(pass).into(),
        }
    }

    #[test]
    fn ratios_are_those_of_equal_nodes_sizes_and_passes() {
        let saved = Saved::parse(SAVED).unwrap();
        assert_eq!(saved.threads(), 4);
        let (whole, passes) = saved.ratios(&now((8, 6), ["rows", "columns"])).unwrap();
        assert!((whole - 0.5).abs() < 1e-9);
        assert!((passes[0] - 1.0).abs() < 1e-9 && (passes[1] - 1.0 / 3.0).abs() < 1e-9);
        let (whole, passes) = saved.ratios(&now((8, 6), ["rows", "rows"])).unwrap();
        assert!((whole - 0.5).abs() < 1e-9 && passes.is_empty());
        assert!(saved.ratios(&now((8, 7), ["rows", "columns"])).is_none());
    }

    #[test]
    fn what_is_no_saved_run_is_refused() {
        for text in ["", "[]", r#"{"results": 3}"#, r#"{"results": [{"node": "gaussian"}]}"#] {
            assert!(Saved::parse(text).is_err(), "{text}");
        }
        assert!(Saved::read(Path::new("no such file")).is_err());
    }

    #[test]
    fn twice_as_fast_and_twice_as_slow_are_even() {
        assert!((mean(&[0.5, 2.0]).unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(mean(&[]), None);
    }
}
