//! The functions of the test host, and the library of variadic ones that is compiled from C.

use super::edits;
use super::handles::{handle_of, nothing, owned};
use super::objects::{Clip, Effect, MAGIC, Param};
use super::properties::{self, Set, Value};
use super::state::{self, Behaviour, Suite, fault, lock};
use super::threads;
use isophote_abi::openfx::*;
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::process::Command;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

/// The structures that a host gives out.
#[derive(Debug)]
pub struct Suites {
    properties: OfxPropertySuiteV1,
    effects: OfxImageEffectSuiteV1,
    params: OfxParameterSuiteV1,
    threads: OfxMultiThreadSuiteV1,
    first_messages: OfxMessageSuiteV1,
    messages: OfxMessageSuiteV2,
}

impl Suites {
    pub(super) fn new(behaviour: &Behaviour) -> Self {
        let shim = shim();
        let null = behaviour.null_functions;
        let (get, get_at, message) =
            (Some(shim.get), Some(shim.get_at), Some(shim.message).filter(|_| !null));
        let params = OfxParameterSuiteV1 { paramGetValue: get, paramGetValueAtTime: get_at, ..PARAMS };
        Self {
            properties: properties::SUITE,
            effects: EFFECTS,
            params: OfxParameterSuiteV1 { paramSetValue: Some(shim.set), ..params },
            threads: if null { threads::NONE } else { threads::SUITE },
            first_messages: OfxMessageSuiteV1 { message },
            messages: OfxMessageSuiteV2 {
                message,
                setPersistentMessage: message,
                clearPersistentMessage: if null { None } else { Some(clear_message) },
            },
        }
    }

    /// Suites that the host gives out. The addresses hold while `self` is where it is.
    pub(super) fn list(&self, behaviour: &Behaviour) -> Vec<Suite> {
        let suite = |name, version, address| Suite { name, version, address };
        let mut list = vec![
            suite(kOfxPropertySuite, 1, (&raw const self.properties).addr()),
            suite(kOfxImageEffectSuite, 1, (&raw const self.effects).addr()),
            suite(kOfxParameterSuite, 1, (&raw const self.params).addr()),
            suite(kOfxMessageSuite, 1, (&raw const self.first_messages).addr()),
        ];
        if behaviour.message_version >= 2 {
            list.push(suite(kOfxMessageSuite, 2, (&raw const self.messages).addr()));
        }
        if behaviour.processors > 0 || behaviour.null_functions {
            list.push(suite(kOfxMultiThreadSuite, 1, (&raw const self.threads).addr()));
        }
        list.retain(|suite| !behaviour.without.contains(&suite.name));
        list
    }
}

pub(super) unsafe extern "C" fn fetch(host: Handle, name: *const c_char, version: c_int) -> *const c_void {
    // SAFETY: the handle is the host's property set, the name a string with a closing zero.
    let (Some(set), Some(name)) = (unsafe { properties::of(host, "fetchSuite") }, unsafe { owned(name) })
    else {
        return std::ptr::null();
    };
    let suites = set.host.suites.get().map_or(&[][..], Vec::as_slice);
    let found = suites.iter().find(|suite| suite.name == name.as_c_str() && suite.version == version);
    found.map_or(std::ptr::null(), |suite| suite.address as *const c_void)
}

// ----- variadic functions -----

type CountFn = unsafe extern "C" fn(*mut c_void) -> c_int;
type GetFn = unsafe extern "C" fn(*mut c_void, f64, c_int, *mut *mut c_void) -> c_int;
type KindFn = unsafe extern "C" fn(*mut c_void) -> c_char;
type SetFn = unsafe extern "C" fn(*mut c_void, c_int, *const c_int, *const f64, *const c_char) -> c_int;
type SaidFn = unsafe extern "C" fn(*mut c_void, *const c_char, *const c_char) -> c_int;
type Install = unsafe extern "C" fn(CountFn, GetFn, KindFn, SetFn, SaidFn);

struct Shim {
    get: unsafe extern "C" fn(Handle, ...) -> OfxStatus,
    get_at: unsafe extern "C" fn(Handle, OfxTime, ...) -> OfxStatus,
    set: unsafe extern "C" fn(Handle, ...) -> OfxStatus,
    message: unsafe extern "C" fn(*mut c_void, *const c_char, *const c_char, *const c_char, ...) -> OfxStatus,
    _library: libloading::Library,
}

/// The C functions, compiled once in a process.
fn shim() -> &'static Shim {
    static SHIM: OnceLock<Shim> = OnceLock::new();
    SHIM.get_or_init(|| {
        let folder = tempfile::TempDir::new().expect("a folder for the C functions");
        let file = folder.path().join("libofx_variadic.so");
        let compiled = Command::new("cc")
            .args(["-std=c11", "-Wall", "-Wextra", "-pedantic", "-Werror", "-shared", "-fPIC", "-o"])
            .arg(&file)
            .arg(crate::library::root().join("tests/c/ofx_variadic.c"))
            .output()
            .expect("the test host needs a C compiler");
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
        // SAFETY: the library was just made from the file beside this crate, which gives its symbols these
        // types; it is kept for the life of the process.
        unsafe {
            let library = libloading::Library::new(&file).expect("the C functions can be loaded");
            let install = *library.get::<Install>(b"ofx_shim_install\0").expect("a symbol");
            install(count_of, get_value, edits::kind_of, edits::set_value, said);
            Shim {
                get: *library.get(b"ofx_shim_get\0").expect("a symbol"),
                get_at: *library.get(b"ofx_shim_get_at\0").expect("a symbol"),
                set: *library.get(b"ofx_shim_set\0").expect("a symbol"),
                message: *library.get(b"ofx_shim_message\0").expect("a symbol"),
                _library: library,
            }
        }
    })
}

/// Thing that a handle leads to, if it begins as things of its type do.
macro_rules! thing {
    ($handle:expr, $type:ty, $what:literal) => {{
        // SAFETY: handles lead to things of this host that live while plugins may use them, or to null; a
        // wrong one is noticed by its beginning as far as it can be.
        let found = unsafe { $handle.cast::<$type>().as_ref() };
        match found {
            Some(found) if found.magic == MAGIC => found,
            _ => {
                fault(concat!($what, ": not such a handle"));
                return kOfxStatErrBadHandle;
            }
        }
    }};
}

unsafe extern "C" fn count_of(param: *mut c_void) -> c_int {
    // SAFETY: as in `thing`.
    let Some(param) = (unsafe { param.cast::<Param>().as_ref() }) else { return 0 };
    if param.magic == MAGIC && param.kind.as_c_str() == kOfxParamTypeRGBA { 4 } else { 1 }
}

unsafe extern "C" fn get_value(
    param: *mut c_void,
    time: f64,
    count: c_int,
    places: *mut *mut c_void,
) -> c_int {
    let param = thing!(param, Param, "paramGetValue");
    let keyed = lock(&param.keys).iter().rev().find(|(from, _)| *from <= time).map(|(_, v)| vec![v.clone()]);
    let values = keyed.unwrap_or_else(|| lock(&param.value).clone());
    if edits::kind_of(handle_of(param)) == 0 {
        param.set.host.fault(format!("{:?} has no value", param.name));
        return kOfxStatErrValue;
    }
    for (index, value) in values.iter().enumerate().take(count as usize) {
        // SAFETY: the plugin gave as many places of the parameter's type, of which the standard has ints and
        // doubles here.
        unsafe {
            let place = *places.add(index);
            match value {
                Value::Int(v) => place.cast::<c_int>().write(*v),
                Value::Double(v) => place.cast::<f64>().write(*v),
                // Valid until the parameter is set.
                Value::String(_) => place.cast::<*const c_char>().write(param.lend(index)),
                _ => return kOfxStatErrValue,
            }
        }
    }
    kOfxStatOK
}

unsafe extern "C" fn said(handle: *mut c_void, kind: *const c_char, text: *const c_char) -> c_int {
    let effect = thing!(handle, Effect, "message");
    // SAFETY: the C function gives strings with a closing zero.
    let (kind, text) = unsafe { (owned(kind), owned(text)) };
    match kind.as_deref() {
        Some(kind) if kind == kOfxMessageError => {}
        // A notice, for which nobody waits.
        Some(kind) if kind == kOfxMessageWarning || kind == kOfxMessageMessage => {
            if state::rendered().is_some() {
                effect.host.fault("a notice while a frame is rendered");
            }
        }
        _ => effect.host.fault(format!("{kind:?} is no kind of message")),
    }
    lock(&effect.host.messages).push(text.unwrap_or_default().to_string_lossy().into_owned());
    kOfxStatOK
}

unsafe extern "C" fn clear_message(effect: Handle) -> OfxStatus {
    let effect = thing!(effect, Effect, "clearPersistentMessage");
    let mut messages = lock(&effect.host.messages);
    if messages.is_empty() {
        effect.host.fault("clearPersistentMessage without a message");
    }
    messages.clear();
    kOfxStatOK
}

// ----- parameters -----

unsafe extern "C" fn param_define(
    set: Handle,
    kind: *const c_char,
    name: *const c_char,
    place: *mut Handle,
) -> OfxStatus {
    nothing(place);
    // SAFETY: the plugin's arguments, as the standard has them.
    let (set, kind, name) = unsafe { (properties::of(set, "paramDefine"), owned(kind), owned(name)) };
    let (Some(set), Some(kind), Some(name)) = (set, kind, name) else { return kOfxStatErrBadHandle };
    let effect = thing!((set.owner as Handle), Effect, "paramDefine");
    if effect.is_instance {
        effect.host.fault("paramDefine on an instance");
    }
    let mut params = lock(&effect.params);
    if params.iter().any(|p| p.name == name) {
        effect.host.fault(format!("two parameters are named {name:?}"));
        return kOfxStatErrExists;
    }
    let set = Set::new(&effect.host, "descriptor");
    let handle = set.handle();
    let (value, keys, lent) = Default::default();
    params.push(Box::new(Param { magic: MAGIC, kind, name, set, value, keys, lent, instance: 0 }));
    // SAFETY: the plugin gave a place, or null.
    if let Some(place) = unsafe { place.as_mut() } {
        *place = handle;
    }
    kOfxStatOK
}

unsafe extern "C" fn param_handle(
    set: Handle,
    name: *const c_char,
    place: *mut Handle,
    properties_place: *mut Handle,
) -> OfxStatus {
    nothing(place);
    nothing(properties_place);
    // SAFETY: as above.
    let (Some(set), Some(name)) = (unsafe { properties::of(set, "paramGetHandle") }, unsafe { owned(name) })
    else {
        return kOfxStatErrBadHandle;
    };
    let effect = thing!((set.owner as Handle), Effect, "paramGetHandle");
    let params = lock(&effect.params);
    let Some(param) = params.iter().find(|p| p.name == name) else { return kOfxStatErrUnknown };
    // SAFETY: as above.
    unsafe {
        if let Some(place) = place.as_mut() {
            *place = handle_of(&**param);
        }
        if let Some(place) = properties_place.as_mut() {
            *place = param.set.handle();
        }
    }
    kOfxStatOK
}

unsafe extern "C" fn param_keys(param: Handle, place: *mut c_uint) -> OfxStatus {
    let param = thing!(param, Param, "paramGetNumKeys");
    // SAFETY: the plugin gave a place.
    unsafe { place.write(lock(&param.keys).len() as c_uint) };
    kOfxStatOK
}

const PARAMS: OfxParameterSuiteV1 = OfxParameterSuiteV1 {
    paramDefine: Some(param_define),
    paramGetHandle: Some(param_handle),
    paramSetGetPropertySet: None,
    paramGetPropertySet: None,
    paramGetValue: None,
    paramGetValueAtTime: None,
    paramGetDerivative: None,
    paramGetIntegral: None,
    paramSetValue: None,
    paramSetValueAtTime: None,
    paramGetNumKeys: Some(param_keys),
    paramGetKeyTime: None,
    paramGetKeyIndex: None,
    paramDeleteKey: None,
    paramDeleteAllKeys: Some(edits::forget_keys),
    paramCopy: None,
    paramEditBegin: Some(edits::begin),
    paramEditEnd: Some(edits::end),
};

// ----- effects, clips, images -----

unsafe extern "C" fn effect_properties(effect: Handle, place: *mut Handle) -> OfxStatus {
    let effect = thing!(effect, Effect, "getPropertySet");
    // SAFETY: as above.
    unsafe { place.write(effect.set.handle()) };
    kOfxStatOK
}

unsafe extern "C" fn effect_params(effect: Handle, place: *mut Handle) -> OfxStatus {
    let effect = thing!(effect, Effect, "getParamSet");
    // SAFETY: as above.
    unsafe { place.write(effect.param_set.handle()) };
    kOfxStatOK
}

unsafe extern "C" fn clip_define(effect: Handle, name: *const c_char, place: *mut Handle) -> OfxStatus {
    nothing(place);
    let effect = thing!(effect, Effect, "clipDefine");
    // SAFETY: as above.
    let Some(name) = (unsafe { owned(name) }) else { return kOfxStatErrBadHandle };
    if effect.is_instance {
        effect.host.fault("clipDefine on an instance");
    }
    let set = Set::new(&effect.host, "descriptor");
    // SAFETY: as above.
    if let Some(place) = unsafe { place.as_mut() } {
        *place = set.handle();
    }
    let (picture, film) = Default::default();
    lock(&effect.clips).push(Box::new(Clip { magic: MAGIC, name, set, picture, film }));
    kOfxStatOK
}

unsafe extern "C" fn clip_handle(
    effect: Handle,
    name: *const c_char,
    place: *mut Handle,
    properties_place: *mut Handle,
) -> OfxStatus {
    nothing(place);
    nothing(properties_place);
    let effect = thing!(effect, Effect, "clipGetHandle");
    // SAFETY: as above.
    let Some(name) = (unsafe { owned(name) }) else { return kOfxStatErrBadHandle };
    let clips = lock(&effect.clips);
    let Some(clip) = clips.iter().find(|c| c.name == name) else {
        // As one host does: no failure, and no clip.
        return if effect.host.behaviour.bare { kOfxStatOK } else { kOfxStatErrBadHandle };
    };
    // SAFETY: as above.
    unsafe {
        if let Some(place) = place.as_mut() {
            *place = handle_of(&**clip);
        }
        if let Some(place) = properties_place.as_mut() {
            *place = clip.set.handle();
        }
    }
    kOfxStatOK
}

unsafe extern "C" fn clip_image(
    clip: Handle,
    time: OfxTime,
    _: *const OfxRectD,
    place: *mut Handle,
) -> OfxStatus {
    nothing(place);
    let clip = thing!(clip, Clip, "clipGetImage");
    let host = &clip.set.host;
    clip.check_access(time);
    let set = Set::new(host, "image");
    if clip.at(time, |picture| picture.describe(&set)).is_none() {
        return if host.behaviour.null_images { kOfxStatOK } else { kOfxStatFailed };
    }
    let lent = host.lent.fetch_add(1, Ordering::SeqCst) + 1;
    host.most_lent.fetch_max(lent, Ordering::SeqCst);
    // SAFETY: the plugin gave a place; the set comes back by `clip_release`.
    unsafe { place.write(Box::into_raw(set).cast()) };
    kOfxStatOK
}

unsafe extern "C" fn clip_release(image: Handle) -> OfxStatus {
    // SAFETY: as above.
    let Some(set) = (unsafe { properties::of(image, "clipReleaseImage") }) else {
        return kOfxStatErrBadHandle;
    };
    if set.what != "image" {
        set.host.fault("clipReleaseImage of what is no image");
        return kOfxStatErrBadHandle;
    }
    set.host.lent.fetch_sub(1, Ordering::SeqCst);
    // SAFETY: `clip_image` made the set as a box and gave it away.
    drop(unsafe { Box::from_raw(image.cast::<Set>()) });
    kOfxStatOK
}

unsafe extern "C" fn clip_defined(clip: Handle, time: OfxTime, place: *mut OfxRectD) -> OfxStatus {
    let clip = thing!(clip, Clip, "clipGetRegionOfDefinition");
    let Some(defined) = clip.at(time, |picture| picture.defined()) else { return kOfxStatFailed };
    // SAFETY: the plugin gave a place.
    unsafe { place.write(defined) };
    kOfxStatOK
}

unsafe extern "C" fn abort(effect: Handle) -> c_int {
    let effect = thing!(effect, Effect, "abort");
    let calls = effect.host.abort_calls.fetch_add(1, Ordering::SeqCst) + 1;
    c_int::from(effect.host.behaviour.abort_after.is_some_and(|after| calls > after))
}

const EFFECTS: OfxImageEffectSuiteV1 = OfxImageEffectSuiteV1 {
    getPropertySet: Some(effect_properties),
    getParamSet: Some(effect_params),
    clipDefine: Some(clip_define),
    clipGetHandle: Some(clip_handle),
    clipGetPropertySet: None,
    clipGetImage: Some(clip_image),
    clipReleaseImage: Some(clip_release),
    clipGetRegionOfDefinition: Some(clip_defined),
    abort: Some(abort),
    imageMemoryAlloc: None,
    imageMemoryFree: None,
    imageMemoryLock: None,
    imageMemoryUnlock: None,
};
