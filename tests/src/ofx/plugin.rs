//! The plugin's binary: loaded, lent to one test at a time, and called.

use super::host::Host;
use super::properties::Set;
use super::{objects, state};
use isophote_abi::openfx::*;
use std::ffi::{CStr, c_int};
use std::ops::Deref;
use std::path::Path;
use std::sync::Mutex;

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
        state::enter(&host.inner);
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
        if let Some(effect) = objects::effect(handle) {
            state::enter(&effect.host);
        }
        let args = |set: Option<&Set>| set.map_or(std::ptr::null_mut(), Set::handle);
        // SAFETY: handles of this host or null, which an effect must stand.
        unsafe { entry(action.as_ptr(), handle.cast_const(), args(in_args), args(out_args)) }
    }
}

/// Copies of the library that no test uses now.
static IDLE: Mutex<Vec<Binary>> = Mutex::new(Vec::new());

/// A copy of the library under test that no other test has meanwhile. Copies have variables of their own, so
/// that each knows another host.
#[derive(Debug)]
pub struct Lent(Option<Binary>);

impl Lent {
    /// A copy: one that is back from another test, or a new one.
    ///
    /// # Panics
    /// When the library cannot be copied or loaded.
    pub fn new() -> Self {
        let idle = state::lock(&IDLE).pop();
        Self(Some(idle.unwrap_or_else(|| {
            let original = crate::library::path();
            let folder = tempfile::TempDir::new().expect("a folder for a copy of the library");
            let copy = folder.path().join(original.file_name().expect("a library has a name"));
            std::fs::copy(original, &copy).expect("the library can be copied");
            // Once it is loaded the file is not needed.
            Binary::open(&copy)
        })))
    }
}

impl Default for Lent {
    fn default() -> Self {
        Self::new()
    }
}

impl Deref for Lent {
    type Target = Binary;

    fn deref(&self) -> &Binary {
        self.0.as_ref().expect("a copy is there until it is given back")
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        // After a failure nobody knows what it is like.
        let binary = self.0.take();
        if std::thread::panicking() {
            std::mem::forget(binary);
        } else {
            state::lock(&IDLE).extend(binary);
        }
    }
}
