//! Computing images on the CPU by rows: what is too large to be floats as a whole.
//!
//! Rows of the host's images become floats when passes need them, and rows of the result leave in the format of the target.
//! They are collected, since the target must stay as it is when a call fails, and may be the memory of an input.

use super::failure::{Failure, Outcome};
use super::guard::lock;
use super::images::Checked;
use isophote::engine::cpu::{CpuExecutor, Rows, Threads};
use isophote::engine::pixels::{Sample, write_row};
use isophote::engine::{Error, Image, Plan, Rect, Result, memory};
use isophote::graph::GraphInput;
use isophote::kernels::shared::host_colour::has_light;
use isophote_abi::ISOPHOTE_ERROR_OUT_OF_MEMORY;
use std::ops::Range;
use std::sync::Mutex;

/// Rows that are looked through at once.
const ROWS: i32 = 64;

/// Bytes that images of a run on the CPU take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// All of the picture at once, or what of it is still read.
    Whole(u64),
    /// Rows of all images.
    ByRows(u64),
}

impl Takes {
    /// Whole images of `region` where they take at most `most` bytes, else rows of them.
    pub fn of(plan: &Plan, region: Rect, most: u64, threads: &dyn Threads) -> Self {
        let whole = plan.peak_bytes(&plan.windows(region));
        if whole <= most {
            return Self::Whole(whole);
        }
        let rows = CpuExecutor::new().bytes_by_rows(plan, (region, most), threads);
        if rows < whole { Self::ByRows(rows) } else { Self::Whole(whole) }
    }

    /// The bytes.
    pub fn bytes(self) -> u64 {
        match self {
            Self::Whole(bytes) | Self::ByRows(bytes) => bytes,
        }
    }
}

/// An image of the host's that enters, and the part of it that is read.
pub type Source = (GraphInput, Checked, Rect);

/// The host's images and the result of one run.
pub struct HostRows<'a> {
    sources: &'a [Source],
    result: Packed,
    threads: &'a dyn Threads,
    /// Samples that were NaN or infinite and were replaced.
    pub replaced: u64,
}

impl<'a> HostRows<'a> {
    /// Those of a run that computes `region` for `target`.
    ///
    /// # Errors
    /// Out of memory; input for samples that a guide cannot have.
    ///
    /// # Safety
    /// The memory of the sources must be readable as long as this lives.
    pub unsafe fn new(
        sources: &'a [Source],
        (target, region): (&Checked, Rect),
        threads: &'a dyn Threads,
    ) -> Outcome<Self> {
        sources.iter().try_for_each(|(input, image, _)| image.must_suit(*input))?;
        Ok(Self { sources, result: Packed::new(target, region)?, threads, replaced: 0 })
    }

    /// True where the colour, which is premultiplied, has light beyond its coverage.
    ///
    /// # Errors
    /// Out of memory.
    pub fn has_light(&self) -> Outcome<bool> {
        let color = self.sources.iter().find(|(input, ..)| *input == GraphInput::Color);
        let Some((input, color, window)) = color.filter(|(_, color, _)| color.has_alpha()) else {
            return Ok(false);
        };
        let mut image = Image::with_window(Rect { y1: window.y0 + 1, ..*window }, 4)?;
        for y0 in (window.y0..window.y1).step_by(ROWS as usize) {
            image = image.reshaped(Rect { y0, y1: (y0 + ROWS).min(window.y1), ..*window }, 4)?;
            let rows = y0..image.window().y1;
            // SAFETY: the memory is readable, as was promised when this was made.
            unsafe { color.read_rows(&mut image, rows, *input, self.threads)? };
            if has_light(image.data()) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Copies the result to the target.
    ///
    /// # Safety
    /// The memory of the target must be writable.
    pub unsafe fn finish(self, target: &Checked) {
        for (y, row) in (self.result.window.y0..).zip(self.result.bytes.chunks_exact(self.result.stride)) {
            // SAFETY: as the caller promised.
            unsafe { target.put_row(&self.result.window, y, row) };
        }
    }
}

impl Rows for HostRows<'_> {
    fn read(&mut self, name: &str, rows: Range<i32>, image: &mut Image) -> Result<()> {
        let Some((input, source, _)) = self.sources.iter().find(|(input, ..)| input.id() == name) else {
            return Err(Error::Input(format!("input image '{name}' is missing")));
        };
        // SAFETY: the memory is readable, as was promised when this was made.
        let replaced = unsafe { source.read_rows(image, rows, *input, self.threads) };
        self.replaced += replaced.map_err(|failure| Error::Memory(failure.message))?;
        Ok(())
    }

    fn write(&mut self, output: usize, part: Rect, image: &Image) -> Result<()> {
        // The first is the graph's; others are stages that sequences keep.
        if output == 0 {
            self.result.pack(part, image, self.threads);
        }
        Ok(())
    }
}

/// A result in the format of its target.
struct Packed {
    /// Kind of its samples, and how many a pixel has.
    format: (Sample, usize),
    window: Rect,
    stride: usize,
    bytes: Vec<u8>,
}

impl Packed {
    fn new(target: &Checked, window: Rect) -> Outcome<Self> {
        let stride = target.row_bytes(&window);
        let len = stride * window.height() as usize;
        memory::must_have(len as u64)?;
        let mut bytes = Vec::new();
        let refused = |_| {
            Failure::new(
                ISOPHOTE_ERROR_OUT_OF_MEMORY,
                format!("there is no memory for a result of {len} bytes"),
            )
        };
        bytes.try_reserve_exact(len).map_err(refused)?;
        bytes.resize(len, 0);
        Ok(Self { format: target.format(), window, stride, bytes })
    }

    fn pack(&mut self, part: Rect, image: &Image, threads: &dyn Threads) {
        let channels = image.channels() as usize;
        let first = (part.x0 - image.window().x0) as usize * channels;
        let values = first..first + part.width() as usize * channels;
        let begin = (part.y0 - self.window.y0) as usize * self.stride;
        let bytes = &mut self.bytes[begin..begin + part.height() as usize * self.stride];
        let rows: Vec<Mutex<&mut [u8]>> = bytes.chunks_exact_mut(self.stride).map(Mutex::new).collect();
        let (sample, samples) = self.format;
        threads.run(rows.len(), &|row| {
            let values = &image.row(part.y0 + row as i32)[values.clone()];
            write_row(values, channels, &mut lock(&rows[row]), sample, samples);
        });
    }
}
