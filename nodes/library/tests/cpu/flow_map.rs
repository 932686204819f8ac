//! `flow_map` on the CPU executor.

use isophote::graph::GraphInput;
use isophote::kernels::shared::tensor::scalar;
use isophote::request::Guides;
use isophote::{Graph, Planned, Request};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Image, Rect};

const SIDE: u32 = 64;

fn image(channels: u32, value: impl Fn(u32, u32, u32) -> f32) -> Image {
    let values = (0..SIDE * SIDE * channels).map(|i| {
        let (pixel, channel) = (i / channels, i % channels);
        value(pixel % SIDE, pixel / SIDE, channel)
    });
    Image::from_vec(SIDE, SIDE, channels, values.collect()).unwrap()
}

/// Waves that run along the rows, so that edges are vertical.
fn waves() -> Image {
    image(4, |x, _, c| if c == 3 { 1.0 } else { 0.5 + 0.4 * (x as f32 * 0.6).sin() })
}

/// Direction (x, y) of full strength in the right half.
fn painted([x, y]: [f32; 2]) -> Image {
    image(4, |column, _, c| match c {
        0 => 0.5 + 0.5 * x,
        1 => 0.5 + 0.5 * y,
        2 => 0.3,
        _ => f32::from(u8::from(column >= SIDE / 2)),
    })
}

fn run(graph: &Graph, flow: &Image) -> Image {
    let guides = Guides { flow: true, ..Guides::default() };
    let planned = Planned::new(graph, Request { guides, ..Request::new(SIDE, SIDE) }).unwrap();
    let (color, all) = (waves(), Rect::of_size(SIDE, SIDE));
    let inputs = [("color", &color), ("flow", flow)];
    let results = CpuExecutor::new().run(planned.plan(), &inputs, all, &CallingThread, Control::default());
    results.unwrap().remove(0)
}

/// A flow map over the tensor of the picture.
fn bent(settings: &[(&str, &str)], flow: &Image) -> Image {
    let mut graph = Graph::new();
    let tensor = graph.add("tensor", "structure_tensor").unwrap();
    let map = graph.add("map", "flow_map").unwrap();
    graph.connect_input(GraphInput::Color, tensor, "color").unwrap();
    graph.connect_input(GraphInput::Flow, map, "color").unwrap();
    graph.connect(tensor, map, "tensor").unwrap();
    for (param, value) in settings {
        graph.set_text(map, param, value).unwrap();
    }
    graph.set_output(map).unwrap();
    run(&graph, flow)
}

/// The sine of the angle between the tangent at a pixel and a direction.
fn off(tensor: &Image, x: i32, y: i32, [dx, dy]: [f32; 2]) -> f32 {
    let t = tensor.pixel(x, y);
    let [tx, ty] = scalar::tangent(t[0], t[1], t[2]);
    (tx * dy - ty * dx).abs() / dx.hypot(dy)
}

#[test]
fn tangents_follow_what_was_painted_and_nothing_else_moves() {
    for direction in [[0.8, 0.6], [-0.8, -0.6], [0.0, 1.0]] {
        let field = bent(&[("softness", "2")], &painted(direction));
        assert!(off(&field, 50, 32, direction) < 1e-3, "{direction:?}");
        assert!(off(&field, 14, 32, [0.0, 1.0]) < 1e-3, "unpainted");
    }
    let up = bent(&[("invert_y", "true"), ("softness", "0")], &painted([0.8, 0.6]));
    assert!(off(&up, 50, 32, [0.8, -0.6]) < 1e-3);
    let weak = bent(&[("strength", "0")], &painted([0.8, 0.6]));
    assert!(off(&weak, 50, 32, [0.0, 1.0]) < 1e-5);
    // 0.5 is no direction, nor is what eight bits have nearest to it.
    for none in [0.0, 1.0 / 255.0] {
        assert!(off(&bent(&[], &painted([none, none])), 50, 32, [0.0, 1.0]) < 1e-5);
    }
}

#[test]
fn to_and_fro_do_not_cancel() {
    let strokes = image(4, |_, y, c| match (c, y % 2) {
        (0, 0) => 1.0,
        (0, _) => 0.0,
        (1, _) => 0.5,
        _ => 1.0,
    });
    assert!(off(&bent(&[], &strokes), 32, 32, [1.0, 0.0]) < 1e-3);
}

#[test]
fn whatever_follows_an_orientation_is_bent() {
    let mut bent = 0;
    for spec in isophote::registry::nodes().iter().filter(|n| n.has_mix() && n.reads_colour_alone()) {
        let mut graph = Graph::single(spec.id).unwrap();
        // Those that smooth the picture along its structure do, too.
        let smooths = ["palette", "toon_shading"].contains(&spec.id);
        let follows = smooths || spec.inputs.iter().any(|p| p.id == "tensor") || spec.group == "styles";
        if spec.id == "mean_curvature_flow" {
            graph.set_text(graph.node(0).unwrap(), "constraint", "1").unwrap();
        }
        let [diagonal, none] = [[0.7, 0.7], [0.0, 0.0]].map(|d| run(&graph, &painted(d)));
        assert_eq!(diagonal != none, follows, "{}", spec.id);
        bent += u32::from(follows);
    }
    assert!(bent > 12, "{bent} nodes follow an orientation");
}
