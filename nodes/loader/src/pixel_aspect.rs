//! Square pixels for pictures that have others.

use std::ffi::CStr;

use super::error::{Result, check};
use super::image::{AsImage, AsTarget};
use super::library::{Library, status_name};
use super::text;
use isophote_abi::{IsophoteAlpha, IsophotePixelAspectApi, IsophoteSquareSize, IsophoteStatus, IsophoteText};

/// Name of the extension.
const EXTENSION: &CStr = c"isophote.pixel_aspect/1";

impl Library {
    /// Size of a picture in square pixels, and the scale of a request for them. `aspect` is the width of its own pixels over
    /// their height.
    ///
    /// # Errors
    /// [`Error`](crate::Error) for impossible sizes and aspects.
    pub fn square_size(&self, size: (u32, u32), aspect: f64) -> Result<((u32, u32), f32)> {
        let mut square = IsophoteSquareSize::default();
        // SAFETY: the place may be written during the call.
        let status = unsafe { (self.aspects()?.square_size)(size.0, size.1, aspect, &raw mut square) };
        check(status, || {
            let (width, height) = size;
            format!("{width}x{height} pixels of the aspect {aspect}: {}", status_name(self.api, status))
        })?;
        Ok(((square.width, square.height), square.scale))
    }

    /// Makes square pixels of the whole picture that is the input `name`, and says how many samples were not finite.
    /// `target` has the size in square pixels; that of guides holds single floats.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when an image has another size, or is none of the input.
    pub fn to_square(
        &self,
        (name, image): (&str, &dyn AsImage),
        (aspect, alpha): (f64, IsophoteAlpha),
        target: &mut dyn AsTarget,
        threads: u32,
    ) -> Result<u64> {
        let (table, name) = (self.aspects()?, text::argument(name)?);
        let (image, target) = (image.image().raw, target.target().raw);
        let mut replaced = 0;
        let call = |error: *mut IsophoteText| {
            // SAFETY: image and target describe memory that is borrowed for the whole call, with strides and sizes that
            // `Image` and `Target` vouch for; the other places may be written.
            unsafe {
                (table.to_square)(
                    name.as_ptr(),
                    &raw const image,
                    aspect,
                    alpha,
                    threads,
                    &raw const target,
                    &raw mut replaced,
                    error,
                )
            }
        };
        told(call)?;
        Ok(replaced)
    }

    /// Makes pixels of this aspect of a result in square ones; the size of `target` is the picture's.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when an image has another size.
    pub fn from_square(
        &self,
        image: &dyn AsImage,
        (aspect, alpha): (f64, IsophoteAlpha),
        target: &mut dyn AsTarget,
        threads: u32,
    ) -> Result<()> {
        let table = self.aspects()?;
        let (image, target) = (image.image().raw, target.target().raw);
        told(|error: *mut IsophoteText| {
            // SAFETY: as in `to_square`.
            unsafe { (table.from_square)(&raw const image, aspect, alpha, threads, &raw const target, error) }
        })
    }

    fn aspects(&self) -> Result<&'static IsophotePixelAspectApi> {
        self.extension(EXTENSION, "this library makes no pixels square")
    }
}

/// A call whose message tells what is wrong.
fn told(call: impl FnOnce(*mut IsophoteText) -> IsophoteStatus) -> Result<()> {
    let (status, message) = text::message(call);
    check(status, || message)
}
