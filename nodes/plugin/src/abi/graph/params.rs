//! Parameters of a graph's nodes: one function for each type, one for text, one to read.

use super::{node, on_graph};
use crate::abi::args;
use crate::abi::catalogue::{self, decimal};
use crate::abi::contract::*;
use crate::abi::failure::{Failure, Outcome};
use isophote::spec::{Param, ParamKind};
use isophote::{Graph, NodeId, Value};
use std::ffi::c_char;
use std::ptr::null;

fn set(
    graph: IsophoteGraph,
    index: u32,
    param: *const c_char,
    fits: fn(&ParamKind) -> bool,
    value: impl FnOnce(&Param, &Graph, NodeId) -> Outcome<Value>,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        let node = node(graph, index)?;
        // SAFETY: the host promised text with a closing zero.
        let id = unsafe { args::text(param, "the parameter's id")? };
        let spec = graph.spec(node)?;
        let Some((_, declared)) = spec.param(id) else {
            // Fails with the nearest name.
            graph.value(node, id)?;
            return Err(Failure::new(ISOPHOTE_UNKNOWN, format!("there is no parameter '{id}'")));
        };
        if !fits(&declared.kind) {
            return Err(Failure::new(
                ISOPHOTE_WRONG_TYPE,
                format!("parameter '{id}' of '{}' is {}", spec.id, type_name(&declared.kind)),
            ));
        }
        let value = value(declared, graph, node)?;
        Ok(graph.set(node, id, value)?)
    })
}

fn type_name(kind: &ParamKind) -> &'static str {
    match kind {
        ParamKind::Float { .. } => "a number; set it with graph_set_float",
        ParamKind::Int { .. } => "a whole number; set it with graph_set_int",
        ParamKind::Bool { .. } => "a switch; set it with graph_set_bool",
        ParamKind::Choice { .. } => "a choice; set it with graph_set_choice",
        ParamKind::Color { .. } => "a colour; set it with graph_set_color",
    }
}

pub(in crate::abi) unsafe extern "C" fn set_float(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    value: f64,
) -> IsophoteStatus {
    set(
        graph,
        node,
        param,
        |kind| matches!(kind, ParamKind::Float { .. }),
        |_, _, _| Ok(Value::Float(value as f32)),
    )
}

pub(in crate::abi) unsafe extern "C" fn set_int(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    value: i32,
) -> IsophoteStatus {
    set(
        graph,
        node,
        param,
        |kind| matches!(kind, ParamKind::Int { .. } | ParamKind::Float { .. }),
        |_, _, _| Ok(Value::Int(value)),
    )
}

pub(in crate::abi) unsafe extern "C" fn set_bool(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    value: u32,
) -> IsophoteStatus {
    set(
        graph,
        node,
        param,
        |kind| matches!(kind, ParamKind::Bool { .. }),
        |_, _, _| Ok(Value::Bool(value != 0)),
    )
}

pub(in crate::abi) unsafe extern "C" fn set_choice(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    option: *const c_char,
) -> IsophoteStatus {
    set(
        graph,
        node,
        param,
        |kind| matches!(kind, ParamKind::Choice { .. }),
        |declared, graph, node| {
            // SAFETY: the host promised text with a closing zero.
            let id = unsafe { args::text(option, "the option's id")? };
            match declared.kind {
                ParamKind::Choice { options, .. } => {
                    let index = isophote::values::option(graph.spec(node)?, declared, options, id)?;
                    Ok(Value::Choice(index))
                }
                _ => Err(Failure::new(ISOPHOTE_WRONG_TYPE, type_name(&declared.kind))),
            }
        },
    )
}

pub(in crate::abi) unsafe extern "C" fn set_color(
    graph: IsophoteGraph,
    node: u32,
    param: *const c_char,
    rgba: *const f32,
) -> IsophoteStatus {
    set(
        graph,
        node,
        param,
        |kind| matches!(kind, ParamKind::Color { .. }),
        |_, _, _| {
            // SAFETY: the host promised four numbers.
            let rgba = unsafe { args::get(rgba.cast::<[f32; 4]>(), "the colour")? };
            Ok(Value::Color(rgba))
        },
    )
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
        let (at, declared) = spec
            .param(id)
            .ok_or_else(|| Failure::new(ISOPHOTE_UNKNOWN, format!("there is no parameter '{id}'")))?;
        let mut out = IsophoteValue {
            kind: catalogue::param_kind(&declared.kind),
            choice_index: 0,
            choice: null(),
            number: [0.0; 4],
        };
        match current {
            Value::Float(v) => out.number[0] = decimal(v),
            Value::Int(v) => out.number[0] = f64::from(v),
            Value::Bool(v) => out.number[0] = f64::from(u8::from(v)),
            Value::Choice(v) => {
                out.number[0] = v as f64;
                out.choice_index = v as u32;
                out.choice = catalogue::option_id(spec, at, v)?;
            }
            Value::Color(v) => out.number = v.map(decimal),
        }
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(value, out, "the place for the value") }
    })
}
