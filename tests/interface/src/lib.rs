//! Nothing but a place for the test that compares the declared OpenFX interface with a crate made from the standard's
//! headers.
