//! The reports of a card.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::found::Card;
use crate::bench::entry::Entry;
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_files::output;
use isophote_finishing::stylize::precision::Precision;

/// Names of the reports.
const NAMES: [&str; 2] = ["card.md", "card.json"];

/// Makes sure that both can be written into a folder.
///
/// # Errors
/// As [`files::check_writable`].
pub fn check(folder: &Path, existing: Existing) -> Result<()> {
    NAMES.iter().try_for_each(|name| files::check_writable(&folder.join(name), existing))
}

/// Writes both into a folder, and says where they are.
///
/// # Errors
/// [`Error::Input`] and [`Error::Failure`] when they cannot be written.
pub fn write(card: &Card, folder: &Path, existing: Existing) -> Result<()> {
    for (name, text) in NAMES.iter().zip([markdown(card), json(card)?]) {
        let file = folder.join(name);
        files::write_bytes(&file, existing, text.as_bytes())?;
        output::print(&format!("{}\n", file.display()))?;
    }
    Ok(())
}

fn json(card: &Card) -> Result<String> {
    let mistake = |e: serde_json::Error| {
        Error::failure(
            format!("the report is no JSON: {e}"),
            "this is a mistake in the program; please report it",
        )
    };
    let mut value = serde_json::to_value(card).map_err(mistake)?;
    value["nodes"] = card.entries.iter().map(|(precision, entry)| node(card, *precision, entry)).collect();
    serde_json::to_string_pretty(&value).map(|text| text + "\n").map_err(mistake)
}

fn node(card: &Card, precision: Precision, entry: &Entry) -> Value {
    let passes = entry.passes.iter().map(|pass| {
        json!({
            "kernel": pass.kernel,
            "seconds": pass.seconds,
            "bytes": pass.bytes,
            "share_of_copying": pass.bytes.and_then(|bytes| share(card, bytes, pass.seconds)),
        })
    });
    json!({
        "node": entry.node,
        "precision": precision.name(),
        "width": entry.size.0,
        "height": entry.size.1,
        "seconds": entry.seconds,
        "bytes": entry.bytes,
        "share_of_copying": entry.bytes.and_then(|bytes| share(card, bytes, entry.seconds)),
        "passes": passes.collect::<Vec<_>>(),
    })
}

/// Bytes a second over those of a copy.
fn share(card: &Card, bytes: u64, seconds: f64) -> Option<f64> {
    (seconds > 0.0 && card.copied > 0.0).then(|| bytes as f64 / seconds / card.copied)
}

fn markdown(card: &Card) -> String {
    let mut text = format!("# {}\n\n", card.adapter);
    for (what, value) in [
        ("driver", card.driver.as_str()),
        ("kind", &card.kind),
        ("backend", &card.backend),
        ("system", &card.system),
        ("Isophote", &card.version),
    ] {
        let _ = writeln!(text, "- {what}: {value}");
    }
    let _ = writeln!(text, "- threads of the CPU: {}", card.threads);
    let _ = writeln!(text, "- copied on the card: {:.1} GB/s, read and written\n", card.copied / 1e9);
    for problem in &card.problems {
        let _ = writeln!(text, "**Failed:** {problem}\n");
    }
    loops(card, &mut text);
    nodes(card, &mut text);
    twins(card, &mut text);
    compiled(card, &mut text);
    passes(card, &mut text);
    text
}

fn size((width, height): (u32, u32)) -> String {
    format!("{width}x{height}")
}

fn loops(card: &Card, text: &mut String) {
    *text +=
        "## Every frame\n\nThe whole of a frame, from its first command to the last one done, in a loop.\n\n";
    *text += "| style | size | precision | frames | median | 99 of 100 within |\n|---|---|---|--:|--:|--:|\n";
    for one in &card.loops {
        let [median, most] = [one.median_seconds, one.most_seconds].map(|seconds| seconds * 1e3);
        let (size, count) = (size(one.size), one.frames);
        let _ = writeln!(
            text,
            "| `{}` | {size} | {} | {count} | {median:.2} ms | {most:.2} ms |",
            one.node, one.precision
        );
    }
    *text += "\n## Sequences\n\nEXR frames of half floats, ZIP, from file to file.\n\n";
    *text += "| style | size | precision | frames | filtering alone | from file to file |\n";
    *text += "|---|---|---|--:|--:|--:|\n";
    for one in &card.sequences {
        let frames = f64::from(one.measured.frames);
        let [alone, whole] =
            [one.measured.filter_seconds, one.measured.seconds].map(|seconds| seconds * 1e3 / frames);
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {frames} | {alone:.1} ms a frame | {whole:.1} ms a frame |",
            one.node,
            size(one.size),
            one.precision
        );
    }
}

fn nodes(card: &Card, text: &mut String) {
    *text += "\n## Nodes\n\nMedians of warm runs. Bytes are those that passes read from and write to textures, each texel \
              once a pass; the share is of what a copy moves in that time.\n\n";
    *text +=
        "| node | size | precision | time | bytes a pixel | share of copying |\n|---|---|---|--:|--:|--:|\n";
    for (precision, entry) in &card.entries {
        let bytes = entry.bytes.unwrap_or_default();
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {:.3} ms | {:.0} | {} |",
            entry.node,
            size(entry.size),
            precision.name(),
            entry.seconds * 1e3,
            bytes as f64 / 1e6 / entry.megapixels(),
            percent(share(card, bytes, entry.seconds)),
        );
    }
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(String::new, |share| format!("{:.0} %", share * 100.0))
}

fn twins(card: &Card, text: &mut String) {
    let wrong = card.twins.iter().filter(|twin| !twin.agrees).count();
    let _ = writeln!(
        text,
        "\n## Against the CPU\n\n{} comparisons, of which {wrong} differ too much. \"Others\" is the share of values that are \
         others to the eye.\n",
        card.twins.len()
    );
    *text += "| node | precision | largest difference | signal to noise | others | allowed | |\n";
    *text += "|---|---|--:|--:|--:|--:|---|\n";
    for twin in &card.twins {
        let decibels = twin.decibels.map_or_else(|| "equal".to_owned(), |db| format!("{db:.1} dB"));
        let said = if twin.agrees { "" } else { "differs" };
        let _ = writeln!(
            text,
            "| `{}` | {} | {:.2e} | {decibels} | {:.3} % | {:.1} % | {said} |",
            twin.node,
            twin.precision,
            twin.largest,
            twin.share * 100.0,
            twin.allowed * 100.0
        );
    }
}

fn compiled(card: &Card, text: &mut String) {
    *text += "\n## Compiling\n\nShaders that several nodes share count for the first of them. Drivers may remember shaders from \
              run to run.\n\n| node | precision | time |\n|---|---|--:|\n";
    for one in &card.compiled {
        let _ = writeln!(text, "| `{}` | {} | {:.0} ms |", one.node, one.precision, one.seconds * 1e3);
    }
}

fn passes(card: &Card, text: &mut String) {
    *text += "\n## Passes\n\nOn the card's own clock, each pass by itself.\n";
    for (precision, entry) in card.entries.iter().filter(|(_, entry)| !entry.passes.is_empty()) {
        let _ = writeln!(
            text,
            "\n<details><summary>{}, {}, {}</summary>\n\n| kernel | time | MB | share of copying |\n|---|--:|--:|--:|",
            entry.node,
            size(entry.size),
            precision.name()
        );
        for pass in &entry.passes {
            let bytes = pass.bytes.unwrap_or_default();
            let _ = writeln!(
                text,
                "| `{}` | {:.3} ms | {:.1} | {} |",
                pass.kernel,
                pass.seconds * 1e3,
                bytes as f64 / 1e6,
                percent(share(card, bytes, pass.seconds))
            );
        }
        *text += "\n</details>\n";
    }
}
