//! Property sets of the test host.

use super::handles::{Named, handle_of, owned};
use super::shapes::{REQUIRED, shape};
use super::state::{Inner, fault, lock};
use isophote_abi::openfx::*;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::sync::{Arc, Mutex, MutexGuard};

/// Value of a property.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A whole number.
    Int(i32),
    /// A number.
    Double(f64),
    /// A text.
    String(CString),
    /// An address.
    Pointer(usize),
}

impl From<i32> for Value {
    fn from(value: i32) -> Self {
        Self::Int(value)
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Double(value)
    }
}

impl From<&CStr> for Value {
    fn from(value: &CStr) -> Self {
        Self::String(value.to_owned())
    }
}

/// Begins every set, so that a handle of something else is noticed.
const MAGIC: u64 = 0x1505_4057_e5f1_7e57;

/// A property set.
#[derive(Debug)]
pub struct Set {
    magic: u64,
    /// The host.
    pub host: Arc<Inner>,
    /// Whose properties they are, for messages.
    pub what: &'static str,
    values: Mutex<Named<Vec<Value>>>,
    /// The texts that were given out.
    lent: Mutex<Vec<CString>>,
    /// Address of the set's owner, for functions that are given the set alone.
    pub owner: usize,
}

impl Set {
    /// An empty set.
    pub fn new(host: &Arc<Inner>, what: &'static str) -> Box<Self> {
        Self::owned_by(host, what, 0)
    }

    /// An empty set of something at an address.
    pub fn owned_by(host: &Arc<Inner>, what: &'static str, owner: usize) -> Box<Self> {
        Box::new(Self {
            magic: MAGIC,
            host: Arc::clone(host),
            what,
            values: Mutex::default(),
            lent: Mutex::default(),
            owner,
        })
    }

    /// Handle that plugins are given.
    pub fn handle(&self) -> Handle {
        handle_of(self)
    }

    fn values(&self) -> MutexGuard<'_, Named<Vec<Value>>> {
        lock(&self.values)
    }

    /// Sets a property as the host.
    pub fn put(&self, name: &CStr, value: Vec<Value>) {
        self.values().insert(name.to_owned(), value);
    }

    /// All values of a property.
    pub fn get(&self, name: &CStr) -> Vec<Value> {
        self.values().get(name).cloned().unwrap_or_default()
    }

    /// The first value, when it is a text.
    pub fn text(&self, name: &CStr) -> Option<String> {
        match self.get(name).first()? {
            Value::String(text) => Some(text.to_string_lossy().into_owned()),
            _ => None,
        }
    }

    /// All values, when they are texts.
    pub fn texts(&self, name: &CStr) -> Vec<String> {
        let text = |v: &Value| match v {
            Value::String(text) => Some(text.to_string_lossy().into_owned()),
            _ => None,
        };
        self.get(name).iter().filter_map(text).collect()
    }

    /// The first value, when it is a whole number.
    pub fn int(&self, name: &CStr) -> Option<i32> {
        match self.get(name).first()? {
            Value::Int(v) => Some(*v),
            _ => None,
        }
    }

    /// All values as numbers.
    pub fn numbers(&self, name: &CStr) -> Vec<f64> {
        let number = |v: &Value| match v {
            Value::Int(v) => Some(f64::from(*v)),
            Value::Double(v) => Some(*v),
            _ => None,
        };
        self.get(name).iter().filter_map(number).collect()
    }

    /// A copy for another owner: what a plugin described becomes what an instance has.
    pub fn copy(&self, what: &'static str, owner: usize) -> Box<Self> {
        let set = Self::owned_by(&self.host, what, owner);
        set.values().clone_from(&self.values());
        set
    }
}

/// The set behind a handle.
///
/// # Safety
/// The handle is null or leads to something that begins with a number.
unsafe fn set<'a>(handle: Handle, what: &str) -> Option<&'a Set> {
    // SAFETY: as the caller promised; sets outlive the calls in which plugins may use them.
    let set = unsafe { handle.cast::<Set>().as_ref() };
    match set {
        Some(set) if set.magic == MAGIC => Some(set),
        _ => {
            fault(format!("{what}: {handle:?} is no property set"));
            None
        }
    }
}

fn is_refused(set: &Set, name: &CStr) -> bool {
    let behaviour = &set.host.behaviour;
    let roi = name.to_bytes().starts_with(ROI_PREFIX.as_bytes());
    behaviour.refused.contains(&name)
        || (behaviour.refuses_optional && !roi && !REQUIRED.contains(&name))
        || (behaviour.bare && set.what != "descriptor" && !roi && !REQUIRED.contains(&name))
}

/// Every call ends the life of texts given out before.
fn bury(set: &Set) {
    let mut lent = lock(&set.lent);
    if set.host.behaviour.strings_die {
        for text in lent.drain(..) {
            // Overwritten before it is freed, so that whoever still reads it reads nonsense.
            let mut bytes = text.into_bytes_with_nul();
            bytes.fill(b'#');
            std::hint::black_box(&bytes);
        }
    }
}

unsafe fn put(handle: Handle, name: *const c_char, index: c_int, kind: char, value: Value) -> OfxStatus {
    // SAFETY: handles and names are checked as far as they can be.
    let (Some(set), Some(name)) = (unsafe { set(handle, "propSet") }, unsafe { owned(name) }) else {
        return kOfxStatErrBadHandle;
    };
    bury(set);
    let Some((wanted, most)) = shape(&name) else {
        set.host.fault(format!("{} sets {name:?}, which there is not", set.what));
        return kOfxStatErrUnknown;
    };
    if (wanted != kind && wanted != '?') || index < 0 {
        set.host.fault(format!("{} sets {name:?}[{index}] as '{kind}' and not as '{wanted}'", set.what));
        return kOfxStatErrValue;
    }
    if index >= most {
        set.host.fault(format!("{} sets {name:?}[{index}], which has {most} values", set.what));
        return kOfxStatErrBadIndex;
    }
    if is_refused(set, &name) {
        return kOfxStatErrUnknown;
    }
    let mut values = set.values();
    let list = values.entry(name.clone()).or_default();
    let index = index as usize;
    if index > list.len() {
        set.host.fault(format!("{} sets {name:?}[{index}] before those in front of it", set.what));
        return kOfxStatErrBadIndex;
    }
    if index == list.len() {
        list.push(value);
    } else {
        list[index] = value;
    }
    kOfxStatOK
}

unsafe fn get<T>(
    handle: Handle,
    name: *const c_char,
    index: c_int,
    place: *mut T,
    take: impl FnOnce(&Set, &Value) -> Option<T>,
) -> OfxStatus {
    // SAFETY: as in `put`.
    let (Some(set), Some(name)) = (unsafe { set(handle, "propGet") }, unsafe { owned(name) }) else {
        return kOfxStatErrBadHandle;
    };
    bury(set);
    if shape(&name).is_none() {
        set.host.fault(format!("{} is asked for {name:?}, which there is not", set.what));
    }
    if is_refused(set, &name) {
        return kOfxStatErrUnknown;
    }
    let value = {
        let values = set.values();
        let Some(list) = values.get(&name) else { return kOfxStatErrUnknown };
        let Some(value) = usize::try_from(index).ok().and_then(|i| list.get(i)) else {
            return kOfxStatErrBadIndex;
        };
        value.clone()
    };
    match take(set, &value) {
        Some(value) => {
            // SAFETY: the plugin gives a place for a value of the function's type.
            unsafe { place.write(value) };
            kOfxStatOK
        }
        None => {
            set.host.fault(format!("{} is asked for {name:?} as another type", set.what));
            kOfxStatErrValue
        }
    }
}

unsafe extern "C" fn set_pointer(h: Handle, n: *const c_char, i: c_int, v: *mut c_void) -> OfxStatus {
    // SAFETY: the plugin's arguments, as the standard has them.
    unsafe { put(h, n, i, 'p', Value::Pointer(v as usize)) }
}

unsafe extern "C" fn set_string(h: Handle, n: *const c_char, i: c_int, v: *const c_char) -> OfxStatus {
    // SAFETY: as above.
    let Some(text) = (unsafe { owned(v) }) else {
        fault("a null text");
        return kOfxStatErrValue;
    };
    if text.to_str().is_err() {
        fault(format!("{text:?} is no UTF-8"));
    }
    // SAFETY: as above.
    unsafe { put(h, n, i, 's', Value::String(text)) }
}

unsafe extern "C" fn set_double(h: Handle, n: *const c_char, i: c_int, v: f64) -> OfxStatus {
    // SAFETY: as above.
    unsafe { put(h, n, i, 'd', Value::Double(v)) }
}

unsafe extern "C" fn set_int(h: Handle, n: *const c_char, i: c_int, v: c_int) -> OfxStatus {
    // SAFETY: as above.
    unsafe { put(h, n, i, 'i', Value::Int(v)) }
}

unsafe extern "C" fn get_pointer(h: Handle, n: *const c_char, i: c_int, v: *mut *mut c_void) -> OfxStatus {
    let take = |_: &Set, value: &Value| match value {
        Value::Pointer(address) => Some(*address as *mut c_void),
        _ => None,
    };
    // SAFETY: as above.
    unsafe { get(h, n, i, v, take) }
}

unsafe extern "C" fn get_string(h: Handle, n: *const c_char, i: c_int, v: *mut *mut c_char) -> OfxStatus {
    let take = |set: &Set, value: &Value| match value {
        Value::String(text) => {
            let mut lent = lock(&set.lent);
            lent.push(text.clone());
            lent.last().map(|text| text.as_ptr().cast_mut())
        }
        _ => None,
    };
    // SAFETY: as above.
    unsafe { get(h, n, i, v, take) }
}

unsafe extern "C" fn get_double(h: Handle, n: *const c_char, i: c_int, v: *mut f64) -> OfxStatus {
    let take = |_: &Set, value: &Value| match value {
        Value::Double(value) => Some(*value),
        _ => None,
    };
    // SAFETY: as above.
    unsafe { get(h, n, i, v, take) }
}

unsafe extern "C" fn get_int(h: Handle, n: *const c_char, i: c_int, v: *mut c_int) -> OfxStatus {
    let take = |_: &Set, value: &Value| match value {
        Value::Int(value) => Some(*value),
        _ => None,
    };
    // SAFETY: as above.
    unsafe { get(h, n, i, v, take) }
}

unsafe extern "C" fn dimension(h: Handle, n: *const c_char, count: *mut c_int) -> OfxStatus {
    // SAFETY: as above.
    let (Some(set), Some(name)) = (unsafe { set(h, "propGetDimension") }, unsafe { owned(n) }) else {
        return kOfxStatErrBadHandle;
    };
    // SAFETY: the plugin gives a place for the answer.
    unsafe { count.write(set.get(&name).len() as c_int) };
    kOfxStatOK
}

/// The functions. Those for several values at once are left out, as old hosts leave them.
pub const SUITE: OfxPropertySuiteV1 = OfxPropertySuiteV1 {
    propSetPointer: Some(set_pointer),
    propSetString: Some(set_string),
    propSetDouble: Some(set_double),
    propSetInt: Some(set_int),
    propSetPointerN: None,
    propSetStringN: None,
    propSetDoubleN: None,
    propSetIntN: None,
    propGetPointer: Some(get_pointer),
    propGetString: Some(get_string),
    propGetDouble: Some(get_double),
    propGetInt: Some(get_int),
    propGetPointerN: None,
    propGetStringN: None,
    propGetDoubleN: None,
    propGetIntN: None,
    propReset: None,
    propGetDimension: Some(dimension),
};

/// The set behind a handle, for the other suites.
///
/// # Safety
/// As the property suite's functions.
pub(crate) unsafe fn of<'a>(handle: Handle, what: &str) -> Option<&'a Set> {
    // SAFETY: as the caller promised.
    unsafe { set(handle, what) }
}
