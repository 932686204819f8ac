//! Windows whose rows and columns run in one dispatch, with what they sum, give what their passes give one by one.

use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::program::{Precision, Program};
use isophote::engine::{Image, Plan, Rect};
use isophote::{Graph, Planned, Request, Value};
use isophote_tests::device;
use isophote_tests::pictures::{self, Kind};

/// Tones step where they change, which a window over their gradient says.
const STEPS: (&str, Value) = ("least_gradient", Value::Float(0.2));

/// A node with parameters, on pictures of a size.
fn plan(node: &str, settings: &[(&str, Value)], [width, height]: [u32; 2]) -> Planned {
    let mut graph = Graph::single(node).expect("there is such a node");
    for (name, value) in settings {
        graph.set(graph.node(0).expect("it is the first"), name, *value).expect("it has such a value");
    }
    Planned::new(&graph, Request::new(width, height)).expect("it can be planned")
}

fn names(plan: &Plan) -> Vec<String> {
    let [width, height] = plan.size();
    let program = Program::lower_as(plan, Rect::of_size(width, height), Precision::Half);
    let program = program.expect("it can be lowered");
    program.dispatches.iter().map(|dispatch| dispatch.shader.name.to_string()).collect()
}

fn on_cpu(plan: &Plan, picture: &Image, region: Rect) -> Image {
    let run = CpuExecutor::new().run(plan, &[("color", picture)], region, &CallingThread, Control::default());
    run.expect("it runs").remove(0)
}

#[test]
fn small_windows_are_fused_and_large_ones_are_not() {
    let of_sigma = |sigma: f32| names(plan("gaussian", &[("sigma", Value::Float(sigma))], [64, 48]).plan());
    let is_fused = |names: &[String]| names.iter().any(|name| name.contains("gaussian_blur&gaussian_blur"));
    assert!(is_fused(&of_sigma(0.4)) && is_fused(&of_sigma(2.6)));
    assert!(!is_fused(&of_sigma(2.7)) && !is_fused(&of_sigma(9.0)));
    let of_tensor =
        |sigma: f32| names(plan("structure_tensor", &[("rho", Value::Float(sigma))], [64, 48]).plan());
    // With the pixel around it that the derivative reads, a window of seven pixels to each side is the largest.
    assert!(of_tensor(2.3).iter().any(|name| name.contains("gradient_tensor&gaussian_blur&gaussian_blur")));
    assert!(of_tensor(2.6).iter().any(|name| name == "gradient_tensor"));
    let quantized = names(plan("quantize_luminance", &[STEPS], [64, 48]).plan());
    assert!(
        quantized.iter().any(|name| name == "tone_gradient&gaussian_blur&gaussian_blur/half"),
        "{quantized:?}"
    );
}

/// Bounds: the difference that values may have, and the share of them that may differ more.
fn bound(node: &str) -> (f32, f32) {
    match node {
        "gaussian" => (1e-3, 0.0),
        // Tensors of noise may cancel.
        "structure_tensor" => (1e-3, 0.02),
        // Lines magnify what half floats round, and steps of tones that fall on the last bit may go either way.
        _ => (1e-2, 0.08),
    }
}

#[test]
fn fused_windows_are_those_of_the_cpu() {
    let Some(mut gpu) = device::executor("windows") else { return };
    gpu.set_precision(Precision::Half);
    let gaussian = [0.4, 1.0, 2.0, 2.6].map(|sigma| ("gaussian", vec![("sigma", Value::Float(sigma))]));
    let tensors = [0.4, 1.0, 2.0, 2.3].map(|rho| ("structure_tensor", vec![("rho", Value::Float(rho))]));
    let others = [("quantize_luminance", vec![STEPS]), ("cartoon", vec![])];
    let nodes: Vec<_> = gaussian.into_iter().chain(tensors).chain(others).collect();
    // Sizes of no whole number of workgroups, and smaller than a window.
    let sizes = [[67, 53], [16, 16], [5, 3], [4, 40]];
    let pictures =
        sizes.iter().flat_map(|[w, h]| [Kind::Noise, Kind::CutOut].map(|kind| pictures::color(kind, *w, *h)));
    for picture in pictures {
        let size = [picture.width(), picture.height()];
        let whole = Rect::of_size(size[0], size[1]);
        let part = Rect { x0: size[0] as i32 / 3, y0: size[1] as i32 / 2, ..whole };
        for (node, settings) in &nodes {
            let planned = plan(node, settings, size);
            for region in [whole, part] {
                let run = gpu.run_images(planned.plan(), &[("color", &picture)], region, Control::default());
                let (gpu, cpu) = (run.expect("it runs").remove(0), on_cpu(planned.plan(), &picture, region));
                let (bound, outliers) = bound(node);
                let differences = gpu.data().iter().zip(cpu.data()).map(|(a, b)| (*a - *b).abs());
                let far = differences.filter(|difference| *difference > bound).count();
                let most = (outliers * gpu.data().len() as f32) as usize;
                assert!(
                    far <= most,
                    "{node} {settings:?}, {size:?}, {region:?}: {far} of {}",
                    gpu.data().len()
                );
            }
        }
    }
}

#[test]
fn a_window_that_outgrows_its_dispatch_is_lowered_again() {
    let lower = |plan: &Plan| {
        let [width, height] = plan.size();
        Program::lower_as(plan, Rect::of_size(width, height), Precision::Half).expect("it can be lowered")
    };
    let of_sigma = |sigma: f32| plan("gaussian", &[("sigma", Value::Float(sigma))], [64, 48]);
    let mut program = lower(of_sigma(1.0).plan());
    assert!(program.repack(of_sigma(2.0).plan()), "it fits");
    let rewritten = program.dispatches[0].params.clone();
    assert_eq!(rewritten, lower(of_sigma(2.0).plan()).dispatches[0].params);
    assert!(!program.repack(of_sigma(3.0).plan()), "it does not fit");
    assert_eq!(program.dispatches[0].params, rewritten, "nothing is changed then");
}
