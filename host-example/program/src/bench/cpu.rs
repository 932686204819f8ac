//! A node on the CPU, through the library's `process`; one that depends on frames before its own, through a sequence.

use std::cell::Cell;

use super::entry::{Entry, PassEntry};
use super::resident::Resident;
use super::{Subject, median, motion};
use isophote_files::error::{AtPlace, Result};
use isophote_finishing::apply::memory;
use isophote_finishing::stylize::style::Style;
use isophote_loader::abi::{ISOPHOTE_GUIDE_MOTION, IsophoteRequest};
use isophote_loader::process::PassTime;
use isophote_loader::{Control, Input, Library};
use isophote_pictures::pixels::{Pixels, Precision};

/// Measures one node; of one that is steady, frames in order of which those before are known.
pub fn run(library: &Library, subject: &Subject, picture: &Pixels, runs: u32) -> Result<Entry> {
    let node = &subject.node;
    let size = (picture.width(), picture.height());
    let refused = |e: isophote_loader::Error| e.at(node, "leave it out with --node");
    let mut style = Style::any(library, node, &subject.settings)?;
    let request = library.request(size).map_err(|e| e.at("--size", "choose another size"))?;
    let mut target = Pixels::zeroed(size.0, size.1, 4, Precision::F32);
    let inputs = [Input { name: "color", pixels: picture }];
    let [past, future] = library.frames(&style.graph).map_err(refused)?;
    let mut sequence = match past + future {
        0 => None,
        _ => Some(library.sequence(memory::usual().0, 0.0).map_err(refused)?),
    };
    let (motion, frame) = (motion(size), Cell::new(0));
    let mut image = |name: &str, number: i64| match name {
        _ if !(0..=frame.get()).contains(&number) => None,
        "color" => Some(picture),
        "motion" => Some(&motion),
        _ => None,
    };
    let mut once = || {
        let mut times = Vec::new();
        let mut control = Control { measured: Some(&mut times), ..Control::default() };
        let report = match &mut sequence {
            None => style.graph.process(None, &request, &inputs, &mut target, &mut control),
            Some(sequence) => {
                let number = frame.get() + 1;
                frame.set(number);
                let request = IsophoteRequest { frame: number, guides: ISOPHOTE_GUIDE_MOTION, ..request };
                sequence.process(style.graph.handle(), None, &request, &mut image, &mut target, &mut control)
            }
        };
        Ok((report.map_err(refused)?.seconds, times))
    };
    // The first runs allocate, and find the frames that others are based on; they are not counted.
    library.trim().map_err(refused)?;
    let resident = Resident::new();
    for _ in 0..=past {
        once()?;
    }
    let memory = resident.grown();
    let measured: Vec<(f64, Vec<PassTime>)> = (0..runs).map(|_| once()).collect::<Result<_>>()?;
    Ok(Entry { memory, ..entry(subject, size, &measured) })
}

/// Medians of the runs that were measured.
fn entry(subject: &Subject, size: (u32, u32), measured: &[(f64, Vec<PassTime>)]) -> Entry {
    let seconds = |at: usize| median(measured.iter().filter_map(|(_, t)| Some(t.get(at)?.seconds)).collect());
    let passes = measured.first().map_or(&[][..], |(_, times)| times);
    let total = median(measured.iter().map(|(_, times)| times.iter().map(|t| t.seconds).sum()).collect());
    Entry {
        node: subject.label.clone(),
        backend: "cpu",
        size,
        seconds: total,
        call_seconds: Some(median(measured.iter().map(|(call, _)| *call).collect())),
        transfers: None,
        bytes: None,
        memory: None,
        passes: passes
            .iter()
            .enumerate()
            .map(|(at, pass)| PassEntry {
                kernel: pass.kernel.clone(),
                seconds: seconds(at),
                pixels: pass.pixels,
                bytes: None,
                work: Some((pass.operations, pass.bytes as f64)),
            })
            .collect(),
    }
}
