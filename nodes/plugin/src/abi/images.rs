//! The host's images: checked, read row by row, and written row by row.
//!
//! No slice ever covers more than a copy of one row, since rows may run upwards, overlap those of
//! another image, or lie at any address.

use super::failure::{Failure, Outcome};
use super::guard::lock;
use crate::pool;
use isophote::engine::cpu::Threads;
use isophote::engine::pixels::{Sample, read_row, read_vectors, write_row};
use isophote::engine::{Image, Rect};
use isophote::graph::GraphInput;
use isophote::kernels::shared::motion::UNKNOWN;
use isophote::spec::ImageKind;
use isophote_abi::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Value of a control map that changes nothing.
const NEUTRAL: f32 = 0.5;

/// Rows that a thread reads or writes one after the other.
const ROWS: u32 = 32;

/// An image of the host's whose shape was checked.
#[derive(Clone, Copy, Debug)]
pub struct Checked {
    data: *mut u8,
    row_stride: isize,
    sample: Sample,
    channels: usize,
    /// The part of the picture that it holds.
    pub window: Rect,
}

impl Checked {
    /// Checks an image that is read.
    ///
    /// # Errors
    /// Invalid argument for a null pointer or an unlisted number, geometry for sizes and strides that
    /// no image can have.
    pub fn source(image: &IsophoteImage, input: GraphInput, what: &str) -> Outcome<Self> {
        Self::of(
            &IsophoteTarget {
                data: image.data.cast_mut(),
                row_stride: image.row_stride,
                sample: image.sample,
                channels: image.channels,
                width: image.width,
                height: image.height,
                x: image.x,
                y: image.y,
            },
            what,
            input.kind(),
        )
    }

    /// Checks an image that is written.
    ///
    /// # Errors
    /// As [`Checked::source`].
    pub fn new(image: &IsophoteTarget, what: &str) -> Outcome<Self> {
        Self::of(image, what, ImageKind::Color)
    }

    /// Checks an image that is written with pixels of an input: guides are floats.
    ///
    /// # Errors
    /// As [`Checked::source`]; input for guides in other samples, and of another number of channels than they have.
    pub fn target(image: &IsophoteTarget, input: GraphInput) -> Outcome<Self> {
        let checked = Self::of(image, "the target image", input.kind())?;
        let (name, channels) = (input.id(), input.kind().channels());
        if input != GraphInput::Color && (checked.sample != Sample::F32 || image.channels != channels) {
            let message = format!("the target image of '{name}' must have {channels} channels of f32");
            return Err(Failure::new(ISOPHOTE_ERROR_INPUT, message));
        }
        Ok(checked)
    }

    fn of(image: &IsophoteTarget, what: &str, kind: ImageKind) -> Outcome<Self> {
        if image.data.is_null() {
            return Err(Failure::argument(format!("{what} has no data")));
        }
        let sample = match image.sample {
            ISOPHOTE_SAMPLE_U8 => Sample::U8,
            ISOPHOTE_SAMPLE_U16 => Sample::U16,
            ISOPHOTE_SAMPLE_F16 => Sample::F16,
            ISOPHOTE_SAMPLE_F32 => Sample::F32,
            other => {
                return Err(Failure::argument(format!("{what} has samples of the unknown format {other}")));
            }
        };
        let known = if kind == ImageKind::Motion { [2, 3, 4] } else { [1, 3, 4] };
        if !known.contains(&image.channels) {
            let [a, b, c] = known;
            let message = format!("{what} has {} channels, not {a}, {b} or {c}", image.channels);
            return Err(Failure::argument(message));
        }
        isophote::engine::image::check_size(image.width, image.height)
            .map_err(|e| Failure::geometry(format!("{what}: {e}")))?;
        let far = |from: i32, size: u32| from.checked_add_unsigned(size);
        let (Some(x1), Some(y1)) = (far(image.x, image.width), far(image.y, image.height)) else {
            let message = format!("{what} begins at ({}, {}), too far out", image.x, image.y);
            return Err(Failure::geometry(message));
        };
        let row_bytes = i128::from(image.width) * i128::from(image.channels) * sample.size() as i128;
        let stride = image.row_stride as i128;
        if image.height > 1 && stride.abs() < row_bytes {
            return Err(Failure::geometry(format!(
                "{what} has rows of {row_bytes} bytes and a row stride of only {stride}"
            )));
        }
        // From the first byte of the lowest row in memory to the last one of the highest.
        let last = stride * i128::from(image.height - 1);
        let base = image.data as usize as i128;
        let (begin, end) = (base + last.min(0), base + last.max(0) + row_bytes);
        if begin <= 0 || end > usize::MAX as i128 || end - begin > isize::MAX as i128 {
            return Err(Failure::geometry(format!(
                "{what} of {}x{} with a row stride of {stride} does not fit into memory",
                image.width, image.height
            )));
        }
        let window = Rect { x0: image.x, y0: image.y, x1, y1 };
        Ok(Self {
            data: image.data.cast(),
            row_stride: image.row_stride,
            sample,
            channels: image.channels as usize,
            window,
        })
    }

    /// Fails unless the image holds `needed`.
    ///
    /// # Errors
    /// Geometry, with what is held and what is needed.
    pub fn must_hold(&self, needed: &Rect, what: &str) -> Outcome<()> {
        if self.window.contains(needed) {
            return Ok(());
        }
        Err(Failure::geometry(format!("{what} holds {}; {} is needed", shown(&self.window), shown(needed))))
    }

    /// Address at which the pixels `window.x0..` of row `y` begin.
    fn at(&self, window: &Rect, y: i32) -> *mut u8 {
        let column = (window.x0 - self.window.x0) as usize * self.channels * self.sample.size();
        let row = (y - self.window.y0) as isize;
        // The products were checked for overflow when the image was.
        self.data.wrapping_offset(row * self.row_stride).wrapping_add(column)
    }

    /// Reads the pixels of `window`, which the image must hold, and counts the samples that were replaced.
    ///
    /// # Errors
    /// Out of memory; input when normals, positions or motions are not floats of as many channels.
    ///
    /// # Safety
    /// The memory of the image must be readable.
    pub unsafe fn read(
        &self,
        window: Rect,
        input: GraphInput,
        threads: &dyn Threads,
    ) -> Outcome<(Image, u64)> {
        self.must_suit(input)?;
        let mut image = pool::image(window, input.kind().channels())?;
        // SAFETY: as the caller promised.
        let replaced = unsafe { self.read_rows(&mut image, window.y0..window.y1, input, threads)? };
        Ok((image, replaced))
    }

    /// Reads `rows` of the columns of `image`, which both must hold, into it, and counts the samples that were replaced. The
    /// input was found to suit.
    ///
    /// # Errors
    /// Out of memory.
    ///
    /// # Safety
    /// As [`Checked::read`].
    pub unsafe fn read_rows(
        &self,
        image: &mut Image,
        rows: Range<i32>,
        input: GraphInput,
        threads: &dyn Threads,
    ) -> Outcome<u64> {
        let window = image.window();
        let (replaced, shared) = (AtomicU64::new(0), Shared(self));
        of_rows(image, rows, threads, &|first, rows, stride| {
            let checked = shared.get();
            let mut bytes = checked.row_of_bytes(&window)?;
            for (y, row) in (first..).zip(rows.chunks_exact_mut(stride)) {
                // SAFETY: the row lies in the image, whose memory is readable as the caller promised; the copy
                // is of bytes and needs no alignment.
                unsafe { bytes.as_mut_ptr().copy_from_nonoverlapping(checked.at(&window, y), bytes.len()) };
                replaced.fetch_add(checked.row_of(&bytes, input, row), Ordering::Relaxed);
            }
            Ok(())
        })?;
        Ok(replaced.into_inner())
    }

    /// The values of a row of an input, of its bytes; counts the samples that were replaced.
    fn row_of(&self, bytes: &[u8], input: GraphInput, row: &mut [f32]) -> u64 {
        if input.kind() == ImageKind::Motion {
            read_vectors(bytes, self.sample, self.channels, row, 2, UNKNOWN);
            return 0;
        }
        let replaced = read_row(bytes, self.sample, self.channels, row, input.kind().channels() as usize);
        if input == GraphInput::RestPosition && self.channels == 3 {
            // Renderers leave 0, 0, 0 where there is nothing.
            for point in row.chunks_exact_mut(4) {
                point[3] = f32::from(u8::from(point[..3] != [0.0; 3]));
            }
        }
        if input == GraphInput::Control && self.channels < 4 {
            row.chunks_exact_mut(4).for_each(|map| map[3] = NEUTRAL);
        }
        // Numbers, not shares of the largest one.
        let most = match self.sample {
            Sample::U8 if input == GraphInput::ObjectId => 255.0,
            Sample::U16 if input == GraphInput::ObjectId => 65535.0,
            _ => return replaced,
        };
        row.iter_mut().for_each(|v| *v = (*v * most).round());
        replaced
    }

    /// Hands the bytes of each row of `window`, which the image must hold, to `look`, on several threads. They are not copied:
    /// who looks through many pictures for their contents does hardly anything beside reading.
    ///
    /// # Safety
    /// The memory of the image must be readable, and nobody may write to it meanwhile.
    pub unsafe fn each_row(&self, window: Rect, threads: &dyn Threads, look: &(dyn Fn(i32, &[u8]) + Sync)) {
        let image = Shared(self);
        let len = window.width() as usize * self.channels * self.sample.size();
        threads.run(window.height().div_ceil(ROWS) as usize, &|job| {
            let first = window.y0 + job as i32 * ROWS as i32;
            for y in first..(first + ROWS as i32).min(window.y1) {
                // SAFETY: the row lies in the image, whose memory is readable and stays as it is, as the caller promised.
                look(y, unsafe { std::slice::from_raw_parts(image.get().at(&window, y), len) });
            }
        });
    }

    /// Reads two channels of the pixels of `inside`, which both images must hold, as they are stored, into an image of
    /// two, and has `change` go over each row of them.
    ///
    /// # Errors
    /// Input when the image has no such channels.
    ///
    /// # Safety
    /// As [`Checked::each_row`].
    pub unsafe fn read_pairs(
        &self,
        inside: Rect,
        channels: [usize; 2],
        pairs: &mut Image,
        threads: &dyn Threads,
        change: &(dyn Fn(&mut [f32]) + Sync),
    ) -> Outcome<()> {
        if channels.iter().any(|c| *c >= self.channels) {
            return Err(Failure::new(ISOPHOTE_ERROR_INPUT, "an image of vectors has too few channels"));
        }
        let (sample, pixel) = (self.sample, self.channels * self.sample.size());
        let (whole, stride) = (pairs.window(), pairs.stride());
        let rows: Vec<Mutex<&mut [f32]>> =
            pairs.data_mut().chunks_exact_mut(stride).map(Mutex::new).collect();
        let first = (inside.x0 - whole.x0) as usize * 2;
        let read = |y: i32, bytes: &[u8]| {
            let mut row = lock(&rows[(y - whole.y0) as usize]);
            let row = &mut row[first..first + bytes.len() / pixel * 2];
            let pairs = bytes.chunks_exact(pixel).zip(row.chunks_exact_mut(2));
            match sample {
                Sample::F32 => pairs.for_each(|(pixel, pair)| read_floats(pixel, channels, pair)),
                _ => pairs.for_each(|(pixel, pair)| read_pair(pixel, sample, channels, pair)),
            }
            change(row);
        };
        // SAFETY: as the caller promised.
        unsafe { self.each_row(inside, threads, &read) };
        Ok(())
    }

    /// Fails for directions, vectors and ids in samples that cannot hold them.
    pub(super) fn must_suit(&self, input: GraphInput) -> Outcome<()> {
        let (channels, shown) = match input.kind() {
            ImageKind::Normal | ImageKind::Position => (3, "3 or 4 channels of f16 or f32"),
            ImageKind::Motion => (2, "2 to 4 channels of f16 or f32"),
            // Ids are all bits of a float.
            ImageKind::Cryptomatte => (4, "4 channels of f32"),
            _ => return Ok(()),
        };
        let is_short = matches!(self.sample, Sample::U8 | Sample::U16)
            || self.sample == Sample::F16 && input.kind() == ImageKind::Cryptomatte;
        if self.channels < channels || is_short {
            let name = input.id();
            return Err(Failure::new(
                ISOPHOTE_ERROR_INPUT,
                format!("input image '{name}' must have {shown}"),
            ));
        }
        Ok(())
    }

    /// Bytes of one row of `window`.
    pub(super) fn row_bytes(&self, window: &Rect) -> usize {
        window.width() as usize * self.channels * self.sample.size()
    }

    /// True where its pixels have alpha.
    pub(super) fn has_alpha(&self) -> bool {
        self.channels == 4
    }

    /// Kind of its samples, and how many a pixel has.
    pub(super) fn format(&self) -> (Sample, usize) {
        (self.sample, self.channels)
    }

    /// Copies the bytes of row `y` of `window`, which the image must hold.
    ///
    /// # Safety
    /// As [`Checked::write`].
    pub(super) unsafe fn put_row(&self, window: &Rect, y: i32, bytes: &[u8]) {
        // SAFETY: the row lies in the image, whose memory is writable as the caller promised; the copy is of bytes and
        // needs no alignment.
        unsafe { self.at(window, y).copy_from_nonoverlapping(bytes.as_ptr(), bytes.len()) };
    }

    /// Room for a copy of one row of `window`.
    fn row_of_bytes(&self, window: &Rect) -> Outcome<Vec<u8>> {
        let len = self.row_bytes(window);
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(len).map_err(|_| {
            Failure::new(ISOPHOTE_ERROR_OUT_OF_MEMORY, format!("there is no memory for a row of {len} bytes"))
        })?;
        bytes.resize(len, 0);
        Ok(bytes)
    }

    /// Writes the numbers of a guide as they are, into an image of [`Checked::target`] that holds its window.
    ///
    /// # Safety
    /// The memory of the image must be writable.
    pub unsafe fn write_guide(&self, result: &Image) {
        let window = result.window();
        for y in window.y0..window.y1 {
            let bytes: Vec<u8> = result.row(y).iter().flat_map(|v| v.to_ne_bytes()).collect();
            // SAFETY: as in `write`: floats of as many channels are as many bytes.
            unsafe { self.at(&window, y).copy_from_nonoverlapping(bytes.as_ptr(), bytes.len()) };
        }
    }

    /// Writes all pixels of `result`, which must lie within the image, each row after `last` has changed it.
    ///
    /// # Errors
    /// Out of memory.
    ///
    /// # Safety
    /// The memory of the image must be writable.
    pub unsafe fn write(
        &self,
        result: &mut Image,
        threads: &dyn Threads,
        last: &(dyn Fn(i32, &mut [f32]) + Sync),
    ) -> Outcome<()> {
        let (window, channels, shared) = (result.window(), result.channels() as usize, Shared(self));
        of_rows(result, window.y0..window.y1, threads, &|first, rows, stride| {
            let checked = shared.get();
            let mut bytes = checked.row_of_bytes(&window)?;
            for (y, row) in (first..).zip(rows.chunks_exact_mut(stride)) {
                last(y, row);
                write_row(row, channels, &mut bytes, checked.sample, checked.channels);
                // SAFETY: as the caller promised.
                unsafe { checked.put_row(&window, y, &bytes) };
            }
            Ok(())
        })
    }
}

/// Leaves rows as they were computed.
pub const AS_COMPUTED: &(dyn Fn(i32, &mut [f32]) + Sync) = &|_, _| ();

/// Reads two channels of a pixel. A vector of one component is kept whatever the other is.
fn read_pair(pixel: &[u8], sample: Sample, channels: [usize; 2], pair: &mut [f32]) {
    let size = sample.size();
    for (value, channel) in pair.iter_mut().zip(channels) {
        let from = &pixel[channel * size..][..size];
        read_vectors(from, sample, 1, std::slice::from_mut(value), 1, f32::NAN);
    }
}

/// The same of floats, of which whole pictures are read for each frame.
#[inline(always)]
fn read_floats(pixel: &[u8], channels: [usize; 2], pair: &mut [f32]) {
    for (value, channel) in pair.iter_mut().zip(channels) {
        let bytes = pixel[channel * 4..].first_chunk();
        let read = bytes.map_or(f32::NAN, |bytes| f32::from_ne_bytes(*bytes));
        *value = if read.is_finite() { read } else { f32::NAN };
    }
}

/// Work on some rows: the number of the first, their values, and how many values a row has.
type RowsJob<'r> = dyn Fn(i32, &mut [f32], usize) -> Outcome<()> + Sync + 'r;

/// Does `job` to rows of an image on several threads, some at once.
fn of_rows(image: &mut Image, rows: Range<i32>, threads: &dyn Threads, job: &RowsJob<'_>) -> Outcome<()> {
    let (window, stride) = (image.window(), image.stride());
    if window.is_empty() || rows.is_empty() {
        return Ok(());
    }
    let at = |y: i32| (y - window.y0) as usize * stride;
    let values = &mut image.data_mut()[at(rows.start)..at(rows.end)];
    let parts: Vec<Mutex<&mut [f32]>> = values.chunks_mut(stride * ROWS as usize).map(Mutex::new).collect();
    let failure = Mutex::new(None);
    threads.run(parts.len(), &|part| {
        let first = rows.start + part as i32 * ROWS as i32;
        if let Err(error) = job(first, &mut lock(&parts[part]), stride) {
            *lock(&failure) = Some(error);
        }
    });
    failure.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

/// An image that several threads read, or write in rows of their own.
struct Shared<'c>(&'c Checked);

impl<'c> Shared<'c> {
    fn get(&self) -> &'c Checked {
        self.0
    }
}

// SAFETY: who reads by it has been promised that the memory is readable, and nobody writes it meanwhile; who writes by it
// that the memory is writable, and no two threads write one row.
unsafe impl Sync for Shared<'_> {}

/// A rectangle for people: its size and corner.
pub fn shown(rect: &Rect) -> String {
    format!("{}x{} pixels at ({}, {})", rect.width(), rect.height(), rect.x0, rect.y0)
}
