//! Context that effects on one device of a host's share: compiled shaders, and objects that wait to be destroyed.

use super::device::Device;
use super::objects::Kernel;
use crate::abi::failure::{Failure, Outcome};
use crate::abi::guard::lock;
use isophote::engine::program::Shader;
use isophote_abi::ISOPHOTE_ERROR_INVALID_HANDLE;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError, RwLock, RwLockReadGuard};

/// A device with all that was made on it, but for effects.
pub struct Context {
    /// The device.
    pub device: Arc<Device>,
    kernels: Mutex<HashMap<Arc<Shader>, Arc<Kernel>>>,
    /// Objects, each with the value of the timeline from which on nothing uses it.
    retired: Mutex<Vec<(u64, Box<dyn Send>)>>,
    /// False from when the host destroys the object; read while something is done on the device.
    alive: RwLock<bool>,
}

impl Context {
    /// Nothing but the device.
    pub fn new(device: Device) -> Self {
        Self {
            device: Arc::new(device),
            kernels: Mutex::default(),
            retired: Mutex::default(),
            alive: RwLock::new(true),
        }
    }

    /// Keeps the object from being destroyed as long as what is returned.
    ///
    /// # Errors
    /// Invalid handle when it was destroyed.
    pub fn enter(&self) -> Outcome<RwLockReadGuard<'_, bool>> {
        let alive = self.alive.read().unwrap_or_else(PoisonError::into_inner);
        if *alive {
            return Ok(alive);
        }
        let message = "the Vulkan object of the effect was destroyed; destroy the effect, too";
        Err(Failure::new(ISOPHOTE_ERROR_INVALID_HANDLE, message))
    }

    /// Destroys all that was made on the device, effects by `forget`, and lets nobody in any more.
    pub fn end(&self, forget: impl FnOnce()) {
        *self.alive.write().unwrap_or_else(PoisonError::into_inner) = false;
        forget();
        let retired = std::mem::take(&mut *lock(&self.retired));
        drop(retired);
        let kernels = std::mem::take(&mut *lock(&self.kernels));
        drop(kernels);
    }

    /// The pipeline of `shader`, compiled at the first request.
    ///
    /// # Errors
    /// As [`Kernel::new`].
    pub fn kernel(&self, shader: &Arc<Shader>) -> Outcome<Arc<Kernel>> {
        if let Some(known) = lock(&self.kernels).get(shader) {
            return Ok(Arc::clone(known));
        }
        // Not under the lock: drivers take their time, and two of the same are alike.
        let made = Arc::new(Kernel::new(&self.device, shader)?);
        Ok(Arc::clone(lock(&self.kernels).entry(Arc::clone(shader)).or_insert(made)))
    }

    /// Destroys `object` once the timeline has reached `value`.
    pub fn retire(&self, value: u64, object: Box<dyn Send>) {
        lock(&self.retired).push((value, object));
    }

    /// Destroys what nothing uses any more; says what the timeline has reached.
    ///
    /// # Errors
    /// Device, when it is lost.
    pub fn advance(&self) -> Outcome<u64> {
        let reached = self.device.reached()?;
        let mut gone = Vec::new();
        let mut retired = lock(&self.retired);
        let mut index = 0;
        while index < retired.len() {
            if retired[index].0 <= reached {
                gone.push(retired.swap_remove(index));
            } else {
                index += 1;
            }
        }
        drop(retired);
        drop(gone);
        Ok(reached)
    }
}
