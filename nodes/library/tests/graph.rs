//! Graphs from declaration to pixels on the CPU executor.

use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::{Image, Rect};
use isophote::graph::GraphInput;
use isophote::planned::Change;
use isophote::{Error, Graph, Planned, Request, Value};

fn step_edge(width: u32, height: u32) -> Image {
    let mut image = Image::new(width, height, 4).unwrap();
    for (i, pixel) in image.data_mut().chunks_exact_mut(4).enumerate() {
        let light = if (i as u32 % width) < width / 2 { 0.2 } else { 0.8 };
        pixel.copy_from_slice(&[light, light * 0.5, 1.0 - light, 1.0]);
    }
    image
}

fn run(planned: &Planned, input: &Image, region: Rect) -> Image {
    let mut executor = CpuExecutor::new();
    let windows = planned.plan().windows(region);
    let port = &planned.plan().inputs()[0];
    let part = input.crop(windows[port.image.index()]).unwrap();
    executor
        .run(planned.plan(), &[("color", &part)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

#[test]
fn a_gaussian_smooths_a_step_and_keeps_flat_parts() {
    let graph = Graph::single("gaussian").unwrap();
    let planned = Planned::new(&graph, Request::new(40, 9)).unwrap();
    let input = step_edge(40, 9);
    let out = run(&planned, &input, Rect::of_size(40, 9));
    for (far, near) in [(2, 19), (37, 20)] {
        assert!((out.pixel(far, 4)[0] - input.pixel(far, 4)[0]).abs() < 1e-5);
        assert!((out.pixel(near, 4)[0] - input.pixel(near, 4)[0]).abs() > 0.1);
    }
}

#[test]
fn a_tile_is_the_same_part_of_the_full_frame() {
    let mut graph = Graph::single("gaussian").unwrap();
    graph.set(graph.node(0).unwrap(), "mix", Value::Float(0.7)).unwrap();
    let planned = Planned::new(&graph, Request::new(61, 37)).unwrap();
    let input = step_edge(61, 37);
    let full = run(&planned, &input, Rect::of_size(61, 37));
    let tile = Rect { x0: 13, y0: 5, x1: 42, y1: 30 };
    assert_eq!(run(&planned, &input, tile), full.crop(tile).unwrap());
}

#[test]
fn a_slider_edits_in_place_and_a_structural_parameter_does_not() {
    let mut graph = Graph::single("gaussian").unwrap();
    let node = graph.node(0).unwrap();
    let mut planned = Planned::new(&graph, Request::new(40, 9)).unwrap();
    graph.set(node, "sigma", Value::Float(5.0)).unwrap();
    assert_eq!(planned.update(&graph).unwrap(), Change::Uniforms);
    let fresh = Planned::new(&graph, Request::new(40, 9)).unwrap();
    let input = step_edge(40, 9);
    let all = Rect::of_size(40, 9);
    assert_eq!(run(&planned, &input, all), run(&fresh, &input, all));
    graph.set(node, "mix", Value::Float(0.5)).unwrap();
    assert_eq!(planned.update(&graph).unwrap(), Change::Structure);
}

#[test]
fn equal_passes_are_recorded_once() {
    let mut graph = Graph::new();
    let a = graph.add("a", "gaussian").unwrap();
    let b = graph.add("b", "gaussian").unwrap();
    let c = graph.add("c", "gaussian").unwrap();
    graph.connect_input(GraphInput::Color, a, "color").unwrap();
    graph.connect_input(GraphInput::Color, b, "color").unwrap();
    graph.connect(b, c, "color").unwrap();
    graph.set_output(c).unwrap();
    let planned = Planned::new(&graph, Request::new(8, 8)).unwrap();
    // Import, two axes for `a` and `b` together, two for `c`, export.
    assert_eq!(planned.plan().passes().len(), 6);
}

#[test]
fn json_round_trips_and_names_what_is_wrong() {
    let mut graph = Graph::single("gaussian").unwrap();
    graph.set_text(graph.node(0).unwrap(), "sigma", "0.1").unwrap();
    let text = graph.to_json().unwrap();
    assert!(text.contains("0.1"), "{text}");
    assert_eq!(Graph::from_json(&text).unwrap().to_json().unwrap(), text);
    let wrong = text.replace("\"sigma\"", "\"sigmo\"");
    let message = Graph::from_json(&wrong).unwrap_err().to_string();
    assert!(message.contains("sigmo") && message.contains("did you mean 'sigma'"), "{message}");
    assert!(matches!(Graph::from_json("{"), Err(Error::Format(_))));
}

#[test]
fn cycles_and_wrong_values_are_refused_and_leave_the_graph_as_it_was() {
    let mut graph = Graph::new();
    let a = graph.add("a", "gaussian").unwrap();
    let b = graph.add("b", "gaussian").unwrap();
    graph.connect(a, b, "color").unwrap();
    assert!(matches!(graph.connect(b, a, "color"), Err(Error::Connection(_))));
    graph.connect_input(GraphInput::Color, a, "color").unwrap();
    graph.set_output(b).unwrap();
    assert!(Planned::new(&graph, Request::new(8, 8)).is_ok());
    for bad in [Value::Float(f32::NAN), Value::Float(-1.0), Value::Bool(true)] {
        assert!(matches!(graph.set(a, "sigma", bad), Err(Error::Value(_))), "{bad:?}");
    }
    assert!(graph.connect_input(GraphInput::Depth, a, "color").is_err());
}

#[test]
fn an_open_tensor_port_is_a_structure_tensor_with_its_defaults() {
    let (mut tried, mut unlike) = (0, Vec::new());
    for spec in isophote::registry::nodes() {
        if !spec.inputs.iter().any(|port| port.id == "tensor" && port.optional) {
            continue;
        }
        tried += 1;
        let mut open = Graph::new();
        let node = open.add("node", spec.id).unwrap();
        open.connect_input(GraphInput::Color, node, "color").unwrap();
        open.set_output(node).unwrap();
        let mut connected = open.clone();
        let tensor = connected.add("tensor", "structure_tensor").unwrap();
        connected.connect_input(GraphInput::Color, tensor, "color").unwrap();
        connected.connect(tensor, node, "tensor").unwrap();
        for scale in [1.0, 0.5, 0.3] {
            let passes = |graph: &Graph| -> Vec<_> {
                let planned = Planned::new(graph, Request { scale, ..Request::new(48, 32) }).unwrap();
                let passes = planned.plan().passes().iter();
                passes
                    .map(|p| (p.kernel.name, p.params.clone(), p.inputs.clone(), p.outputs.clone()))
                    .collect()
            };
            if passes(&open) != passes(&connected) {
                unlike.push((spec.id, scale));
            }
        }
    }
    // Scales and rounds that take the tensors of their own pictures, a filter that needs none by default, and one
    // whose picture is a map.
    let others = ["painting", "coherent", "coherence_enhancing", "mean_curvature_flow", "flow_map"];
    unlike.retain(|(id, _)| !others.contains(id));
    assert_eq!(unlike, []);
    assert!(tried > 5, "{tried} nodes have the port");
}
