//! The frames that an instance needs of each clip.

use super::effects::Effect;
use super::host::{Host, Outcome};
use super::image::Clip;
use super::instance::Moment;
use super::known::{Known, clip_of};
use super::settings::Settings;
use isophote::engine::Rect;
use isophote::graph::GraphInput;
use isophote::{Planned, Request};
use isophote_abi::openfx::*;
use std::collections::BTreeMap;
use std::ffi::{CStr, CString};

/// Side of the picture that is planned for: which frames are read does not depend on it.
const SIDE: u32 = 64;

/// First and last frame of a clip, counted from the one that is rendered.
type Ranges = BTreeMap<&'static CStr, [i32; 2]>;

/// Frames around a frame that it needs. Frames that a clip says it has not are not asked for.
///
/// # Errors
/// Failed, when the host has no parameters or the graph cannot be planned.
pub fn frames(effect: &Effect, host: &Host, instance: Handle, in_args: Handle, out_args: Handle) -> Outcome {
    if !effect.temporal || !host.temporal {
        return Ok(kOfxStatReplyDefault);
    }
    let time = Moment::of(host.set(in_args)).time;
    let settings = Settings::read(effect, host, instance, time)?;
    if settings.is_identity(1.0) {
        return Ok(kOfxStatReplyDefault);
    }
    let mut ranges = Ranges::new();
    for mut known in Known::connected(effect, host, instance, &settings)? {
        known.limit_to_source(host, instance, time);
        while let Some(missing) = gather(&known, &settings, host, instance, time, &mut ranges)? {
            known.forget_from(missing);
        }
    }
    let (answer, mut answered) = (host.set(out_args), false);
    for (clip, [first, last]) in ranges.into_iter().filter(|(_, range)| *range != [0, 0]) {
        let name = CString::new(format!("{FRAME_RANGE_PREFIX}{}", clip.to_string_lossy()));
        let range = [first, last].map(|offset| time + f64::from(offset));
        answered |= answer.set_doubles(&name.unwrap_or_default(), &range);
    }
    Ok(if answered { kOfxStatOK } else { kOfxStatReplyDefault })
}

/// Adds what a plan reads of each clip; nothing but a frame that a clip has not, where there is such.
fn gather(
    known: &Known,
    settings: &Settings,
    host: &Host,
    instance: Handle,
    time: f64,
    ranges: &mut Ranges,
) -> Outcome<Option<i32>> {
    let request = Request { guides: known.guides, frames: known.frames, ..Request::new(SIDE, SIDE) };
    let planned = Planned::new(&known.graph, request).map_err(|_| kOfxStatFailed)?;
    let plan = planned.plan();
    let windows = plan.windows(Rect::of_size(SIDE, SIDE));
    let mut found = Vec::new();
    for port in plan.inputs().iter().filter(|port| !windows[port.image.index()].is_empty()) {
        let clip =
            GraphInput::from_id(port.base()).and_then(|input| clip_of(settings, host, instance, input));
        let Some(name) = clip else { continue };
        let at = time + f64::from(port.frame);
        if port.frame != 0 && !Clip::of(host, instance, name).is_some_and(|clip| clip.has_frame(at)) {
            return Ok(Some(port.frame));
        }
        found.push((name, port.frame));
    }
    for (name, frame) in found {
        let [first, last] = ranges.entry(name).or_default();
        (*first, *last) = ((*first).min(frame), (*last).max(frame));
    }
    Ok(None)
}
