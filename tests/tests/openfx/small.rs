//! The small picture of tests that fail on purpose or go on for long.

use isophote_tests::ofx::picture::{Layout, Picture};

pub const SIZE: i32 = 32;

pub fn picture(layout: Layout) -> Picture {
    let values = (0..SIZE * SIZE * 4).map(|i| if i % 4 == 3 { 1.0 } else { (i * 37 % 101) as f32 / 101.0 });
    let bytes: Vec<u8> = values.flat_map(f32::to_ne_bytes).collect();
    Picture::packed_in(layout, SIZE, SIZE, &bytes)
}
