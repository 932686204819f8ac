//! Arrays of NumPy as pixels.
//!
//! The package prepares arrays so that they can be taken as they lie in memory; here that is checked, since everything after
//! it trusts the numbers. They come from NumPy's own description of its arrays, the array interface.

use isophote_loader::abi::{IsophoteImage, IsophoteTarget};
use isophote_loader::{AsImage, AsTarget, Image, Sample, Target};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

/// Pixels in an array's memory, which is kept.
#[derive(Debug)]
pub struct Pixels {
    /// The first pixel of the top row.
    pub data: *mut u8,
    /// Bytes from one row to the one below it.
    pub row_stride: isize,
    /// Storage of a sample.
    pub sample: Sample,
    /// Samples a pixel.
    pub channels: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Whose memory it is.
    _array: Py<PyAny>,
}

// SAFETY: the memory is the array's, which lives as long as this; only the library reads and writes it, and it may be done
// on any thread.
unsafe impl Send for Pixels {}
// SAFETY: as above; nothing in it changes.
unsafe impl Sync for Pixels {}

/// Direction: an array that is read, or one that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// It is read.
    Read,
    /// It is written.
    Write,
}

impl Pixels {
    /// The pixels of an array of rows, columns and channels, whose rows hold their pixels one after the other.
    ///
    /// # Errors
    /// `TypeError` for what is no such array of NumPy, `ValueError` for another layout, and for arrays that are written and
    /// may not be.
    pub fn of(array: &Bound<'_, PyAny>, what: &str, purpose: Use) -> PyResult<Self> {
        let interface = interface(array, what)?;
        let (data, is_read_only): (usize, bool) = item(&interface, "data")?.extract()?;
        if is_read_only && purpose == Use::Write {
            return Err(PyValueError::new_err(format!("{what} is read-only")));
        }
        let kind: String = item(&interface, "typestr")?.extract()?;
        let sample = sample(&kind).ok_or_else(|| {
            PyTypeError::new_err(format!(
                "{what} has samples of type '{kind}' in memory, which none are read as"
            ))
        })?;
        let shape: Vec<usize> = item(&interface, "shape")?.extract()?;
        let [height, width, channels] = *shape.as_slice() else {
            return Err(PyValueError::new_err(format!(
                "{what} has the shape {shape:?}, not rows, columns, channels"
            )));
        };
        let size = sample.bytes();
        let pixel = channels.saturating_mul(size);
        let strides: Option<Vec<isize>> = item(&interface, "strides")?.extract()?;
        let strides =
            strides.unwrap_or_else(|| [width.saturating_mul(pixel), pixel, size].map(|s| s as isize).into());
        let [row_stride, column, channel] = *strides.as_slice() else {
            return Err(PyValueError::new_err(format!("{what} has strides {strides:?} of another shape")));
        };
        // The strides of a dimension of one element say nothing.
        let is_dense =
            (channels <= 1 || channel == size as isize) && (width <= 1 || column == pixel as isize);
        if !is_dense {
            return Err(PyValueError::new_err(format!(
                "the rows of {what} do not hold pixels one after the other"
            )));
        }
        let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Ok(Self {
            data: data as *mut u8,
            row_stride: if height > 1 { row_stride } else { width.saturating_mul(pixel) as isize },
            sample,
            channels: number(channels),
            width: number(width),
            height: number(height),
            _array: array.clone().unbind(),
        })
    }
}

/// NumPy's own description of an array, whatever a class derived from its arrays says.
fn interface<'py>(array: &Bound<'py, PyAny>, what: &str) -> PyResult<Bound<'py, PyDict>> {
    static DESCRIBE: PyOnceLock<[Py<PyAny>; 2]> = PyOnceLock::new();
    let py = array.py();
    let [class, describe] = DESCRIBE.get_or_try_init(py, || {
        let class = py.import("numpy")?.getattr("ndarray")?;
        let describe = class.getattr("__array_interface__")?.getattr("__get__")?;
        Ok::<_, PyErr>([class.unbind(), describe.unbind()])
    })?;
    if !array.is_instance(class.bind(py))? {
        return Err(PyTypeError::new_err(format!("{what} is no array of NumPy")));
    }
    Ok(describe.bind(py).call1((array,))?.cast_into::<PyDict>()?)
}

fn item<'py>(interface: &Bound<'py, PyDict>, key: &str) -> PyResult<Bound<'py, PyAny>> {
    match interface.get_item(key)? {
        Some(value) => Ok(value),
        None => Ok(interface.py().None().into_bound(interface.py())),
    }
}

/// A type of samples, by NumPy's name of it.
fn sample(kind: &str) -> Option<Sample> {
    let native = if cfg!(target_endian = "little") { '<' } else { '>' };
    let (order, kind) = kind.split_at_checked(1)?;
    let is_native = order == "|" || order.starts_with(native);
    match kind {
        "u1" => Some(Sample::U8),
        "u2" if is_native => Some(Sample::U16),
        "f2" if is_native => Some(Sample::F16),
        "f4" if is_native => Some(Sample::F32),
        _ => None,
    }
}

impl AsImage for Pixels {
    fn image(&self) -> Image<'_> {
        let IsophoteTarget { data, row_stride, sample, channels, width, height, x, y } = self.described();
        let data = data.cast_const();
        // SAFETY: the memory is that of an array that `self` keeps alive, with the strides and sizes that NumPy vouches for.
        // Whoever changes it meanwhile gets pixels of before or after: samples are copied, and any bits are a sample.
        unsafe { Image::from_raw(IsophoteImage { data, row_stride, sample, channels, width, height, x, y }) }
    }
}

impl AsTarget for Pixels {
    fn target(&mut self) -> Target<'_> {
        // SAFETY: as for images; NumPy said that the memory may be written when `self` was made to be.
        unsafe { Target::from_raw(self.described()) }
    }
}

impl Pixels {
    /// Place where a line of floats begins.
    pub fn line(&self, y: u32) -> *mut f32 {
        self.data.wrapping_offset(y as isize * self.row_stride).cast()
    }

    fn described(&self) -> IsophoteTarget {
        IsophoteTarget {
            data: self.data.cast(),
            row_stride: self.row_stride,
            sample: self.sample.number(),
            channels: self.channels,
            width: self.width,
            height: self.height,
            x: 0,
            y: 0,
        }
    }
}
