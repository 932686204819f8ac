//! A node on the CPU, through the library's `process`.

use super::entry::{Entry, PassEntry};
use super::{Subject, median};
use crate::error::Result;
use crate::loader::process::PassTime;
use crate::loader::{Control, Input, Library};
use crate::pixels::{Pixels, Precision};
use crate::stylize::style::Style;

/// Measures one node.
pub fn run(library: &Library, subject: &Subject, picture: &Pixels, runs: u32) -> Result<Entry> {
    let node = &subject.node;
    let size = (picture.width(), picture.height());
    let mut style = Style::any(library, node, &subject.settings)?;
    let request = library.request(size).map_err(|e| e.at("--size", "choose another size"))?;
    let mut target = Pixels::zeroed(size.0, size.1, 4, Precision::F32);
    let inputs = [Input { name: "color", pixels: picture }];
    let mut once = || {
        let mut times = Vec::new();
        let mut control = Control { measured: Some(&mut times), ..Control::default() };
        let report = style
            .graph
            .process(None, &request, &inputs, &mut target, &mut control)
            .map_err(|e| e.at(node, "leave it out with --node"))?;
        Ok((report.seconds, times))
    };
    // The first run allocates, and is not counted.
    once()?;
    let measured: Vec<(f64, Vec<PassTime>)> = (0..runs).map(|_| once()).collect::<Result<_>>()?;
    let seconds = |at: usize| median(measured.iter().filter_map(|(_, t)| Some(t.get(at)?.seconds)).collect());
    let passes = measured.first().map_or(&[][..], |(_, times)| times);
    let total = median(measured.iter().map(|(_, times)| times.iter().map(|t| t.seconds).sum()).collect());
    Ok(Entry {
        node: subject.label.clone(),
        backend: "cpu",
        size,
        seconds: total,
        call_seconds: Some(median(measured.iter().map(|(call, _)| *call).collect())),
        passes: passes
            .iter()
            .enumerate()
            .map(|(at, pass)| PassEntry {
                kernel: pass.kernel.clone(),
                seconds: seconds(at),
                pixels: pass.pixels,
                work: Some((pass.operations, pass.bytes as f64)),
            })
            .collect(),
    })
}
