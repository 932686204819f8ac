//! Colours of spaces in which the library does not compute, changed to one of those in which it does, and back.

use crate::array::{Pixels, Use};
use crate::exception::{invalid, usage};
use isophote_colour::{Conversion, Space};
use isophote_loader::Sample;
use pyo3::prelude::*;

/// Id of the space of an id or alias, and of the one in which the library computes its pictures.
///
/// # Errors
/// `InvalidValueError` for a space that does not exist.
#[pyfunction]
pub fn color_space(name: &str) -> PyResult<(&'static str, &'static str)> {
    let space = named(name)?;
    Ok((space.id(), space.working().id()))
}

/// The space of an id or alias.
///
/// # Errors
/// `InvalidValueError`, which says which there are.
pub fn named(name: &str) -> PyResult<Space> {
    name.parse().map_err(invalid)
}

/// Changes an array of floats, in its own memory, from one space to another.
///
/// # Errors
/// `InvalidValueError` for a space that does not exist, and those of arrays that cannot be written.
#[pyfunction]
#[pyo3(signature = (array, source, target, is_premultiplied))]
pub fn change_space(
    py: Python<'_>,
    array: &Bound<'_, PyAny>,
    source: &str,
    target: &str,
    is_premultiplied: bool,
) -> PyResult<()> {
    let pixels = Pixels::of(array, "the picture", Use::Write)?;
    if pixels.sample != Sample::F32 {
        return Err(usage("colours are changed in float32"));
    }
    if let Some(conversion) = Conversion::of_spaces(named(source)?, named(target)?, is_premultiplied) {
        py.detach(|| change(&pixels, &conversion));
    }
    Ok(())
}

fn change(pixels: &Pixels, conversion: &Conversion) {
    let channels = pixels.channels.max(1) as usize;
    let mut row = vec![0.0; pixels.width as usize * channels];
    for y in 0..pixels.height {
        let line = pixels.line(y);
        // SAFETY: the line holds so many floats, as the description of the array says; nothing is aligned.
        unsafe {
            for (at, value) in row.iter_mut().enumerate() {
                *value = line.add(at).read_unaligned();
            }
            for pixel in row.chunks_exact_mut(channels) {
                conversion.apply(pixel);
            }
            for (at, value) in row.iter().enumerate() {
                line.add(at).write_unaligned(*value);
            }
        }
    }
}
