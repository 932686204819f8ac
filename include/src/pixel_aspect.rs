//! The extension "isophote.pixel_aspect/1": square pixels for pictures that have others, such as anamorphic ones.

use super::constants::{IsophoteAlpha, IsophoteStatus};
use super::types::{IsophoteImage, IsophoteTarget, IsophoteText};
use core::ffi::c_char;

/// Size of a picture in square pixels.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IsophoteSquareSize {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Scale of a request for them. Full size is that of the picture's rows where pixels are wider than high, and its
    /// `origin_x` counts in that unit too.
    pub scale: f32,
}

/// The functions of the extension "isophote.pixel_aspect/1". Tags and ownership are those of `IsophoteApi`.
///
/// Nodes know lengths in pixels, the same in every direction. A host whose pixels are not square makes its images so, asks for
/// the result of them, and makes that its own pixels again. Both ways take a pixel for the mean over its area; where a whole
/// number of square pixels makes one of the host's, there and back is no change. `aspect` is the width of a pixel over its
/// height, 0.01 to 100.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophotePixelAspectApi {
    /// Bytes of this struct.
    pub struct_size: u32,

    /// [any-thread] Size in square pixels, which are as fine as the finer side of the picture's own. The picture's own size
    /// where those are square as far as anyone can see.
    pub square_size: unsafe extern "C" fn(
        width: u32,
        height: u32,
        aspect: f64,
        size: *mut IsophoteSquareSize,
    ) -> IsophoteStatus,

    /// [any-thread] Makes square pixels of the whole picture `image`, which is the input of this name: "color", or a guide,
    /// whose target holds 32-bit floats. Vectors of motion are counted in square pixels then. `alpha` is that of the
    /// colour. `threads` are as in `IsophoteControl`. `replaced` receives how many samples were not finite, and may be null.
    pub to_square: unsafe extern "C" fn(
        input: *const c_char,
        image: *const IsophoteImage,
        aspect: f64,
        alpha: IsophoteAlpha,
        threads: u32,
        target: *const IsophoteTarget,
        replaced: *mut u64,
        error: *mut IsophoteText,
    ) -> IsophoteStatus,

    /// [any-thread] Makes the host's pixels of a result in square ones; the size of `target` is the picture's.
    pub from_square: unsafe extern "C" fn(
        image: *const IsophoteImage,
        aspect: f64,
        alpha: IsophoteAlpha,
        threads: u32,
        target: *const IsophoteTarget,
        error: *mut IsophoteText,
    ) -> IsophoteStatus,
}
