//! Measurements as a table, in Markdown or as JSON.

use serde_json::{Value, json};

use super::compare::{self, Saved};
use super::entry::Entry;
use super::peak::Peak;
use super::peers;
use super::transfers::Transfers;
use isophote_files::error::{Error, Result};
use isophote_files::output;
use isophote_loader::Library;

/// Machine that was measured on.
#[derive(Debug)]
pub struct Machine {
    threads: usize,
    peak: Option<Peak>,
    adapter: Option<String>,
}

impl Machine {
    /// A machine with so many threads, the peak of its CPU and the name of its adapter, where they are used.
    pub fn new(threads: usize, peak: Option<Peak>, adapter: Option<String>) -> Self {
        Self { threads, peak, adapter }
    }
}

/// Form in which measurements are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// As text, each as soon as it is there.
    Table,
    /// As a table in Markdown, each as soon as it is there.
    Markdown,
    /// As JSON, all at the end.
    Json,
}

/// All measurements of a run.
#[derive(Debug)]
pub struct Report {
    version: &'static str,
    machine: Machine,
    runs: u32,
    shown: Shown,
    before: Option<Saved>,
    ratios: Vec<f64>,
    entries: Vec<Entry>,
}

/// Shares of the machine's peak: of multiply-adds and of copied bytes.
fn shares(peak: Option<Peak>, seconds: f64, work: Option<(f64, f64)>) -> Option<[f64; 2]> {
    let (peak, (operations, bytes)) = (peak?, work?);
    (seconds > 0.0).then(|| [operations / seconds / peak.multiply_adds, bytes / seconds / peak.copied])
}

impl Report {
    /// An empty report of medians of `runs`, compared with a run of `before`.
    pub fn new(library: &Library, machine: Machine, runs: u32, shown: Shown, before: Option<Saved>) -> Self {
        Self {
            version: library.version(),
            machine,
            runs,
            shown,
            before,
            ratios: Vec::new(),
            entries: Vec::new(),
        }
    }

    /// Keeps an entry, and prints it where it is not to be JSON.
    ///
    /// # Errors
    /// As [`output::print`].
    pub fn add(&mut self, entry: Entry) -> Result<()> {
        let ratios = self.before.as_ref().and_then(|before| before.ratios(&entry));
        let (whole, passes) = ratios.map_or((None, Vec::new()), |(whole, passes)| (Some(whole), passes));
        self.ratios.extend(whole);
        match self.shown {
            Shown::Table => output::print(&self.paragraph(&entry, whole, &passes))?,
            Shown::Markdown => output::print(&row(&entry, whole))?,
            Shown::Json => {}
        }
        self.entries.push(entry);
        Ok(())
    }

    fn paragraph(&self, entry: &Entry, whole: Option<f64>, passes: &[f64]) -> String {
        let peak = self.machine.peak;
        let rate = entry.megapixels() / entry.seconds;
        let mut text = format!(
            "\n{} ({}, {}x{}){}{}{}{}\n",
            entry.node,
            entry.backend,
            entry.size.0,
            entry.size.1,
            columns(entry.seconds, rate, shares(peak, entry.seconds, entry.work())),
            entry.bytes.map_or_else(String::new, |bytes| {
                format!("  {:.0} bytes a pixel", bytes as f64 / 1e6 / entry.megapixels())
            }),
            entry.memory.map_or_else(String::new, |bytes| {
                format!("  {:.0} MiB a megapixel", bytes as f64 / f64::from(1 << 20) / entry.megapixels())
            }),
            ratio(whole)
        );
        if let Some(Transfers { upload, download }) = entry.transfers {
            let whole = upload + entry.seconds + download;
            for (what, seconds) in [("upload", upload), ("download", download), ("with both", whole)] {
                text += &format!("  {what:38}{}\n", columns(seconds, entry.megapixels() / seconds, None));
            }
        }
        for (at, pass) in entry.passes.iter().enumerate() {
            let rate = pass.pixels as f64 / 1e6 / pass.seconds;
            text += &format!(
                "  {:38}{}{}{}\n",
                pass.kernel,
                columns(pass.seconds, rate, shares(peak, pass.seconds, pass.work)),
                pass.bytes.map_or_else(String::new, |bytes| {
                    format!("  {:3.0} bytes a pixel", bytes as f64 / pass.pixels as f64)
                }),
                ratio(passes.get(at).copied())
            );
        }
        text
    }

    /// Prints the heading before the table.
    ///
    /// # Errors
    /// As [`output::print`].
    pub fn print_heading(&self) -> Result<()> {
        if self.shown == Shown::Json {
            return Ok(());
        }
        let mut text = format!("Isophote {}, medians of {} warm runs\n", self.version, self.runs);
        if let Some(peak) = self.machine.peak {
            text += &format!(
                "CPU: {} threads, {:.1} G multiply-adds/s, {:.1} GB/s copied\n",
                self.machine.threads,
                peak.multiply_adds / 1e9,
                peak.copied / 1e9
            );
        }
        if let Some(adapter) = &self.machine.adapter {
            text += &format!("GPU: {adapter}\n");
        }
        if let Some(before) = &self.before
            && before.threads() != self.machine.threads as u64
        {
            output::warn(format_args!(
                "the saved run is of another machine, with {} threads instead of {}",
                before.threads(),
                self.machine.threads
            ));
        }
        if self.shown == Shown::Markdown {
            text += "\n| node | on | size | ms | MP/s | before | other program | its ms | ratio |\n";
            text += "|---|---|---|--:|--:|--:|---|--:|--:|\n";
        }
        output::print(&text)
    }

    /// Prints the end after the table: all as JSON, or what the comparison came to.
    ///
    /// # Errors
    /// As [`Report::json`] and [`output::print`].
    pub fn print_end(&self) -> Result<()> {
        if self.shown == Shown::Json {
            return output::print(&format!("{}\n", self.json()?));
        }
        let text = match (compare::mean(&self.ratios), &self.before) {
            (_, None) => return Ok(()),
            (Some(mean), _) => {
                format!("\nx{mean:.2} of before, geometric mean of {}\n", self.ratios.len())
            }
            (None, _) => "\nNothing of this was measured before\n".into(),
        };
        output::print(&text)
    }

    /// Everything as JSON.
    ///
    /// # Errors
    /// [`Error::Failure`] when it cannot be written so.
    pub fn json(&self) -> Result<String> {
        let peak = self.machine.peak;
        let value = json!({
            "version": self.version,
            "runs": self.runs,
            "threads": self.machine.threads,
            "adapter": self.machine.adapter,
            "peak": peak.map(|p| json!({
                "multiply_adds_per_second": p.multiply_adds,
                "copied_bytes_per_second": p.copied,
            })),
            "results": self.entries.iter().map(|e| entry(e, peak)).collect::<Vec<_>>(),
        });
        serde_json::to_string_pretty(&value)
            .map_err(|e| Error::failure(format!("cannot be written as JSON: {e}"), "leave out --json"))
    }
}

fn ratio(ratio: Option<f64>) -> String {
    ratio.map_or_else(String::new, |r| format!("  x{r:.2} of before"))
}

/// A row of the table in Markdown.
fn row(entry: &Entry, whole: Option<f64>) -> String {
    let before = whole.map_or_else(String::new, |r| format!("x{r:.2}"));
    let ms = entry.seconds * 1e3;
    let peer = peers::of(&entry.node, entry.size).filter(|_| entry.backend == "cpu");
    let peer = peer.map_or_else(
        || " | | ".to_owned(),
        |p| format!("{} | {} | x{:.2} ", p.program, p.milliseconds, ms / p.milliseconds),
    );
    format!(
        "| `{}` | {} | {}x{} | {ms:.1} | {:.1} | {before} | {peer}|\n",
        entry.node,
        entry.backend,
        entry.size.0,
        entry.size.1,
        entry.megapixels() / entry.seconds
    )
}

fn columns(seconds: f64, rate: f64, shares: Option<[f64; 2]>) -> String {
    let shares = shares.map_or_else(String::new, |[operations, bytes]| {
        format!("  {:5.1} % of multiply-adds, {:5.1} % of copying", operations * 100.0, bytes * 100.0)
    });
    format!("{:10.2} ms {rate:9.1} MP/s{shares}", seconds * 1e3)
}

fn entry(entry: &Entry, peak: Option<Peak>) -> Value {
    let mut value = json!({
        "node": entry.node,
        "backend": entry.backend,
        "width": entry.size.0,
        "height": entry.size.1,
        "milliseconds": entry.seconds * 1e3,
        "megapixels_per_second": entry.megapixels() / entry.seconds,
        "bytes": entry.bytes,
        "peak_bytes": entry.memory,
        "passes": entry.passes.iter().map(|p| {
            let mut value = json!({
                "kernel": p.kernel,
                "milliseconds": p.seconds * 1e3,
                "megapixels_per_second": p.pixels as f64 / 1e6 / p.seconds,
                "bytes": p.bytes,
            });
            add_shares(&mut value, shares(peak, p.seconds, p.work));
            value
        }).collect::<Vec<_>>(),
    });
    if let Some(call) = entry.call_seconds {
        value["call_milliseconds"] = json!(call * 1e3);
    }
    if let Some(Transfers { upload, download }) = entry.transfers {
        value["upload_milliseconds"] = json!(upload * 1e3);
        value["download_milliseconds"] = json!(download * 1e3);
    }
    add_shares(&mut value, shares(peak, entry.seconds, entry.work()));
    value
}

fn add_shares(value: &mut Value, shares: Option<[f64; 2]>) {
    if let Some([operations, bytes]) = shares {
        value["share_of_peak_multiply_adds"] = json!(operations);
        value["share_of_peak_copy"] = json!(bytes);
    }
}
