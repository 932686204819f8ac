//! Result of one node on the CPU executor, in programs that test what nodes make of guides.

use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::{Image, Rect};
use isophote::request::Guides;
use isophote::{ColourSpace, Graph, Planned, Request};

/// Images by the names of inputs, all of one size.
pub type Inputs<'a> = &'a [(&'static str, &'a Image)];

/// A picture of RGBA from the places of its pixels.
pub fn picture([width, height]: [i32; 2], value: impl Fn(i32, i32) -> [f32; 4]) -> Image {
    let mut image = Image::new(width as u32, height as u32, 4).unwrap();
    for (at, pixel) in (0..).zip(image.data_mut().chunks_exact_mut(4)) {
        pixel.copy_from_slice(&value(at % width, at / width));
    }
    image
}

/// The result of a node with these settings, in full size; inputs that it does not read are left out.
pub fn of(node: &str, settings: &[(&str, &str)], space: ColourSpace, inputs: Inputs<'_>) -> Image {
    let (width, height) = (inputs[0].1.width(), inputs[0].1.height());
    at(node, settings, Request { space, ..Request::new(width, height) }, inputs)
}

/// The same for a request, whose guides are those that there are.
pub fn at(node: &str, settings: &[(&str, &str)], request: Request, inputs: Inputs<'_>) -> Image {
    part(node, settings, request, inputs, Rect::of_size(request.width, request.height))
}

/// A region of it, computed alone.
pub fn part(
    node: &str,
    settings: &[(&str, &str)],
    request: Request,
    inputs: Inputs<'_>,
    region: Rect,
) -> Image {
    let mut graph = Graph::single(node).unwrap();
    let id = graph.node(0).unwrap();
    for (param, value) in settings {
        graph.set_text(id, param, value).unwrap();
    }
    let has = |name: &str| inputs.iter().any(|(n, _)| *n == name);
    let request = Request { guides: Guides::of(|input| has(input.id())), ..request };
    let planned = Planned::new(&graph, request).unwrap();
    let windows = planned.plan().windows(region);
    let read = planned.plan().inputs().iter().filter(|port| !windows[port.image.index()].is_empty());
    let parts: Vec<(&str, Image)> = read
        .filter_map(|port| {
            let (name, image) = inputs.iter().find(|(name, _)| *name == port.name)?;
            Some((*name, image.crop(windows[port.image.index()]).unwrap()))
        })
        .collect();
    let parts: Vec<(&str, &Image)> = parts.iter().map(|(name, image)| (*name, image)).collect();
    CpuExecutor::new()
        .run(planned.plan(), &parts, region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}
