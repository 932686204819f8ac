//! The OpenFX face in the host of `isophote_tests::ofx`: every effect, generated from the registry.

#![allow(unsafe_code, reason = "calls through the C table, and reading foreign layouts")]

#[path = "openfx/aspect.rs"]
mod aspect;
#[path = "openfx/describe.rs"]
mod describe;
#[path = "openfx/memory.rs"]
mod memory;
#[path = "openfx/quirks.rs"]
mod quirks;
#[path = "openfx/reference.rs"]
mod reference;
#[path = "openfx/regions.rs"]
mod regions;
#[path = "openfx/render.rs"]
mod render;
#[path = "openfx/scale.rs"]
mod scale;
