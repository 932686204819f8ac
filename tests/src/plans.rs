//! Every node of the registry, planned in many ways: sizes, pictures, parameter sets, guides, proxies.

use crate::cases::{self, Setting};
use crate::pictures::Kind;
use crate::run;
use isophote::Request;
use isophote::spec::{ImageKind, NodeSpec};
use isophote::things::ThingRule;
use isophote_engine::Plan;
use isophote_engine::plan::Pass;
use std::collections::BTreeSet;

/// Sizes of the pictures: one pixel, less than a vector and a workgroup, and odd ends of both.
pub const SIZES: [[u32; 2]; 3] = [[1, 1], [7, 5], [67, 43]];

/// Random parameter sets per node and size.
const RANDOM_SETS: usize = 6;

/// Multiply-adds that one plan may take at one size; costlier parameter sets appear on the smaller
/// sizes only.
const COST_LIMIT: f64 = 3e8;

/// A node's plan and what enters it.
#[derive(Clone, Debug)]
pub struct Case {
    /// Node, parameter set, picture and size, for messages.
    pub label: String,
    /// The plan.
    pub plan: Plan,
    /// Picture that enters.
    pub kind: Kind,
    /// Its size.
    pub size: [u32; 2],
    /// For each image of the plan: the generated field that later passes read instead of what its
    /// producer makes, which is tamer.
    pub fields: Vec<Option<ImageKind>>,
}

/// Request of a full picture, of a kind and a size.
type FullRequest = fn(Kind, u32, u32) -> Request;

/// Variant in which a node is planned.
struct Variant {
    setting: Setting,
    wired: bool,
    kind: Kind,
    guides: bool,
    /// Request of the full picture.
    request: FullRequest,
    scale: f32,
    rules: Vec<ThingRule>,
}

/// All cases, the smallest pictures first.
pub fn all() -> Vec<Case> {
    let mut all = Vec::new();
    for size in SIZES {
        for spec in isophote::registry::nodes() {
            all.extend(variants(spec).iter().filter_map(|variant| planned(spec, variant, size)));
        }
    }
    all
}

/// Defaults on every kind of picture, with and without guides and connected fields, and as proxies; the
/// other parameter sets take turns.
fn variants(spec: &'static NodeSpec) -> Vec<Variant> {
    let (fields, guides) = (cases::has_optional_field(spec), cases::has_guides(spec));
    let mut all = Vec::new();
    let mut add = |setting: &Setting, wired, kind, guides, scale| {
        let request = if guides { with_guides } else { without_guides };
        let rules = Vec::new();
        all.push(Variant { setting: setting.clone(), wired, kind, guides, request, scale, rules });
    };
    let settings = cases::settings(spec, RANDOM_SETS);
    let Some((default, others)) = settings.split_first() else { return all };
    for kind in Kind::ALL {
        add(default, false, kind, false, 1.0);
        if fields || guides {
            add(default, fields, kind, guides, 1.0);
        }
    }
    for (index, setting) in (1..).zip(others) {
        let turn = |n: usize| (index / n) % 2 == 1;
        add(setting, fields && turn(2), Kind::ALL[index % Kind::ALL.len()], guides && turn(1), 1.0);
    }
    for kind in Kind::ALL {
        add(default, false, kind, false, 0.5);
    }
    let plain = Vec::new;
    let others: [(_, FullRequest, _); 9] = [
        (cases::carrying(spec), cases::request_without_rest, plain()),
        (cases::fading(spec), with_guides, plain()),
        (cases::by_distance(spec), with_guides, plain()),
        (cases::dotted(spec), with_guides, plain()),
        (cases::in_sets(spec), with_guides, plain()),
        (cases::on_materials(spec), cases::request_on_materials, plain()),
        (cases::ruled(spec), cases::request_on_materials, cases::rules()),
        (cases::ruled(spec), cases::request_of_numbers, cases::rules()),
        (cases::ruled(spec), cases::request_of_names, cases::rules()),
    ];
    for (setting, request, rules) in others {
        all.extend(setting.into_iter().flat_map(|setting| {
            Kind::ALL.map(|kind| Variant {
                setting: setting.clone(),
                wired: false,
                kind,
                guides: true,
                request,
                scale: 1.0,
                rules: rules.clone(),
            })
        }));
    }
    all
}

fn with_guides(kind: Kind, width: u32, height: u32) -> Request {
    cases::request(kind, width, height, true)
}

fn without_guides(kind: Kind, width: u32, height: u32) -> Request {
    cases::request(kind, width, height, false)
}

/// The case of a variant, unless it takes too long, or is a proxy whose kernels the full picture has.
fn planned(spec: &'static NodeSpec, variant: &Variant, size: [u32; 2]) -> Option<Case> {
    let ([width, height], &Variant { wired, kind, guides, scale, request, .. }) = (size, variant);
    let mut setup = cases::setup(spec, wired);
    variant.setting.apply(&mut setup.graph, setup.node);
    cases::rule(&mut setup.graph, variant.rules.clone());
    let full = request(kind, width, height);
    let request = Request { scale, ..full };
    let plan = run::planned(&setup.graph, request).plan().clone();
    let kernels = |plan: &Plan| plan.passes().iter().map(|p| p.kernel.name).collect::<BTreeSet<_>>();
    if scale < 1.0 && kernels(run::planned(&setup.graph, full).plan()).is_superset(&kernels(&plan)) {
        return None;
    }
    if cost(&plan) > COST_LIMIT {
        return None;
    }
    let mut fields = vec![None; plan.images().len()];
    for producer in &setup.producers {
        let mut graph = setup.graph.clone();
        if graph.set_output(*producer).is_err() {
            continue;
        }
        let image = run::planned(&graph, request).plan().outputs()[0].image;
        fields[image.index()] = Some(graph.spec(*producer).map_or(ImageKind::Scalar, |s| s.output.kind));
    }
    let label = format!(
        "{} ({}) {kind:?} {width}x{height} wired={wired} guides={guides} at {scale}",
        spec.id, variant.setting.label
    );
    Some(Case { label, plan, kind, size, fields })
}

/// Multiply-adds of a whole plan.
pub fn cost(plan: &Plan) -> f64 {
    let pixels = |pass: &Pass| {
        let [w, h] = plan.level_size(plan.desc(pass.outputs[0]).level);
        f64::from(w) * f64::from(h)
    };
    plan.passes().iter().map(|p| (p.kernel.cost)(&p.params) * pixels(p)).sum()
}
