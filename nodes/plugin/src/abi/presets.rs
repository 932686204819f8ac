//! The extension for presets: what the library reads of them, and styles behind handles.

use super::args;
use super::catalogue::lasting;
use super::failure::{Failure, Outcome, one_line};
use super::guard::{self, lock};
use super::handles::{Handle, Object, object};
use super::objects::GraphObject;
use isophote::preset::{self, Fault, Lengths, Preset, Settings};
use isophote::value::color_from_text;
use isophote::{Error, Graph};
use isophote_abi::*;
use serde_json::json;
use std::cell::Cell;
use std::ffi::{CStr, c_char};
use std::sync::{Mutex, OnceLock};

/// Name of the extension.
pub const EXTENSION: &CStr = c"isophote.presets/1";

/// The functions of the extension.
pub static API: IsophotePresetsApi = IsophotePresetsApi {
    struct_size: size_of::<IsophotePresetsApi>() as u32,
    looks,
    color,
    read,
    write,
    check,
    style_create,
    style_create_from_json,
    style_destroy,
    style_graph,
    style_reference_height,
    style_set,
    style_at_frame,
    style_value,
    style_frames,
    style_left_out,
};

const _: () = assert!(Lengths::Relative.reference_height() == ISOPHOTE_REFERENCE_HEIGHT);

/// A style of a host's.
#[derive(Debug)]
pub struct StyleObject {
    graph: Graph,
    settings: Mutex<Settings>,
    message: Mutex<String>,
}

object!(StyleObject, IsophoteStyle, 7, "style");

/// Why a call of this extension failed.
enum Wrong {
    /// A preset is at fault.
    Fault(Fault),
    /// The call is.
    Call(Failure),
}

impl From<Fault> for Wrong {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl From<Failure> for Wrong {
    fn from(failure: Failure) -> Self {
        Self::Call(failure)
    }
}

/// Runs the inside of a call, and fills the parts of its fault when it fails.
///
/// # Safety
/// `out` is null or points to a fault whose buffers may be written.
unsafe fn call(out: *mut IsophoteFault, body: impl FnOnce() -> Result<(), Wrong>) -> IsophoteStatus {
    let is_told = Cell::new(false);
    let tell = |parts: [&str; 4]| {
        is_told.set(true);
        if !out.is_null() {
            // SAFETY: as the caller promised; the places of the four texts are within the fault.
            unsafe {
                let texts = [
                    &raw mut (*out).place,
                    &raw mut (*out).problem,
                    &raw mut (*out).fix,
                    &raw mut (*out).node,
                ];
                texts.into_iter().zip(parts).for_each(|(text, part)| args::fill_message(text, part));
            }
        }
    };
    let inside = || {
        body().map_err(|wrong| match wrong {
            Wrong::Call(failure) => failure,
            Wrong::Fault(fault) => {
                // Names in files may hold anything, as in all messages.
                let [place, problem, fix] =
                    [&fault.place, &fault.problem, &fault.fix].map(|part| one_line(part.clone()));
                tell([&place, &problem, &fix, &fault.node]);
                Failure::from(Error::from(fault))
            }
        })
    };
    guard::call(inside, |message| {
        if !is_told.get() {
            tell(["", message, "", ""]);
        }
    })
}

/// Text from the host that may be missing.
///
/// # Safety
/// As [`args::text`].
unsafe fn optional<'a>(pointer: *const c_char, what: &str) -> Outcome<Option<&'a str>> {
    // SAFETY: as the caller promised.
    if pointer.is_null() { Ok(None) } else { unsafe { args::text(pointer, what) }.map(Some) }
}

/// All looks, never written once made.
struct List(Vec<IsophoteLook>);

// SAFETY: all that the list points to is leaked and constant.
unsafe impl Send for List {}
// SAFETY: as above.
unsafe impl Sync for List {}

unsafe extern "C" fn looks(looks: *mut *const IsophoteLook, count: *mut u32) -> IsophoteStatus {
    static LIST: OnceLock<List> = OnceLock::new();
    let body = || {
        let look = |look: &preset::Look| IsophoteLook { id: lasting(look.id), preset: lasting(look.json) };
        let List(all) = LIST.get_or_init(|| List(preset::LOOKS.iter().map(look).collect()));
        // SAFETY: the host promised that both places may be written.
        unsafe {
            args::put(looks, all.as_ptr(), "the place for the looks")?;
            args::put(count, all.len() as u32, "the place for their number")
        }
    };
    guard::call(body, |_| {})
}

unsafe extern "C" fn color(text: *const c_char, rgba: *mut f32, fault: *mut IsophoteFault) -> IsophoteStatus {
    // SAFETY: the host promised text with a closing zero, room for four numbers and a fault that may be written.
    unsafe {
        call(fault, || {
            let color = color_from_text(args::text(text, "the colour")?).map_err(Failure::from)?;
            Ok(args::put(rgba.cast::<[f32; 4]>(), color, "the place for the colour")?)
        })
    }
}

unsafe extern "C" fn read(
    json: *const c_char,
    place: *const c_char,
    report: *mut IsophoteText,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised texts with a closing zero, and that the others may be written.
    unsafe {
        call(fault, || {
            let (json, place) = (args::text(json, "the preset's text")?, args::text(place, "the place")?);
            let text = if preset::is_graph(json) {
                json!({ "preset": null, "faults": [] })
            } else {
                let (preset, faults) = Preset::examine(place, json)?;
                json!({ "preset": preset, "faults": faults })
            };
            Ok(args::fill(report, &text.to_string())?)
        })
    }
}

unsafe extern "C" fn write(
    preset: *const c_char,
    json: *mut IsophoteText,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised text with a closing zero, and that the others may be written.
    unsafe {
        call(fault, || {
            let preset: Preset = serde_json::from_str(args::text(preset, "the preset")?)
                .map_err(|e| Failure::argument(format!("the preset is not in the form of `read`: {e}")))?;
            Ok(args::fill(json, &preset.to_json())?)
        })
    }
}

unsafe extern "C" fn check(
    json: *const c_char,
    place: *const c_char,
    graph: *const c_char,
    faults: *mut IsophoteText,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised texts with a closing zero, and that the others may be written.
    unsafe {
        call(fault, || {
            let (json, place) = (args::text(json, "the preset's text")?, args::text(place, "the place")?);
            let found = preset::check(place, json, optional(graph, "the graph's text")?);
            Ok(args::fill(faults, &json!(found).to_string())?)
        })
    }
}

/// Makes the object of a style that is opened.
///
/// # Safety
/// `style` and `fault` are null or may be written.
unsafe fn create(
    style: *mut IsophoteStyle,
    fault: *mut IsophoteFault,
    open: impl FnOnce() -> Result<(Graph, Settings), Wrong>,
) -> IsophoteStatus {
    // SAFETY: as the caller promised.
    unsafe {
        call(fault, || {
            args::put(style, IsophoteStyle::new(0), "the place for the style")?;
            let (graph, settings) = open()?;
            let object = StyleObject { graph, settings: Mutex::new(settings), message: Mutex::default() };
            let handle = IsophoteStyle::new(StyleObject::slots().insert(object)?);
            Ok(args::put(style, handle, "the place for the style")?)
        })
    }
}

unsafe extern "C" fn style_create(
    name: *const c_char,
    style: *mut IsophoteStyle,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised text with a closing zero, and that the others may be written.
    unsafe { create(style, fault, || Ok(preset::open(args::text(name, "the style's name")?)?)) }
}

unsafe extern "C" fn style_create_from_json(
    json: *const c_char,
    place: *const c_char,
    graph: *const c_char,
    style: *mut IsophoteStyle,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised texts with a closing zero, and that the others may be written.
    unsafe {
        create(style, fault, || {
            let (json, place) = (args::text(json, "the preset's text")?, args::text(place, "the place")?);
            Ok(preset::open_json(place, json, optional(graph, "the graph's text")?)?)
        })
    }
}

unsafe extern "C" fn style_destroy(style: IsophoteStyle) -> IsophoteStatus {
    guard::destroy::<StyleObject>(style)
}

unsafe extern "C" fn style_graph(
    style: IsophoteStyle,
    graph: *mut IsophoteGraph,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised that both places may be written.
    unsafe {
        call(fault, || {
            args::put(graph, IsophoteGraph::new(0), "the place for the graph")?;
            let object = GraphObject::new(StyleObject::slots().get(style.id)?.graph.clone());
            let handle = IsophoteGraph::new(GraphObject::slots().insert(object)?);
            Ok(args::put(graph, handle, "the place for the graph")?)
        })
    }
}

unsafe extern "C" fn style_reference_height(style: IsophoteStyle, height: *mut u32) -> IsophoteStatus {
    guard::on::<StyleObject>(style, |style| {
        let lengths = lock(&style.settings).lengths();
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(height, lengths.reference_height(), "the place for the height") }
    })
}

unsafe extern "C" fn style_set(
    style: IsophoteStyle,
    graph: IsophoteGraph,
    name: *const c_char,
    text: *const c_char,
    node: *mut u32,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised texts with a closing zero, and that the others may be written.
    unsafe {
        call(fault, || {
            let (style, graph) = (StyleObject::slots().get(style.id)?, GraphObject::slots().get(graph.id)?);
            let (name, text) = (args::text(name, "the parameter's name")?, args::text(text, "the value")?);
            let found = lock(&style.settings).set(&mut graph.lock(), name, text)?;
            args::put_if_wanted(node, found.index() as u32);
            Ok(())
        })
    }
}

unsafe extern "C" fn style_at_frame(
    style: IsophoteStyle,
    graph: IsophoteGraph,
    frame: i64,
    changes: *mut u32,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised that both places may be written.
    unsafe {
        call(fault, || {
            let (style, graph) = (StyleObject::slots().get(style.id)?, GraphObject::slots().get(graph.id)?);
            let is_animated = lock(&style.settings).at_frame(&mut graph.lock(), frame)?;
            args::put_if_wanted(changes, u32::from(is_animated));
            Ok(())
        })
    }
}

unsafe extern "C" fn style_value(
    style: IsophoteStyle,
    name: *const c_char,
    frame: i64,
    text: *mut IsophoteText,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised text with a closing zero, and that the others may be written.
    unsafe {
        call(fault, || {
            let style = StyleObject::slots().get(style.id)?;
            let name = args::text(name, "the parameter's name")?;
            let value = lock(&style.settings).value(name, frame).ok_or_else(|| {
                Failure::new(ISOPHOTE_ERROR_UNKNOWN, format!("no parameter '{name}' has keyframes"))
            })?;
            Ok(args::fill(text, &value)?)
        })
    }
}

unsafe extern "C" fn style_frames(
    style: IsophoteStyle,
    frames: *mut i64,
    capacity: u32,
    count: *mut u32,
) -> IsophoteStatus {
    guard::on::<StyleObject>(style, |style| {
        let found = lock(&style.settings).frames();
        if frames.is_null() && capacity > 0 {
            return Err(Failure::argument("the frames have a capacity and no place"));
        }
        for (at, frame) in found.iter().enumerate().take(capacity as usize) {
            // SAFETY: the host promised room for so many numbers.
            unsafe { frames.add(at).write_unaligned(*frame) };
        }
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(count, found.len() as u32, "the place for the number of frames") }
    })
}

unsafe extern "C" fn style_left_out(
    style: IsophoteStyle,
    faults: *mut IsophoteText,
    fault: *mut IsophoteFault,
) -> IsophoteStatus {
    // SAFETY: the host promised that both may be written.
    unsafe {
        call(fault, || {
            let style = StyleObject::slots().get(style.id)?;
            let left_out = json!(lock(&style.settings).left_out()).to_string();
            Ok(args::fill(faults, &left_out)?)
        })
    }
}
