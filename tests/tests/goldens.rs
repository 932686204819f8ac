//! Golden images: each node on a generated test card, two styles on a frame of the demo scene, and a cartoon on forms that a
//! renderer knows, as they were last looked at and found right.
//!
//! `cargo xtask bless` makes them anew. Nothing else does: a missing one is a failure. What differs is written to `target/isophote-tests`.

use isophote::frames::Frames;
use isophote::graph::GraphInput;
use isophote::registry;
use isophote::request::Guides;
use isophote::spec::{ImageKind, NodeSpec};
use isophote::things::{ThingRule, Things};
use isophote::{Graph, Planned, Request, Value};
use isophote_engine::cpu::Control;
use isophote_engine::plan::Port;
use isophote_engine::{Image, Plan, Rect};
use isophote_tests::pictures::{self, from_fn};
use isophote_tests::trials::Trials;
use isophote_tests::{cases, device, png, run, scenery};
use std::path::{Path, PathBuf};

/// Steps of 8 bits that a value may be off before it counts.
const STEP_LIMIT: f32 = 3.5 / 255.0;

/// Share of values that may be off by more: a line may move by a pixel where a comparison turns on
/// the last bit.
const SHARE_LIMIT: f64 = 0.004;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("goldens")
}

fn is_blessing() -> bool {
    std::env::var("ISOPHOTE_BLESS").is_ok_and(|v| v == "1")
}

fn card() -> Image {
    pictures::test_card(192, 128)
}

/// The committed frame of the demo scene.
fn scene() -> Image {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scene.png");
    png::read(&path).unwrap_or_else(|e| panic!("the frame of the demo scene is missing: {e}"))
}

/// A result as a picture without transparency, as it is stored.
fn shown(spec: &NodeSpec, image: &Image) -> Image {
    from_fn(image.width(), image.height(), |x, y| {
        let v = image.pixel(x, y);
        let [r, g, b] = match spec.output.kind {
            // Premultiplied over mid-grey, so that coverage shows too.
            ImageKind::Color => [0, 1, 2].map(|c| v[c] + 0.5 * (1.0 - v[3])),
            // The square roots spread the dark parts, where most edges lie.
            ImageKind::Tensor => [v[0].max(0.0).sqrt(), 0.5 + v[1], v[2].max(0.0).sqrt()],
            // Mid-grey is no motion.
            ImageKind::Motion => [0.5 + 0.05 * v[0], 0.5 + 0.05 * v[1], 0.5],
            _ => [v[0]; 3],
        };
        let store = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() / 255.0;
        [store(r), store(g), store(b), 1.0]
    })
}

/// Parameters and their values, as text.
type Values = &'static [(&'static str, &'static str)];

/// Cartoons of forms that a renderer knows: their names, values, and guides beside normals, depth and numbers of objects.
const OF_FORMS: [(&str, Values, &[GraphInput]); 4] = [
    (
        "cartoon-sets",
        &[("line_colors", "kinds"), ("line_gap", "8"), ("taper", "8"), ("line_width", "3")],
        &[],
    ),
    ("cartoon-dots", &[("dots", "1"), ("dot_spacing", "7")], &[]),
    ("cartoon-light", &[("shading", "light")], &[GraphInput::Albedo, GraphInput::Diffuse]),
    (RULED, &[("line_width", "3")], &[]),
];

/// The one whose things have rules.
const RULED: &str = "cartoon-ruled";

/// Rules for the forms: red lines on the large ball, none on the small one, wide ones on the roof.
fn rules() -> Vec<ThingRule> {
    let rule = |number, control, line_color| ThingRule {
        things: Things::Numbers(vec![number]),
        control,
        line_color,
    };
    vec![
        rule(1, [None; 4], Some([0.8, 0.1, 0.1, 1.0])),
        rule(2, [None, None, Some(0.0), None], None),
        rule(5, [None, Some(0.6), None, None], Some([0.1, 0.2, 0.7, 1.0])),
    ]
}

/// A picture of the forms by its name.
fn form(name: &str) -> Image {
    let known = |name: &str| {
        scenery::forms().iter().find(|(known, _)| *known == name).map(|(_, image)| image.clone())
    };
    let color = || known("color").unwrap();
    match name {
        // Surfaces of one colour, which have all light that is seen.
        "albedo" => from_fn(color().width(), color().height(), |_, _| [0.45, 0.4, 0.4, 1.0]),
        "diffuse" => color(),
        name => known(name).unwrap(),
    }
}

/// The plan of a cartoon of the forms.
fn plan_of_forms(name: &str) -> Option<Planned> {
    let (_, settings, more) = OF_FORMS.iter().find(|(known, ..)| *known == name)?;
    let mut graph = Graph::single("cartoon").unwrap();
    let node = graph.node(0).unwrap();
    settings.iter().for_each(|(param, value)| graph.set_text(node, param, value).unwrap());
    if name == RULED {
        graph.set_rules(rules());
    }
    let known = [GraphInput::Normal, GraphInput::Depth, GraphInput::ObjectId];
    let guides = Guides::of(|guide| known.contains(&guide) || more.contains(&guide));
    let color = form("color");
    Some(run::planned(&graph, Request { guides, ..Request::new(color.width(), color.height()) }))
}

fn plan(Golden { name, spec, .. }: &Golden, input: &Image) -> Planned {
    if let Some(planned) = plan_of_forms(name) {
        return planned;
    }
    let setup = cases::setup(spec, false);
    // The frame of the scene is small: half the lengths suit its detail.
    let scale = if input.width() > 200 { 0.5 } else { 1.0 };
    let request = Request { scale, ..Request::new(input.width(), input.height()) };
    if !is_of_time(spec) {
        return run::planned(&setup.graph, request);
    }
    let guides = Guides::of(|input| matches!(input, GraphInput::Motion | GraphInput::MotionForward));
    run::planned(&setup.graph, Request { guides, frames: Frames::around(2, 2), max_motion: 8.0, ..request })
}

/// True where a node does something to neighbouring frames with its defaults.
fn is_of_time(spec: &NodeSpec) -> bool {
    let is_steady = spec.params().any(|p| p.id == "steadiness" && p.default != Value::Float(0.0));
    is_steady || spec.output.kind == ImageKind::Motion
}

/// Inputs of a plan: the forms as a renderer knows them; the picture; or where it knows of time a camera that moves over it, with noise on each frame.
fn inputs(Golden { name, spec, .. }: &Golden, plan: &Plan, picture: &Image) -> Vec<(String, Image)> {
    let is_of_forms = OF_FORMS.iter().any(|(known, ..)| known == name);
    let enters = |port: &Port| {
        if is_of_forms {
            return form(&port.name);
        }
        let way = match GraphInput::from_id(port.base()) {
            Some(GraphInput::Motion) => -1.0,
            Some(GraphInput::MotionForward) => 1.0,
            _ if is_of_time(spec) => {
                let moved = pictures::moved(picture, [3 * port.frame, -2 * port.frame]);
                return pictures::noisy(moved, 0.08, (40 + port.frame) as u64);
            }
            _ => return picture.clone(),
        };
        from_fn(picture.width(), picture.height(), |_, _| [3.0 * way, -2.0 * way])
    };
    plan.inputs().iter().map(|port| (port.name.clone(), enters(port))).collect()
}

/// Compares with the golden image `name`, or makes it. Returns what is wrong.
fn check(name: &str, executor: &str, picture: &Image) -> Option<String> {
    let path = folder().join(format!("{name}.png"));
    if is_blessing() {
        if executor == "cpu" {
            std::fs::create_dir_all(folder()).unwrap();
            png::write(&path, picture);
        }
        return None;
    }
    let golden = match png::read(&path) {
        Ok(golden) => golden,
        Err(e) => return Some(format!("{name}: no golden image ({e}); look at the result and bless it")),
    };
    if (golden.width(), golden.height()) != (picture.width(), picture.height()) {
        return Some(format!("{name}: the golden image is of {}x{}", golden.width(), golden.height()));
    }
    let pairs = golden.data().iter().zip(picture.data());
    let far = pairs.clone().filter(|(a, b)| (*a - *b).abs() > STEP_LIMIT).count();
    let mean = pairs.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / golden.data().len() as f64;
    let share = far as f64 / golden.data().len() as f64;
    println!(
        "{name} on the {executor}: mean difference {:.3} of 255, {share:.5} beyond the limit",
        255.0 * mean
    );
    if share <= SHARE_LIMIT && mean <= 0.35 / 255.0 {
        return None;
    }
    let (w, h) = (picture.width(), picture.height());
    let difference = from_fn(w, h, |x, y| {
        let (a, b) = (golden.pixel(x, y), picture.pixel(x, y));
        [4.0 * (a[0] - b[0]).abs(), 4.0 * (a[1] - b[1]).abs(), 4.0 * (a[2] - b[2]).abs(), 1.0]
    });
    let stem = png::results().join(format!("{name}-{executor}"));
    png::write(&stem.with_extension("png"), picture);
    png::write(&png::results().join(format!("{name}-{executor}-difference.png")), &difference);
    Some(format!(
        "{name} on the {executor}: mean difference {:.2} of 255, {:.2} % differ; see {}",
        255.0 * mean,
        100.0 * share,
        stem.display()
    ))
}

/// One golden image: its name, the node and the input.
#[derive(Clone)]
struct Golden {
    name: String,
    spec: &'static NodeSpec,
    input: fn() -> Image,
}

/// Every golden image.
fn all() -> Vec<Golden> {
    let of_node = |spec: &&'static NodeSpec| Golden { name: spec.id.to_owned(), spec, input: card };
    let mut all: Vec<Golden> = registry::nodes().iter().map(of_node).collect();
    for style in ["cartoon", "blueprint"] {
        let spec = registry::find(style).unwrap();
        all.push(Golden { name: format!("{style}-on-scene"), spec, input: scene });
    }
    let cartoon = registry::find("cartoon").unwrap();
    let of_forms = |(name, ..): &(&str, _, _)| Golden {
        name: (*name).to_owned(),
        spec: cartoon,
        input: || form("color"),
    };
    all.extend(OF_FORMS.iter().map(of_forms));
    all
}

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for golden in all() {
        let again = golden.clone();
        trials.add("goldens::cpu", &golden.name, move || the_cpu_gives_the_golden_image(&again));
        trials.add("goldens::gpu", golden.name.clone(), move || the_gpu_gives_the_golden_image(&golden));
    }
    trials.add_plain("goldens::every_one_belongs_to_a_node_and_all_are_small", || {
        every_golden_image_belongs_to_a_node_and_all_are_small();
    });
}

fn the_cpu_gives_the_golden_image(golden: &Golden) -> Vec<String> {
    let input = (golden.input)();
    let planned = plan(golden, &input);
    let inputs = inputs(golden, planned.plan(), &input);
    let named: Vec<(&str, Image)> =
        inputs.iter().map(|(name, image)| (name.as_str(), image.clone())).collect();
    let result = run::whole(planned.plan(), &named);
    check(&golden.name, "cpu", &shown(golden.spec, &result)).into_iter().collect()
}

fn the_gpu_gives_the_golden_image(golden: &Golden) -> Option<Vec<String>> {
    if is_blessing() {
        return Some(Vec::new());
    }
    let mut gpu = device::executor(&golden.name)?;
    let input = (golden.input)();
    let planned = plan(golden, &input);
    let region = Rect::of_size(input.width(), input.height());
    let inputs = inputs(golden, planned.plan(), &input);
    let named: Vec<(&str, &Image)> = inputs.iter().map(|(name, image)| (name.as_str(), image)).collect();
    let images = gpu.run_images(planned.plan(), &named, region, Control::default()).unwrap();
    Some(check(&golden.name, "gpu", &shown(golden.spec, &images[0])).into_iter().collect())
}

fn every_golden_image_belongs_to_a_node_and_all_are_small() {
    if is_blessing() {
        return;
    }
    let names: Vec<String> = all().into_iter().map(|golden| format!("{}.png", golden.name)).collect();
    let mut bytes = 0;
    for file in std::fs::read_dir(folder()).unwrap().flatten() {
        let name = file.file_name().into_string().unwrap();
        assert!(names.contains(&name), "{name} belongs to no node");
        bytes += file.metadata().unwrap().len();
    }
    assert!(bytes < 2 << 20, "the golden images have grown to {bytes} bytes");
}
