//! On macOS the linker must be told that Python gives the symbols; maturin does, and cargo alone would not.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
