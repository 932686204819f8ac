//! Parts of a picture that the processor computes one by one, and what each reads.

use crate::ask::Picture;
use crate::look::GraphAtFrame;
use isophote::engine::plan::LEAST_ROWS;
use isophote::engine::{Plan, Rect};
use isophote::frames::Frames;
use isophote::planned::Planned;
use isophote::{Error, Graph};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Pixels of a part: few enough that a page can change its mind between two of them.
const PIXELS: i32 = 1 << 19;

/// The graph of a look and what is wanted of it.
///
/// # Errors
/// What is wrong with the look or the picture.
pub fn graph_and_request(look: &Value, picture: &Picture) -> Result<(Graph, isophote::Request), Error> {
    let look = GraphAtFrame::read(look, picture.frame)?;
    let mut graph = look.graph;
    graph.set_precision(picture.precision());
    isophote::engine::image::check_size(picture.width, picture.height)?;
    let mut request = picture.request(look.reference_height)?;
    let [read, _] = graph.frames();
    if let Some(past) = picture.past.filter(|_| read > 0) {
        request.frames = Frames::in_order(past.min(read));
    }
    Ok((graph, request))
}

/// Images that frames in order read of those before them, where all are known: their number, and by the names of stages and guides
/// how many frames before are read. Nothing where they read none.
///
/// # Errors
/// As planning.
pub fn history(graph: &Graph, request: isophote::Request) -> Result<Value, Error> {
    let [read, _] = graph.frames();
    if request.frames == Frames::NONE || read == 0 {
        return Ok(Value::Null);
    }
    let whole = Planned::new(graph, isophote::Request { frames: Frames::in_order(read), ..request })?;
    let mut images: BTreeMap<&str, u32> = BTreeMap::new();
    for port in whole.plan().inputs().iter().filter(|port| port.frame < 0) {
        let most = images.entry(port.base()).or_default();
        *most = port.frame.unsigned_abs().max(*most);
    }
    let frames = images.values().copied().max().unwrap_or(0);
    Ok(json!({ "frames": frames, "images": images }))
}

/// The plan of a look on a picture.
///
/// # Errors
/// As [`graph_and_request`], and those of planning.
pub fn planned(look: &Value, picture: &Picture) -> Result<Planned, Error> {
    let (graph, request) = graph_and_request(look, picture)?;
    Planned::new(&graph, request)
}

/// Bands of the picture that each take so many bytes where that can be, and the window of every input that each reads.
///
/// # Errors
/// As [`planned`].
pub fn parts(look: &Value, picture: &Picture, memory: u64) -> Result<Value, Error> {
    let planned = planned(look, picture)?;
    let (plan, whole) = (planned.plan(), Rect::of_size(picture.width, picture.height));
    let rows = rows(plan, whole, memory);
    let starts = (whole.y0..whole.y1).step_by(rows as usize);
    let bands = starts.map(|y0| Rect { y0, y1: (y0 + rows).min(whole.y1), ..whole });
    Ok(json!({ "parts": bands.map(|band| part(plan, band)).collect::<Vec<Value>>() }))
}

/// Rows of a part. What lies around a part is computed anew for each, so that parts are high against it.
fn rows(plan: &Plan, whole: Rect, memory: u64) -> i32 {
    let most = plan.band_rows(whole, [memory / 2, memory], LEAST_ROWS);
    let Some([_, halo]) = plan.support().sides() else { return most };
    let efficient = i32::try_from(halo).unwrap_or(i32::MAX).saturating_mul(4).max(LEAST_ROWS);
    // Two at least, for two threads.
    let wanted = (PIXELS / whole.width().max(1) as i32).min((whole.height() as i32 + 1) / 2);
    most.min(wanted.max(efficient)).max(1)
}

fn part(plan: &Plan, region: Rect) -> Value {
    let windows = plan.windows(region);
    let inputs: Map<String, Value> = plan
        .inputs()
        .iter()
        .map(|port| (port, windows[port.image.index()]))
        .filter(|(_, window)| !window.is_empty())
        .map(|(port, window)| (port.name.clone(), corners(window)))
        .collect();
    json!({ "region": corners(region), "inputs": inputs, "bytes": plan.peak_bytes(&windows) })
}

fn corners(rect: Rect) -> Value {
    json!([rect.x0, rect.y0, rect.x1, rect.y1])
}
