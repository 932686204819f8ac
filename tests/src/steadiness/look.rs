//! Frames, carried frames and their differences as pictures, for people who ask for them.

use super::carry::{carried, rgb};
use super::shot::Shot;
use crate::pictures::from_fn;
use crate::png;
use isophote_engine::Image;
use std::path::PathBuf;

/// Environment variable that names the folder for [`show`].
pub const FOLDER: &str = "ISOPHOTE_PICTURES";

/// Factor by which differences are amplified.
const AMPLIFIED: f32 = 4.0;

/// Colour of what does not count, in differences: a dark blue that no small difference has.
const MASKED: [f32; 4] = [0.0, 0.0, 0.35, 1.0];

/// Writes what a filter made of a shot, where [`FOLDER`] names a folder: `SHOT-NAME-00.png` is a frame,
/// `-00-carried.png` the frame before carried to it, and `-00-difference.png` the difference of both four times
/// amplified, dark blue where the pixel does not count.
///
/// # Panics
/// When a picture cannot be written.
pub fn show(shot: &Shot, name: &str, frames: &[Image]) {
    let Some(folder) = std::env::var_os(FOLDER).filter(|f| !f.is_empty()).map(PathBuf::from) else { return };
    if let Err(e) = std::fs::create_dir_all(&folder) {
        panic!("cannot make {}: {e}", folder.display());
    }
    let stem = format!("{}-{name}", shot.name).replace([' ', '/'], "_");
    for (t, frame) in frames.iter().enumerate() {
        let write =
            |kind: &str, image: &Image| png::write(&folder.join(format!("{stem}-{t:02}{kind}.png")), image);
        write("", &picture(frame, |x, y| opaque(rgb(frame, x, y))));
        if t > 0 {
            let before = carried(shot, t, &frames[t - 1]);
            let at = |x: i32, y: i32| before[y as usize * frame.width() as usize + x as usize];
            write("-carried", &picture(frame, |x, y| opaque(at(x, y).color)));
            let difference = picture(frame, |x, y| {
                let (now, then) = (rgb(frame, x, y), at(x, y));
                let difference = std::array::from_fn(|c| AMPLIFIED * (now[c] - then.color[c]).abs());
                if then.counts { opaque(difference) } else { MASKED }
            });
            write("-difference", &difference);
        }
    }
}

fn picture(like: &Image, value: impl FnMut(i32, i32) -> [f32; 4]) -> Image {
    from_fn(like.width(), like.height(), value)
}

fn opaque([r, g, b]: [f32; 3]) -> [f32; 4] {
    [r, g, b, 1.0]
}
