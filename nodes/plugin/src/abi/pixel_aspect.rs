//! The extension for pixels that are not square.

use super::failure::{Failure, Outcome};
use super::images::{AS_COMPUTED, Checked};
use super::process::NO_CONTROL;
use super::threads::CallThreads;
use super::{args, graph, guard};
use crate::pixel_aspect::{SquarePixels, divide, is_square, multiply};
use isophote::engine::{Image, Rect};
use isophote::graph::GraphInput;
use isophote::kernels::shared::motion::UNKNOWN;
use isophote::spec::ImageKind;
use isophote_abi::*;
use std::ffi::{CStr, c_char};

/// Name of the extension.
pub const EXTENSION: &CStr = c"isophote.pixel_aspect/1";

/// The functions of the extension.
pub static API: IsophotePixelAspectApi = IsophotePixelAspectApi {
    struct_size: size_of::<IsophotePixelAspectApi>() as u32,
    square_size,
    to_square,
    from_square,
};

/// The square pixels of a picture; none where its own are square.
fn square(size: [u32; 2], aspect: f64) -> Outcome<Option<SquarePixels>> {
    isophote::engine::image::check_size(size[0], size[1])?;
    if !(0.01..=100.0).contains(&aspect) {
        return Err(Failure::argument(format!(
            "{aspect} is no aspect of a pixel, which are from 0.01 to 100"
        )));
    }
    let ratio = [1.0 / aspect, 1.0];
    Ok((!is_square(ratio)).then(|| SquarePixels::of(size, ratio)))
}

unsafe extern "C" fn square_size(
    width: u32,
    height: u32,
    aspect: f64,
    size: *mut IsophoteSquareSize,
) -> IsophoteStatus {
    let body = || {
        let own = IsophoteSquareSize { width, height, scale: 1.0 };
        let value = square([width, height], aspect)?.map_or(own, |square| {
            let [width, height] = square.size();
            IsophoteSquareSize { width, height, scale: square.scale }
        });
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(size, value, "the place for the size") }
    };
    guard::call(body, |_| {})
}

unsafe extern "C" fn to_square(
    input: *const c_char,
    image: *const IsophoteImage,
    aspect: f64,
    alpha: IsophoteAlpha,
    threads: u32,
    target: *const IsophoteTarget,
    replaced: *mut u64,
    error: *mut IsophoteText,
) -> IsophoteStatus {
    let body = || {
        // SAFETY: the host promised text with a closing zero, and structs behind the pointers.
        let (input, image, target) = unsafe {
            let input = graph::input(input)?;
            let image = Checked::source(&args::get(image, "the image")?, input, "the image")?;
            (input, image, Checked::target(&args::get(target, "the target image")?, input)?)
        };
        let (window, size) = (image.window, [image.window.width(), image.window.height()]);
        let square = square(size, aspect)?;
        let [width, height] = square.map_or(size, |square| square.size());
        let whole = Rect::of_size(width, height);
        must_be(&target, whole)?;
        let threads = CallThreads::new(&IsophoteControl { threads, ..NO_CONTROL })?;
        // SAFETY: the host promised that the image's memory may be read.
        let (mut pixels, bad) = unsafe { image.read(window, input, threads.threads())? };
        if let Some(square) = square {
            let is_straight = input.is_colour() && alpha == ISOPHOTE_ALPHA_STRAIGHT;
            if is_straight {
                multiply(&mut pixels);
            }
            let pixels_at_0 = moved(pixels, Rect::of_size(size[0], size[1]))?;
            pixels = square.to_square(pixels_at_0, whole, input, threads.threads())?;
            if is_straight {
                divide(&mut pixels);
            }
            if input.kind() == ImageKind::Motion {
                longer(&mut pixels, square.per_pixel());
            }
        }
        // SAFETY: the host promised that the target's memory may be written, and the count, or it is null.
        unsafe {
            let mut pixels = moved(pixels, target.window)?;
            match input {
                GraphInput::Color => target.write(&mut pixels, threads.threads(), AS_COMPUTED)?,
                _ => target.write_guide(&pixels),
            }
            args::put_if_wanted(replaced, bad);
        }
        Ok(())
    };
    // SAFETY: the host promised that the text may be written, or is null.
    guard::call(body, |message| unsafe { args::fill_message(error, message) })
}

unsafe extern "C" fn from_square(
    image: *const IsophoteImage,
    aspect: f64,
    alpha: IsophoteAlpha,
    threads: u32,
    target: *const IsophoteTarget,
    error: *mut IsophoteText,
) -> IsophoteStatus {
    let body = || {
        // SAFETY: the host promised structs behind the pointers.
        let (image, target) = unsafe {
            let image = Checked::source(&args::get(image, "the image")?, GraphInput::Color, "the image")?;
            (image, Checked::new(&args::get(target, "the target image")?, "the target image")?)
        };
        let whole = Rect::of_size(target.window.width(), target.window.height());
        let square = square([whole.width(), whole.height()], aspect)?;
        let [width, height] = square.map_or([whole.width(), whole.height()], |square| square.size());
        must_be(&image, Rect::of_size(width, height))?;
        let threads = CallThreads::new(&IsophoteControl { threads, ..NO_CONTROL })?;
        // SAFETY: the host promised that the image's memory may be read.
        let (mut pixels, _) = unsafe { image.read(image.window, GraphInput::Color, threads.threads())? };
        if let Some(square) = square {
            let is_straight = alpha == ISOPHOTE_ALPHA_STRAIGHT;
            if is_straight {
                multiply(&mut pixels);
            }
            let pixels_at_0 = moved(pixels, Rect::of_size(width, height))?;
            pixels = square.to_host(pixels_at_0, whole, threads.threads())?;
            if is_straight {
                divide(&mut pixels);
            }
        }
        // SAFETY: the host promised that the target's memory may be written.
        unsafe { target.write(&mut moved(pixels, target.window)?, threads.threads(), AS_COMPUTED) }
    };
    // SAFETY: the host promised that the text may be written, or is null.
    guard::call(body, |message| unsafe { args::fill_message(error, message) })
}

/// Fails unless an image has the size of `wanted`.
fn must_be(image: &Checked, wanted: Rect) -> Outcome<()> {
    let (has, wanted) = (image.window, [wanted.width(), wanted.height()]);
    if [has.width(), has.height()] == wanted {
        return Ok(());
    }
    let [width, height] = wanted;
    Err(Failure::geometry(format!(
        "an image of {}x{} pixels is given where square ones are {width}x{height}",
        has.width(),
        has.height()
    )))
}

/// The same pixels in another place.
fn moved(image: Image, window: Rect) -> Outcome<Image> {
    if image.window() == window {
        return Ok(image);
    }
    let mut moved = Image::with_window(window, image.channels())?;
    moved.data_mut().copy_from_slice(image.data());
    Ok(moved)
}

/// Vectors in other pixels, so many for one; what is unknown is no number.
fn longer(vectors: &mut Image, [x, y]: [f64; 2]) {
    for vector in vectors.data_mut().chunks_exact_mut(2) {
        if vector[0] == UNKNOWN {
            vector.fill(f32::NAN);
        } else {
            vector[0] *= x as f32;
            vector[1] *= y as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ptr::null_mut;

    fn image(values: &[f32], size: [u32; 2], channels: u32) -> IsophoteImage {
        IsophoteImage {
            data: values.as_ptr().cast(),
            row_stride: (size[0] * channels * 4) as isize,
            sample: ISOPHOTE_SAMPLE_F32,
            channels,
            width: size[0],
            height: size[1],
            x: 3,
            y: -2,
        }
    }

    fn target(values: &mut [f32], size: [u32; 2], channels: u32) -> IsophoteTarget {
        let IsophoteImage { row_stride, sample, channels, width, height, x, y, .. } =
            image(values, size, channels);
        IsophoteTarget { data: values.as_mut_ptr().cast(), row_stride, sample, channels, width, height, x, y }
    }

    fn size(width: u32, height: u32, aspect: f64) -> IsophoteSquareSize {
        let mut size = IsophoteSquareSize::default();
        // SAFETY: the place may be written.
        assert_eq!(unsafe { square_size(width, height, aspect, &raw mut size) }, ISOPHOTE_OK);
        size
    }

    #[test]
    fn sizes_are_those_of_the_finer_side() {
        let of = |width, height, scale| IsophoteSquareSize { width, height, scale };
        assert_eq!(size(5, 3, 2.0), of(10, 3, 1.0));
        assert_eq!(size(5, 3, 0.5), of(5, 6, 2.0));
        assert_eq!(size(5, 3, 1.005), of(5, 3, 1.0));
        for (width, aspect) in [(5, 0.0), (5, f64::NAN), (5, 1e9), (0, 2.0)] {
            // SAFETY: nothing is written before the numbers are checked.
            assert_ne!(unsafe { square_size(width, 3, aspect, null_mut()) }, ISOPHOTE_OK);
        }
    }

    #[test]
    fn colour_comes_back_and_vectors_count_in_square_pixels() {
        let colour: Vec<f32> = (0..5 * 3 * 4).map(|i| ((i * 37) % 60) as f32 / 60.0).collect();
        for alpha in [ISOPHOTE_ALPHA_PREMULTIPLIED, ISOPHOTE_ALPHA_STRAIGHT] {
            let (mut square, mut back) = (vec![0.0; 10 * 3 * 4], vec![0.0; colour.len()]);
            let (from, to) = (image(&colour, [5, 3], 4), target(&mut square, [10, 3], 4));
            let (mut replaced, name) = (9, c"color".as_ptr());
            // SAFETY: images and targets are as large as they say, and the count may be written.
            let status = unsafe {
                to_square(name, &raw const from, 2.0, alpha, 1, &raw const to, &raw mut replaced, null_mut())
            };
            assert_eq!((status, replaced), (ISOPHOTE_OK, 0));
            let (from, to) = (image(&square, [10, 3], 4), target(&mut back, [5, 3], 4));
            // SAFETY: as above.
            let status = unsafe { from_square(&raw const from, 2.0, alpha, 1, &raw const to, null_mut()) };
            assert_eq!(status, ISOPHOTE_OK);
            for (at, (a, b)) in colour.iter().zip(&back).enumerate() {
                let is_hidden = alpha == ISOPHOTE_ALPHA_STRAIGHT && colour[at / 4 * 4 + 3] == 0.0;
                assert!(is_hidden || (a - b).abs() < 1e-5, "{a} {b}");
            }
        }
        let vectors = [1.0, 2.0, f32::NAN, 0.0];
        let mut square = vec![0.0; 4 * 2];
        let (from, to) = (image(&vectors, [2, 1], 2), target(&mut square, [4, 1], 2));
        let name = c"motion".as_ptr();
        // SAFETY: as above.
        let status =
            unsafe { to_square(name, &raw const from, 2.0, 0, 1, &raw const to, null_mut(), null_mut()) };
        assert_eq!((status, &square[..4]), (ISOPHOTE_OK, &[2.0, 2.0, 2.0, 2.0][..]));
        assert!(square[4..].iter().all(|v| v.is_nan()));
    }
}
