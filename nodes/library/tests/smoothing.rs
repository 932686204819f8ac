//! The structure-adaptive smoothing nodes on the CPU executor: tiles, flat and noisy pictures, edges
//! and cut-outs.

use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::{Image, Rect};
use isophote::{Graph, Planned, Request, Value, registry};

const NODES: &[&str] = &["line_integral_convolution", "oriented_bilateral", "flow_bilateral"];

/// Numbers in 0..1 that look random and never change.
fn noise(i: usize) -> f32 {
    let mut v = (i as u32).wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    v = ((v >> ((v >> 28) + 4)) ^ v).wrapping_mul(277_803_737);
    ((v >> 22) ^ v) as f32 / u32::MAX as f32
}

fn picture(width: u32, height: u32, pixel: impl Fn(f32, f32, usize) -> [f32; 4]) -> Image {
    let mut image = Image::new(width, height, 4).unwrap();
    for (i, p) in image.data_mut().chunks_exact_mut(4).enumerate() {
        let (x, y) = ((i as u32 % width) as f32 + 0.5, (i as u32 / width) as f32 + 0.5);
        p.copy_from_slice(&pixel(x, y, i));
    }
    image
}

/// Curved stripes, noise and a soft and a hard edge of coverage, premultiplied.
fn awkward(width: u32, height: u32) -> Image {
    picture(width, height, |x, y, i| {
        let wave = 0.5 + 0.4 * ((x * x + y * y).sqrt() * 0.7).sin();
        let alpha = ((x - 9.0) / 8.0).clamp(0.0, 1.0) * if y > 40.0 && x > 30.0 { 0.0 } else { 1.0 };
        let c = |k: usize| (wave + 0.2 * noise(3 * i + k)) * alpha;
        [c(0), c(1), 0.5 * c(2), alpha]
    })
}

fn run(graph: &Graph, input: &Image, region: Rect) -> Image {
    let planned = Planned::new(graph, Request::new(input.width(), input.height())).unwrap();
    let windows = planned.plan().windows(region);
    let port = &planned.plan().inputs()[0];
    // Only what the plan asks for: a pass that reads further fails.
    let part = input.crop(windows[port.image.index()]).unwrap();
    CpuExecutor::new()
        .run(planned.plan(), &[("color", &part)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

fn whole(graph: &Graph, input: &Image) -> Image {
    run(graph, input, Rect::of_size(input.width(), input.height()))
}

fn node(id: &str, values: &[(&str, Value)]) -> Graph {
    let mut graph = Graph::single(id).unwrap();
    let node = graph.node(0).unwrap();
    for (param, value) in values {
        graph.set(node, param, *value).unwrap();
    }
    graph
}

/// The node with each option of each of its choices, at small sizes that reach odd radii.
fn variants(id: &str) -> Vec<Graph> {
    let mut graphs = vec![node(id, &[])];
    let spec = registry::find(id).unwrap();
    for param in spec.params() {
        match param.default {
            Value::Choice(_) => {
                graphs.extend((0..param.options.len()).map(|i| node(id, &[(param.id, Value::Choice(i))])));
            }
            Value::Float(_) if param.id != "mix" => {
                let (range, slider) = (param.range, param.slider);
                for value in [range[0], slider[0] + 0.37 * (slider[1] - slider[0])] {
                    graphs.push(node(id, &[(param.id, Value::Float(value))]));
                }
            }
            _ => {}
        }
    }
    graphs
}

#[test]
fn tiles_equal_the_full_frame() {
    let input = awkward(83, 61);
    for id in NODES {
        for (n, graph) in variants(id).iter().enumerate() {
            let full = whole(graph, &input);
            for tile in [
                Rect { x0: 13, y0: 5, x1: 42, y1: 30 },
                Rect { x0: 0, y0: 0, x1: 7, y1: 3 },
                Rect { x0: 71, y0: 40, x1: 83, y1: 61 },
                Rect { x0: 33, y0: 29, x1: 34, y1: 30 },
            ] {
                assert_eq!(run(graph, &input, tile), full.crop(tile).unwrap(), "{id}, variant {n}");
            }
        }
    }
}

#[test]
fn a_constant_picture_stays_what_it_is() {
    for alpha in [1.0, 0.5] {
        let input = picture(37, 21, |_, _, _| [0.7 * alpha, 0.3 * alpha, 0.1 * alpha, alpha]);
        for id in NODES {
            for graph in variants(id) {
                for (a, b) in whole(&graph, &input).data().iter().zip(input.data()) {
                    assert!((a - b).abs() < 2e-5, "{id}: {a} for {b}");
                }
            }
        }
    }
}

#[test]
fn bilateral_filters_smooth_noise_and_keep_a_step() {
    let input = picture(48, 40, |x, _, i| {
        let light = if x < 24.0 { 0.3 } else { 0.6 } + 0.03 * (noise(i) - 0.5);
        [light, light, light, 1.0]
    });
    for id in &NODES[1..] {
        let out = whole(&node(id, &[]), &input);
        let spread = |image: &Image, x0: i32, x1: i32| {
            let all: Vec<f32> = (4..36)
                .flat_map(|y| (x0..x1).map(move |x| (x, y)))
                .map(|(x, y)| image.pixel(x, y)[1])
                .collect();
            let mean = all.iter().sum::<f32>() / all.len() as f32;
            (all.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / all.len() as f32).sqrt()
        };
        for (x0, x1) in [(4, 24), (24, 44)] {
            let (before, after) = (spread(&input, x0, x1), spread(&out, x0, x1));
            assert!(after < 0.25 * before, "{id}: noise {before} came down to {after}");
        }
        for y in 4..36 {
            let jump = out.pixel(24, y)[1] - out.pixel(23, y)[1];
            assert!(jump > 0.28, "{id}: the step of 0.3 fell to {jump}");
        }
    }
}

#[test]
fn lines_smooth_along_stripes_and_not_across() {
    // Diagonal stripes with noise on them.
    let clean = |x: f32, y: f32| 0.5 + 0.3 * ((x + 0.5 * y) * 0.6).sin();
    let input = picture(64, 64, |x, y, i| {
        let v = clean(x, y) + 0.1 * (noise(i) - 0.5);
        [v, v, v, 1.0]
    });
    let out = whole(&node("line_integral_convolution", &[]), &input);
    let error = |image: &Image| {
        let mut sum = 0.0;
        for y in 12..52 {
            for x in 12..52 {
                sum += (image.pixel(x, y)[0] - clean(x as f32 + 0.5, y as f32 + 0.5)).powi(2);
            }
        }
        (sum / 1600.0).sqrt()
    };
    let (before, after) = (error(&input), error(&out));
    assert!(after < 0.5 * before, "error {before} came down to {after} only");
}

#[test]
fn transparent_pixels_lend_no_colour() {
    // Red inside a disc; the green outside is hidden.
    let input = picture(40, 40, |x, y, _| {
        let alpha = (14.0 - (x - 20.0).hypot(y - 20.0)).clamp(0.0, 1.0);
        [0.8 * alpha, 0.1 * alpha, 0.1 * alpha, alpha]
    });
    let hidden = picture(40, 40, |x, y, _| {
        let alpha = (14.0 - (x - 20.0).hypot(y - 20.0)).clamp(0.0, 1.0);
        if alpha > 0.0 { [0.8, 0.1, 0.1, alpha] } else { [0.0, 1.0, 0.0, 0.0] }
    });
    for id in NODES {
        for (n, graph) in variants(id).iter().enumerate() {
            for (input, premultiplied) in [(&input, true), (&hidden, false)] {
                let request = Request { premultiplied, ..Request::new(40, 40) };
                let planned = Planned::new(graph, request).unwrap();
                let out = CpuExecutor::new()
                    .run(
                        planned.plan(),
                        &[("color", input)],
                        Rect::of_size(40, 40),
                        &CallingThread,
                        Control::default(),
                    )
                    .unwrap()
                    .remove(0);
                for p in out.data().chunks_exact(4).filter(|p| p[3] > 1e-3) {
                    let factor = if premultiplied { p[3] } else { 1.0 };
                    let wrong = (p[0] - 0.8 * factor).abs().max((p[1] - 0.1 * factor).abs());
                    assert!(wrong < 1e-3, "{id}, variant {n}: {p:?}");
                }
            }
        }
    }
}
