//! The catalogue: the nodes' declarations as plain data, made once and kept for the process's life.

use super::args;
use super::contract::*;
use super::failure::{Failure, Outcome};
use super::guard;
use isophote::registry;
use isophote::spec::{Choice, ImageKind, NodeSpec, Param, ParamKind, Port, Unit};
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
    all.index
        .get(spec.id)
        .and_then(|i| all.nodes.get(*i))
        .ok_or_else(|| Failure::new(ISOPHOTE_UNKNOWN, format!("node '{}' is not in the catalogue", spec.id)))
}

/// Id of an option of a choice, for the process's life.
pub fn option_id(spec: &NodeSpec, param: usize, option: usize) -> Outcome<*const c_char> {
    let entry = entry(spec)?;
    let missing = || Failure::new(ISOPHOTE_UNKNOWN, format!("node '{}' has no such option", spec.id));
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
    let inputs: Vec<IsophotePort> = spec.inputs.iter().map(port).collect();
    let params: Vec<IsophoteParam> = spec.params().map(param).collect();
    IsophoteNode {
        id: lasting(spec.id),
        label: lasting(spec.label),
        group: lasting(spec.group),
        doc: lasting(spec.doc),
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
    let mut out = IsophoteParam {
        id: lasting(param.id),
        label: lasting(param.label),
        doc: lasting(param.doc),
        group: lasting(param.group),
        kind: param_kind(&param.kind),
        unit: match param.unit {
            Unit::None => ISOPHOTE_UNIT_NONE,
            Unit::Pixels => ISOPHOTE_UNIT_PIXELS,
            Unit::Percent => ISOPHOTE_UNIT_PERCENT,
            Unit::Degrees => ISOPHOTE_UNIT_DEGREES,
        },
        structural: u32::from(param.structural),
        choice_count: 0,
        choices: null(),
        default_value: [0.0; 4],
        minimum: 0.0,
        maximum: 1.0,
        slider_minimum: 0.0,
        slider_maximum: 1.0,
    };
    match param.kind {
        ParamKind::Float { default, range, slider } => {
            out.default_value[0] = decimal(default);
            [out.minimum, out.maximum] = range.map(decimal);
            [out.slider_minimum, out.slider_maximum] = slider.map(decimal);
        }
        ParamKind::Int { default, range, slider } => {
            out.default_value[0] = f64::from(default);
            [out.minimum, out.maximum] = range.map(f64::from);
            [out.slider_minimum, out.slider_maximum] = slider.map(f64::from);
        }
        ParamKind::Bool { default } => out.default_value[0] = f64::from(u8::from(default)),
        ParamKind::Choice { default, options } => {
            let choices: Vec<IsophoteChoice> = options.iter().map(choice).collect();
            out.default_value[0] = default as f64;
            out.maximum = choices.len().saturating_sub(1) as f64;
            out.slider_maximum = out.maximum;
            out.choice_count = choices.len() as u32;
            out.choices = choices.leak().as_ptr();
        }
        ParamKind::Color { default } => out.default_value = default.map(decimal),
    }
    out
}

fn choice(choice: &Choice) -> IsophoteChoice {
    IsophoteChoice { id: lasting(choice.id), label: lasting(choice.label) }
}

/// The number of a type of parameter.
pub fn param_kind(kind: &ParamKind) -> IsophoteParamKind {
    match kind {
        ParamKind::Float { .. } => ISOPHOTE_PARAM_FLOAT,
        ParamKind::Int { .. } => ISOPHOTE_PARAM_INT,
        ParamKind::Bool { .. } => ISOPHOTE_PARAM_BOOL,
        ParamKind::Choice { .. } => ISOPHOTE_PARAM_CHOICE,
        ParamKind::Color { .. } => ISOPHOTE_PARAM_COLOR,
    }
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
    }
}

/// The double that prints like the float: 0.1, not 0.10000000149.
pub fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// Text with a closing zero that is never freed.
pub fn lasting(text: &str) -> *const c_char {
    // A zero within the text would end it early, which no declaration means.
    let bytes: Vec<u8> = text.bytes().filter(|b| *b != 0).collect();
    CString::new(bytes).unwrap_or_default().into_raw()
}
