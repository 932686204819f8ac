//! Makes programs ready for a device and keeps the memory between them.

use super::device::Device;
use super::prepared::Prepared;
use super::staging::Upload;
use super::texture::Pool;
use crate::error::{Error, Result};
use crate::program::{Precision, Program};
use std::sync::Arc;

/// Runs programs on a device. Each user has one of its own; they share the device and its pipelines.
#[derive(Debug)]
pub struct Executor {
    pub(super) device: Arc<Device>,
    pool: Arc<Pool>,
    /// Programs with textures of their own, kept between runs.
    pub(super) warm: Vec<Prepared>,
    /// Buffers to read results back, while no results are on their way in them.
    pub(super) readbacks: Vec<wgpu::Buffer>,
    /// Buffers to upload images, while no images are on their way in them.
    pub(super) uploads: Vec<Upload>,
    /// Bytes of the largest upload of the run.
    pub(super) largest: u64,
    pub(super) max_side: u32,
    pub(super) budget: u64,
    pub(super) work: f64,
    pub(super) precision: Precision,
}

impl Executor {
    /// Texture memory that a run may take before it is cut into tiles, unless set otherwise: what
    /// the smaller graphics cards of today can spare.
    pub const DEFAULT_BUDGET: u64 = 2 << 30;

    /// Operations of a dispatch and of a submission at most, unless set otherwise: half a second on the slowest graphics
    /// devices. Systems reset a device that does not answer for two.
    pub const DEFAULT_WORK: f64 = 5e10;

    /// An executor on `device`.
    pub fn new(device: Arc<Device>) -> Self {
        let max_side = device.max_side();
        // Nothing waits for a driver that computes on the CPU but who called it.
        let work = if device.is_software() { f64::INFINITY } else { Self::DEFAULT_WORK };
        Self {
            device,
            pool: Arc::default(),
            warm: Vec::new(),
            readbacks: Vec::new(),
            uploads: Vec::new(),
            largest: 0,
            max_side,
            budget: Self::DEFAULT_BUDGET,
            work,
            precision: Precision::default(),
        }
    }

    /// The device.
    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Sets what [`Executor::run_images`] may use at once: the largest side of a texture in texels
    /// (never more than the device has) and the bytes of all textures and transfers together.
    pub fn set_limits(&mut self, max_side: u32, budget: u64) {
        self.max_side = max_side.clamp(1, self.device.max_side());
        self.budget = budget;
    }

    /// Sets how much [`Executor::run_images`] gives the device to do at once: operations (fused multiply-adds, or others of
    /// like cost) of a dispatch, above which a picture is cut into tiles as long as that does not double the work, and of a
    /// submission.
    pub fn set_work(&mut self, operations: f64) {
        self.work = operations;
    }

    /// Sets how precisely [`Executor::run_images`] computes; exactly, unless set otherwise.
    pub fn set_precision(&mut self, precision: Precision) {
        self.precision = precision;
    }

    /// Compiles what `program` needs and allocates its scratch textures and uniforms. Inputs and
    /// outputs are then bound ([`Prepared::bind`]) or owned ([`Prepared::own_output`]).
    ///
    /// # Errors
    /// [`Error::Device`] for a shader that the device refuses, [`Error::Memory`] when its memory does
    /// not suffice.
    pub fn prepare(&self, program: &Program) -> Result<Prepared> {
        match Prepared::new(&self.device, &self.pool, program) {
            // What lies in the pool may be what is missing.
            Err(Error::Memory(_)) if !self.pool.is_empty() => {
                self.pool.clear();
                Prepared::new(&self.device, &self.pool, program)
            }
            result => result,
        }
    }

    /// Gives back all memory kept for later runs; pipelines stay with the device.
    pub fn purge(&mut self) {
        self.warm.clear();
        self.readbacks.clear();
        self.pool.clear();
        self.uploads.clear();
    }
}
