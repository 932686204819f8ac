//! The function that Godot calls when it loads the extension.

// The macro writes that function, and its trait is unsafe to implement.
#![allow(unsafe_code)]

use godot::init::{ExtensionLibrary, gdextension};

struct Isophote;

// SAFETY: Godot alone calls the function, once for a process.
#[gdextension]
unsafe impl ExtensionLibrary for Isophote {}
