//! The classes of the extension module. `isophote/_native.pyi` describes them to type checkers.

use crate::array::{Pixels, Use};
use crate::colour;
use crate::exception::{invalid, raised, usage};
use crate::opened::library;
use crate::owned::Owned;
use crate::watch::Watch;
use isophote_colour::Space;
use isophote_loader::abi::{self as c, IsophoteRequest};
use isophote_loader::{self as loader, Control, Input, Report};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// One of some words, or an error that lists them.
fn word<T: Copy>(what: &str, given: &str, words: &[(&str, T)]) -> PyResult<T> {
    words.iter().find(|(word, _)| *word == given).map(|(_, value)| *value).ok_or_else(|| {
        let known: Vec<String> = words.iter().map(|(word, _)| format!("'{word}'")).collect();
        invalid(format!("{what} is {}, not '{given}'", known.join(" or ")))
    })
}

/// Request: the picture, its spaces and where it stands. Its numbers are those of the space in which pictures of
/// `color_space` are computed.
#[pyclass(frozen, module = "isophote._native")]
#[derive(Debug)]
pub struct Request(IsophoteRequest);

#[pymethods]
impl Request {
    #[new]
    #[pyo3(signature = (size, *, scale, color_space, alpha_mode, guides, origin, frame, reference_height, canonical_height))]
    fn new(
        py: Python<'_>,
        size: (u32, u32),
        scale: f32,
        color_space: &str,
        alpha_mode: &str,
        guides: Vec<String>,
        origin: (f64, f64),
        frame: i64,
        reference_height: u32,
        canonical_height: u32,
    ) -> PyResult<Self> {
        const ALPHAS: [(&str, u32); 3] = [
            ("straight", c::ISOPHOTE_ALPHA_STRAIGHT),
            ("premultiplied", c::ISOPHOTE_ALPHA_PREMULTIPLIED),
            ("emissive", c::ISOPHOTE_ALPHA_EMISSIVE),
        ];
        let library = library()?;
        let guides = answer(py, library.guide_bits(guides.iter().map(String::as_str)))?;
        let whole = answer(py, library.request(size))?;
        Ok(Self(IsophoteRequest {
            scale,
            space: match colour::named(color_space)?.working() {
                Space::Srgb => c::ISOPHOTE_SPACE_SRGB,
                Space::Acescg => c::ISOPHOTE_SPACE_ACESCG,
                _ => c::ISOPHOTE_SPACE_LINEAR,
            },
            alpha: word("alpha", alpha_mode, &ALPHAS)?,
            guides,
            origin_x: origin.0,
            origin_y: origin.1,
            frame,
            reference_height,
            canonical_height,
            ..whole
        }))
    }
}

/// A graphics device of the library's own.
#[pyclass(frozen, module = "isophote._native")]
#[derive(Debug)]
pub struct Device(loader::Device);

#[pymethods]
impl Device {
    #[new]
    #[pyo3(signature = (adapter=None))]
    fn new(py: Python<'_>, adapter: Option<&str>) -> PyResult<Self> {
        let library = library()?;
        let device = py.detach(|| library.device(adapter)).map_err(|error| raised(py, &error))?;
        Ok(Self(device))
    }

    /// Name of the adapter.
    #[getter]
    fn name(&self, py: Python<'_>) -> PyResult<String> {
        answer(py, self.0.name())
    }
}

/// The parameters of a graph as a style sets them.
#[pyclass(frozen, module = "isophote._native")]
#[derive(Debug)]
pub struct Style(Owned<loader::Style>);

#[pymethods]
impl Style {
    /// The node of an id, or the look that is named `look:ID`.
    #[staticmethod]
    fn named(py: Python<'_>, name: &str) -> PyResult<Self> {
        let style = answer(py, library()?.style(name))?;
        Ok(Self(Owned::new(style)))
    }

    /// The preset or graph of a JSON text, which `place` names in messages; `graph` is the text of the graph file that the
    /// preset names.
    #[staticmethod]
    fn from_json(py: Python<'_>, place: &str, json: &str, graph: Option<&str>) -> PyResult<Self> {
        let style = answer(py, library()?.style_from_json(place, json, graph))?;
        Ok(Self(Owned::new(style)))
    }

    /// The graph with the values of its parameters; those with keyframes have that of the first.
    fn graph(&self, py: Python<'_>) -> PyResult<Graph> {
        let graph = answer(py, self.0.with(py, |style| style.graph())?)?;
        Ok(Graph(Owned::new(graph)))
    }

    /// What the graph does not follow of rules for things, a sentence each.
    fn left_out(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let faults = answer(py, self.0.with(py, |style| style.left_out())?)?;
        Ok(faults.iter().map(ToString::to_string).collect())
    }

    /// Lines of the pictures that its lengths are meant for; 0: lengths are pixels.
    fn reference_height(&self, py: Python<'_>) -> PyResult<u32> {
        self.0.with(py, |style| style.reference_height())
    }

    /// Sets a parameter of its graph for all frames, by its id or `node.id`, from text as a person writes it.
    fn set(&self, py: Python<'_>, graph: &Graph, name: &str, text: &str) -> PyResult<()> {
        let graph = graph.0.with(py, |graph| graph.handle())?;
        answer(py, self.0.with(py, |style| style.set(graph, name, text))?).map(drop)
    }

    /// Gives parameters with keyframes their values at a frame in its graph.
    fn at_frame(&self, py: Python<'_>, graph: &Graph, frame: i64) -> PyResult<()> {
        let graph = graph.0.with(py, |graph| graph.handle())?;
        answer(py, self.0.with(py, |style| style.at_frame(graph, frame))?).map(drop)
    }
}

/// A graph of nodes.
#[pyclass(frozen, module = "isophote._native")]
#[derive(Debug)]
pub struct Graph(Owned<loader::Graph>);

#[pymethods]
impl Graph {
    /// Sets how precisely graphics devices compute it.
    fn set_precision(&self, py: Python<'_>, precision: &str) -> PyResult<()> {
        const WORDS: [(&str, u32); 3] = [
            ("exact", c::ISOPHOTE_PRECISION_EXACT),
            ("half", c::ISOPHOTE_PRECISION_HALF),
            ("fast", c::ISOPHOTE_PRECISION_FAST),
        ];
        let precision = word("the precision", precision, &WORDS)?;
        answer(py, self.0.with(py, |graph| graph.set_precision(precision))?)
    }

    /// Kind of image that leaves the graph, as the catalogue names it.
    fn output_kind(&self, py: Python<'_>) -> PyResult<String> {
        let kind = answer(py, self.0.with(py, |graph| graph.output_kind())?)?;
        let named = serde_json::to_value(kind).ok();
        named
            .as_ref()
            .and_then(|name| name.as_str())
            .map(str::to_owned)
            .ok_or_else(|| usage("a kind has no name"))
    }

    /// Frames before and after its own that a frame depends on.
    fn frames(&self, py: Python<'_>) -> PyResult<(u32, u32)> {
        let library = library()?;
        let [past, future] = answer(py, self.0.with(py, |graph| library.frames(graph))?)?;
        Ok((past, future))
    }

    /// The graph as JSON.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        answer(py, self.0.with(py, |graph| graph.to_json())?)
    }

    /// Computes the whole picture into an array; how many samples were replaced, and the seconds that it took.
    #[pyo3(signature = (request, inputs, target, device, threads, progress))]
    fn process(
        &self,
        py: Python<'_>,
        request: &Request,
        inputs: &Bound<'_, PyDict>,
        target: &Bound<'_, PyAny>,
        device: Option<&Device>,
        threads: u32,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(u64, f64)> {
        let mut images = Vec::new();
        for (name, array) in inputs {
            let name: String = name.extract()?;
            let pixels = Pixels::of(&array, &format!("input image '{name}'"), Use::Read)?;
            images.push((name, pixels));
        }
        let mut target = Pixels::of(target, "the target image", Use::Write)?;
        let watch = Watch::new(progress);
        let device = device.map(|device| &device.0);
        let report = self.0.with(py, |graph| {
            let inputs: Vec<Input<'_>> = images.iter().map(|(name, pixels)| Input { name, pixels }).collect();
            watched(&watch, threads, |control| {
                graph.process(device, &request.0, &inputs, &mut target, control)
            })
        })?;
        outcome(py, &watch, report)
    }
}

/// State that the library keeps of a sequence of frames.
#[pyclass(frozen, module = "isophote._native")]
#[derive(Debug)]
pub struct Sequence(Owned<loader::Sequence>);

#[pymethods]
impl Sequence {
    #[new]
    fn new(py: Python<'_>, memory: u64, max_motion: f32) -> PyResult<Self> {
        let sequence = answer(py, library()?.sequence(memory, max_motion))?;
        Ok(Self(Owned::new(sequence)))
    }

    /// Gives back the memory of all stages.
    fn forget(&self, py: Python<'_>) -> PyResult<()> {
        answer(py, self.0.with(py, |sequence| sequence.forget())?)
    }

    /// Computes the whole picture of the request's frame into an array, from the arrays that `source(name, frame)` gives.
    #[pyo3(signature = (graph, request, source, target, device, threads, progress))]
    fn process(
        &self,
        py: Python<'_>,
        graph: &Graph,
        request: &Request,
        source: Py<PyAny>,
        target: &Bound<'_, PyAny>,
        device: Option<&Device>,
        threads: u32,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(u64, f64)> {
        let mut target = Pixels::of(target, "the target image", Use::Write)?;
        let watch = Watch::new(progress);
        let device = device.map(|device| &device.0);
        let graph = graph.0.with(py, |graph| graph.handle())?;
        let mut image = |name: &str, frame: i64| {
            let asked = Python::attach(|py| {
                let array = source.bind(py).call1((name, frame))?;
                if array.is_none() {
                    return Ok(None);
                }
                let what = format!("input image '{name}' of frame {frame}");
                Pixels::of(&array, &what, Use::Read).map(Some)
            });
            asked.unwrap_or_else(|raised| {
                watch.stop(raised);
                None
            })
        };
        let report = self.0.with(py, |sequence| {
            watched(&watch, threads, |control| {
                sequence.process(graph, device, &request.0, &mut image, &mut target, control)
            })
        })?;
        outcome(py, &watch, report)
    }
}

/// Calls `work` with a control that `watch` looks at.
fn watched<T>(watch: &Watch, threads: u32, work: impl FnOnce(&mut Control<'_>) -> T) -> T {
    let mut progress = |done: f32| watch.look(done);
    let cancelled = || watch.is_stopped();
    let mut control =
        Control { threads, progress: Some(&mut progress), cancelled: Some(&cancelled), ..Control::default() };
    work(&mut control)
}

fn answer<T>(py: Python<'_>, result: loader::Result<T>) -> PyResult<T> {
    result.map_err(|error| raised(py, &error))
}

/// Result of a call. What Python raised meanwhile is why the library stopped, or went on without an image.
fn outcome(py: Python<'_>, watch: &Watch, report: loader::Result<Report>) -> PyResult<(u64, f64)> {
    if let Some(raised) = watch.raised() {
        return Err(raised);
    }
    let report = answer(py, report)?;
    Ok((report.replaced, report.seconds))
}
