//! Running graphs and plans on the CPU.

use isophote::{Graph, Planned, Request};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor, Pool, Rows, Threads};
use isophote_engine::{Error, Image, Plan, Rect, Result};
use std::ops::Range;
use std::sync::OnceLock;

/// One pool for all tests of a binary.
pub fn pool() -> &'static Pool {
    static POOL: OnceLock<Pool> = OnceLock::new();
    POOL.get_or_init(|| Pool::new(0))
}

/// Plans a graph.
///
/// # Panics
/// When it cannot be planned.
pub fn planned(graph: &Graph, request: Request) -> Planned {
    match Planned::new(graph, request) {
        Ok(planned) => planned,
        Err(e) => panic!("cannot plan: {e}"),
    }
}

/// A region of the first output of a plan, its inputs cut to exactly what the plan says it reads.
///
/// # Panics
/// When the executor refuses.
pub fn region<S: AsRef<str>>(
    executor: &mut CpuExecutor,
    plan: &Plan,
    inputs: &[(S, Image)],
    region: Rect,
    threads: &dyn Threads,
) -> Image {
    let windows = plan.windows(region);
    let mut parts: Vec<(&str, Image)> = Vec::new();
    for port in plan.inputs() {
        let window = windows[port.image.index()];
        if let Some((name, image)) = inputs.iter().find(|(name, _)| name.as_ref() == port.name)
            && !window.is_empty()
        {
            parts.push((
                name.as_ref(),
                image.crop(window).expect("the picture holds every window of its plan"),
            ));
        }
    }
    let borrowed: Vec<(&str, &Image)> = parts.iter().map(|(name, image)| (*name, image)).collect();
    match executor.run(plan, &borrowed, region, threads, Control::default()) {
        Ok(mut images) => images.swap_remove(0),
        Err(e) => panic!("cannot run: {e}"),
    }
}

/// Images that a run reads by rows, and its first output, put together of rows.
struct ByRows<'a, S> {
    inputs: &'a [(S, Image)],
    result: Image,
}

impl<S: AsRef<str>> Rows for ByRows<'_, S> {
    fn read(&mut self, name: &str, rows: Range<i32>, image: &mut Image) -> Result<()> {
        let Some((_, input)) = self.inputs.iter().find(|(known, _)| known.as_ref() == name) else {
            return Err(Error::Input(format!("{name} is missing")));
        };
        let window = image.window();
        for y in rows {
            let row = input.crop(Rect { y0: y, y1: y + 1, ..window })?;
            image.row_mut(y).copy_from_slice(row.data());
        }
        Ok(())
    }

    fn write(&mut self, output: usize, part: Rect, image: &Image) -> Result<()> {
        let part = image.crop(part)?;
        for y in (part.window().y0..part.window().y1).filter(|_| output == 0) {
            self.result.row_mut(y).copy_from_slice(part.row(y));
        }
        Ok(())
    }
}

/// A region of the first output of a plan, as [`region()`], from and to images by rows that take at most `most` bytes.
///
/// # Panics
/// When the executor refuses.
pub fn by_rows<S: AsRef<str>>(
    executor: &mut CpuExecutor,
    plan: &Plan,
    inputs: &[(S, Image)],
    (region, most): (Rect, u64),
    threads: &dyn Threads,
) -> Image {
    let output = plan.desc(plan.outputs()[0].image);
    let result = Image::with_window(plan.region_at(region, output.level), output.channels);
    let mut rows = ByRows { inputs, result: result.expect("a small image") };
    match executor.run_rows(plan, &mut rows, (region, most), threads, Control::default()) {
        Ok(()) => rows.result,
        Err(e) => panic!("cannot run: {e}"),
    }
}

/// The whole first output of a plan.
///
/// # Panics
/// When the executor refuses.
pub fn whole<S: AsRef<str>>(plan: &Plan, inputs: &[(S, Image)]) -> Image {
    let [width, height] = plan.size();
    region(&mut CpuExecutor::new(), plan, inputs, Rect::of_size(width, height), pool())
}

/// A graph on one colour picture, whole.
///
/// # Panics
/// When it cannot be planned or run.
pub fn graph(graph: &Graph, request: Request, color: &Image) -> Image {
    whole(planned(graph, request).plan(), &[("color", color.clone())])
}

/// A graph of one node on one colour picture in sRGB, with parameters as a person writes them.
///
/// # Panics
/// For unknown names and values, and as [`graph()`].
pub fn node(id: &str, params: &[(&str, &str)], color: &Image) -> Image {
    let single = single(id, params);
    graph(&single, Request::new(color.width(), color.height()), color)
}

/// A graph of one node with parameters as a person writes them.
///
/// # Panics
/// For unknown names and values.
pub fn single(id: &str, params: &[(&str, &str)]) -> Graph {
    let build = || -> isophote::Result<Graph> {
        let mut graph = Graph::single(id)?;
        let node = graph.node(0)?;
        for (param, value) in params {
            graph.set_text(node, param, value)?;
        }
        Ok(graph)
    };
    match build() {
        Ok(graph) => graph,
        Err(e) => panic!("{e}"),
    }
}

/// The calling thread as [`Threads`].
pub static CALLING: CallingThread = CallingThread;
