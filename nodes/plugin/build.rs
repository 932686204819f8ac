//! Linking of the dynamic library: it stays in memory once it is loaded, and has a name for those that
//! link to it.
//!
//! Its worker threads and their thread-locals, and those of the graphics drivers it loads, would run
//! code that `dlclose` had taken away. With `-z nodelete` unloading and loading again is safe, and
//! gives the same library. Linkers for Windows have no such flag; `src/pinned.rs` does it there.
//!
//! Programs that link to it look for the version of the C interface that they were built with, so that two versions can
//! be installed beside each other.

/// Path of the file where the version of the C interface is declared.
const CONSTANTS: &str = "../../include/src/constants.rs";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={CONSTANTS}");
    let version = abi_version().unwrap_or_else(|| panic!("{CONSTANTS} declares no ISOPHOTE_ABI_VERSION"));
    let os = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    if os == "linux" || os == "android" || os.ends_with("bsd") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-z,nodelete");
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libisophote.so.{version}");
    } else if os == "macos" {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libisophote.{version}.dylib");
    }
}

fn abi_version() -> Option<u32> {
    let text = std::fs::read_to_string(CONSTANTS).ok()?;
    let (_, rest) = text.split_once("ISOPHOTE_ABI_VERSION: u32 = ")?;
    rest.split_once(';')?.0.parse().ok()
}
