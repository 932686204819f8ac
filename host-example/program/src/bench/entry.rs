//! Measurements of one node.

use super::transfers::Transfers;

/// One node on one backend.
#[derive(Debug)]
pub struct Entry {
    /// Id of the node.
    pub node: String,
    /// `cpu` or `gpu`.
    pub backend: &'static str,
    /// Size of the picture in pixels.
    pub size: (u32, u32),
    /// All passes together.
    pub seconds: f64,
    /// The whole call with the conversion of pixels in and out, where there is any.
    pub call_seconds: Option<f64>,
    /// The picture's way to the device and the result's way back, on the GPU.
    pub transfers: Option<Transfers>,
    /// Bytes that all passes together read from and write to textures, on the GPU.
    pub bytes: Option<u64>,
    /// Most bytes of memory that the first run takes beside the picture, on the CPU, where the system tells: the result and all that
    /// is made on the way.
    pub memory: Option<u64>,
    /// The passes; empty where they are not timed apart.
    pub passes: Vec<PassEntry>,
}

/// One pass.
#[derive(Debug)]
pub struct PassEntry {
    /// The kernel.
    pub kernel: String,
    /// Time of the run.
    pub seconds: f64,
    /// Pixels written.
    pub pixels: u64,
    /// Bytes that it reads from and writes to textures, on the GPU.
    pub bytes: Option<u64>,
    /// Multiply-adds and bytes, on the CPU.
    pub work: Option<(f64, f64)>,
}

impl Entry {
    /// Millions of pixels.
    pub fn megapixels(&self) -> f64 {
        f64::from(self.size.0) * f64::from(self.size.1) / 1e6
    }

    /// Multiply-adds and bytes of all passes together, on the CPU.
    pub fn work(&self) -> Option<(f64, f64)> {
        self.passes
            .iter()
            .map(|p| p.work)
            .try_fold((0.0, 0.0), |sum, work| work.map(|w| (sum.0 + w.0, sum.1 + w.1)))
            .filter(|_| !self.passes.is_empty())
    }
}
