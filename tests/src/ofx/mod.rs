//! A small OpenFX host: strict where the standard is strict, and able to behave like hosts that are not.
//!
//! It records what a plugin does against the standard ([`faults`]) instead of repairing it, and can
//! refuse properties, lend images of any layout, leave functions out and free strings early.

#![allow(unsafe_code, reason = "a host calls foreign code and is called by it")]

#[path = "../../../nodes/plugin/src/ofx/interface.rs"]
pub mod interface;

pub mod effect;
pub mod picture;
pub mod properties;
pub mod suites;

use interface::*;
use properties::{Set, Value};
use std::collections::HashMap;
use std::ffi::{CStr, CString, c_int, c_void};
use std::path::Path;
use std::sync::atomic::{AtomicI32, AtomicU32};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

static FAULTS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Notes that the plugin broke a rule.
pub(crate) fn fault(what: impl Into<String>) {
    FAULTS.lock().unwrap_or_else(PoisonError::into_inner).push(what.into());
}

/// What plugins did against the standard so far, in this process.
pub fn faults() -> Vec<String> {
    FAULTS.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// How a host behaves.
#[derive(Clone, Debug)]
pub struct Behaviour {
    /// Its name.
    pub name: &'static CStr,
    /// Properties that it does not know: setting and getting them is answered with "unknown".
    pub refused: Vec<&'static CStr>,
    /// Whether it refuses every property that the standard does not require of it.
    pub refuses_optional: bool,
    /// Whether images may be parts of pictures.
    pub tiles: bool,
    /// Whether it has half floats.
    pub half: bool,
    /// Processors of its multi-thread suite; 0 for a host without the suite.
    pub processors: u32,
    /// Whether the multi-thread suite and the message suite consist of null functions.
    pub null_functions: bool,
    /// Whether a text that was asked for is destroyed at the next call.
    pub strings_die: bool,
    /// Whether it calls clips without a picture connected.
    pub all_connected: bool,
    /// Whether properties of clips and images are missing as far as a plugin can do without.
    pub bare: bool,
    /// After so many questions it wants to stop.
    pub abort_after: Option<u32>,
    /// The latest version of its message suite.
    pub message_version: c_int,
    /// Suites that it lacks.
    pub without: Vec<&'static CStr>,
}

impl Default for Behaviour {
    fn default() -> Self {
        Self {
            name: c"org.isophote.tests",
            refused: Vec::new(),
            refuses_optional: false,
            tiles: true,
            half: true,
            processors: 0,
            null_functions: false,
            strings_die: false,
            all_connected: false,
            bare: false,
            abort_after: None,
            message_version: 2,
            without: Vec::new(),
        }
    }
}

/// What all handles of a host lead back to.
#[derive(Debug)]
pub struct Inner {
    /// How it behaves.
    pub behaviour: Behaviour,
    /// Images that were lent and not given back.
    pub lent: AtomicI32,
    /// How often it was asked whether to stop.
    pub asked: AtomicU32,
    /// Messages that it shows.
    pub messages: Mutex<Vec<String>>,
    suites: suites::Suites,
}

/// A host. Only one lives at a time in a process, as plugins know of one: others wait.
#[derive(Debug)]
pub struct Host {
    /// What its handles lead to.
    pub inner: Arc<Inner>,
    properties: Box<Set>,
    raw: Box<OfxHost>,
    _alone: MutexGuard<'static, ()>,
}

static ALONE: Mutex<()> = Mutex::new(());

// SAFETY: what the pointers lead to is constant or behind locks, and lives as long as the host.
unsafe impl Sync for Host {}

impl Host {
    /// A host that behaves so.
    pub fn new(behaviour: Behaviour) -> Self {
        let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let inner = Arc::new(Inner {
            suites: suites::Suites::new(&behaviour),
            behaviour,
            lent: AtomicI32::new(0),
            asked: AtomicU32::new(0),
            messages: Mutex::default(),
        });
        let properties = Set::new(&inner, "host");
        properties.put(kOfxPropName, vec![inner.behaviour.name.into()]);
        properties.put(kOfxImageEffectPropSupportsTiles, vec![i32::from(inner.behaviour.tiles).into()]);
        let mut depths = vec![kOfxBitDepthFloat, kOfxBitDepthShort, kOfxBitDepthByte];
        if inner.behaviour.half {
            depths.push(kOfxBitDepthHalf);
        }
        let depths = depths.into_iter().map(Value::from).collect();
        properties.put(kOfxImageEffectPropSupportedPixelDepths, depths);
        let raw = Box::new(OfxHost { host: properties.handle(), fetchSuite: Some(suites::fetch) });
        Self { inner, properties, raw, _alone }
    }

    /// What plugins are given.
    pub fn raw(&self) -> *mut OfxHost {
        (&raw const *self.raw).cast_mut()
    }

    /// Its properties.
    pub fn properties(&self) -> &Set {
        &self.properties
    }
}

/// The plugin's binary, loaded.
#[derive(Debug)]
pub struct Binary {
    plugins: Vec<Plugin>,
    _library: libloading::Library,
}

/// One image effect of a binary.
#[derive(Clone, Copy, Debug)]
pub struct Plugin(&'static OfxPlugin);

// SAFETY: the structure is constant for the life of the process, as the standard demands.
unsafe impl Send for Plugin {}
// SAFETY: as above.
unsafe impl Sync for Plugin {}

impl Binary {
    /// Loads a binary and lists its effects.
    ///
    /// # Panics
    /// When it is none.
    pub fn open(path: &Path) -> Self {
        // SAFETY: the library is ours; its initialisers do nothing but what Rust's own library needs.
        let library = unsafe { libloading::Library::new(path) }.expect("the binary can be loaded");
        // SAFETY: the standard gives the symbols these types; the plugins stay in memory.
        let plugins = unsafe {
            let count = library
                .get::<unsafe extern "C" fn() -> c_int>(b"OfxGetNumberOfPlugins\0")
                .expect("the binary counts its plugins");
            let get = library
                .get::<unsafe extern "C" fn(c_int) -> *const OfxPlugin>(b"OfxGetPlugin\0")
                .expect("the binary gives its plugins");
            assert!(get(-1).is_null() && get(count()).is_null(), "there are no plugins beyond the last");
            (0..count()).map(|n| Plugin(get(n).as_ref().expect("a plugin of every number"))).collect()
        };
        Self { plugins, _library: library }
    }

    /// Its effects.
    pub fn plugins(&self) -> &[Plugin] {
        &self.plugins
    }

    /// The effect of this identifier.
    ///
    /// # Panics
    /// When there is none.
    pub fn plugin(&self, identifier: &str) -> Plugin {
        let found = self.plugins.iter().find(|p| p.identifier() == identifier);
        *found.unwrap_or_else(|| panic!("there is no effect {identifier}"))
    }
}

impl Plugin {
    /// Its identifier.
    pub fn identifier(&self) -> String {
        // SAFETY: a string with a closing zero for the life of the process.
        unsafe { CStr::from_ptr(self.0.pluginIdentifier) }.to_string_lossy().into_owned()
    }

    /// The structure.
    pub fn raw(&self) -> &'static OfxPlugin {
        self.0
    }

    /// Tells it the host.
    ///
    /// # Panics
    /// When it has no function for that.
    pub fn set_host(&self, host: &Host) {
        let set = self.0.setHost.expect("a plugin takes its host");
        // SAFETY: the host outlives what the tests do with the plugin.
        unsafe { set(host.raw()) };
    }

    /// Calls an action.
    ///
    /// # Panics
    /// When it has no main entry.
    pub fn act(
        &self,
        action: &CStr,
        handle: Handle,
        in_args: Option<&Set>,
        out_args: Option<&Set>,
    ) -> OfxStatus {
        let entry = self.0.mainEntry.expect("a plugin has a main entry");
        let args = |set: Option<&Set>| set.map_or(std::ptr::null_mut(), Set::handle);
        // SAFETY: handles of this host or null, which an effect must stand.
        unsafe { entry(action.as_ptr(), handle.cast_const(), args(in_args), args(out_args)) }
    }
}

/// A copy of foreign text.
///
/// # Safety
/// `text` is null or leads to a string with a closing zero.
pub(crate) unsafe fn owned(text: *const std::ffi::c_char) -> Option<CString> {
    // SAFETY: as the caller promised.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_owned())
}

/// Texts by name.
pub(crate) type Named<T> = HashMap<CString, T>;

/// The address as a handle.
pub(crate) fn handle_of<T>(thing: &T) -> Handle {
    std::ptr::from_ref(thing).cast_mut().cast::<c_void>()
}
