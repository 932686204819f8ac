//! The effect for looks: the graph that its choice or its file stands for.

use super::clips::{guide_clip, guide_label, is_connected};
use super::host::Host;
use super::image::Clip;
use super::preset_files::{self, Opened};
use super::shipped;
use super::values::Values;
use isophote::graph::GraphInput;
use isophote::preset::Settings;
use isophote::spec::{MIX, Param};
use isophote::{Graph, Value, registry};
use isophote_abi::openfx::Handle;
use std::ffi::CStr;
use std::path::PathBuf;

/// Names of its controls. The choice has the name that it has in the effects of styles.
pub const LOOK: &CStr = c"look";
pub const FILE: &CStr = c"file";
pub const RELOAD: &CStr = c"reload";
pub const TIMES_READ: &CStr = c"times_read";

/// The option for a file, before those of what ships.
pub const FROM_FILE: &CStr = c"From file";
/// Position of the default option.
pub const DEFAULT: usize = 1;

/// Numbers that are the effect's own, and no node's.
pub fn own_numbers() -> [Option<&'static Param>; 2] {
    let steady = registry::nodes().iter().find(|node| node.is_steady());
    [steady.and_then(|node| node.param(STEADINESS)).map(|(_, param)| param), Some(&MIX)]
}

const STEADINESS: &str = "steadiness";

/// Graph that an instance shows at a time, with all that is known of it.
#[derive(Debug)]
pub struct Shown {
    /// The graph with its values.
    pub graph: Graph,
    /// True where its lengths are pixels of the picture, whatever the effect's reference height.
    pub in_pixels: bool,
    /// True where its values differ from frame to frame.
    pub varies: bool,
    /// True where it comes from a file.
    pub is_file: bool,
    /// Reason why the source is passed on instead, and what to do, for people.
    pub fault: Option<String>,
    /// Rules for things that are not followed, and what to do, for people.
    pub left_out: Option<String>,
}

/// The look of an instance at the time of its values.
pub fn shown(host: &Host, instance: Handle, values: &Values<'_>) -> Shown {
    let option = values.index(LOOK).unwrap_or(DEFAULT);
    let is_file = option == 0;
    let found = if is_file {
        from_file(host, instance, values).and_then(|opened| {
            let shown = at_frame(&opened.graph, &opened.settings, values)?;
            Ok(Shown { left_out: left_out(host, instance, &opened), ..shown })
        })
    } else {
        let shipped = shipped::all().get(option - 1).ok_or_else(|| UNKNOWN.to_owned());
        shipped.and_then(|shipped| at_frame(&shipped.graph, &shipped.settings, values))
    };
    found.map(|shown| Shown { is_file, ..shown }).unwrap_or_else(|fault| Shown {
        graph: stand_in(),
        in_pixels: false,
        varies: false,
        is_file,
        fault: Some(fault),
        left_out: None,
    })
}

const UNKNOWN: &str = "The project was saved by a newer Isophote, with a look that this one does not have. Update Isophote, or choose \
                       another look.";

/// A graph that is not run.
pub fn stand_in() -> Graph {
    shipped::all().first().map(|shipped| shipped.graph.clone()).unwrap_or_default()
}

fn from_file(host: &Host, instance: Handle, values: &Values<'_>) -> Result<std::sync::Arc<Opened>, String> {
    let path = path(values).ok_or("No file is chosen. Choose a preset or a graph (.json) under File.")?;
    let opened = preset_files::open(&path)?;
    let missing = |name: &&CStr| !is_connected(host, instance, name);
    for guide in &opened.needs {
        if guide_clip(*guide).as_ref().is_none_or(missing) {
            let label = guide_label(*guide).map(CStr::to_string_lossy).unwrap_or_default();
            return Err(format!("{} needs the clip {label}. Connect it.", path.display()));
        }
    }
    Ok(opened)
}

/// The rules for things of a file that are not followed, and what to do.
fn left_out(host: &Host, instance: Handle, opened: &Opened) -> Option<String> {
    let left_out: Vec<String> = opened.settings.left_out().iter().map(ToString::to_string).collect();
    if !left_out.is_empty() {
        return Some(format!("Some rules for things are left out. {}.", left_out.join(". ")));
    }
    let is_missing = |guide| {
        let is_told = opened.graph.rules().iter().any(|rule| rule.things.guide() == guide);
        is_told && guide_clip(guide).is_none_or(|name| !is_connected(host, instance, name))
    };
    if is_missing(GraphInput::ObjectId) {
        return Some("The look has rules for things by number. Connect the clip Object id.".to_owned());
    }
    if is_missing(GraphInput::Cryptomatte) {
        let connect =
            "Connect its first layer (as crypto_object00), as RGBA floats, to the clip Cryptomatte.";
        return Some(format!("The look has rules for things by their names in a Cryptomatte. {connect}"));
    }
    let by_name = opened.graph.rules().iter().any(|rule| rule.things.guide() == GraphInput::Cryptomatte);
    let clip = guide_clip(GraphInput::Cryptomatte).and_then(|name| Clip::of(host, instance, name));
    (by_name && clip.is_some_and(|clip| clip.is_short())).then(|| {
        "The clip Cryptomatte has no 32-bit floats, which names of things are. Give it floats that nothing has converted."
            .to_owned()
    })
}

/// The file that is chosen.
fn path(values: &Values<'_>) -> Option<PathBuf> {
    let text = values.text(FILE)?.into_string().ok()?;
    let text = text.trim();
    (!text.is_empty()).then(|| PathBuf::from(text))
}

fn at_frame(graph: &Graph, settings: &Settings, values: &Values<'_>) -> Result<Shown, String> {
    let mut graph = graph.clone();
    let frame = values.time.floor() as i64;
    let varies = settings.at_frame(&mut graph, frame).map_err(|fault| fault.to_string())?;
    steady(&mut graph, values).map_err(|error| error.to_string())?;
    let in_pixels = settings.lengths().reference_height() == 0;
    Ok(Shown { graph, in_pixels, varies, is_file: false, fault: None, left_out: None })
}

/// Gives nodes the steadiness of the effect, unless theirs is greater.
fn steady(graph: &mut Graph, values: &Values<'_>) -> isophote::Result<()> {
    let [Some(param), _] = own_numbers() else { return Ok(()) };
    let Some(Value::Float(wanted)) = values.value(c"steadiness", param) else { return Ok(()) };
    for index in 0..graph.len() {
        let node = graph.node(index)?;
        if graph.spec(node)?.is_steady()
            && let Value::Float(own) = graph.value(node, STEADINESS)?
            && own < wanted
        {
            graph.set(node, STEADINESS, Value::Float(wanted))?;
        }
    }
    graph.looks_mut().iter_mut().try_for_each(|look| steady(&mut look.graph, values))
}

/// Share of the result in the picture.
pub fn mix(values: &Values<'_>) -> f32 {
    match values.value(c"mix", &MIX) {
        Some(Value::Float(mix)) => mix,
        _ => 1.0,
    }
}

/// True where a graph has a node that can be steady over time.
pub fn can_be_steady(graph: &Graph) -> bool {
    let specs = (0..graph.len()).filter_map(|index| graph.spec(graph.node(index).ok()?).ok());
    specs.into_iter().any(|spec| spec.is_steady())
        || graph.looks().iter().any(|look| can_be_steady(&look.graph))
}

/// Reads the file again where the user asks. The host is given another number, by which it knows that its frames are old.
pub fn edited(values: &Values<'_>, name: &CStr) {
    if name != RELOAD {
        return;
    }
    path(values).iter().for_each(|path| preset_files::forget(path));
    let times = values.int(TIMES_READ).unwrap_or_default();
    values.set_int(TIMES_READ, times.checked_add(1).unwrap_or_default());
}
