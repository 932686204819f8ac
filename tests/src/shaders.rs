//! The shaders' own text: finding numbers in it and changing one.

use isophote_engine::Kernel;
use std::path::{Path, PathBuf};

/// A shader with one thing changed.
#[derive(Clone, Debug)]
pub struct Spoiled {
    /// The whole module.
    pub source: String,
    /// Description of the change, for messages.
    pub change: String,
}

/// Folder of the shaders.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shaders")
}

/// Exchanges of text, each where it first stands in the function that a kernel is entered by.
const EXCHANGES: [(&str, &str); 4] = [(" + ", " - "), (" - ", " + "), (" * ", " + "), (".xy", ".yx")];

/// The shader with one number of its own text changed, for each number that carries meaning; those
/// with a fraction first. After them, it with an operator or components exchanged.
pub fn spoil(kernel: &Kernel) -> Vec<Spoiled> {
    let own: String = kernel.pieces.own.iter().map(|piece| piece.text()).collect();
    let (shared, after) = kernel.shader.split_once(own.as_str()).unwrap_or_default();
    let mut spoiled: Vec<(bool, Spoiled)> = Vec::new();
    for (line_number, line) in own.lines().enumerate() {
        for (start, end) in numbers(line) {
            let literal = &line[start..end];
            let Some(changed) = other_number(literal) else { continue };
            let line_start: usize = own.lines().take(line_number).map(|l| l.len() + 1).sum();
            let source =
                format!("{shared}{}{changed}{}{after}", &own[..line_start + start], &own[line_start + end..]);
            let change = format!("{literal} -> {changed} in `{}`", line.trim());
            spoiled.push((literal.contains('.'), Spoiled { source, change }));
        }
    }
    spoiled.sort_by_key(|(has_fraction, _)| !has_fraction);
    let mut spoiled: Vec<Spoiled> = spoiled.into_iter().map(|(_, s)| s).collect();
    let body = own.find("fn main").or_else(|| own.find("fn of_pixel")).unwrap_or_default();
    for (from, to) in EXCHANGES {
        let Some(at) = own[body..].find(from).map(|at| body + at) else { continue };
        let source = format!("{shared}{}{to}{}{after}", &own[..at], &own[at + from.len()..]);
        let change = format!("{} -> {} in the entry", from.trim(), to.trim());
        spoiled.push(Spoiled { source, change });
    }
    spoiled
}

/// Byte ranges of the numbers of a line that are values: not in comments, names, types, attributes or
/// the lengths of arrays.
fn numbers(line: &str) -> Vec<(usize, usize)> {
    let code = line.split("//").next().unwrap_or("");
    if code.trim_start().starts_with('@') || code.contains("array<") {
        return Vec::new();
    }
    let bytes = code.as_bytes();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let c = bytes[at];
        if c.is_ascii_alphabetic() || c == b'_' {
            while at < bytes.len() && (bytes[at].is_ascii_alphanumeric() || bytes[at] == b'_') {
                at += 1;
            }
        } else if c.is_ascii_digit() {
            let start = at;
            while at < bytes.len()
                && (bytes[at].is_ascii_alphanumeric()
                    || bytes[at] == b'.'
                    || (matches!(bytes[at], b'-' | b'+') && matches!(bytes[at - 1], b'e' | b'E')))
            {
                at += 1;
            }
            found.push((start, at));
        } else {
            at += 1;
        }
    }
    found
}

/// Another value for a literal, far enough to matter; `None` for the tiny guards of divisions, for bit
/// masks and for 0, which are rarely reached.
fn other_number(literal: &str) -> Option<String> {
    if literal.starts_with("0x") {
        return None;
    }
    if let Ok(v) = literal.trim_end_matches(['u', 'i']).parse::<i64>()
        && !literal.contains(['.', 'f'])
    {
        let suffix = if literal.ends_with('u') { "u" } else { "" };
        return Some(format!("{}{suffix}", v + 1));
    }
    let v: f64 = literal.trim_end_matches('f').parse().ok()?;
    (v != 0.0 && v.abs() > 1e-4 && v.abs() < 1e5).then(|| format!("{:?}", v * 1.25 + 0.03))
}
