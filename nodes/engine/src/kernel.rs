//! Kernel: one pass over an image, as a WGSL shader and as a CPU function.
//!
//! The engine knows no kernel. It runs whatever a plan names, on either executor, by this contract.

use crate::image::{Rect, View};
use crate::wgsl::{Import, Piece, Pieces};
use fearless_simd::Level;

/// Most images that one pass may read; the size of `Grid.inputs` in `shaders/gpu/grid.wgsl`.
pub const MAX_INPUTS: usize = 6;

/// Side of the square workgroups of every kernel.
pub const WORKGROUP: u32 = 8;

/// Most pixels that a window reads to each side where its rows and columns run in one dispatch, with what the pass before
/// it reads around: 16 x 16 pixels and so many around them take the 16 KiB of workgroup memory of the smallest devices.
pub const PAIR_REACH: u32 = 8;

/// Side of the square workgroups of dispatches of such windows.
pub const PAIR_WORKGROUP: u32 = 16;

/// Side of the square workgroups whose windows of neighbours hold 16-bit floats; `shaders/gpu/tap_half.wgsl` has it, too.
pub const PACKED_WORKGROUP: u32 = 16;

/// Binding of the sampler of shaders that interpolate by one.
pub const SAMPLER_BINDING: u32 = 15;

/// One kernel: the shader, its CPU twin and what both need to be run.
#[derive(Debug)]
pub struct Kernel {
    /// Stem of the WGSL file and of the Rust file.
    pub name: &'static str,
    /// Complete WGSL module, imports resolved, entry point `main`.
    pub shader: &'static str,
    /// Images read, at bindings 2, 3, ...
    pub inputs: usize,
    /// Channels of the images written, at the bindings after the inputs.
    pub outputs: &'static [u32],
    /// Size of the uniform block at binding 1, in bytes; 0 for none.
    pub params_size: usize,
    /// The shader in pieces, for dispatches of several kernels and textures of 16-bit floats.
    pub pieces: Pieces,
    /// Part that it can take in a dispatch of several.
    pub fusible: Fusible,
    /// The CPU twin: fills one band of the outputs.
    #[cfg(feature = "cpu")]
    pub cpu: fn(&CpuPass<'_>, &mut Band<'_>),
    /// Fused multiply-adds (or operations of like cost) per output pixel, for benchmarks.
    pub cost: fn(&[u8]) -> f64,
    /// Greatest difference of the two twins.
    pub tolerance: Tolerance,
    /// Greatest difference where the shader reads and writes 16-bit floats, and interpolates by samplers if it can.
    pub fast: Tolerance,
}

/// Part that a kernel can take in a dispatch of several.
#[derive(Clone, Copy, Debug)]
pub enum Fusible {
    /// None: it always has dispatches of its own.
    Never,
    /// The first: it stores its only result in one place, by [`STORE`](crate::wgsl::STORE), where kernels of single pixels
    /// can follow.
    First,
    /// The first, and before a window that sums what it computes, which is then not stored: a function
    /// `at_place(p: vec2i) -> vec4f` gives it at any pixel, and reads the only texture by [`LOAD`](crate::wgsl::LOAD).
    BeforeWindow {
        /// The beginning of [`Pieces::own`] up to what needs a workgroup: the function and all that it uses.
        anywhere: &'static [Piece],
    },
    /// The first, or the rows and the columns of a separable window together.
    Window(Pair),
    /// Any: each pixel of its only result depends on the same pixel of the inputs alone. It has no entry point of its own, but
    /// a function `of_pixel(id: vec3u, ...) -> vec4f` of the pixels of all textures read.
    SinglePixels {
        /// Inputs that it reads itself, at other pixels or at another level; `of_pixel` has no argument for them. It knows
        /// their numbers by constants, [`Piece::Slot`], which other kernels before it change.
        around: &'static [usize],
    },
}

/// Two passes of a kernel, the rows and the columns of a separable window, in one dispatch.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// Texts that `own` uses, as in [`Pieces::imports`].
    pub imports: &'static [&'static Import],
    /// The struct of the uniform blocks.
    pub block: &'static [Piece],
    /// WGSL with the entry point, of [`PAIR_WORKGROUP`]. It knows the two uniform blocks as [`Piece::Params`] and
    /// [`Piece::ColumnsParams`] and what rows sum as `pair_source(p: vec2i) -> vec4f`; `pair_hold` is called before it asks.
    pub own: &'static [Piece],
    /// Test of two uniform blocks: true for those of the rows and the columns of a window.
    pub fits: fn(&[u8], &[u8]) -> bool,
}

impl Fusible {
    /// True where kernels of single pixels can follow in the same dispatch.
    pub const fn can_lead(&self) -> bool {
        !matches!(self, Self::Never)
    }

    /// For a kernel of single pixels: the inputs that it reads itself.
    pub const fn around(&self) -> Option<&'static [usize]> {
        if let Self::SinglePixels { around } = self { Some(around) } else { None }
    }

    /// For a kernel that sums windows along one axis: its rows and columns in one dispatch.
    pub const fn pair(&self) -> Option<&Pair> {
        if let Self::Window(pair) = self { Some(pair) } else { None }
    }
}

impl PartialEq for &'static Kernel {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(*self, *other)
    }
}

/// The bound on the difference between a shader and its CPU twin:
/// |gpu - cpu| <= absolute + relative * m, for all but a share of `outliers`, where m is the largest
/// |gpu| or |cpu| of all channels of the pixel: one channel of a tensor or a CIELAB colour is a
/// difference of what makes up the others, and has their rounding.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// In the unit of the output.
    pub absolute: f32,
    /// As a share of the pixel's largest value.
    pub relative: f32,
    /// Share of the values that may break the bound (a floor, a comparison or a stream line that
    /// goes the other way on the last bit).
    pub outliers: f32,
    /// Why these numbers.
    pub reason: &'static str,
}

impl Tolerance {
    /// That of roundings alone, without outliers: a bound in the unit of the output, another as a share of the pixel's largest
    /// value, and why these numbers.
    pub const fn of_rounding(absolute: f32, relative: f32, reason: &'static str) -> Self {
        Self { absolute, relative, outliers: 0.0, reason }
    }

    /// That of results which are stored in 16-bit floats, and are computed as exactly as before.
    pub const fn rounded_to_half(self) -> Self {
        let (relative, absolute) = (self.relative + 1.0 / 2040.0, self.absolute + 1e-7);
        Self { relative, absolute, reason: "as exact, and rounded to eleven bits", ..self }
    }
}

/// Arguments of a CPU twin: the uniform block, the inputs and the instruction set to use.
#[derive(Debug)]
pub struct CpuPass<'a> {
    /// The uniform block's bytes, as the shader would see them.
    pub params: &'a [u8],
    /// The images read, each with the pixels that the pass's support promises.
    pub inputs: &'a [View<'a>],
    /// The widest instruction set that this machine has.
    pub level: Level,
}

impl CpuPass<'_> {
    /// The uniform block as the kernel's own type.
    ///
    /// # Panics
    /// When the plan was made with a block of another size, which the plan builder refuses.
    pub fn params<P: bytemuck::AnyBitPattern>(&self) -> P {
        bytemuck::pod_read_unaligned(self.params)
    }
}

/// A band of output rows that one CPU job fills.
#[derive(Debug)]
pub struct Band<'a> {
    /// Columns and rows to write, absolute.
    pub window: Rect,
    /// Size of the whole output picture.
    pub full: [i32; 2],
    /// The values of the band, one slice per output, rows adjacent.
    pub outputs: Vec<&'a mut [f32]>,
}

impl Band<'_> {
    /// Row `y` (absolute) of output `index`, from column `window.x0` to `window.x1`.
    #[inline]
    pub fn row_mut(&mut self, index: usize, y: i32) -> &mut [f32] {
        let rows = self.window.height() as usize;
        let stride = self.outputs[index].len() / rows;
        let start = (y - self.window.y0) as usize * stride;
        &mut self.outputs[index][start..start + stride]
    }
}
