//! Warm state that one call on a graph leaves for the next.

use super::failure::{Failure, Outcome};
use isophote::engine::cpu::CpuExecutor;
use isophote::engine::gpu::{Device, Executor};
use isophote::engine::{Image, Plan};
use isophote::{Graph, Planned, Request};
use isophote_abi::ISOPHOTE_ERROR_INTERNAL;
use std::sync::Arc;

/// The plan, and executors with their memory.
#[derive(Debug, Default)]
pub struct Warm {
    planned: Option<Planned>,
    cpu: Option<CpuExecutor>,
    /// On the last device.
    gpu: Option<Executor>,
}

impl Warm {
    /// Brings the plan up to date, or makes it anew for another request.
    ///
    /// # Errors
    /// The errors of planning; there is no plan then.
    pub fn plan_for(&mut self, graph: &Graph, request: &Request) -> Outcome<()> {
        self.planned = match self.planned.take().filter(|planned| planned.request() == request) {
            Some(mut planned) => {
                // A plan whose update failed is not used again.
                planned.update(graph)?;
                Some(planned)
            }
            None => Some(Planned::new(graph, *request)?),
        };
        Ok(())
    }

    /// The plan.
    ///
    /// # Errors
    /// Internal, when none was made.
    pub fn plan(&self) -> Outcome<&Plan> {
        self.planned.as_ref().map(Planned::plan).ok_or_else(no_plan)
    }

    /// The plan, the executor on the CPU and the one on a device.
    ///
    /// # Errors
    /// As [`Warm::plan`].
    pub fn parts(&mut self) -> Outcome<(&Plan, &mut Option<CpuExecutor>, &mut Option<Executor>)> {
        let plan = self.planned.as_ref().map(Planned::plan).ok_or_else(no_plan)?;
        Ok((plan, &mut self.cpu, &mut self.gpu))
    }

    /// Gives back the memory kept for the next run on the CPU.
    pub fn purge(&mut self) {
        if let Some(cpu) = &mut self.cpu {
            cpu.purge();
        }
    }

    /// Keeps the memory of a result for the next run on the CPU.
    pub fn recycle(&mut self, image: Image) {
        if let Some(cpu) = &mut self.cpu {
            cpu.recycle(image);
        }
    }

    /// Takes the executor on a device out, when there is one.
    pub fn take_executor(&mut self, device: &Arc<Device>) -> Option<Executor> {
        self.gpu.take_if(|executor| Arc::ptr_eq(executor.device(), device))
    }
}

fn no_plan() -> Failure {
    Failure::new(ISOPHOTE_ERROR_INTERNAL, "the graph has no plan")
}
