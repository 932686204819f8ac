//! Values of an instance's parameters: read at a time, and set for the user.

use super::host::{Host, Outcome};
use isophote::Value;
use isophote::spec::Param;
use isophote_abi::openfx::*;
use std::ffi::{CStr, CString, c_char, c_int};
use std::ptr::null_mut;

/// Parameters of an instance at a time.
pub struct Values<'h> {
    pub host: &'h Host,
    set: Handle,
    pub time: f64,
}

impl<'h> Values<'h> {
    /// Values of an instance at a time.
    ///
    /// # Errors
    /// Failed, when the host has no parameters.
    pub fn of(host: &'h Host, instance: Handle, time: f64) -> Outcome<Self> {
        Ok(Self { host, set: host.params(instance)?, time })
    }

    fn handle(&self, name: &CStr) -> Option<Handle> {
        let get = self.host.parameters.paramGetHandle?;
        let mut param = null_mut();
        // SAFETY: a set that the host gave, a string with a closing zero, a place for the answer, and no
        // wish for the properties.
        let status = unsafe { get(self.set, name.as_ptr(), &raw mut param, null_mut()) };
        (status == kOfxStatOK && !param.is_null()).then_some(param)
    }

    /// True where it has values of its own at different times.
    pub fn is_animated(&self, name: &CStr) -> bool {
        let Some((param, count)) = self.handle(name).zip(self.host.parameters.paramGetNumKeys) else {
            return false;
        };
        let mut keys = 0;
        // SAFETY: a parameter that the host gave, and a place for the answer.
        unsafe { count(param, &raw mut keys) == kOfxStatOK && keys > 0 }
    }

    /// A whole number, a switch or the position of an option.
    pub fn int(&self, name: &CStr) -> Option<c_int> {
        let (param, get) = (self.handle(name)?, self.host.parameters.paramGetValueAtTime?);
        let mut value: c_int = 0;
        // SAFETY: integers, booleans and choices are given through one pointer to an int.
        let status = unsafe { get(param, self.time, &raw mut value) };
        (status == kOfxStatOK).then_some(value)
    }

    /// The position of a choice's option.
    pub fn index(&self, name: &CStr) -> Option<usize> {
        usize::try_from(self.int(name)?).ok()
    }

    /// A switch.
    pub fn bool(&self, name: &CStr) -> Option<bool> {
        Some(self.int(name)? != 0)
    }

    fn double(&self, name: &CStr) -> Option<f64> {
        let (param, get) = (self.handle(name)?, self.host.parameters.paramGetValueAtTime?);
        let mut value: f64 = 0.0;
        // SAFETY: doubles are given through one pointer to a double.
        let status = unsafe { get(param, self.time, &raw mut value) };
        (status == kOfxStatOK && !value.is_nan()).then_some(value)
    }

    fn color(&self, name: &CStr) -> Option<[f64; 4]> {
        let (param, get) = (self.handle(name)?, self.host.parameters.paramGetValueAtTime?);
        let mut value = [0.0_f64; 4];
        let [r, g, b, a] = &mut value;
        // SAFETY: colours with alpha are given through four pointers to doubles.
        let status = unsafe { get(param, self.time, &raw mut *r, &raw mut *g, &raw mut *b, &raw mut *a) };
        (status == kOfxStatOK && !value.iter().any(|v| v.is_nan())).then_some(value)
    }

    /// A text, copied.
    pub fn text(&self, name: &CStr) -> Option<CString> {
        let (param, get) = (self.handle(name)?, self.host.parameters.paramGetValueAtTime?);
        let mut value: *mut c_char = null_mut();
        // SAFETY: texts are given through one pointer to a pointer, valid until the next call and copied before it.
        unsafe {
            let status = get(param, self.time, &raw mut value);
            (status == kOfxStatOK && !value.is_null()).then(|| CStr::from_ptr(value).to_owned())
        }
    }

    /// A value within the range of the parameter, which not every host keeps.
    pub fn value(&self, name: &CStr, param: &Param) -> Option<Value> {
        let numbers = match param.default {
            Value::Float(_) => [self.double(name)?, 0.0, 0.0, 0.0],
            Value::Int(_) | Value::Choice(_) => [self.int(name)?.into(), 0.0, 0.0, 0.0],
            Value::Bool(_) => [u8::from(self.bool(name)?).into(), 0.0, 0.0, 0.0],
            Value::Color(_) => self.color(name)?,
        };
        Some(param.nearest(numbers))
    }

    /// Sets a whole number, a switch or a choice.
    pub fn set_int(&self, name: &CStr, value: c_int) {
        if let Some((param, set)) = self.handle(name).zip(self.host.parameters.paramSetValue) {
            // SAFETY: a parameter that the host gave; whole numbers, switches and choices are given as an int.
            unsafe { set(param, value) };
        }
    }

    /// Sets a value for all times.
    pub fn set_value(&self, name: &CStr, value: Value) {
        let Some((param, set)) = self.handle(name).zip(self.host.parameters.paramSetValue) else { return };
        if self.is_animated(name)
            && let Some(forget) = self.host.parameters.paramDeleteAllKeys
        {
            // SAFETY: a parameter that the host gave.
            unsafe { forget(param) };
        }
        let [first, second, third, fourth] = value.decimals();
        // SAFETY: numbers are given as a double, whole numbers, switches and choices as an int, and colours with alpha
        // as four doubles.
        unsafe {
            match value {
                Value::Float(_) => set(param, first),
                Value::Int(_) | Value::Bool(_) | Value::Choice(_) => set(param, first as c_int),
                Value::Color(_) => set(param, first, second, third, fourth),
            }
        };
    }

    /// Lets all that is set meanwhile be one step to undo.
    pub fn in_one_step(&self, label: &CStr, set: impl FnOnce()) {
        let both = self.host.parameters.paramEditBegin.zip(self.host.parameters.paramEditEnd);
        // SAFETY: a set that the host gave, and a string with a closing zero.
        let begun = both.filter(|(begin, _)| unsafe { begin(self.set, label.as_ptr()) } == kOfxStatOK);
        set();
        if let Some((_, end)) = begun {
            // SAFETY: as above.
            unsafe { end(self.set) };
        }
    }
}
