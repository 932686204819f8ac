//! Values that a plugin sets: within the ranges that it described, outside renders, in steps that begin and end; and what it is
//! told of them.

use super::handles::owned;
use super::objects::{Effect, MAGIC, Param, Step};
use super::properties::{Set, Value};
use super::state::{self, fault, lock};
use isophote_abi::openfx::*;
use std::ffi::{c_char, c_int, c_void};

/// The parameter behind a handle, or a fault.
fn param<'a>(handle: Handle, what: &str) -> Option<&'a Param> {
    // SAFETY: handles lead to things of this host that live while plugins may use them, or to null.
    let found = unsafe { handle.cast::<Param>().as_ref() }.filter(|param| param.magic == MAGIC);
    if found.is_none() {
        fault(format!("{what}: not a parameter"));
    }
    found
}

/// The instance of a parameter.
fn instance_of(param: &Param) -> Option<&Effect> {
    // SAFETY: an instance outlives its parameters.
    unsafe { (param.instance as *const Effect).as_ref() }
}

/// The instance of a set of parameters.
fn instance_of_set<'a>(set: Handle, what: &str) -> Option<&'a Effect> {
    // SAFETY: as in `param`.
    let owner = unsafe { super::properties::of(set, what) }?.owner;
    // SAFETY: as in `param`.
    let effect = unsafe { (owner as *const Effect).as_ref() }?;
    (effect.magic == MAGIC && effect.is_instance).then_some(effect)
}

/// Type of the values of a parameter: 'i', 'd', 's', or 0 for none.
pub(super) extern "C" fn kind_of(handle: *mut c_void) -> c_char {
    let kind = param(handle, "a value").map(|param| param.kind.as_c_str());
    let letter = match kind {
        Some(k) if k == kOfxParamTypeDouble || k == kOfxParamTypeRGBA => b'd',
        Some(k) if k == kOfxParamTypeString => b's',
        Some(k) if k == kOfxParamTypeInteger || k == kOfxParamTypeBoolean || k == kOfxParamTypeChoice => b'i',
        _ => 0,
    };
    letter as c_char
}

/// Notes values that the parameter cannot have.
fn check(param: &Param, values: &[Value]) {
    let set = &param.set;
    let ends = [kOfxParamPropMin, kOfxParamPropMax].map(|end| set.numbers(end).first().copied());
    let options = set.texts(kOfxParamPropChoiceOption).len() as i32;
    for value in values {
        let fits = match (param.kind.as_c_str(), value) {
            (k, Value::Int(v)) if k == kOfxParamTypeChoice => (0..options).contains(v),
            (k, Value::Int(v)) if k == kOfxParamTypeBoolean => (0..2).contains(v),
            (_, Value::Int(v)) => within(f64::from(*v), ends),
            (_, Value::Double(v)) => v.is_finite() && within(*v, ends),
            _ => true,
        };
        if !fits {
            set.host.fault(format!("{:?} is set to {value:?}", param.name));
        }
    }
}

fn within(value: f64, [low, high]: [Option<f64>; 2]) -> bool {
    low.is_none_or(|low| value >= low) && high.is_none_or(|high| value <= high)
}

pub(super) unsafe extern "C" fn set_value(
    handle: *mut c_void,
    count: c_int,
    whole: *const c_int,
    numbers: *const f64,
    text: *const c_char,
) -> c_int {
    let Some(param) = param(handle, "paramSetValue") else { return kOfxStatErrBadHandle };
    // SAFETY: the C function gives as many values of each type, and a text or null.
    let value = |index: usize| unsafe {
        match kind_of(handle) as u8 {
            b'i' => Some(Value::Int(*whole.add(index))),
            b'd' => Some(Value::Double(*numbers.add(index))),
            b's' => owned(text).map(Value::String),
            _ => None,
        }
    };
    let Some(values) = (0..count as usize).map(value).collect::<Option<Vec<Value>>>() else {
        param.set.host.fault(format!("{:?} cannot be set", param.name));
        return kOfxStatErrValue;
    };
    let Some(instance) = instance_of(param) else {
        param.set.host.fault(format!("{:?} is set before there is an instance", param.name));
        return kOfxStatErrBadHandle;
    };
    if state::rendered().is_some() {
        instance.host.fault(format!("{:?} is set while a frame is rendered", param.name));
    }
    check(param, &values);
    note(instance, param);
    *lock(&param.value) = values;
    tell(instance, param)
}

/// Notes what a parameter was, for undoing.
fn note(instance: &Effect, param: &Param) {
    let before = (param.name.clone(), lock(&param.value).clone(), lock(&param.keys).clone());
    let mut edits = lock(&instance.edits);
    match &mut edits.open {
        Some(step) => step.before.push(before),
        None => edits.done.push(Step { label: None, before: vec![before] }),
    }
}

/// Tells the plugin at once, as hosts do, that a value is another.
fn tell(instance: &Effect, param: &Param) -> OfxStatus {
    let Some(entry) = *lock(&instance.entry) else { return kOfxStatOK };
    let args = Set::new(&instance.host, "arguments");
    args.put(kOfxPropName, vec![param.name.as_c_str().into()]);
    args.put(kOfxPropType, vec![kOfxTypeParameter.into()]);
    args.put(kOfxPropChangeReason, vec![kOfxChangePluginEdited.into()]);
    args.put(kOfxPropTime, vec![0.0.into()]);
    args.put(kOfxImageEffectPropRenderScale, vec![1.0.into(); 2]);
    let action = kOfxActionInstanceChanged.as_ptr();
    // SAFETY: the plugin's own function, with handles of this host.
    let status =
        unsafe { entry(action, instance.handle().cast_const(), args.handle(), std::ptr::null_mut()) };
    if status != kOfxStatOK && status != kOfxStatReplyDefault {
        instance.host.fault(format!("InstanceChanged by the plugin itself: {status}"));
    }
    kOfxStatOK
}

pub(super) unsafe extern "C" fn forget_keys(handle: Handle) -> OfxStatus {
    let Some(param) = param(handle, "paramDeleteAllKeys") else { return kOfxStatErrBadHandle };
    let Some(instance) = instance_of(param) else { return kOfxStatErrBadHandle };
    note(instance, param);
    lock(&param.keys).clear();
    kOfxStatOK
}

pub(super) unsafe extern "C" fn begin(set: Handle, label: *const c_char) -> OfxStatus {
    let Some(instance) = instance_of_set(set, "paramEditBegin") else { return kOfxStatErrBadHandle };
    // SAFETY: the plugin gives a string with a closing zero.
    let label = unsafe { owned(label) };
    if label.is_none() {
        instance.host.fault("paramEditBegin without a label");
    }
    let mut edits = lock(&instance.edits);
    if edits.open.is_some() {
        instance.host.fault("paramEditBegin twice");
    }
    edits.open = Some(Step { label, before: Vec::new() });
    kOfxStatOK
}

pub(super) unsafe extern "C" fn end(set: Handle) -> OfxStatus {
    let Some(instance) = instance_of_set(set, "paramEditEnd") else { return kOfxStatErrBadHandle };
    let mut edits = lock(&instance.edits);
    match edits.open.take() {
        Some(step) if step.before.is_empty() => instance.host.fault("a step without a value"),
        Some(step) => edits.done.push(step),
        None => instance.host.fault("paramEditEnd without a beginning"),
    }
    kOfxStatOK
}
