//! Makes programs ready for a device and keeps the memory between them.

use super::device::Device;
use super::pipeline::texture_format;
use super::prepared::{Prepared, create_texture, texture_bytes};
use super::tiles::Warm;
use crate::error::{Error, Result};
use crate::program::Program;
use std::sync::{Arc, Mutex, PoisonError};

/// Runs programs on a device. Each user has one of its own; they share the device and its pipelines.
#[derive(Debug)]
pub struct Executor {
    pub(super) device: Arc<Device>,
    pool: Arc<Pool>,
    pub(super) warm: Vec<Warm>,
    pub(super) padded: Vec<f32>,
    pub(super) max_side: u32,
    pub(super) budget: u64,
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
            padded: Vec::new(),
            max_side,
            budget: Self::DEFAULT_BUDGET,
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
        self.padded = Vec::new();
    }
}

/// Scratch textures of dropped programs, for the next ones.
#[derive(Debug, Default)]
pub(super) struct Pool(Mutex<Vec<wgpu::TextureView>>);

impl Pool {
    /// Bytes kept at most; the oldest textures go first.
    const KEPT: u64 = 512 << 20;

    /// A texture of at least `size` that wastes at most half of itself, or a new one of `size`.
    pub fn take(&self, device: &Device, size: [u32; 2], channels: u32) -> Result<wgpu::TextureView> {
        let wanted = u64::from(size[0]) * u64::from(size[1]);
        let area = |t: &wgpu::Texture| u64::from(t.width()) * u64::from(t.height());
        let mut kept = self.lock();
        let best = kept
            .iter()
            .enumerate()
            .filter(|(_, view)| {
                let t = view.texture();
                t.format() == texture_format(channels)
                    && t.width() >= size[0]
                    && t.height() >= size[1]
                    && area(t) <= 2 * wanted
            })
            .min_by_key(|(_, view)| area(view.texture()))
            .map(|(index, _)| index);
        if let Some(index) = best {
            return Ok(kept.remove(index));
        }
        drop(kept);
        create_texture(device, size, channels)
    }

    pub fn put(&self, view: wgpu::TextureView) {
        let mut kept = self.lock();
        kept.push(view);
        let mut bytes: u64 = kept.iter().map(|v| texture_bytes(v.texture())).sum();
        let mut surplus = 0;
        while bytes > Self::KEPT && surplus < kept.len() {
            bytes -= texture_bytes(kept[surplus].texture());
            surplus += 1;
        }
        kept.drain(..surplus);
    }

    fn is_empty(&self) -> bool {
        self.lock().is_empty()
    }

    fn clear(&self) {
        self.lock().clear();
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<wgpu::TextureView>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
