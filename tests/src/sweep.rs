//! Every node of the registry, planned in many ways and run on the CPU pass by pass, so that each
//! pass can be repeated elsewhere on equal input.

use crate::cases::{self, Setting};
use crate::pictures::{self, Kind};
use crate::run;
use isophote::Request;
use isophote::graph::GraphInput;
use isophote::spec::{ImageKind, NodeSpec};
use isophote_engine::cpu::{Control, CpuExecutor};
use isophote_engine::{Image, Kernel, Plan, Rect};
use std::collections::{BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

/// Sizes of the pictures: one pixel, less than a vector and a workgroup, and odd ends of both.
pub const SIZES: [[u32; 2]; 3] = [[1, 1], [7, 5], [67, 43]];

/// Random parameter sets per node and size.
const RANDOM_SETS: usize = 6;

/// Multiply-adds that one plan may take at one size; costlier parameter sets appear on the smaller
/// sizes only.
const COST_LIMIT: f64 = 3e8;

/// One pass with its inputs and what the CPU made of them.
#[derive(Clone, Debug)]
pub struct Step {
    /// Node, parameter set, picture and size, for messages.
    pub label: String,
    /// The pass's kernel.
    pub kernel: &'static Kernel,
    /// The plan that the pass is of, and its place there.
    plan: Rc<Plan>,
    index: usize,
    /// The images read.
    pub inputs: Vec<Rc<Image>>,
    /// What the CPU twin gave.
    pub outputs: Vec<Rc<Image>>,
}

impl Step {
    /// A plan of this pass alone, run by `kernel`.
    ///
    /// # Panics
    /// When `kernel` has other bindings than the pass's own.
    pub fn plan_with(&self, kernel: &'static Kernel) -> Plan {
        match self.plan.single_pass(self.index, kernel) {
            Ok(plan) => plan,
            Err(e) => panic!("{e}"),
        }
    }

    /// The inputs by the names that a plan of one pass gives them.
    pub fn named_inputs(&self) -> Vec<(&'static str, &Image)> {
        const NAMES: [&str; 6] = ["0", "1", "2", "3", "4", "5"];
        NAMES.into_iter().zip(self.inputs.iter().map(Rc::as_ref)).collect()
    }

    /// The region that a plan of one pass is run for.
    pub fn region(&self) -> Rect {
        let [width, height] = self.plan.size();
        Rect::of_size(width, height)
    }
}

/// Plans every node with every parameter set and calls `visit` once for each distinct pass.
pub fn sweep(mut visit: impl FnMut(&Step)) {
    for size in SIZES {
        // Equal passes of different nodes and sets are computed once.
        let mut known = HashMap::new();
        for spec in cases::nodes() {
            for (case, wired, kind, guides) in combinations(spec) {
                one(spec, &case, wired, kind, guides, size, 1.0, &mut known, &mut visit);
            }
            // Some passes are those of proxies alone.
            let [case, ..] = &cases::settings(spec, 0)[..] else { continue };
            for kind in Kind::ALL {
                one(spec, case, false, kind, false, size, 0.5, &mut known, &mut visit);
            }
        }
    }
}

/// Defaults on every kind of picture, with and without guides and connected fields; the other sets
/// take turns.
fn combinations(spec: &'static NodeSpec) -> Vec<(Setting, bool, Kind, bool)> {
    let (fields, guides) = (cases::has_optional_field(spec), cases::has_guides(spec));
    let mut all = Vec::new();
    for (index, case) in cases::settings(spec, RANDOM_SETS).into_iter().enumerate() {
        if index == 0 {
            for kind in Kind::ALL {
                all.push((case.clone(), false, kind, false));
                if fields || guides {
                    all.push((case.clone(), fields, kind, guides));
                }
            }
            continue;
        }
        let turn = |n: usize| (index / n) % 2 == 1;
        all.push((case, fields && turn(2), Kind::ALL[index % Kind::ALL.len()], guides && turn(1)));
    }
    all
}

fn one(
    spec: &'static NodeSpec,
    setting: &Setting,
    wired: bool,
    kind: Kind,
    guides: bool,
    size: [u32; 2],
    scale: f32,
    known: &mut HashMap<u64, Vec<Rc<Image>>>,
    visit: &mut impl FnMut(&Step),
) {
    let [width, height] = size;
    let mut setup = cases::setup(spec, wired);
    setting.apply(&mut setup.graph, setup.node);
    let full = cases::request(kind, width, height, guides);
    let request = Request { scale, ..full };
    let plan = Rc::new(run::planned(&setup.graph, request).plan().clone());
    let kernels = |plan: &Plan| plan.passes().iter().map(|p| p.kernel.name).collect::<BTreeSet<_>>();
    if scale < 1.0 && kernels(run::planned(&setup.graph, full).plan()).is_superset(&kernels(&plan)) {
        return;
    }
    let pixels = |plan: &Plan, pass: &isophote_engine::plan::Pass| {
        let [w, h] = plan.level_size(plan.desc(pass.outputs[0]).level);
        f64::from(w) * f64::from(h)
    };
    let cost: f64 = plan.passes().iter().map(|p| (p.kernel.cost)(&p.params) * pixels(&plan, p)).sum();
    if cost > COST_LIMIT {
        return;
    }
    let label = format!(
        "{} ({}) {kind:?} {width}x{height} wired={wired} guides={guides} at {scale}",
        spec.id, setting.label
    );
    let mut slots: Vec<Option<Rc<Image>>> = vec![None; plan.images().len()];
    for port in plan.inputs() {
        slots[port.image.index()] = Some(Rc::new(input(&port.name, kind, size)));
    }
    // Fields that feed the node are generated, which is harsher than what its producers would make.
    let mut given = vec![None; plan.images().len()];
    for producer in &setup.producers {
        let mut graph = setup.graph.clone();
        if graph.set_output(*producer).is_err() {
            continue;
        }
        let made = run::planned(&graph, request);
        let image = made.plan().outputs()[0].image;
        let kind = graph.spec(*producer).map_or(ImageKind::Scalar, |s| s.output.kind);
        given[image.index()] = Some(Rc::new(pictures::field(kind, width, height)));
    }
    for (index, pass) in plan.passes().iter().enumerate() {
        let inputs: Vec<Rc<Image>> = pass.inputs.iter().filter_map(|i| slots[i.index()].clone()).collect();
        assert_eq!(inputs.len(), pass.inputs.len(), "{label}: pass {index} reads what nobody wrote");
        let key = key(&plan, index, &inputs);
        let outputs = match known.get(&key) {
            Some(outputs) => outputs.clone(),
            None => {
                let step = Step {
                    label: format!("{label} pass {index}"),
                    kernel: pass.kernel,
                    plan: Rc::clone(&plan),
                    index,
                    inputs,
                    outputs: Vec::new(),
                };
                let step = Step { outputs: on_cpu(&step), ..step };
                visit(&step);
                known.insert(key, step.outputs.clone());
                step.outputs
            }
        };
        for (id, image) in pass.outputs.iter().zip(outputs) {
            slots[id.index()] = Some(given[id.index()].take().unwrap_or(image));
        }
    }
}

fn on_cpu(step: &Step) -> Vec<Rc<Image>> {
    let plan = step.plan_with(step.kernel);
    let run =
        CpuExecutor::new().run(&plan, &step.named_inputs(), step.region(), &run::CALLING, Control::default());
    match run {
        Ok(images) => images.into_iter().map(Rc::new).collect(),
        Err(e) => panic!("{}: {e}", step.label),
    }
}

/// The picture or guide that enters a plan under `name`.
///
/// # Panics
/// For a name that graphs do not have.
pub fn input(name: &str, kind: Kind, [width, height]: [u32; 2]) -> Image {
    match GraphInput::from_id(name) {
        Some(GraphInput::Color) => pictures::color(kind, width, height),
        Some(guide) if kind == Kind::Broken => pictures::broken(pictures::field(guide.kind(), width, height)),
        Some(guide) => pictures::field(guide.kind(), width, height),
        None => panic!("no graph has an input '{name}'"),
    }
}

fn key(plan: &Plan, index: usize, inputs: &[Rc<Image>]) -> u64 {
    let pass = &plan.passes()[index];
    let mut hasher = DefaultHasher::new();
    pass.kernel.name.hash(&mut hasher);
    pass.params.hash(&mut hasher);
    pass.support.hash(&mut hasher);
    for id in pass.inputs.iter().chain(&pass.outputs) {
        plan.desc(*id).hash(&mut hasher);
    }
    for image in inputs {
        bytemuck::cast_slice::<f32, u8>(image.data()).hash(&mut hasher);
    }
    hasher.finish()
}
