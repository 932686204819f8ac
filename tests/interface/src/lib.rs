//! The OpenFX interface that the plugin declares, for the test that compares it.

#[path = "../../../nodes/plugin/src/ofx/interface.rs"]
pub mod interface;
