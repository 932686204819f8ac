//! A picture through a style: `stylize IN OUT [NODE]`.

use isophote::engine::cpu::{Control, CpuExecutor, Pool};
use isophote::engine::{Image, Rect};
use isophote::{Graph, Planned, Request};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (from, to, node) = match arguments.as_slice() {
        [from, to] => (from, to, "cartoon"),
        [from, to, node] => (from, to, node.as_str()),
        _ => return Err("say a picture, the file to write, and a node if it is not to be cartoon".into()),
    };
    let decoded = image::open(from)?.into_rgba32f();
    let (width, height) = decoded.dimensions();
    let picture = Image::from_vec(width, height, 4, decoded.into_raw())?;
    let result = stylize(&picture, node)?;
    let values = result.into_data().iter().map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8).collect();
    let written =
        image::RgbaImage::from_raw(width, height, values).ok_or("the node has no picture as its result")?;
    Ok(written.save(to)?)
}

/// The picture through a node, at sizes as they are meant for pictures of 1080 rows.
fn stylize(picture: &Image, node: &str) -> Result<Image, Box<dyn Error>> {
    let graph = Graph::single(node)?;
    // Colour of files is not multiplied by alpha.
    let request = Request {
        premultiplied: false,
        reference_height: 1080,
        ..Request::new(picture.width(), picture.height())
    };
    let planned = Planned::new(&graph, request)?;
    let all = Rect::of_size(picture.width(), picture.height());
    let (mut executor, threads) = (CpuExecutor::new(), Pool::new(0));
    let mut results =
        executor.run(planned.plan(), &[("color", picture)], all, &threads, Control::default())?;
    Ok(results.remove(0))
}
