//! Running graphs on sequences of frames.

use crate::run::pool;
use isophote::frames::Frames;
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote::sequence::Sequence;
use isophote::{Graph, Request};
use isophote_engine::cpu::{Control, CpuExecutor};
use isophote_engine::{Image, Rect};

/// Content of a frame of a sequence, by the input of a graph; `None` for frames and inputs that do not exist.
pub type FrameLookup<'s> = &'s dyn Fn(GraphInput, i64) -> Option<Image>;

/// A graph on the frames of a sequence, on the CPU.
#[derive(Debug)]
pub struct Player {
    graph: Graph,
    sequence: Sequence<Image>,
    executor: CpuExecutor,
    /// Frames before and after the one at hand that may be looked at.
    pub around: [u32; 2],
    /// Frames whose colour was read from the source.
    pub reads: usize,
}

impl Player {
    /// A player that keeps at most `most` bytes of stages.
    pub fn new(graph: Graph, most: u64) -> Self {
        Self {
            around: graph.frames(),
            graph,
            sequence: Sequence::new(most),
            executor: CpuExecutor::new(),
            reads: 0,
        }
    }

    /// The stylized frame of a number.
    ///
    /// # Panics
    /// When it cannot be planned or run.
    pub fn frame(&mut self, request: Request, number: i64, source: FrameLookup<'_>) -> Image {
        let exists = |n: i64| source(GraphInput::Color, number + n).is_some();
        let past = (1..=i64::from(self.around[0])).take_while(|n| exists(-n)).count() as u32;
        let future = (1..=i64::from(self.around[1])).take_while(|n| exists(*n)).count() as u32;
        let guides = Guides::of(|input| source(input, number).is_some());
        let request = Request { frame: number, frames: Frames::around(past, future), guides, ..request };
        let planned = self.sequence.plan(&self.graph, request, true).expect("the frame can be planned");
        let plan = planned.plan().clone();
        let region = Rect::of_size(request.width, request.height);
        let windows = plan.windows(region);
        let mut read: Vec<(&str, Image)> = Vec::new();
        for port in plan.inputs().iter().filter(|port| !windows[port.image.index()].is_empty()) {
            let Some(input) = GraphInput::from_id(port.base()) else { continue };
            let image = source(input, number + i64::from(port.frame)).expect("known frames have all images");
            self.reads += usize::from(input == GraphInput::Color);
            read.push((&port.name, image));
        }
        let mut inputs: Vec<(&str, &Image)> = read.iter().map(|(name, image)| (*name, image)).collect();
        inputs.extend(self.sequence.handed(&plan));
        let results = self.executor.run(&plan, &inputs, region, pool(), Control::default());
        let results = results.expect("the frame can be run");
        let (output, gone) = self.sequence.finish(results, |image| 4 * image.data().len() as u64);
        gone.into_iter().for_each(|image| self.executor.recycle(image));
        output.expect("the graph has an output")
    }
}
