//! Pictures as a host keeps them: rows upwards or downwards, padded, anywhere in the plane.

use super::properties::{Set, Value};
use isophote_abi::openfx::*;
use isophote_engine::pixels::Sample;
use std::ffi::CStr;

/// Layout of a picture in memory, and what it says of itself.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Kind of samples.
    pub depth: &'static CStr,
    /// Samples of a pixel.
    pub components: &'static CStr,
    /// Relation of colour to alpha; `None` for a host that does not say.
    pub alpha: Option<&'static CStr>,
    /// True where the top row comes first in memory.
    pub negative: bool,
    /// Bytes between rows.
    pub padding: usize,
    /// Left and bottom of the picture.
    pub origin: [i32; 2],
    /// Width over height of pixels.
    pub aspect: f64,
    /// Pixels per unit that its region of definition counts with.
    pub scale: f64,
    /// Pixels in x over those in y, beside what the aspect makes of them.
    pub squeeze: f64,
    /// Scale that the image names.
    pub claimed_scale: f64,
    /// Fields that it holds.
    pub field: &'static CStr,
    /// True where blue comes first.
    pub blue_first: bool,
    /// Bounds of its clip's region of definition, where it has none.
    pub endless: Option<f64>,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            depth: kOfxBitDepthFloat,
            components: kOfxImageComponentRGBA,
            alpha: Some(kOfxImagePreMultiplied),
            negative: false,
            padding: 0,
            origin: [0, 0],
            aspect: 1.0,
            scale: 1.0,
            squeeze: 1.0,
            claimed_scale: 1.0,
            field: kOfxImageFieldNone,
            blue_first: false,
            endless: None,
        }
    }
}

impl Layout {
    /// Kind of samples, as the engine names it.
    pub fn sample(&self) -> Sample {
        match self.depth {
            d if d == kOfxBitDepthByte => Sample::U8,
            d if d == kOfxBitDepthShort => Sample::U16,
            d if d == kOfxBitDepthHalf => Sample::F16,
            _ => Sample::F32,
        }
    }

    /// Samples of a pixel.
    pub fn channels(&self) -> usize {
        match self.components {
            c if c == kOfxImageComponentRGBA => 4,
            c if c == kOfxImageComponentRGB => 3,
            _ => 1,
        }
    }

    /// Bytes of a pixel.
    pub fn pixel(&self) -> usize {
        self.sample().size() * self.channels()
    }
}

/// Bytes around the rows that nobody may touch.
const GUARD: usize = 64;
const UNTOUCHED: u8 = 0xa5;

/// A picture in memory.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Layout of the pixels.
    pub layout: Layout,
    /// Bounds of the pixels, y up.
    pub bounds: [i32; 4],
    /// The whole picture of which it may be a part, y up.
    pub whole: [i32; 4],
    memory: Vec<u8>,
}

impl Picture {
    /// A picture nobody has written to.
    pub fn new(layout: Layout, width: i32, height: i32) -> Self {
        let [x, y] = layout.origin;
        let bounds = [x, y, x + width, y + height];
        Self::part(layout, bounds, bounds)
    }

    fn part(layout: Layout, bounds: [i32; 4], whole: [i32; 4]) -> Self {
        let mut picture = Self { layout, bounds, whole, memory: Vec::new() };
        let rows = (bounds[3] - bounds[1]) as usize;
        picture.memory = vec![UNTOUCHED; rows * picture.stride() + 2 * GUARD];
        picture
    }

    /// Writes packed pixels, as the layout has them, to the row `y` (up).
    pub fn fill_row(&mut self, y: i32, packed: &[u8]) {
        let at = self.row(y);
        self.memory[at..at + packed.len()].copy_from_slice(packed);
    }

    /// A picture of packed rows, the top one first.
    pub fn packed_in(layout: Layout, width: i32, height: i32, packed: &[u8]) -> Self {
        let mut picture = Self::new(layout, width, height);
        let bytes = width as usize * layout.pixel();
        assert_eq!(packed.len(), bytes * height as usize);
        for (row, from) in packed.chunks_exact(bytes).enumerate() {
            let at = picture.row(picture.bounds[3] - 1 - row as i32);
            picture.memory[at..at + bytes].copy_from_slice(from);
        }
        picture.swap();
        picture
    }

    /// Its rows without what lies between them, the top one first.
    pub fn packed(&self) -> Vec<u8> {
        let mut copy = self.clone();
        copy.swap();
        let bytes = self.width() as usize * self.layout.pixel();
        let rows = (self.bounds[1]..self.bounds[3]).rev();
        rows.flat_map(|y| copy.memory[copy.row(y)..copy.row(y) + bytes].to_vec()).collect()
    }

    fn swap(&mut self) {
        if !self.layout.blue_first {
            return;
        }
        let (size, pixel) = (self.layout.sample().size(), self.layout.pixel());
        for y in self.bounds[1]..self.bounds[3] {
            let at = self.row(y);
            for p in self.memory[at..at + pixel * (self.bounds[2] - self.bounds[0]) as usize]
                .chunks_exact_mut(pixel)
            {
                let (first, rest) = p.split_at_mut(2 * size);
                first[..size].swap_with_slice(&mut rest[..size]);
            }
        }
    }

    /// The part under other bounds.
    pub fn crop(&self, bounds: [i32; 4]) -> Self {
        let mut part = Self::part(self.layout, bounds, self.whole);
        let pixel = self.layout.pixel();
        let bytes = (bounds[2] - bounds[0]) as usize * pixel;
        for y in bounds[1]..bounds[3] {
            let from = self.row(y) + (bounds[0] - self.bounds[0]) as usize * pixel;
            let to = part.row(y);
            part.memory[to..to + bytes].copy_from_slice(&self.memory[from..from + bytes]);
        }
        part
    }

    /// Columns.
    pub fn width(&self) -> i32 {
        self.bounds[2] - self.bounds[0]
    }

    /// Rows.
    pub fn height(&self) -> i32 {
        self.bounds[3] - self.bounds[1]
    }

    fn stride(&self) -> usize {
        self.width() as usize * self.layout.pixel() + self.layout.padding
    }

    /// Offset at which row `y` begins.
    fn row(&self, y: i32) -> usize {
        let up = (y - self.bounds[1]) as usize;
        let row = if self.layout.negative { self.height() as usize - 1 - up } else { up };
        GUARD + row * self.stride()
    }

    /// Bytes that were touched outside `window` (y up).
    pub fn touched_outside(&self, window: [i32; 4]) -> usize {
        let pixel = self.layout.pixel();
        let mut allowed = vec![false; self.memory.len()];
        for y in window[1].max(self.bounds[1])..window[3].min(self.bounds[3]) {
            let (x0, x1) = (window[0].max(self.bounds[0]), window[2].min(self.bounds[2]));
            let at = self.row(y);
            let (from, to) = ((x0 - self.bounds[0]) as usize, (x1 - self.bounds[0]).max(0) as usize);
            allowed[at + from * pixel..at + to * pixel].fill(true);
        }
        self.memory.iter().zip(allowed).filter(|(byte, allowed)| !allowed && **byte != UNTOUCHED).count()
    }

    /// The whole picture's region of definition, canonical.
    pub fn defined(&self) -> OfxRectD {
        if let Some(far) = self.layout.endless {
            return OfxRectD { x1: -far, y1: -far, x2: far, y2: far };
        }
        let y = 1.0 / self.layout.scale;
        let x = y * self.layout.aspect / self.layout.squeeze;
        let [x1, y1, x2, y2] = self.whole.map(f64::from);
        OfxRectD { x1: x1 * x, y1: y1 * y, x2: x2 * x, y2: y2 * y }
    }

    /// Fills in what an image says of itself.
    pub(super) fn describe(&mut self, set: &Set) {
        let layout = self.layout;
        let first = self.row(self.bounds[1]);
        set.put(kOfxImagePropData, vec![Value::Pointer(self.memory.as_mut_ptr() as usize + first)]);
        set.put(kOfxImagePropBounds, self.bounds.map(Value::from).to_vec());
        set.put(kOfxImagePropRegionOfDefinition, self.whole.map(Value::from).to_vec());
        let stride = self.stride() as i32;
        set.put(kOfxImagePropRowBytes, vec![if layout.negative { -stride } else { stride }.into()]);
        set.put(kOfxImagePropPixelAspectRatio, vec![layout.aspect.into()]);
        set.put(kOfxImageEffectPropRenderScale, vec![layout.claimed_scale.into(); 2]);
        set.put(kOfxImagePropField, vec![layout.field.into()]);
        set.put(kOfxImageEffectPropPixelDepth, vec![layout.depth.into()]);
        set.put(kOfxImageEffectPropComponents, vec![layout.components.into()]);
        if let Some(alpha) = layout.alpha {
            set.put(kOfxImageEffectPropPreMultiplication, vec![alpha.into()]);
        }
        if layout.blue_first {
            set.put(PIXEL_ORDER, vec![PIXEL_ORDER_BGRA.into()]);
        }
    }
}
