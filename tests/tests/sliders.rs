//! No slider of a look is idle: over its whole range it changes the picture, visibly and ever farther, in each style and
//! preset in which it has an effect at all.

use isophote::request::{Guides, Planned};
use isophote::spec::{NodeSpec, Param};
use isophote::{Graph, Request, Value};
use isophote_engine::Image;
use isophote_tests::pictures::from_fn;
use isophote_tests::run;
use isophote_tests::trials::Trials;
use std::process::ExitCode;
use std::sync::OnceLock;

/// Positions along a slider.
const STEPS: usize = 5;
/// Least change from end to end, root of the mean square.
const LEAST: f64 = 2.0 / 255.0;
/// Least share of it between two positions.
const LEAST_STEP: f64 = 0.03;

/// Sliders whose positions are patterns of their own, each as far from the first as any other.
const PATTERNS: [(&str, &str); 1] = [("blueprint", "grid")];

fn main() -> ExitCode {
    let mut trials = Trials::new();
    for spec in isophote::registry::nodes().iter().filter(|spec| spec.group == "styles") {
        for preset in presets(spec) {
            for param in spec.params().filter(|p| p.group == "look" && is_number(p)) {
                let name = format!("{} {} {}", spec.id, preset.unwrap_or_default(), param.id);
                trials.add("sliders", &name, move || changes_the_picture(spec, preset, param));
            }
        }
    }
    trials.run()
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

/// A picture with all that renderers know of it: balls on a floor, textured and plain.
fn scene() -> &'static [(&'static str, Image)] {
    static SCENE: OnceLock<Vec<(&str, Image)>> = OnceLock::new();
    SCENE.get_or_init(|| {
        const SIZE: [u32; 2] = [240, 180];
        let at = |x: i32, y: i32| {
            let (u, v) = (x as f32 / 180.0, y as f32 / 180.0);
            for (number, [cx, cy, r]) in [[0.45, 0.55, 0.3], [1.0, 0.65, 0.22]].into_iter().enumerate() {
                let (dx, dy) = ((u - cx) / r, (v - cy) / r);
                let zz = 1.0 - dx * dx - dy * dy;
                if zz > 0.0 {
                    let n = [dx, -dy, zz.sqrt()];
                    let light = (0.2 + 0.8 * (n[2] * 0.6 - n[0] * 0.5 + n[1] * 0.6)).clamp(0.05, 1.0);
                    let checks = ((dx * 5.0).floor() as i32 + (dy * 5.0).floor() as i32).rem_euclid(2) as f32;
                    let own = if number == 0 { [0.8, 0.3, 0.2] } else { [0.25 + 0.3 * checks, 0.5, 0.75] };
                    return (own.map(|c| c * light), n, 4.0 - n[2] * r, number as f32 + 1.0);
                }
            }
            let grain = 0.05 * ((x * 7 + y * 13) % 11) as f32 / 11.0;
            if v > 0.7 {
                let far = 3.0 / (v - 0.45);
                ([0.35 + grain, 0.4 + grain + 0.2 * v, 0.25], [0.0, 0.9, 0.44], far, 9.0)
            } else {
                ([0.55 + 0.3 * v, 0.7, 0.9 - 0.1 * u + grain * 0.2], [0.0; 3], 0.0, 0.0)
            }
        };
        let [width, height] = SIZE;
        let color = |x, y| {
            let [r, g, b] = at(x, y).0;
            [r, g, b, 1.0]
        };
        let normal = |x, y| {
            let (_, [a, b, c], _, id) = at(x, y);
            [a, b, c, f32::from(id > 0.0)]
        };
        vec![
            ("color", from_fn(width, height, color)),
            ("normal", from_fn(width, height, normal)),
            ("depth", from_fn(width, height, |x, y| [at(x, y).2])),
            ("object_id", from_fn(width, height, |x, y| [at(x, y).3])),
        ]
    })
}

fn planned(spec: &NodeSpec, preset: Option<&str>, param: &Param, value: f32) -> Planned {
    let mut graph = Graph::single(spec.id).unwrap();
    let node = graph.node(0).unwrap();
    if let Some(preset) = preset {
        graph.set_text(node, "style", preset).unwrap();
    }
    graph.set(node, param.id, param.nearest([f64::from(value); 4])).unwrap();
    let guides = Guides { normal: true, depth: true, object_id: true, ..Guides::default() };
    let color = &scene()[0].1;
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
        (0..STEPS).map(|step| run::whole(planned(spec, preset, param, at(step)).plan(), scene())).collect();
    // What has no effect in this preset shows in no panel: its plans are the same.
    let [first, last] = [low, high].map(|value| planned(spec, preset, param, value));
    if has_same_work(&first, &last) {
        return;
    }
    let total = difference(&results[0], &results[STEPS - 1]);
    assert!(total >= LEAST, "from end to end {:.2}/255", total * 255.0);
    let mut before = 0.0;
    for step in 1..STEPS {
        let moved = difference(&results[step], &results[step - 1]);
        assert!(moved >= LEAST_STEP * total, "{} to {}: {:.3}/255", at(step - 1), at(step), moved * 255.0);
        let away = difference(&results[step], &results[0]);
        let is_pattern = PATTERNS.contains(&(spec.id, param.id));
        assert!(is_pattern || away >= before * 0.98, "{} is nearer to {low} than what is before", at(step));
        before = away;
    }
}

fn has_same_work(a: &Planned, b: &Planned) -> bool {
    let (a, b) = (a.plan().passes(), b.plan().passes());
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| std::ptr::eq(a.kernel, b.kernel) && a.params == b.params)
}
