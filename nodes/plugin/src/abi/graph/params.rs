//! Parameters of a graph's nodes: one function for each type, one for text, one to read.

use super::{node, on_graph};
use crate::abi::args;
use crate::abi::catalogue::{self, param_type};
use crate::abi::failure::{Failure, Outcome};
use isophote::Value;
use isophote::spec::Param;
use isophote_abi::*;
use std::ffi::c_char;
use std::ptr::null;

fn set(
    graph: IsophoteGraph,
    index: u32,
    param: *const c_char,
    kinds: &[IsophoteParamKind],
    value: impl FnOnce(&Param, &str) -> Outcome<Value>,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        let node = node(graph, index)?;
        // SAFETY: the host promised text with a closing zero.
        let id = unsafe { args::text(param, "the parameter's id")? };
        let spec = graph.spec(node)?;
        let Some((_, declared)) = spec.param(id) else {
            // Fails with the nearest name.
            graph.value(node, id)?;
            return Err(Failure::new(ISOPHOTE_ERROR_UNKNOWN, format!("there is no parameter '{id}'")));
        };
        let own = param_type(declared.default);
        if !kinds.contains(&own.kind) {
            return Err(Failure::new(
                ISOPHOTE_ERROR_WRONG_TYPE,
                format!("parameter '{id}' of '{}' is {}", spec.id, own.name),
            ));
        }
        let value = value(declared, spec.id)?;
        Ok(graph.set(node, id, value)?)
    })
}

pub(in crate::abi) unsafe extern "C" fn set_float(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    value: f64,
) -> IsophoteStatus {
    set(graph, node, param, &[ISOPHOTE_PARAM_FLOAT], |_, _| Ok(Value::Float(value as f32)))
}

pub(in crate::abi) unsafe extern "C" fn set_int(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    value: i32,
) -> IsophoteStatus {
    let kinds = [ISOPHOTE_PARAM_INT, ISOPHOTE_PARAM_FLOAT];
    set(graph, node, param, &kinds, |_, _| Ok(Value::Int(value)))
}

pub(in crate::abi) unsafe extern "C" fn set_bool(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    value: u32,
) -> IsophoteStatus {
    set(graph, node, param, &[ISOPHOTE_PARAM_BOOL], |_, _| Ok(Value::Bool(value != 0)))
}

pub(in crate::abi) unsafe extern "C" fn set_choice(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    option: *const c_char,
) -> IsophoteStatus {
    set(graph, node, param, &[ISOPHOTE_PARAM_CHOICE], |declared, node| {
        // SAFETY: the host promised text with a closing zero.
        Ok(declared.parse(node, unsafe { args::text(option, "the option's id")? })?)
    })
}

pub(in crate::abi) unsafe extern "C" fn set_color(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    rgba: *const f32,
) -> IsophoteStatus {
    set(graph, node, param, &[ISOPHOTE_PARAM_COLOR], |_, _| {
        // SAFETY: the host promised four numbers.
        let rgba = unsafe { args::get(rgba.cast::<[f32; 4]>(), "the colour")? };
        Ok(Value::Color(rgba))
    })
}

pub(in crate::abi) unsafe extern "C" fn set_text(
    graph: IsophoteGraph,
    index: u32,
    param: *const c_char,
    text: *const c_char,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        // SAFETY: the host promised text with a closing zero.
        let (id, text) =
            unsafe { (args::text(param, "the parameter's id")?, args::text(text, "the value")?) };
        Ok(graph.set_text(node(graph, index)?, id, text)?)
    })
}

pub(in crate::abi) unsafe extern "C" fn get(
    graph: IsophoteGraph,
    index: u32,
    param: *const c_char,
    value: *mut IsophoteValue,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        let node = node(graph, index)?;
        // SAFETY: the host promised text with a closing zero.
        let id = unsafe { args::text(param, "the parameter's id")? };
        let current = graph.value(node, id)?;
        let spec = graph.spec(node)?;
        let mut out = IsophoteValue {
            kind: param_type(current).kind,
            choice_index: 0,
            choice: null(),
            number: current.decimals(),
        };
        if let (Value::Choice(option), Some((at, _))) = (current, spec.param(id)) {
            out.choice_index = option as u32;
            out.choice = catalogue::option_id(spec, at, option)?;
        }
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(value, out, "the place for the value") }
    })
}
