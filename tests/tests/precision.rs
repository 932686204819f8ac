//! Gains of graphics devices by fused passes and by half precision, and the quality that pictures keep.

use isophote::registry;
use isophote::spec::ImageKind;
use isophote::{Graph, Planned, Request};
use isophote_engine::cpu::Control;
use isophote_engine::program::{Precision, Program};
use isophote_engine::{Image, Plan, Rect};
use isophote_tests::compare::psnr;
use isophote_tests::pictures::{self, Kind};
use isophote_tests::{device, png, scenery};
use std::path::Path;

/// Least ratio of signal to noise of a style in half precision, decibels, for pictures as they are; and for patches of one
/// colour, some of which lie on the border of two tones and change their tone as a whole.
const LEAST: f64 = 50.0;
const LEAST_FLAT: f64 = 30.0;

/// Of details of single pixels under a filter that sharpens what it has sharpened before: some become another shape.
const LEAST_SHARPENED: f64 = 44.0;

fn plan(node: &str, size: [u32; 2]) -> Plan {
    plan_with(node, size, &[])
}

fn plan_with(node: &str, size: [u32; 2], params: &[(&str, &str)]) -> Plan {
    let mut graph = Graph::single(node).expect("the node is there");
    let id = graph.node(0).expect("it is in the graph");
    for (param, value) in params {
        graph.set_text(id, param, value).expect("the parameter is there");
    }
    Planned::new(&graph, Request::new(size[0], size[1])).expect("it can be planned").plan().clone()
}

fn program(plan: &Plan, precision: Precision) -> Program {
    let [width, height] = plan.size();
    Program::lower_as(plan, Rect::of_size(width, height), precision).expect("it can be lowered")
}

/// Bytes that each pass would read and write by itself, in 32-bit floats.
fn bytes_pass_by_pass(plan: &Plan) -> u64 {
    let bytes = |image: &isophote_engine::ImageId| {
        let desc = plan.desc(*image);
        let [width, height] = plan.level_size(desc.level);
        width as u64 * height as u64 * if desc.channels == 3 { 16 } else { u64::from(desc.channels) * 4 }
    };
    plan.passes().iter().flat_map(|pass| pass.inputs.iter().chain(&pass.outputs)).map(bytes).sum()
}

#[test]
fn plans_move_fewer_bytes_in_fewer_passes() {
    println!(
        "| style | passes | dispatches, exact | half | bytes a pixel by pass | exact | half | textures, MiB at 1080p, exact | half |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    let size = [1920, 1080];
    for spec in registry::nodes().iter().filter(|spec| spec.group == "styles") {
        let plan = plan(spec.id, size);
        let (exact, half) = (program(&plan, Precision::Exact), program(&plan, Precision::Fast));
        let pixels = f64::from(size[0] * size[1]);
        let a_pixel = |bytes: u64| bytes as f64 / pixels;
        let memory = |program: &Program| program.textures.iter().map(|t| t.bytes()).sum::<u64>() >> 20;
        let (before, after) = (bytes_pass_by_pass(&plan), half.bytes_moved());
        println!(
            "| `{}` | {} | {} | {} | {:.0} | {:.0} | {:.0} | {} | {} |",
            spec.id,
            plan.passes().len(),
            exact.dispatches.len(),
            half.dispatches.len(),
            a_pixel(before),
            a_pixel(exact.bytes_moved()),
            a_pixel(after),
            memory(&exact),
            memory(&half),
        );
        assert!(exact.dispatches.len() <= plan.passes().len(), "{}: more than one a pass", spec.id);
        assert!(
            exact.dispatches.len() < plan.passes().len() || spec.id == "painting",
            "{} joins nothing",
            spec.id
        );
        assert!(before * 5 > after * 6, "{}: {before} bytes, and still {after}", spec.id);
        let names = half.dispatches.iter().map(|dispatch| &dispatch.shader.name);
        let filtered = names.filter(|name| name.contains("/filtered")).count();
        assert!(
            filtered > 0 || !["cartoon", "coherent", "ink"].contains(&spec.id),
            "{} samples nothing",
            spec.id
        );
    }
}

/// Cartoons with lines as the thesis has them, and with lines that are weighed by what is around them, which needs windows at
/// several levels and three differences of Gaussians: the most dispatches, bytes a pixel and MiB of textures.
type Bounds = (usize, f64, u64);
const CARTOONS: [(&[(&str, &str)], Bounds); 2] = [
    (
        &[("steps", "levels"), ("local_contrast", "0"), ("inhibition", "0"), ("colour_edges", "0")],
        (14, 345.0, 122),
    ),
    (&[], (41, 744.0, 279)),
];

#[test]
fn a_frame_of_a_cartoon_moves_few_bytes() {
    // It is what a viewer computes all the time.
    let size = [1920, 1080];
    for (params, most) in CARTOONS {
        let half = program(&plan_with("cartoon", size, params), Precision::Fast);
        let bytes = half.bytes_moved() as f64 / f64::from(size[0] * size[1]);
        let mebibytes = half.textures.iter().map(|t| t.bytes()).sum::<u64>() >> 20;
        let found = (half.dispatches.len(), bytes, mebibytes);
        assert!(found.0 <= most.0 && found.1 <= most.1 && found.2 <= most.2, "{found:?} of {most:?}");
    }
}

#[test]
fn pictures_of_styles_keep_their_quality() {
    let Some(mut gpu) = device::executor("precision") else { return };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scene.png");
    let scene = png::read(&path).expect("the frame of the demo scene is there");
    let pictures = [
        ("scene", scene),
        ("landscape", scenery::landscape(180)),
        ("cut out", pictures::color(Kind::CutOut, 160, 120)),
    ];
    let mut wrong = Vec::new();
    for spec in registry::nodes().iter().filter(|spec| spec.group == "styles") {
        for (name, picture) in &pictures {
            let plan = plan(spec.id, [picture.width(), picture.height()]);
            let mut run = |precision| {
                gpu.set_precision(precision);
                let region = Rect::of_size(picture.width(), picture.height());
                let results = gpu.run_images(&plan, &[("color", picture)], region, Control::default());
                results.expect("it runs").remove(0)
            };
            let exact: Image = run(Precision::Exact);
            for precision in [Precision::Half, Precision::Fast] {
                let quality = psnr(&exact, &run(precision));
                println!("{} on {name}, {precision:?}: {quality:.1} dB", spec.id);
                let least = match (spec.id, *name) {
                    (_, "cut out") => LEAST_FLAT,
                    ("coherent", "scene") => LEAST_SHARPENED,
                    _ => LEAST,
                };
                if quality < least {
                    wrong.push(format!("{} on {name}, {precision:?}: {quality:.1} dB", spec.id));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "too far from exact:\n{}", wrong.join("\n"));
}

#[test]
fn light_of_any_strength_stays_finite() {
    let Some(mut gpu) = device::executor("precision") else { return };
    gpu.set_precision(Precision::Fast);
    let picture = pictures::color(Kind::Hdr, 67, 43);
    for spec in registry::nodes().iter().filter(|spec| spec.output.kind == ImageKind::Color) {
        if spec.inputs.iter().any(|port| !port.optional && port.kind != ImageKind::Color) {
            continue;
        }
        let mut request = Request::new(67, 43);
        request.space = isophote::ColourSpace::Linear;
        let graph = Graph::single(spec.id).expect("the node is there");
        let planned = Planned::new(&graph, request).expect("it can be planned");
        let region = Rect::of_size(67, 43);
        let result = gpu.run_images(planned.plan(), &[("color", &picture)], region, Control::default());
        let image = result.expect("it runs").remove(0);
        assert!(image.data().iter().all(|v| v.is_finite()), "{}", spec.id);
    }
}
