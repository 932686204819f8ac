//! Keeps the dynamic library in memory once it is loaded.
//!
//! Its worker threads and their thread-locals, and those of the graphics drivers it loads, would run
//! code that `dlclose` had taken away. With `-z nodelete` unloading and loading again is safe, and
//! gives the same library. Linkers for Windows have no such flag; `src/pinned.rs` does it there.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let os = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    if os == "linux" || os == "android" || os.ends_with("bsd") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
}
