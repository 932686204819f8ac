//! How much memory a frame may take; the tests measure by the same numbers.

/// Bytes that the working images of one band should take, and those that they may, where the passes allow
/// bands. With a source and a result of 8K in floats, 4 GiB are not exceeded.
pub const WORKING_MEMORY: [u64; 2] = [768 << 20, 3000 << 20];
/// Bands of fewer rows would spend most of their time on what lies around them.
pub const LEAST_ROWS: i32 = 64;
