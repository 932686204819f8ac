//! An effect: a graph made ready for one size on a host's device, updated, recorded and submitted.

use super::context::Context;
use super::images::Given;
use super::objects::Commands;
use super::passes::{Passes, Port};
use super::record::Recorder;
use crate::abi::failure::{Failure, Outcome};
use ash::vk;
use isophote::engine::Rect;
use isophote::planned::Change;
use isophote::{Graph, Lowered, Request};
use isophote_abi::*;
use std::sync::Arc;

/// A graph with all that it needs on the device.
pub struct Effect {
    context: Arc<Context>,
    lowered: Lowered,
    passes: Passes,
    /// For submissions of the library's own; made at the first.
    commands: Option<Commands>,
}

impl Effect {
    /// The effect of a graph.
    ///
    /// # Errors
    /// As planning, shaders and memory.
    pub fn new(context: &Arc<Context>, graph: Graph, request: Request) -> Outcome<Self> {
        context.advance()?;
        let lowered = lowered(graph, request)?;
        let passes = Passes::new(context, lowered.program())?;
        Ok(Self { context: Arc::clone(context), lowered, passes, commands: None })
    }

    /// Takes over the parameters of a graph, and a request of any size.
    ///
    /// # Errors
    /// As [`Effect::new`]; the effect is then as it was.
    pub fn update(&mut self, graph: Graph, request: Option<Request>) -> Outcome<Change> {
        self.context.advance()?;
        let size = |r: &Request| [r.width, r.height];
        if let Some(request) = request.filter(|r| size(r) != size(self.lowered.request())) {
            let lowered = lowered(graph, request)?;
            self.put(Passes::new(&self.context, lowered.program())?);
            self.lowered = lowered;
            return Ok(Change::Structure);
        }
        let (last_graph, last_request) = (self.lowered.graph().clone(), *self.lowered.request());
        let change = self.lowered.update(graph, request)?;
        if change == Change::Uniforms {
            self.passes.repack(self.lowered.program());
            return Ok(change);
        }
        match Passes::new(&self.context, self.lowered.program()) {
            Ok(passes) => self.put(passes),
            Err(e) => {
                self.lowered = lowered(last_graph, last_request)?;
                return Err(e);
            }
        }
        Ok(change)
    }

    /// Records into a command buffer of the host's.
    ///
    /// # Errors
    /// Invalid argument for a value that is past; those of the images and of memory. Nothing is then recorded.
    pub fn record(&mut self, commands: vk::CommandBuffer, images: &[Given], value: u64) -> Outcome<()> {
        let reached = self.reached_before(value)?;
        let (ports, bindings) = self.bind(images, reached)?;
        self.record_into(commands, &ports, bindings);
        self.passes.recorded(bindings, value);
        Ok(())
    }

    /// Records into a command buffer of the library's and submits it.
    ///
    /// # Errors
    /// As [`Effect::record`], and what Vulkan answers. Nothing is then submitted.
    pub fn submit(
        &mut self,
        images: &[Given],
        waits: &[IsophoteVulkanSemaphore],
        signals: &[IsophoteVulkanSemaphore],
        value: u64,
    ) -> Outcome<()> {
        let context = Arc::clone(&self.context);
        context.device.must_have_queue()?;
        let reached = self.reached_before(value)?;
        let mut own = match self.commands.take() {
            Some(commands) => commands,
            None => Commands::new(&context.device)?,
        };
        // A command buffer that was begun is ended whatever happens, so that what can fail comes first.
        let submitted = self.bind(images, reached).and_then(|(ports, bindings)| {
            let buffer = own.begin(reached)?;
            self.record_into(buffer, &ports, bindings);
            own.end(buffer)?;
            context.device.submit(buffer, waits, signals, value)?;
            own.submitted(buffer, value);
            Ok(bindings)
        });
        self.commands = Some(own);
        self.passes.recorded(submitted?, value);
        Ok(())
    }

    /// Destroys what it holds, once commands that use it have been executed.
    pub fn retire(self) {
        let Self { context, passes, commands, .. } = self;
        context.retire(passes.last_value(), Box::new((passes, commands)));
    }

    /// Checks the images and binds them; says to which bindings.
    fn bind(&mut self, images: &[Given], reached: u64) -> Outcome<(Vec<Port>, usize)> {
        let ports = self.passes.ports(images)?;
        let bindings = self.passes.bind(&ports, reached)?;
        Ok((ports, bindings))
    }

    fn record_into(&self, commands: vk::CommandBuffer, ports: &[Port], bindings: usize) {
        Recorder { device: &self.context.device, commands }.record(&self.passes, ports, bindings);
    }

    /// Value that the timeline has reached, which is less than `value`.
    fn reached_before(&self, value: u64) -> Outcome<u64> {
        let reached = self.context.advance()?;
        if value > reached {
            return Ok(reached);
        }
        Err(Failure::argument(format!(
            "the timeline stands at {reached} already; the value must be above, not {value}"
        )))
    }

    /// Takes other passes.
    fn put(&mut self, passes: Passes) {
        let last = std::mem::replace(&mut self.passes, passes);
        self.context.retire(last.last_value(), Box::new(last));
    }
}

fn lowered(graph: Graph, request: Request) -> Outcome<Lowered> {
    // Refused before the region of an impossible size is made.
    isophote::engine::image::check_size(request.width, request.height)?;
    Ok(Lowered::new(graph, request, Rect::of_size(request.width, request.height))?)
}
