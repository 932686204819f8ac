//! Makes programs ready for a device and keeps the memory between them.

use super::device::Device;
use super::prepared::Prepared;
use super::texture::Pool;
use crate::error::{Error, Result};
use crate::program::{Precision, Program};
use std::sync::Arc;

/// Runs programs on a device. Each user has one of its own; they share the device and its pipelines.
#[derive(Debug)]
pub struct Executor {
    pub(super) device: Arc<Device>,
    pool: Arc<Pool>,
    pub(super) warm: Vec<Warm>,
    /// Pixels on their way to a texture.
    pub(super) staged: Vec<u8>,
    pub(super) max_side: u32,
    pub(super) budget: u64,
    pub(super) precision: Precision,
}

impl Executor {
    /// Texture memory that a run may take before it is cut into tiles, unless set otherwise: what
    /// the smaller graphics cards of today can spare.
    pub const DEFAULT_BUDGET: u64 = 2 << 30;

    /// An executor on `device`.
    pub fn new(device: Arc<Device>) -> Self {
        let max_side = device.max_side();
        Self {
            device,
            pool: Arc::default(),
            warm: Vec::new(),
            staged: Vec::new(),
            max_side,
            budget: Self::DEFAULT_BUDGET,
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
        self.pool.clear();
        self.staged = Vec::new();
    }
}

/// A prepared program with textures of its own and the way back to the CPU, kept between runs.
#[derive(Debug)]
pub(super) struct Warm {
    pub(super) prepared: Prepared,
    pub(super) readback: wgpu::Buffer,
}

impl Warm {
    pub(super) fn bytes(&self) -> u64 {
        self.prepared.bytes() + self.readback.size()
    }
}
