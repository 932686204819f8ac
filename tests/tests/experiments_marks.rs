//! Experiment 18: marks belong to things. How far the noise of styles slides against the surface, and how large it is on
//! screen when the camera comes closer.

use isophote::Graph;
use isophote_engine::Image;
use isophote_tests::device::device;
use isophote_tests::marks::{FARTHEST, Looks, drawn, grey, looks, slides};
use isophote_tests::pictures::from_fn;
use isophote_tests::run;
use isophote_tests::steadiness::{Frame, Shot, footage};
use isophote_tests::table::Table;

/// Name, node, parameters and grey of what is drawn.
type Drawing = (&'static str, &'static str, &'static [(&'static str, &'static str)], f32);

/// Styles that draw marks, with their parameters and the grey that shows most of them; without paper, which stays on the
/// screen.
const STYLES: [Drawing; 3] = [
    ("oil_paint", "oil_paint", &[], 0.6),
    ("ink, woodcut", "ink", &[("style", "woodcut")], 0.45),
    ("ink, pencil", "ink", &[("style", "pencil"), ("grain", "0")], 0.45),
];

/// Most that marks may slide, pixels a frame.
const MOST_SLIDE: f64 = 0.5;

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The value that nine of ten do not exceed.
fn ninth(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() * 9 / 10).copied().unwrap_or_default()
}

/// All frames of a shot as grey pictures in a style.
fn marked(shot: &Shot, graph: &Graph, value: f32, has_rest: bool) -> Vec<Image> {
    let draw = |frame: &Frame| {
        let picture = grey(frame.color.width(), frame.color.height(), value);
        drawn(graph, &picture, has_rest.then_some(&frame.rest))
    };
    shot.frames.iter().map(draw).collect()
}

#[test]
fn marks_do_not_slide_on_surfaces() {
    let Some(_) = device("the demo scene") else { return };
    let mut shot = footage::demo().unwrap();
    // Five pairs tell as much as nine.
    shot.frames.truncate(6);
    let columns = ["style", "on the screen", "at rest positions", "nine of ten squares"];
    let title = "How far marks slide against the surface, pixels a frame: demo scene, camera on its path";
    let mut table = Table::new(18, "marks", title, &columns);
    let mut worst = Vec::new();
    for (name, node, params, value) in STYLES {
        let graph = run::single(node, params);
        let [screen, mut rest] = [false, true].map(|has_rest| {
            let frames = marked(&shot, &graph, value, has_rest);
            let pairs = 1..frames.len();
            pairs.flat_map(|n| slides(&shot, n, [&frames[n - 1], &frames[n]])).collect::<Vec<f64>>()
        });
        assert!(rest.len() > 200, "{name}: {} squares", rest.len());
        let (before, after, most) = (mean(&screen), mean(&rest), ninth(&mut rest));
        table.row(&[name.to_owned(), format!("{before:.1}"), format!("{after:.2}"), format!("{most:.2}")]);
        worst.push((name, before, after));
    }
    table.print();
    for (name, before, after) in worst {
        assert!(after < MOST_SLIDE, "{name} slides by {after:.3} pixels a frame");
        assert!(
            before > 2.0 * MOST_SLIDE && before <= f64::from(FARTHEST),
            "{name}: {before:.3} on the screen"
        );
    }
}

/// Large enough for some hundreds of the longest marks.
const WIDTH: u32 = 720;
const HEIGHT: u32 = 480;

/// A wall before the camera, a little inclined, of which a pixel shows so many units.
fn wall(footprint: f32) -> Image {
    from_fn(WIDTH, HEIGHT, |x, y| {
        let [u, v] = [footprint * x as f32, footprint * y as f32];
        [u + 3.1, 17.7 - v, 0.4 * u, 1.0]
    })
}

#[test]
fn marks_keep_their_size_when_the_camera_comes_closer() {
    let columns = ["style", "at rest positions", "widest to narrowest", "strongest to weakest"];
    let title = "Marks on a wall that comes four times closer: width and contrast over those on the screen, and how they vary";
    let mut table = Table::new(18, "marks", title, &columns);
    let mut found = Vec::new();
    for (name, node, params, value) in STYLES {
        let graph = run::single(node, params);
        let picture = grey(WIDTH, HEIGHT, value);
        let screen = looks(&drawn(&graph, &picture, None));
        let closer: Vec<Looks> = (0..=8)
            .map(|step| wall(0.02 * 2f32.powf(-0.25 * step as f32)))
            .map(|rest| looks(&drawn(&graph, &picture, Some(&rest))))
            .collect();
        let across = |l: &Looks| l.width[0];
        let spread = |of: &dyn Fn(&Looks) -> f64| {
            let values: Vec<f64> = closer.iter().map(of).collect();
            let [least, most] = [f64::INFINITY, 0.0];
            [values.iter().copied().fold(least, f64::min), values.iter().copied().fold(most, f64::max)]
        };
        let ([narrow, wide], [weak, strong]) = (spread(&across), spread(&|l| l.contrast));
        let size = mean(&closer.iter().map(across).collect::<Vec<_>>()) / screen.width[0];
        let contrast = mean(&closer.iter().map(|l| l.contrast).collect::<Vec<_>>()) / screen.contrast;
        table.row(&[
            name.to_owned(),
            format!("{size:.2}, {contrast:.2}"),
            format!("{:.2}", wide / narrow),
            format!("{:.2}", strong / weak),
        ]);
        found.push((name, [size, contrast], wide / narrow, strong / weak));
    }
    table.print();
    for (name, like, size, contrast) in found {
        assert!(size < 1.2, "{name}: sizes vary by {size:.2}");
        assert!(contrast < 1.15, "{name}: contrast varies by {contrast:.2}");
        assert!(like.iter().all(|share| (0.8..1.25).contains(share)), "{name}: {like:.2?} of the screen's");
    }
}

#[test]
fn far_from_the_origin_marks_are_the_same() {
    let graph = run::single("oil_paint", &[]);
    let picture = grey(WIDTH, HEIGHT, 0.6);
    let at = |offset: f32| {
        let mut rest = wall(0.02);
        rest.data_mut().chunks_exact_mut(4).for_each(|p| p[0] += offset);
        looks(&drawn(&graph, &picture, Some(&rest)))
    };
    let (near, far) = (at(0.0), at(8192.0));
    assert!((far.width[0] / near.width[0] - 1.0).abs() < 0.1, "{near:?} {far:?}");
    assert!((far.contrast / near.contrast - 1.0).abs() < 0.1, "{near:?} {far:?}");
}
