//! No slider of a look is idle: over its whole range it changes the picture, visibly and ever farther, in each style and
//! preset in which it has an effect at all.

use isophote::request::Guides;
use isophote::spec::{NodeSpec, Param};
use isophote::{Graph, Planned, Request, Value};
use isophote_engine::Image;
use isophote_tests::run;
use isophote_tests::scenery::forms;
use isophote_tests::trials::Trials;

/// Positions along a slider.
const STEPS: usize = 5;
/// Least change from end to end, root of the mean square.
const LEAST: f64 = 1.4 / 255.0;
/// Least share of it between two positions.
const LEAST_STEP: f64 = 0.03;

/// Sliders whose positions are patterns of their own, each as far from the first as any other, or that begin at off.
const PATTERNS: [(&str, &str); 11] = [
    ("blueprint", "grid"),
    ("blueprint", "wobble"),
    ("cartoon", "wobble"),
    ("oil_paint", "stroke_length"),
    ("oil_paint", "stroke_width"),
    ("oil_paint", "light_angle"),
    ("watercolor", "wobble"),
    ("halftone", "cell"),
    ("halftone", "angle"),
    ("halftone", "misregistration"),
    ("coherent", "posterize"),
];

/// The slider of what texture and blur do not have, of which the forms have none.
const FOUND: &str = "importance";

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in isophote::registry::nodes().iter().filter(|spec| spec.group == "styles") {
        for preset in presets(spec) {
            for param in spec.params().filter(|p| p.group == "look" && is_number(p) && p.id != FOUND) {
                let name = format!("{} {} {}", spec.id, preset.unwrap_or_default(), param.id);
                trials.add("sliders", &name, move || changes_the_picture(spec, preset, param));
            }
        }
    }
}

/// The options of `style`, where there is such a choice.
fn presets(spec: &NodeSpec) -> Vec<Option<&'static str>> {
    match spec.param("style") {
        Some((_, style)) => style.options.iter().map(|option| Some(option.id)).collect(),
        None => vec![None],
    }
}

fn is_number(param: &Param) -> bool {
    matches!(param.default, Value::Float(_) | Value::Int(_))
}

fn planned(spec: &NodeSpec, preset: Option<&str>, param: &Param, value: f32) -> Planned {
    let mut graph = Graph::single(spec.id).unwrap();
    let node = graph.node(0).unwrap();
    if let Some(preset) = preset {
        graph.set_text(node, "style", preset).unwrap();
    }
    graph.set(node, param.id, param.nearest([f64::from(value); 4])).unwrap();
    let guides = Guides { normal: true, depth: true, object_id: true, ..Guides::default() };
    let color = &forms()[0].1;
    run::planned(&graph, Request { guides, ..Request::new(color.width(), color.height()) })
}

fn difference(a: &Image, b: &Image) -> f64 {
    let squares: f64 = a.data().iter().zip(b.data()).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (squares / a.data().len() as f64).sqrt()
}

fn changes_the_picture(spec: &NodeSpec, preset: Option<&str>, param: &Param) {
    let [low, high] = param.slider;
    let at = |step: usize| low + (high - low) * step as f32 / (STEPS - 1) as f32;
    let results: Vec<Image> =
        (0..STEPS).map(|step| run::whole(planned(spec, preset, param, at(step)).plan(), forms())).collect();
    // What has no effect in this preset shows in no panel: its plans are the same.
    let [first, last] = [low, high].map(|value| planned(spec, preset, param, value));
    if has_same_work(&first, &last) {
        return;
    }
    let away: Vec<f64> = results.iter().map(|result| difference(result, &results[0])).collect();
    let left: Vec<f64> = results.iter().map(|result| difference(result, &results[STEPS - 1])).collect();
    let total = away.iter().copied().fold(0.0, f64::max);
    assert!(total >= LEAST, "{:.2}/255 at most", total * 255.0);
    for step in 1..STEPS {
        let moved = difference(&results[step], &results[step - 1]);
        assert!(moved >= LEAST_STEP * total, "{} to {}: {:.3}/255", at(step - 1), at(step), moved * 255.0);
    }
    let goes_on = away.windows(2).all(|pair| pair[1] >= pair[0] * 0.98);
    let comes_near = left.windows(2).all(|pair| pair[1] <= pair[0] * 1.02);
    let is_pattern = PATTERNS.contains(&(spec.id, param.id));
    assert!(
        is_pattern || goes_on || comes_near,
        "it turns back: {away:.4?} from {low}, {left:.4?} to {high}"
    );
}

fn has_same_work(a: &Planned, b: &Planned) -> bool {
    let (a, b) = (a.plan().passes(), b.plan().passes());
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| std::ptr::eq(a.kernel, b.kernel) && a.params == b.params)
}
