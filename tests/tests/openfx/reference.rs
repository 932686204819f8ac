//! Parts that the tests of the OpenFX face share: effects by the registry, and the same result through C.

use isophote::graph::GraphInput;
use isophote::spec::{ImageKind, NodeSpec};
use isophote::{ColourSpace, Graph};
use isophote_abi::openfx::kOfxImageEffectContextGeneral;
use isophote_abi::*;
use isophote_engine::pixels::Sample;
use isophote_tests::library::{Loaded, text};
use isophote_tests::ofx::effect::{Described, Instance};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::{Binary, Plugin};
use std::ffi::CString;
use std::ptr::{null, null_mut};
use std::sync::OnceLock;

pub const WIDTH: i32 = 41;
pub const HEIGHT: i32 = 29;

fn table() -> &'static Loaded {
    static LOADED: OnceLock<Loaded> = OnceLock::new();
    LOADED.get_or_init(Loaded::new)
}

/// An effect that there must be, and the graph that it must be like.
#[derive(Clone, Copy)]
pub struct Expected {
    pub node: &'static NodeSpec,
}

/// The effects of the registry.
pub fn expected() -> Vec<Expected> {
    let is_effect = |n: &&'static NodeSpec| {
        n.id == "tensor_view"
            || (matches!(n.output.kind, ImageKind::Color | ImageKind::Scalar) && n.reads_colour_alone())
    };
    let nodes = isophote::registry::nodes().iter().copied().filter(is_effect);
    nodes.map(|node| Expected { node }).collect()
}

pub fn identifier(node: &NodeSpec) -> String {
    let id = if node.id == "tensor_view" { "structure" } else { node.id };
    format!("org.isophote.{id}")
}

impl Expected {
    /// The plugin of the effect.
    pub fn plugin(&self, binary: &Binary) -> Plugin {
        binary.plugin(&identifier(self.node))
    }

    pub fn is_lines(&self) -> bool {
        self.node.output.kind == ImageKind::Scalar
    }

    /// The graph of the effect. `over`: lines over the picture.
    pub fn graph(&self, over: bool) -> Graph {
        let mut graph = Graph::new();
        let connect = |graph: &mut Graph, id, spec: &NodeSpec| {
            for port in spec.inputs {
                if let Some(input) = GraphInput::from_id(port.id) {
                    graph.connect_input(input, id, port.id).unwrap();
                }
            }
        };
        let tensor = (self.node.id == "tensor_view").then(|| graph.add("t", "structure_tensor").unwrap());
        let node = graph.add("n", self.node.id).unwrap();
        connect(&mut graph, node, self.node);
        graph.set_output(node).unwrap();
        if let Some(tensor) = tensor {
            connect(&mut graph, tensor, isophote::registry::find("structure_tensor").unwrap());
            graph.connect(tensor, node, "tensor").unwrap();
        }
        if over {
            let lines = graph.add("l", "composite_lines").unwrap();
            graph.connect_input(GraphInput::Color, lines, "color").unwrap();
            graph.connect(node, lines, "edges").unwrap();
            graph.set_output(lines).unwrap();
        }
        graph
    }
}

/// A picture of edges, a disc, a ramp and grain, with cut-out parts; values 0..=1, premultiplied.
pub fn scene(width: i32, height: i32, opaque: bool) -> Vec<f32> {
    let pixel = |x: i32, y: i32| {
        let (s, t) = (x as f32 / width as f32, y as f32 / height as f32);
        let disc = (s - 0.6).powi(2) + (t - 0.5).powi(2) < 0.05;
        let edge = if s + t < 0.7 { 0.2 } else { 0.7 };
        let grain = ((x * 7919 + y * 104_729) % 97) as f32 / 970.0;
        let alpha = if opaque || t < 0.7 { 1.0 } else { (s * 1.6 - 0.3).clamp(0.0, 1.0) };
        [if disc { 0.9 } else { edge }, 0.1 + 0.8 * s, 0.3 + grain, 1.0].map(|v| v * alpha)
    };
    (0..height).flat_map(|y| (0..width).flat_map(move |x| pixel(x, y))).collect()
}

/// Packed samples of RGBA floats in a layout.
pub fn packed(rgba: &[f32], layout: &Layout) -> Vec<u8> {
    let mut bytes = vec![0; rgba.len() / 4 * layout.pixel()];
    isophote_engine::pixels::write_row(rgba, 4, &mut bytes, layout.sample(), layout.channels());
    bytes
}

/// Result of the C table on packed pixels, in the same layout.
pub struct Through<'a> {
    pub graph: &'a Graph,
    pub size: [i32; 2],
    pub scale: f32,
    pub space: ColourSpace,
    pub premultiplied: bool,
    /// Height of pictures at which lengths are meant; 0: any.
    pub reference_height: u32,
}

impl<'a> Through<'a> {
    /// Full-size sRGB, multiplied by alpha, whose lengths are pixels.
    pub fn of(graph: &'a Graph, size: [i32; 2]) -> Self {
        let (scale, space, reference_height) = (1.0, ColourSpace::Srgb, 0);
        Self { graph, size, scale, space, premultiplied: true, reference_height }
    }
}

/// A device of the C table's that computes, and how precisely.
#[derive(Clone, Copy, Default)]
pub struct On {
    pub device: IsophoteDevice,
    pub precision: IsophotePrecision,
}

impl On {
    /// A device of the table's, which all tests of this process share; none where there is none and none was required.
    pub fn device(test: &str) -> Option<IsophoteDevice> {
        static DEVICE: OnceLock<IsophoteDevice> = OnceLock::new();
        isophote_tests::device::device(test)?;
        Some(*DEVICE.get_or_init(|| {
            let mut device = IsophoteDevice::default();
            // SAFETY: a place for the handle; there is an adapter.
            let status = unsafe { (table().api.device_create)(null(), null_mut(), &raw mut device) };
            assert_eq!(status, ISOPHOTE_OK);
            device
        }))
    }

    /// Sets the precision of a graph.
    fn prepare(&self, graph: IsophoteGraph) {
        // SAFETY: a name with a closing zero; the extension of this name is of this type.
        let status = unsafe {
            let extension = (table().api.extension)(c"isophote.precision/1".as_ptr());
            let api = extension.cast::<IsophotePrecisionApi>().as_ref().unwrap();
            (api.graph_set_precision)(graph, self.precision)
        };
        assert_eq!(status, ISOPHOTE_OK);
    }
}

impl Through<'_> {
    /// Runs the graph on `inputs`, each packed pixels by the name of their port.
    pub fn c(&self, inputs: &[(&str, &[u8], Layout)], layout: Layout) -> Vec<u8> {
        self.on(On::default(), inputs, layout)
    }

    /// The same on a device.
    pub fn on(&self, on: On, inputs: &[(&str, &[u8], Layout)], layout: Layout) -> Vec<u8> {
        let names: Vec<CString> = inputs.iter().map(|(name, ..)| CString::new(*name).unwrap()).collect();
        let images: Vec<IsophoteInput> = inputs
            .iter()
            .zip(&names)
            .map(|((_, bytes, layout), name)| IsophoteInput {
                name: name.as_ptr(),
                image: self.image(bytes.as_ptr(), layout),
            })
            .collect();
        let mut out = vec![0_u8; (self.size[0] * self.size[1]) as usize * layout.pixel()];
        let IsophoteImage { row_stride, sample, channels, width, height, x, y, .. } =
            self.image(null(), &layout);
        let data = out.as_mut_ptr().cast();
        self.process(
            on,
            &images,
            &IsophoteTarget { data, row_stride, sample, channels, width, height, x, y },
        );
        out
    }

    fn image(&self, data: *const u8, layout: &Layout) -> IsophoteImage {
        let [width, height] = self.size.map(|n| n as u32);
        let sample = match layout.sample() {
            Sample::U8 => ISOPHOTE_SAMPLE_U8,
            Sample::U16 => ISOPHOTE_SAMPLE_U16,
            Sample::F16 => ISOPHOTE_SAMPLE_F16,
            Sample::F32 => ISOPHOTE_SAMPLE_F32,
        };
        IsophoteImage {
            data: data.cast(),
            row_stride: width as isize * layout.pixel() as isize,
            sample,
            channels: layout.channels() as u32,
            width,
            height,
            x: 0,
            y: 0,
        }
    }

    fn process(&self, on: On, images: &[IsophoteInput], target: &IsophoteTarget) {
        let api = table().api;
        let json = CString::new(self.graph.to_json().unwrap()).unwrap();
        let mut graph = Default::default();
        let request = IsophoteRequest {
            width: self.size[0] as u32,
            height: self.size[1] as u32,
            scale: self.scale,
            space: self.space as u32,
            alpha: if self.premultiplied { ISOPHOTE_ALPHA_PREMULTIPLIED } else { ISOPHOTE_ALPHA_STRAIGHT },
            reference_height: self.reference_height,
            ..Default::default()
        };
        // SAFETY: text with a closing zero, images of the sizes they name, and places for the answers.
        unsafe {
            assert_eq!((api.graph_create_from_json)(json.as_ptr(), null_mut(), &raw mut graph), ISOPHOTE_OK);
            on.prepare(graph);
            let status = (api.process)(
                graph,
                on.device,
                &raw const request,
                images.as_ptr(),
                images.len() as u32,
                null(),
                &raw const *target,
                null(),
                null_mut(),
            );
            let said = text(|t| assert_eq!((api.graph_error)(graph, t), ISOPHOTE_OK));
            assert_eq!(status, ISOPHOTE_OK, "{said}");
            assert_eq!((api.graph_destroy)(graph), ISOPHOTE_OK);
        }
    }
}

/// Samples as numbers; integers in code values.
pub fn values(bytes: &[u8], layout: &Layout) -> Vec<f32> {
    match layout.sample() {
        Sample::U8 => bytes.iter().map(|b| f32::from(*b)).collect(),
        Sample::U16 => bytes.chunks_exact(2).map(|b| f32::from(u16::from_ne_bytes([b[0], b[1]]))).collect(),
        Sample::F16 | Sample::F32 => {
            let size = layout.sample().size();
            let mut values = vec![0.0; bytes.len() / size];
            isophote_engine::pixels::read_row(bytes, layout.sample(), 1, &mut values, 1);
            values
        }
    }
}

/// The largest difference; in code values for integers.
pub fn difference(a: &[u8], b: &[u8], layout: &Layout) -> f32 {
    assert_eq!(a.len(), b.len());
    let pairs = values(a, layout).into_iter().zip(values(b, layout));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The picture of the tests in a layout.
pub fn source(layout: Layout, opaque: bool) -> Picture {
    Picture::packed_in(layout, WIDTH, HEIGHT, &packed(&scene(WIDTH, HEIGHT, opaque), &layout))
}

/// Working space sRGB, alpha filtered too: what the C table does.
pub fn plain(instance: &Instance<'_>) {
    instance.set("working_space", 1);
    instance.set("process_alpha", 1);
}

/// An instance in the general context for which guides count, plain; none of effects that take none.
pub fn guided<'h>(host: &'h Host, binary: &Binary, effect: Expected) -> Option<Instance<'h>> {
    let instance = Described::new(host, effect.plugin(binary)).instance(kOfxImageEffectContextGeneral);
    let names = instance.effect.clip_names();
    if !names.contains(&"Normal".to_owned()) || !names.contains(&"Depth".to_owned()) {
        return None;
    }
    plain(&instance);
    if instance.has("rim") {
        instance.set("rim", 1.0);
        instance.set("rim_width", 0.9);
    }
    if instance.has("guide_weight") {
        instance.set("guide_weight", 1.0);
    }
    Some(instance)
}
