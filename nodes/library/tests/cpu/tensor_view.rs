//! `tensor_view` on the CPU executor.

use isophote::graph::GraphInput;
use isophote::{Graph, Planned, Request};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Image, Rect};

const SIZE: u32 = 96;

/// A view of the tensor of waves along (x, y).
fn view(show: &str, [x, y]: [f32; 2]) -> Image {
    let mut graph = Graph::new();
    let tensor = graph.add("tensor", "structure_tensor").unwrap();
    let view = graph.add("view", "tensor_view").unwrap();
    graph.connect_input(GraphInput::Color, tensor, "color").unwrap();
    graph.connect(tensor, view, "tensor").unwrap();
    graph.set_text(view, "show", show).unwrap();
    graph.set_output(view).unwrap();
    let planned = Planned::new(&graph, Request::new(SIZE, SIZE)).unwrap();
    let pixels = (0..SIZE * SIZE).flat_map(|i| {
        let phase = (i % SIZE) as f32 * x + (i / SIZE) as f32 * y;
        [[0.5 + 0.4 * phase.sin(); 3].as_slice(), &[1.0]].concat()
    });
    let color = Image::from_vec(SIZE, SIZE, 4, pixels.collect()).unwrap();
    let region = Rect::of_size(SIZE, SIZE);
    CpuExecutor::new()
        .run(planned.plan(), &[("color", &color)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

#[test]
fn hues_tell_orientations_apart() {
    let near = |direction: [f32; 2], want: [f32; 3]| {
        let image = view("orientation", direction);
        let got = image.pixel(48, 48);
        assert!((0..3).all(|c| (got[c] - want[c]).abs() < 0.05) && got[3] == 1.0, "{got:?} for {want:?}");
    };
    near([0.0, 0.5], [1.0, 0.25, 0.25]);
    near([0.5, 0.0], [0.0, 0.75, 0.75]);
    near([0.0, 0.0], [0.5; 3]);
}

#[test]
fn waves_are_anisotropic_and_flat_parts_are_not() {
    assert!(view("anisotropy", [0.3, 0.4]).pixel(48, 48)[0] > 0.99);
    assert_eq!(view("anisotropy", [0.0, 0.0]).pixel(48, 48), [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn noise_is_smeared_along_edges_only_and_keeps_its_contrast() {
    let image = view("lic", [0.5, 0.0]);
    let (mut along, mut across, mut square) = (0.0, 0.0, 0.0);
    let inner = 20..76;
    for (x, y) in inner.clone().flat_map(|y| inner.clone().map(move |x| (x, y))) {
        let value = |x: i32, y: i32| f64::from(image.pixel(x, y)[0]) - 0.5;
        along += (value(x, y + 1) - value(x, y)).powi(2);
        across += (value(x + 1, y) - value(x, y)).powi(2);
        square += value(x, y).powi(2);
    }
    assert!(across > 10.0 * along, "{across} across, {along} along");
    let deviation = (square / inner.len().pow(2) as f64).sqrt();
    assert!((0.1..0.35).contains(&deviation), "{deviation}");
}
