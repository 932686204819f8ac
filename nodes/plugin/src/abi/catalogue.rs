//! The catalogue: the nodes' declarations as plain data, made once and kept for the process's life.

use super::args;
use super::failure::{Failure, Outcome};
use super::guard;
use isophote::Value;
use isophote::registry;
use isophote::spec::{ImageKind, NodeSpec, Param, Port, Unit};
use isophote::value::{Choice, decimal};
use isophote_abi::*;
use std::collections::HashMap;
use std::ffi::{CString, c_char};
use std::ptr::null;
use std::sync::OnceLock;

/// All nodes, in the registry's order.
struct Catalogue {
    nodes: Vec<IsophoteNode>,
    /// Position of each node by id.
    index: HashMap<&'static str, usize>,
}

// SAFETY: the catalogue is never written once made, and all it points to is leaked and constant.
unsafe impl Send for Catalogue {}
// SAFETY: as above.
unsafe impl Sync for Catalogue {}

fn all() -> &'static Catalogue {
    static CATALOGUE: OnceLock<Catalogue> = OnceLock::new();
    CATALOGUE.get_or_init(|| {
        let specs = registry::nodes();
        Catalogue {
            nodes: specs.iter().map(|spec| node(spec)).collect(),
            index: specs.iter().enumerate().map(|(i, spec)| (spec.id, i)).collect(),
        }
    })
}

/// A node as the catalogue shows it.
///
/// # Errors
/// Unknown when the registry has no such node.
pub fn entry(spec: &NodeSpec) -> Outcome<&'static IsophoteNode> {
    let all = all();
    all.index.get(spec.id).and_then(|i| all.nodes.get(*i)).ok_or_else(|| {
        Failure::new(ISOPHOTE_ERROR_UNKNOWN, format!("node '{}' is not in the catalogue", spec.id))
    })
}

/// Id of an option of a choice, for the process's life.
pub fn option_id(spec: &NodeSpec, param: usize, option: usize) -> Outcome<*const c_char> {
    let entry = entry(spec)?;
    let missing = || Failure::new(ISOPHOTE_ERROR_UNKNOWN, format!("node '{}' has no such option", spec.id));
    // SAFETY: the catalogue's arrays have the lengths beside them, and live for ever.
    let params = unsafe { std::slice::from_raw_parts(entry.params, entry.param_count as usize) };
    let param = params.get(param).filter(|p| !p.choices.is_null()).ok_or_else(missing)?;
    // SAFETY: as above.
    let choices = unsafe { std::slice::from_raw_parts(param.choices, param.choice_count as usize) };
    Ok(choices.get(option).ok_or_else(missing)?.id)
}

pub(super) unsafe extern "C" fn catalogue(catalogue: *mut IsophoteCatalogue) -> IsophoteStatus {
    guard::call(
        || {
            let nodes = &all().nodes;
            let value = IsophoteCatalogue { nodes: nodes.as_ptr(), node_count: nodes.len() as u32 };
            // SAFETY: the host promised that the place may be written.
            unsafe { args::put(catalogue, value, "the place for the catalogue") }
        },
        |_| {},
    )
}

pub(super) unsafe extern "C" fn find_node(
    id: *const c_char,
    error: *mut IsophoteText,
    node: *mut *const IsophoteNode,
) -> IsophoteStatus {
    let body = || {
        // SAFETY: the host promised text with a closing zero, and that the place may be written.
        unsafe {
            let spec = registry::find(args::text(id, "the node's id")?)?;
            args::put(node, entry(spec)?, "the place for the node")
        }
    };
    // SAFETY: the host promised that the message may be written.
    guard::call(body, |message| unsafe { args::fill_message(error, message) })
}

fn node(spec: &NodeSpec) -> IsophoteNode {
    let inputs: Vec<IsophotePort> = spec.ports().map(port).collect();
    let params: Vec<IsophoteParam> = spec.params().map(param).collect();
    IsophoteNode {
        id: lasting(spec.id),
        label: lasting(spec.label),
        group: lasting(spec.group),
        doc: lasting(&spec.text()),
        section: lasting(spec.section),
        input_count: inputs.len() as u32,
        param_count: params.len() as u32,
        inputs: inputs.leak().as_ptr(),
        params: params.leak().as_ptr(),
        output: port(&spec.output),
    }
}

fn port(port: &Port) -> IsophotePort {
    IsophotePort {
        id: lasting(port.id),
        doc: lasting(port.doc),
        kind: kind(port.kind),
        optional: u32::from(port.optional),
    }
}

fn param(param: &Param) -> IsophoteParam {
    let choices: Vec<IsophoteChoice> = param.options.iter().map(choice).collect();
    let [minimum, maximum] = param.range.map(decimal);
    let [slider_minimum, slider_maximum] = param.slider.map(decimal);
    IsophoteParam {
        id: lasting(param.id),
        label: lasting(param.label),
        doc: lasting(&param.text()),
        group: lasting(param.group),
        kind: param_type(param.default).kind,
        unit: match param.unit {
            Unit::None => ISOPHOTE_UNIT_NONE,
            Unit::Pixels => ISOPHOTE_UNIT_PIXELS,
            Unit::Percent => ISOPHOTE_UNIT_PERCENT,
            Unit::Degrees => ISOPHOTE_UNIT_DEGREES,
        },
        structural: u32::from(param.structural),
        choice_count: choices.len() as u32,
        choices: if choices.is_empty() { null() } else { choices.leak().as_ptr() },
        default_value: param.default.decimals(),
        minimum,
        maximum,
        slider_minimum,
        slider_maximum,
    }
}

fn choice(choice: &Choice) -> IsophoteChoice {
    IsophoteChoice { id: lasting(choice.id), label: lasting(choice.label) }
}

/// A type of parameter in the C interface.
pub struct ParamType {
    /// Its number.
    pub kind: IsophoteParamKind,
    /// For messages: what it is, and what sets it.
    pub name: &'static str,
}

/// The type of a value.
pub fn param_type(value: Value) -> ParamType {
    let (kind, name) = match value {
        Value::Float(_) => (ISOPHOTE_PARAM_FLOAT, "a number; set it with graph_set_float"),
        Value::Int(_) => (ISOPHOTE_PARAM_INT, "a whole number; set it with graph_set_int"),
        Value::Bool(_) => (ISOPHOTE_PARAM_BOOL, "a switch; set it with graph_set_bool"),
        Value::Choice(_) => (ISOPHOTE_PARAM_CHOICE, "a choice; set it with graph_set_choice"),
        Value::Color(_) => (ISOPHOTE_PARAM_COLOR, "a colour; set it with graph_set_color"),
    };
    ParamType { kind, name }
}

/// The number of a kind of image.
pub fn kind(kind: ImageKind) -> IsophoteKind {
    match kind {
        ImageKind::Color => ISOPHOTE_KIND_COLOR,
        ImageKind::Scalar => ISOPHOTE_KIND_SCALAR,
        ImageKind::Tensor => ISOPHOTE_KIND_TENSOR,
        ImageKind::Normal => ISOPHOTE_KIND_NORMAL,
        ImageKind::Depth => ISOPHOTE_KIND_DEPTH,
        ImageKind::ObjectId => ISOPHOTE_KIND_OBJECT_ID,
        ImageKind::Control => ISOPHOTE_KIND_CONTROL,
        ImageKind::Hatching => ISOPHOTE_KIND_HATCHING,
        ImageKind::Cryptomatte => ISOPHOTE_KIND_CRYPTOMATTE,
        ImageKind::Flow => ISOPHOTE_KIND_FLOW,
        ImageKind::Motion => ISOPHOTE_KIND_MOTION,
        ImageKind::Position => ISOPHOTE_KIND_POSITION,
    }
}

/// Text with a closing zero that is never freed.
pub fn lasting(text: &str) -> *const c_char {
    // A zero within the text would end it early, which no declaration means.
    let bytes: Vec<u8> = text.bytes().filter(|b| *b != 0).collect();
    CString::new(bytes).unwrap_or_default().into_raw()
}
