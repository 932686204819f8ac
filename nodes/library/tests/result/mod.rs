//! Result of one node on the CPU executor, in programs that test what nodes make of guides.

use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::{Image, Rect};
use isophote::request::Guides;
use isophote::{ColourSpace, Graph, Planned, Request};

/// Images by the names of inputs, all of one size.
pub type Inputs<'a> = &'a [(&'static str, &'a Image)];

/// The result of a node with these settings; inputs that it does not read are left out.
pub fn of(node: &str, settings: &[(&str, &str)], space: ColourSpace, inputs: Inputs<'_>) -> Image {
    let mut graph = Graph::single(node).unwrap();
    let id = graph.node(0).unwrap();
    for (param, value) in settings {
        graph.set_text(id, param, value).unwrap();
    }
    let has = |name: &str| inputs.iter().any(|(n, _)| *n == name);
    let (width, height) = (inputs[0].1.width(), inputs[0].1.height());
    let guides = Guides::of(|input| has(input.id()));
    let request = Request { space, guides, ..Request::new(width, height) };
    let planned = Planned::new(&graph, request).unwrap();
    let whole = Rect::of_size(width, height);
    let read = planned.plan().windows(whole);
    let is_read = |name: &str| {
        planned.plan().inputs().iter().any(|port| port.name == name && !read[port.image.index()].is_empty())
    };
    let parts: Vec<(&str, &Image)> = inputs.iter().filter(|(name, _)| is_read(name)).copied().collect();
    CpuExecutor::new()
        .run(planned.plan(), &parts, whole, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}
