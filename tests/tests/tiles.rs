//! A part of a picture computed alone is the same part of the whole, bit for bit on the CPU, whatever
//! the threads; other instruction sets differ by rounding only; a proxy looks like the full frame.

use isophote::Planned;
use isophote::Request;
use isophote::spec::{ImageKind, NodeSpec};
use isophote_engine::cpu::{CallingThread, CpuExecutor, Pool, Threads};
use isophote_engine::dispatch::levels;
use isophote_engine::fearless_simd::Level;
use isophote_engine::{Image, Plan, Rect, Support};
use isophote_tests::cases::{self, Setting};
use isophote_tests::compare::{distance, psnr};
use isophote_tests::pictures::{self, Kind};
use isophote_tests::trials::Trials;
use isophote_tests::{run, sweep};
use std::sync::OnceLock;

const SIZE: [u32; 2] = [61, 37];

/// Odd offsets, odd widths, single pixels, whole rows and columns, all four corners.
const TILES: [[i32; 4]; 12] = [
    [13, 5, 42, 30],
    [17, 11, 24, 36],
    [0, 0, 1, 1],
    [60, 36, 61, 37],
    [30, 18, 31, 19],
    [0, 7, 61, 8],
    [29, 0, 30, 37],
    [0, 0, 19, 13],
    [45, 23, 61, 37],
    [1, 20, 10, 37],
    [52, 0, 61, 3],
    [8, 8, 16, 16],
];

/// Multiply-adds of one plan that this test spends at most.
const COST_LIMIT: f64 = 4e8;

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in isophote::registry::nodes() {
        trials.add("tiles", spec.id, || a_tile_is_the_same_part_of_the_full_frame(spec));
        trials.add("rows", spec.id, || rows_give_what_the_full_frame_gives(spec));
        trials.add("threads", spec.id, || the_number_of_threads_changes_nothing(spec));
        trials.add("instruction_sets", spec.id, || instruction_sets_differ_by_rounding_only(spec));
        trials.add("proxies", spec.id, || a_proxy_looks_like_the_full_frame(spec));
    }
    trials.add_plain("tiles::most_nodes_are_local", most_nodes_are_local);
}

/// Or nothing would have been compared above.
fn most_nodes_are_local() {
    let nodes = isophote::registry::nodes();
    let is_local = |spec: &&&'static NodeSpec| {
        let setup = cases::setup(spec, false);
        run::planned(&setup.graph, Request::new(SIZE[0], SIZE[1])).plan().support() != Support::Global
    };
    let local = nodes.iter().filter(is_local).count();
    assert!(2 * local > nodes.len(), "only {local} of {} nodes", nodes.len());
}

struct Run {
    label: String,
    planned: Planned,
    inputs: Vec<(String, Image)>,
}

/// The node with several parameter sets, pictures and guides.
fn runs(spec: &'static NodeSpec, size: [u32; 2]) -> Vec<Run> {
    let mut all = Vec::new();
    for (index, setting) in cases::settings(spec, 3).into_iter().enumerate() {
        let kind = Kind::ALL[(index + 2) % Kind::ALL.len()];
        let wired = cases::has_optional_field(spec) && index % 2 == 1;
        let run = one(spec, &setting, kind, wired, takes_more(spec) && index % 3 == 1, size);
        if cost(run.planned.plan()) < COST_LIMIT {
            all.push(run);
        }
    }
    if let Some(setting) = cases::fading(spec) {
        all.push(one(spec, &setting, Kind::Steps, false, true, size));
    }
    if let Some(setting) = cases::carrying(spec) {
        let request = cases::request_without_rest(Kind::Steps, size[0], size[1]);
        all.push(planned(spec, &setting, false, Kind::Steps, request));
    }
    if let Some(setting) = cases::on_materials(spec) {
        let request = cases::request_on_materials(Kind::Steps, size[0], size[1]);
        all.push(planned(spec, &setting, false, Kind::Steps, request));
    }
    all
}

fn one(
    spec: &'static NodeSpec,
    setting: &Setting,
    kind: Kind,
    wired: bool,
    guides: bool,
    size: [u32; 2],
) -> Run {
    let request = cases::request(kind, size[0], size[1], guides);
    let run = planned(spec, setting, wired, kind, request);
    Run { label: format!("{} guides={guides}", run.label), ..run }
}

fn planned(spec: &'static NodeSpec, setting: &Setting, wired: bool, kind: Kind, request: Request) -> Run {
    let mut setup = cases::setup(spec, wired);
    setting.apply(&mut setup.graph, setup.node);
    let planned = run::planned(&setup.graph, request);
    let (names, size) = (planned.plan().inputs().iter().map(|port| port.name.clone()), planned.plan().size());
    let inputs = names.map(|name| (name.clone(), sweep::input(&name, kind, size))).collect();
    Run { label: format!("{} ({}) {kind:?}", spec.id, setting.label), planned, inputs }
}

/// True for nodes that read more than their picture where there is more.
fn takes_more(spec: &NodeSpec) -> bool {
    cases::has_guides(spec) || spec.has_mix()
}

fn cost(plan: &Plan) -> f64 {
    let [w, h] = plan.size();
    plan.passes().iter().map(|p| (p.kernel.cost)(&p.params)).sum::<f64>() * f64::from(w * h)
}

fn equal(a: &Image, b: &Image) -> bool {
    a.window() == b.window() && a.data().iter().zip(b.data()).all(|(a, b)| a.to_bits() == b.to_bits())
}

fn a_tile_is_the_same_part_of_the_full_frame(spec: &'static NodeSpec) -> Vec<String> {
    let mut wrong = Vec::new();
    let (mut compared, mut local) = (0, 0);
    for run in runs(spec, SIZE) {
        let plan = run.planned.plan();
        if plan.support() == Support::Global {
            continue;
        }
        local += 1;
        let full = run::whole(plan, &run.inputs);
        let mut executor = CpuExecutor::new();
        for [x0, y0, x1, y1] in TILES {
            let tile = Rect { x0, y0, x1, y1 };
            let alone = run::region(&mut executor, plan, &run.inputs, tile, &CallingThread);
            compared += 1;
            if !equal(&alone, &full.crop(tile).unwrap()) {
                let (worst, _) = distance(&alone, &full.crop(tile).unwrap());
                wrong.push(format!("{} {tile:?} differs by up to {worst:e}", run.label));
                break;
            }
        }
    }
    println!("tiles::{}: {compared} tiles of {local} plans compared", spec.id);
    wrong
}

fn rows_give_what_the_full_frame_gives(spec: &'static NodeSpec) -> Vec<String> {
    let mut wrong = Vec::new();
    for run in runs(spec, SIZE) {
        let plan = run.planned.plan();
        let full = run::whole(plan, &run.inputs);
        // Executors keep memory, in which there are then other images.
        let mut executor = CpuExecutor::new();
        for region in [Rect::of_size(SIZE[0], SIZE[1]), Rect { x0: 3, y0: 9, x1: 60, y1: 36 }] {
            for strip in [1, 5, 16] {
                executor.set_strip(Some(strip));
                let rows = run::by_rows(&mut executor, plan, &run.inputs, (region, 0), run::pool());
                if !equal(&rows, &full.crop(rows.window()).unwrap()) {
                    let (worst, _) = distance(&rows, &full.crop(rows.window()).unwrap());
                    wrong.push(format!("{} {region:?} by rows differs by up to {worst:e}", run.label));
                }
            }
        }
    }
    wrong
}

fn the_number_of_threads_changes_nothing(spec: &'static NodeSpec) -> Vec<String> {
    static POOLS: OnceLock<Vec<Pool>> = OnceLock::new();
    let pools = POOLS.get_or_init(|| [1, 2, 3, 7].map(Pool::new).into());
    let mut wrong = Vec::new();
    for run in runs(spec, SIZE).into_iter().step_by(2) {
        let plan = run.planned.plan();
        let all = Rect::of_size(SIZE[0], SIZE[1]);
        let mut executor = CpuExecutor::new();
        let reference = run::region(&mut executor, plan, &run.inputs, all, &CallingThread);
        for pool in pools {
            let other = run::region(&mut executor, plan, &run.inputs, all, pool);
            if !equal(&reference, &other) {
                wrong.push(format!("{} differs with {} threads", run.label, pool.count()));
            }
        }
    }
    wrong
}

fn instruction_sets_differ_by_rounding_only(spec: &'static NodeSpec) -> Vec<String> {
    let mut wrong = Vec::new();
    let default = &cases::settings(spec, 0)[0];
    let run = one(spec, default, Kind::Steps, false, takes_more(spec), SIZE);
    let all = Rect::of_size(SIZE[0], SIZE[1]);
    let by = |level| {
        let mut executor = CpuExecutor::with_level(level);
        run::region(&mut executor, run.planned.plan(), &run.inputs, all, run::pool())
    };
    let here = by(Level::new());
    // A stream line or a threshold may turn on the last bit; few pixels may.
    let scale = here.data().iter().fold(1e-3f32, |m, v| m.max(v.abs()));
    for (name, level) in levels() {
        let there = by(level);
        let far = here.data().iter().zip(there.data()).filter(|(a, b)| (*a - *b).abs() > 2e-3 * scale);
        let share = far.count() as f64 / here.data().len() as f64;
        println!("instruction_sets::{}: {share:.5} of the values differ on {name}", spec.id);
        if share > 0.01 || there.data().iter().any(|v| !v.is_finite()) {
            wrong.push(format!("{share:.4} of the values differ on {name}"));
        }
    }
    wrong
}

/// Means of 2 x 2 pixels.
fn halved(image: &Image) -> Image {
    let channels = image.channels() as usize;
    let (w, h) = (image.width() / 2, image.height() / 2);
    let mut data = Vec::new();
    for y in 0..h as i32 {
        for x in 0..w as i32 {
            for c in 0..channels {
                let at = |dx: i32, dy: i32| image.pixel(2 * x + dx, 2 * y + dy)[c];
                data.push(0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)));
            }
        }
    }
    Image::from_vec(w, h, image.channels(), data).unwrap()
}

/// The node's result with its defaults, its lengths scaled.
fn result(spec: &'static NodeSpec, image: &Image, scale: f32) -> Image {
    let setup = cases::setup(spec, false);
    let request = Request { scale, ..Request::new(image.width(), image.height()) };
    run::whole(run::planned(&setup.graph, request).plan(), &[("color", image.clone())])
}

fn a_proxy_looks_like_the_full_frame(spec: &'static NodeSpec) -> Vec<String> {
    // Tensors change with the gradient's scale, and views of them show noise that is not scaled.
    let takes_color = spec.inputs.iter().any(|p| p.kind == ImageKind::Color && !p.optional);
    if spec.output.kind == ImageKind::Tensor || !takes_color {
        return Vec::new();
    }
    let picture = pictures::scenery(256, 192);
    let small = halved(&picture);
    let full = halved(&result(spec, &picture, 1.0));
    let proxy = result(spec, &small, 0.5);
    let unscaled = result(spec, &small, 1.0);
    let (close, far) = (psnr(&full, &proxy), psnr(&full, &unscaled));
    println!("proxies::{:28} proxy {close:5.1} dB, without scaling {far:5.1} dB", spec.id);
    let mut wrong = Vec::new();
    if close < 20.0 {
        wrong.push(format!("a proxy is only {close:.1} dB like the full frame"));
    }
    let has_lengths = spec.params().any(|p| p.unit == isophote::spec::Unit::Pixels);
    if has_lengths && close < far {
        wrong.push(format!("a proxy is better without scaling its lengths ({far:.1} dB)"));
    }
    wrong
}
