//! The objects that hosts hold handles of, but for plans: graphs and devices.

use super::failure::Outcome;
use super::guard::lock;
use super::handles::{Object, object};
use super::warm::Warm;
use isophote::engine::gpu::Device;
use isophote::engine::plan::WORKING_MEMORY;
use isophote::{Graph, Request};
use isophote_abi::{IsophoteDevice, IsophoteGraph};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

/// A graph of a host's.
#[derive(Debug)]
pub struct GraphObject {
    graph: Mutex<Graph>,
    message: Mutex<String>,
    /// Most bytes that images may take on the CPU; 0 where the host has said none.
    memory: AtomicU64,
    /// Warm state that the last call of `process` left for the next; taken out while one runs.
    warm: Mutex<Option<Warm>>,
}

object!(GraphObject, IsophoteGraph, 1, "graph");

impl GraphObject {
    /// An object that holds `graph`.
    pub fn new(graph: Graph) -> Self {
        Self {
            graph: Mutex::new(graph),
            message: Mutex::default(),
            memory: AtomicU64::new(0),
            warm: Mutex::default(),
        }
    }

    /// The graph itself, locked.
    pub fn lock(&self) -> MutexGuard<'_, Graph> {
        lock(&self.graph)
    }

    /// Most bytes that images of a call may take on the CPU.
    pub fn memory(&self) -> u64 {
        match self.memory.load(Ordering::Relaxed) {
            // Rows take longer than whole images, which are left as long as they fit into most machines.
            0 => WORKING_MEMORY[1],
            bytes => bytes,
        }
    }

    /// Bounds what images of a call may take on the CPU, or by 0 lets the library choose.
    pub fn set_memory(&self, bytes: u64) {
        self.memory.store(bytes, Ordering::Relaxed);
    }

    /// The graph as it is now, so that no lock is held while it is used.
    pub fn snapshot(&self) -> Graph {
        self.lock().clone()
    }

    /// Warm state that an earlier call left, for `request` of the graph as it is now. Give it back with
    /// [`GraphObject::keep`].
    ///
    /// # Errors
    /// The errors of planning.
    pub fn warm(&self, request: &Request) -> Outcome<Warm> {
        let mut warm = lock(&self.warm).take().unwrap_or_default();
        warm.plan_for(&self.snapshot(), request)?;
        Ok(warm)
    }

    /// Keeps what a call leaves for the next.
    pub fn keep(&self, warm: Warm) {
        *lock(&self.warm) = Some(warm);
    }
}

/// A device of a host's.
#[derive(Debug)]
pub struct DeviceObject {
    /// The engine's device.
    pub device: Arc<Device>,
    message: Mutex<String>,
}

object!(DeviceObject, IsophoteDevice, 3, "device");

impl DeviceObject {
    /// An object that holds `device`.
    pub fn new(device: Arc<Device>) -> Self {
        Self { device, message: Mutex::default() }
    }
}

/// Gives back the memory that graphs keep for their next call.
pub fn forget_memory() {
    for graph in GraphObject::slots().all() {
        let warm = lock(&graph.warm).take();
        drop(warm);
    }
}

/// Gives back what graphs keep on a device that is about to be destroyed.
pub fn forget_device(device: &DeviceObject) {
    for graph in GraphObject::slots().all() {
        let executor = lock(&graph.warm).as_mut().and_then(|warm| warm.take_executor(&device.device));
        drop(executor);
    }
}
