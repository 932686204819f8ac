//! Images of the host's, fetched, read into the engine's and written back, and released on every path.

use super::content;
use super::contents::Rows;
use super::frame::{Bounds, Frame};
use super::host::{Host, Outcome, Properties};
use crate::abi::guard::lock;
use crate::abi::images::{AS_COMPUTED, Checked};
use crate::pool;
use isophote::engine::cpu::{CallingThread, Threads};
use isophote::engine::{Image, Rect};
use isophote::graph::GraphInput;
use isophote::spec::ImageKind;
use isophote_abi::openfx::*;
use isophote_abi::*;
use std::ffi::CStr;
use std::ptr::null_mut;
use std::sync::Mutex;

/// Share of a frame below which differences are rounding.
const ROUNDING: f64 = 1e-3;

/// Relation of colour to alpha in an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    Premultiplied,
    Unpremultiplied,
    Opaque,
}

/// A clip of an instance.
#[derive(Clone, Copy, Debug)]
pub struct Clip<'h> {
    host: &'h Host,
    handle: Handle,
    /// Its properties.
    pub properties: Properties<'h>,
}

impl<'h> Clip<'h> {
    /// The clip of this name, where the instance has it.
    pub fn of(host: &'h Host, instance: Handle, name: &CStr) -> Option<Self> {
        let get = host.effects.clipGetHandle?;
        let (mut handle, mut set) = (null_mut(), null_mut());
        // SAFETY: an instance that the host gave, a string with a closing zero, and places for the answers.
        let status = unsafe { get(instance, name.as_ptr(), &raw mut handle, &raw mut set) };
        (status == kOfxStatOK && !handle.is_null()).then(|| Self { host, handle, properties: host.set(set) })
    }

    /// True where it says that nothing is connected.
    pub fn is_open(&self) -> bool {
        self.properties.int(kOfxImageClipPropConnected, 0) == Some(0)
    }

    /// True where it says that its samples are no floats of 32 bits.
    pub fn is_short(&self) -> bool {
        let depth = self.properties.string(kOfxImageEffectPropPixelDepth, 0);
        depth.is_some_and(|depth| depth.as_c_str() != kOfxBitDepthFloat)
    }

    /// True where it has a frame at a time: unless it says that it has not.
    pub fn has_frame(&self, time: f64) -> bool {
        let range = self.properties.doubles::<2>(kOfxImageEffectPropFrameRange);
        // Hosts have been seen to leave the numbers as they found them.
        let range = range.filter(|[first, last]| first <= last);
        range.is_none_or(|[first, last]| first - ROUNDING <= time && time <= last + ROUNDING)
    }

    /// Samples of its pixels, as it says; as many as there may be, where it does not.
    pub fn channels(&self) -> usize {
        match self.properties.string(kOfxImageEffectPropComponents, 0) {
            Some(c) if c.as_c_str() == kOfxImageComponentRGB => 3,
            Some(c) if c.as_c_str() == kOfxImageComponentAlpha => 1,
            _ => 4,
        }
    }

    /// Its region of definition, canonical.
    pub fn defined(&self, time: f64) -> Option<OfxRectD> {
        let get = self.host.effects.clipGetRegionOfDefinition?;
        let mut region = OfxRectD::default();
        // SAFETY: a clip that the host gave, and a place for the answer.
        let status = unsafe { get(self.handle, time, &raw mut region) };
        (status == kOfxStatOK).then_some(region)
    }

    /// Width over height of its pixels.
    pub fn aspect(&self) -> f64 {
        self.properties
            .double(kOfxImagePropPixelAspectRatio, 0)
            .filter(|par| (0.01..100.0).contains(par))
            .unwrap_or(1.0)
    }

    /// Its image; `None` where there is none, or nothing is connected.
    ///
    /// # Errors
    /// Image format, for one of an unknown depth or unknown components.
    pub fn image(&self, time: f64) -> Outcome<Option<Fetched<'h>>> {
        if self.is_open() { Ok(None) } else { self.fetch(time) }
    }

    /// Its image, even where it says that nothing is connected: a preview is rendered for nobody behind it.
    ///
    /// # Errors
    /// As [`Clip::image`].
    pub fn fetch(&self, time: f64) -> Outcome<Option<Fetched<'h>>> {
        let Some(get) = self.host.effects.clipGetImage else { return Ok(None) };
        let mut handle = null_mut();
        // SAFETY: a clip that the host gave, and a place for the answer; the null region asks for what the
        // regions of interest named.
        let status = unsafe { get(self.handle, time, std::ptr::null(), &raw mut handle) };
        if status != kOfxStatOK || handle.is_null() {
            return Ok(None);
        }
        let image = ImageHandle { host: self.host, handle };
        Fetched::of(image)
    }
}

/// An image that goes back to the host when it is dropped.
#[derive(Debug)]
struct ImageHandle<'h> {
    host: &'h Host,
    handle: Handle,
}

impl Drop for ImageHandle<'_> {
    fn drop(&mut self) {
        if let Some(release) = self.host.effects.clipReleaseImage {
            // SAFETY: an image that the host gave and that goes back once.
            unsafe { release(self.handle) };
        }
    }
}

/// An image of known shape.
#[derive(Debug)]
pub struct Fetched<'h> {
    data: *mut u8,
    row_bytes: isize,
    sample: IsophoteSample,
    /// Samples a pixel: 1, 3 or 4.
    pub channels: u32,
    /// Bounds of its pixels, in the host's pixels.
    pub bounds: Bounds,
    /// Relation of colour to alpha.
    pub alpha: Alpha,
    /// Width over height of its pixels, where it says so.
    pub aspect: Option<f64>,
    blue_first: bool,
    #[allow(dead_code, reason = "released when it is dropped")]
    handle: ImageHandle<'h>,
}

impl<'h> Fetched<'h> {
    fn of(handle: ImageHandle<'h>) -> Outcome<Option<Self>> {
        let set = handle.host.set(handle.handle);
        let Some(data) = set.pointer(kOfxImagePropData) else { return Ok(None) };
        let Some(bounds) = set.ints::<4>(kOfxImagePropBounds) else { return Ok(None) };
        if bounds[0] >= bounds[2] || bounds[1] >= bounds[3] {
            return Ok(None);
        }
        let depth = set.string(kOfxImageEffectPropPixelDepth, 0).unwrap_or_default();
        let sample = match depth.as_c_str() {
            d if d == kOfxBitDepthFloat => ISOPHOTE_SAMPLE_F32,
            d if d == kOfxBitDepthHalf => ISOPHOTE_SAMPLE_F16,
            d if d == kOfxBitDepthShort => ISOPHOTE_SAMPLE_U16,
            d if d == kOfxBitDepthByte => ISOPHOTE_SAMPLE_U8,
            _ => return Err(kOfxStatErrImageFormat),
        };
        let components = set.string(kOfxImageEffectPropComponents, 0).unwrap_or_default();
        let channels = match components.as_c_str() {
            c if c == kOfxImageComponentRGBA => 4,
            c if c == kOfxImageComponentRGB => 3,
            c if c == kOfxImageComponentAlpha => 1,
            _ => return Err(kOfxStatErrImageFormat),
        };
        let size = [2, 3].map(|i| i64::from(bounds[i]) - i64::from(bounds[i - 2]));
        let row_bytes = match set.int(kOfxImagePropRowBytes, 0) {
            Some(bytes) if bytes != 0 => bytes as isize,
            // One row needs no distance to the next.
            _ if size[1] == 1 => size[0] as isize * 16,
            _ => return Err(kOfxStatErrImageFormat),
        };
        let alpha = match set.string(kOfxImageEffectPropPreMultiplication, 0) {
            _ if channels != 4 => Alpha::Opaque,
            Some(state) if state.as_c_str() == kOfxImageOpaque => Alpha::Opaque,
            Some(state) if state.as_c_str() == kOfxImageUnPreMultiplied => Alpha::Unpremultiplied,
            _ => Alpha::Premultiplied,
        };
        let aspect = set.double(kOfxImagePropPixelAspectRatio, 0).filter(|par| (0.01..100.0).contains(par));
        let blue_first = set.string(PIXEL_ORDER, 0).as_deref() == Some(PIXEL_ORDER_BGRA) && channels == 4;
        Ok(Some(Self { data, row_bytes, sample, channels, bounds, alpha, aspect, blue_first, handle }))
    }

    /// The image as part of the picture, rows downwards: the host's top row is the first.
    ///
    /// # Errors
    /// Image format, when no image can have its shape.
    fn checked(&self, frame: &Frame) -> Outcome<Checked> {
        let [x1, y1, x2, y2] = self.bounds.map(i64::from);
        let small = |v: i64| i32::try_from(v).map_err(|_| kOfxStatErrImageFormat);
        let top = self.data.wrapping_offset((y2 - 1 - y1) as isize * self.row_bytes);
        let target = IsophoteTarget {
            data: top.cast(),
            row_stride: -self.row_bytes,
            sample: self.sample,
            channels: self.channels,
            width: (x2 - x1) as u32,
            height: (y2 - y1) as u32,
            x: small(x1 - i64::from(frame.picture[0]))?,
            y: small(i64::from(frame.picture[3]) - y2)?,
        };
        Checked::new(&target, "the image").map_err(|_| kOfxStatErrImageFormat)
    }

    /// The window that the image fills.
    ///
    /// # Errors
    /// Image format, when no image can have its shape.
    pub fn window(&self, frame: &Frame) -> Outcome<Rect> {
        Ok(self.checked(frame)?.window)
    }

    /// The pixels of `window`. What the image does not hold is as `beyond` says.
    ///
    /// # Errors
    /// Memory; image format, when no image can have its shape.
    pub fn read(
        &self,
        frame: &Frame,
        window: Rect,
        input: GraphInput,
        beyond: Beyond,
        threads: &dyn Threads,
    ) -> Outcome<Image> {
        let checked = self.checked(frame)?;
        let channels = input.kind().channels();
        let zeros = || Image::with_window(window, channels).map_err(|_| kOfxStatErrMemory);
        let inside = window.intersection(&checked.window);
        // Normals are read as colours: integers hold them as shares of -1..=1.
        let as_input = if input == GraphInput::Normal { GraphInput::Color } else { input };
        if beyond == Beyond::Tiled && inside != window {
            let tile = self.read(frame, checked.window, input, Beyond::Edge, threads)?;
            return repeated(&tile, window);
        }
        if inside.is_empty() && beyond == Beyond::Zero {
            return zeros();
        }
        let inside = if inside.is_empty() { nearest(&window, &checked.window) } else { inside };
        // SAFETY: the host gave the image, so that its memory may be read until it is released.
        let (mut part, _) =
            unsafe { checked.read(inside, as_input, threads) }.map_err(|_| kOfxStatErrMemory)?;
        if self.blue_first && channels == 4 {
            part.data_mut().chunks_exact_mut(4).for_each(|p| p.swap(0, 2));
        }
        if input == GraphInput::Normal && matches!(self.sample, ISOPHOTE_SAMPLE_U8 | ISOPHOTE_SAMPLE_U16) {
            part.data_mut().chunks_exact_mut(4).for_each(|p| {
                p[..3].iter_mut().for_each(|v| *v = *v * 2.0 - 1.0);
            });
        }
        if inside == window {
            return Ok(part);
        }
        let mut image = zeros()?;
        let c = channels as usize;
        for y in window.y0..window.y1 {
            if beyond == Beyond::Zero && !(inside.y0..inside.y1).contains(&y) {
                continue;
            }
            let from = part.row(y.clamp(inside.y0, inside.y1 - 1));
            for (x, pixel) in (window.x0..window.x1).zip(image.row_mut(y).chunks_exact_mut(c)) {
                if beyond == Beyond::Zero && !(inside.x0..inside.x1).contains(&x) {
                    continue;
                }
                let at = (x.clamp(inside.x0, inside.x1 - 1) - inside.x0) as usize * c;
                pixel.copy_from_slice(&from[at..at + c]);
            }
        }
        Ok(image)
    }

    /// Content of all that [`Fetched::read`] reads of `window` for the rows of `part`, a window within it.
    ///
    /// # Errors
    /// As [`Fetched::read`].
    pub fn rows(&self, frame: &Frame, window: Rect, part: Rect, threads: &dyn Threads) -> Outcome<Rows> {
        let checked = self.checked(frame)?;
        let inside = window.intersection(&checked.window);
        let inside = if inside.is_empty() { nearest(&window, &checked.window) } else { inside };
        let form =
            format!("{inside:?} {} {} {:?} {}", self.sample, self.channels, self.alpha, self.blue_first);
        // Rows beyond are those of the edge.
        let y0 = part.y0.clamp(inside.y0, inside.y1 - 1);
        let part = Rect { y0, y1: part.y1.clamp(y0 + 1, inside.y1), ..inside };
        let rows: Vec<Mutex<u128>> = (part.y0..part.y1).map(|_| Mutex::default()).collect();
        let look = |y: i32, bytes: &[u8]| *lock(&rows[(y - part.y0) as usize]) = content::of_bytes(bytes);
        // SAFETY: the host gave the image, so that its memory may be read, and is not written, until it is released.
        unsafe { checked.each_row(part, threads, &look) };
        Ok(Rows::new(&form, part.y0, rows.iter().map(|row| *lock(row)).collect()))
    }

    /// Two channels of the pixels of `window`, as `change` makes those that are stored; NaN for what the image does not
    /// hold.
    ///
    /// # Errors
    /// Memory; image format, for one without such channels or of a shape that no image can have.
    pub fn read_pairs(
        &self,
        frame: &Frame,
        window: Rect,
        channels: [usize; 2],
        threads: &dyn Threads,
        change: &(dyn Fn(&mut [f32]) + Sync),
    ) -> Outcome<Image> {
        let checked = self.checked(frame)?;
        if channels.iter().any(|c| *c >= self.channels as usize) {
            return Err(kOfxStatErrImageFormat);
        }
        let mut image = pool::image(window, 2).map_err(|_| kOfxStatErrMemory)?;
        let inside = window.intersection(&checked.window);
        if inside != window {
            image.data_mut().fill(f32::NAN);
        }
        if inside.is_empty() {
            return Ok(image);
        }
        let channels = if self.blue_first { channels.map(|c| [2, 1, 0, 3][c]) } else { channels };
        // SAFETY: as in `rows`.
        let read = unsafe { checked.read_pairs(inside, channels, &mut image, threads, change) };
        read.map_err(|_| kOfxStatErrImageFormat)?;
        Ok(image)
    }

    /// True where it holds what an input needs.
    pub fn suits(&self, input: GraphInput) -> bool {
        let is_float = matches!(self.sample, ISOPHOTE_SAMPLE_F16 | ISOPHOTE_SAMPLE_F32);
        match input.kind() {
            ImageKind::Normal => self.channels >= 3,
            ImageKind::Position => self.channels >= 3 && is_float,
            // Strengths are in alpha.
            ImageKind::Control | ImageKind::Flow => self.channels == 4,
            // Ids are all bits of a float.
            ImageKind::Cryptomatte => self.channels == 4 && self.sample == ISOPHOTE_SAMPLE_F32,
            // Of three channels, the fourth tone is none.
            ImageKind::Hatching => self.channels >= 3,
            ImageKind::Color
            | ImageKind::Depth
            | ImageKind::ObjectId
            | ImageKind::Scalar
            | ImageKind::Tensor
            | ImageKind::Motion => true,
        }
    }

    /// True where an image can have its shape.
    pub fn is_sound(&self, frame: &Frame) -> bool {
        self.checked(frame).is_ok()
    }

    /// Amounts of a mask, each from a pixel of colour and alpha. 0 outside.
    ///
    /// # Errors
    /// As [`Fetched::read`].
    pub fn read_amounts(
        &self,
        frame: &Frame,
        window: Rect,
        amount: impl Fn([f32; 4]) -> f32,
    ) -> Outcome<Vec<f32>> {
        if self.channels == 1 {
            return Ok(self
                .read(frame, window, GraphInput::Depth, Beyond::Zero, &CallingThread)?
                .into_data());
        }
        let image = self.read(frame, window, GraphInput::Color, Beyond::Zero, &CallingThread)?;
        let mut amounts = Vec::new();
        amounts.try_reserve_exact(image.data().len() / 4).map_err(|_| kOfxStatErrMemory)?;
        amounts.extend(image.data().chunks_exact(4).map(|p| amount([p[0], p[1], p[2], p[3]])));
        Ok(amounts)
    }

    /// Writes the pixels of `image` that this one holds, each row after `last` has changed it; its colours may be in another
    /// order afterwards.
    ///
    /// # Errors
    /// Memory; image format, when no image can have its shape.
    pub fn write(
        &self,
        frame: &Frame,
        image: &mut Image,
        threads: &dyn Threads,
        last: &(dyn Fn(i32, &mut [f32]) + Sync),
    ) -> Outcome<()> {
        let checked = self.checked(frame)?;
        let inside = image.window().intersection(&checked.window);
        if inside.is_empty() {
            return Ok(());
        }
        let swaps = self.blue_first && image.channels() == 4;
        let last = |y: i32, row: &mut [f32]| {
            last(y, row);
            if swaps {
                row.chunks_exact_mut(4).for_each(|p| p.swap(0, 2));
            }
        };
        let window = image.window();
        let written = if inside == window {
            // SAFETY: the host gave the image to be written, until it is released.
            unsafe { checked.write(image, threads, &last) }
        } else {
            (window.y0..window.y1).for_each(|y| last(y, image.row_mut(y)));
            let mut part = pool::part(image, inside, threads).map_err(|_| kOfxStatErrMemory)?;
            // SAFETY: as above.
            unsafe { checked.write(&mut part, threads, AS_COMPUTED) }
        };
        written.map_err(|_| kOfxStatErrMemory)
    }
}

/// Values outside the pixels that an image holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// The nearest that it holds.
    Edge,
    /// Nothing.
    Zero,
    /// What it holds, again and again.
    Tiled,
}

impl Beyond {
    /// Values outside what a clip holds of a guide.
    pub fn of_guide(guide: GraphInput) -> Self {
        match guide {
            // Beside what they hold there is no object, and nothing is painted.
            GraphInput::RestPosition | GraphInput::Flow | GraphInput::LinePaint | GraphInput::Cryptomatte => {
                Self::Zero
            }
            GraphInput::Paper | GraphInput::Hatching => Self::Tiled,
            _ => Self::Edge,
        }
    }
}

/// The pixels of a window that is laid with an image.
fn repeated(tile: &Image, window: Rect) -> Outcome<Image> {
    let mut image = pool::image(window, tile.channels()).map_err(|_| kOfxStatErrMemory)?;
    let (own, c) = (tile.window(), tile.channels() as usize);
    for y in window.y0..window.y1 {
        let from = tile.row(own.y0 + (y - own.y0).rem_euclid(own.y1 - own.y0));
        for (x, pixel) in (window.x0..window.x1).zip(image.row_mut(y).chunks_exact_mut(c)) {
            let at = (x - own.x0).rem_euclid(own.x1 - own.x0) as usize * c;
            pixel.copy_from_slice(&from[at..at + c]);
        }
    }
    Ok(image)
}

/// The one pixel of `bounds` nearest to a window beside it.
fn nearest(window: &Rect, bounds: &Rect) -> Rect {
    let x = window.x0.clamp(bounds.x0, bounds.x1 - 1);
    let y = window.y0.clamp(bounds.y0, bounds.y1 - 1);
    Rect { x0: x, y0: y, x1: x + 1, y1: y + 1 }
}
