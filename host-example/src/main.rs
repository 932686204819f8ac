//! The sample host.
fn main() {}
