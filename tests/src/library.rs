//! The dynamic library under test: built, found and loaded as a host would.

#![allow(unsafe_code, reason = "loading and calling foreign code is what these tests are about")]

use std::ffi::CStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use isophote_abi::{ISOPHOTE_ABI_VERSION, IsophoteApi, IsophoteText};

/// The dynamic library, built with the profile of the running test. `ISOPHOTE_LIBRARY` names another.
///
/// # Panics
/// When it cannot be built.
pub fn path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| match std::env::var_os("ISOPHOTE_LIBRARY") {
        Some(path) => path.into(),
        None => build(),
    })
}

fn build() -> PathBuf {
    // target/<profile>/deps/<test>
    let test = std::env::current_exe().expect("the test knows its own path");
    let profile = test.parent().and_then(Path::parent).expect("the test lies in a target folder");
    let name = profile.file_name().and_then(|n| n.to_str()).expect("a profile has a name");
    let target = profile.parent().expect("a profile lies in a target folder");
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // The whole workspace, since a part of it would have other features and be compiled once more.
    cargo.args(["build", "--workspace", "--lib", "--bins", "--quiet", "--target-dir"]).arg(target);
    if name != "debug" {
        cargo.args(["--profile", name]);
    }
    let status = cargo.current_dir(root()).status().expect("cargo can be started");
    assert!(status.success(), "the dynamic library cannot be built: {status}");
    profile.join(libloading::library_filename("isophote"))
}

/// The repository's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The library, loaded, with its table.
#[derive(Debug)]
pub struct Loaded {
    /// The table.
    pub api: &'static IsophoteApi,
    _library: libloading::Library,
}

// SAFETY: the table is constant, and its functions say themselves which threads may call them.
unsafe impl Send for Loaded {}
// SAFETY: as above.
unsafe impl Sync for Loaded {}

impl Loaded {
    /// Loads the library.
    ///
    /// # Panics
    /// When it is not what it should be.
    pub fn new() -> Self {
        // SAFETY: the library is ours; its initialisers do nothing but what Rust's own library needs.
        let library = unsafe { libloading::Library::new(path()) }.expect("the library can be loaded");
        type Entry = unsafe extern "C" fn(u32) -> *const IsophoteApi;
        // SAFETY: the header declares the symbol with this type.
        let entry = unsafe { library.get::<Entry>(b"isophote_api\0") }.expect("the library has its symbol");
        // SAFETY: the entry may be called with any number.
        assert!(unsafe { entry(0) }.is_null() && unsafe { entry(ISOPHOTE_ABI_VERSION + 1) }.is_null());
        // SAFETY: as before; the table is valid while the library is loaded, and it stays in memory
        // after that.
        let api = unsafe { entry(ISOPHOTE_ABI_VERSION).as_ref() }.expect("the library offers the version");
        assert_eq!(api.abi_version, ISOPHOTE_ABI_VERSION);
        assert_eq!(api.struct_size as usize, size_of::<IsophoteApi>());
        Self { api, _library: library }
    }
}

impl Default for Loaded {
    fn default() -> Self {
        Self::new()
    }
}

/// The text that `ask` fills in.
pub fn text(ask: impl FnOnce(*mut IsophoteText)) -> String {
    let mut bytes = vec![0_u8; 4096];
    let mut text = IsophoteText { data: bytes.as_mut_ptr().cast(), capacity: bytes.len(), length: 0 };
    ask(&raw mut text);
    CStr::from_bytes_until_nul(&bytes).map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}
