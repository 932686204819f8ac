//! Experiment 18: marks belong to things. How far the noise of styles slides against the surface, and how large it is on
//! screen when the camera comes closer.

use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote::{Graph, Request};
use isophote_engine::Image;
use isophote_tests::device::device;
use isophote_tests::marks::{FARTHEST, Looks, drawn, grey, looks, slides};
use isophote_tests::pictures::from_fn;
use isophote_tests::run;
use isophote_tests::sequences::Player;
use isophote_tests::steadiness::{Frame, Shot, rendered_shots};
use isophote_tests::table::Table;

/// Drawing of a node: a name for tables, the node with its parameters, the grey that shows most of its marks, and the
/// direction across them.
type Drawing = (&'static str, &'static str, &'static [(&'static str, &'static str)], f32, [f64; 2]);

/// Styles that draw marks; without paper, which stays on the screen.
const STYLES: [Drawing; 3] = [
    ("oil_paint", "oil_paint", &[], 0.6, [1.0, 0.0]),
    ("ink, woodcut", "ink", &[("style", "woodcut")], 0.45, [0.6, 0.8]),
    ("ink, pencil", "ink", &[("style", "pencil"), ("grain", "0")], 0.45, [0.6, 0.8]),
];

/// Fewest squares whose mean counts.
const LEAST: usize = 150;

/// Frames before a frame that carried marks want.
const KNOWN: usize = 7;

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
    let mut shot = rendered_shots::demo(rendered_shots::size()).unwrap();
    // Five pairs tell as much as nine.
    shot.frames.truncate(6);
    let columns = ["style", "on the screen", "at rest positions", "nine of ten squares"];
    let title = "How far marks slide against the surface, pixels a frame: demo scene, camera on its path";
    let mut table = Table::new(18, "marks", title, &columns);
    let mut worst = Vec::new();
    for (name, node, params, value, _) in STYLES {
        let graph = run::single(node, params);
        let [screen, mut rest] = [false, true].map(|has_rest| {
            let frames = marked(&shot, &graph, value, has_rest);
            let pairs = 1..frames.len();
            let slides = pairs.flat_map(|n| slides(&shot, n, [&frames[n - 1], &frames[n]]));
            slides.map(|[x, y]| x.hypot(y)).collect::<Vec<f64>>()
        });
        assert!(rest.len() > LEAST, "{name}: {} squares", rest.len());
        let (before, after, most) = (mean(&screen), mean(&rest), ninth(&mut rest));
        table.row(&[name.to_owned(), format!("{before:.1}"), format!("{after:.2}"), format!("{most:.2}")]);
        worst.push((name, before, after));
    }
    table.print();
    for (name, before, after) in worst {
        assert!(after < MOST_SLIDE, "{name} slides by {after:.3} pixels a frame");
        assert!(before > 3.0 * after && before <= f64::from(FARTHEST), "{name}: {before:.3} on the screen");
    }
}

/// Frames of a shot as grey pictures in a style that knows their motion alone, from the last of those that know fewer before
/// them than they want.
fn carried(shot: &Shot, graph: &Graph, value: f32) -> Vec<Image> {
    let mut player = Player::new(graph.clone(), 1 << 30);
    let source = |input: GraphInput, number: i64| {
        let frame = shot.frames.get(usize::try_from(number).ok()?)?;
        match input {
            GraphInput::Color => Some(grey(frame.color.width(), frame.color.height(), value)),
            GraphInput::Motion => Some(frame.motion.clone()),
            _ => None,
        }
    };
    let size = &shot.frames[0].color;
    let request = Request::new(size.width(), size.height());
    (KNOWN - 1..shot.frames.len()).map(|n| player.frame(request, n as i64, &source)).collect()
}

/// Everything moves by (-3, 1.5) pixels a frame.
fn pan(like: &Shot) -> Shot {
    let mut shot = like.clone();
    for frame in &mut shot.frames {
        let (w, h) = (frame.color.width(), frame.color.height());
        frame.motion = from_fn(w, h, |_, _| [3.0, -1.5]);
        frame.object_id = from_fn(w, h, |_, _| [1.0]);
        frame.depth = from_fn(w, h, |_, _| [1.0]);
    }
    shot
}

#[test]
fn marks_are_carried_where_motion_alone_is_known() {
    let Some(_) = device("the demo scene") else { return };
    // In smaller frames less moves than marks are uncertain by.
    let demo = rendered_shots::demo(rendered_shots::SIZE).unwrap();
    let columns =
        ["style", "demo scene: on the screen", "carried", "pan by 3.4 pixels: on the screen", "carried"];
    // Layers that fade into one another make long marks longer or shorter, which is no sliding.
    let title = "How far marks slide across themselves where motion alone is known, pixels a frame";
    let mut table = Table::new(18, "marks", title, &columns);
    let mut found = Vec::new();
    for (name, node, params, value, across) in STYLES {
        let mut row = vec![name.to_owned()];
        for shot in [&demo, &pan(&demo)] {
            let [before, after] = ["0", "0.5"].map(|steadiness| {
                let params = [params, &[("steadiness", steadiness), ("window", "0")]].concat();
                let frames = carried(shot, &run::single(node, &params), value);
                let pairs = frames.windows(2).zip(KNOWN..);
                let slides = pairs.flat_map(|(pair, n)| slides(shot, n, [&pair[0], &pair[1]]));
                let slides: Vec<f64> = slides.map(|[x, y]| (x * across[0] + y * across[1]).abs()).collect();
                assert!(slides.len() > LEAST, "{name}: {} squares", slides.len());
                mean(&slides)
            });
            row.extend([format!("{before:.2}"), format!("{after:.2}")]);
            found.push((name, before, after));
        }
        table.row(&row);
    }
    table.print();
    for (name, before, after) in found {
        assert!(
            after < MOST_SLIDE && after < 0.5 * before,
            "{name} slides by {before:.3}, carried by {after:.3}"
        );
    }
}

#[test]
fn where_nothing_moves_carried_marks_stay() {
    for (name, node, params, value, _) in STYLES {
        let still = drawn(&run::single(node, params), &grey(96, 64, value), None);
        let params = [params, &[("steadiness", "0.5"), ("window", "0")]].concat();
        let mut player = Player::new(run::single(node, &params), 1 << 30);
        let source = |input: GraphInput, number: i64| match input {
            GraphInput::Color if number >= 0 => Some(grey(96, 64, value)),
            GraphInput::Motion if number >= 0 => Some(from_fn(96, 64, |_, _| [0.0, 0.0])),
            _ => None,
        };
        for number in [0, 3, 9, 12] {
            let frame = player.frame(Request::new(96, 64), number, &source);
            let apart = frame.data().iter().zip(still.data()).map(|(a, b)| (a - b).abs());
            // Hatches of the screen are drawn another way than those of things.
            if node != "ink" {
                assert!(apart.fold(0.0, f32::max) < 2e-3, "{name} {number}");
            }
        }
        let first = player.frame(Request::new(96, 64), 20, &source);
        let second = player.frame(Request::new(96, 64), 23, &source);
        let apart = first.data().iter().zip(second.data()).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f32::max) < 2e-3, "{name}");
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
    let columns = ["style", "width", "contrast"];
    let title = "Marks on a wall that comes four times closer, over those on the screen";
    let mut table = Table::new(18, "marks", title, &columns);
    let mut found = Vec::new();
    for (name, node, params, value, _) in STYLES {
        let graph = run::single(node, params);
        let picture = grey(WIDTH, HEIGHT, value);
        let screen = looks(&drawn(&graph, &picture, None));
        let closer: Vec<Looks> = (0..=8)
            .map(|step| wall(0.02 * 2f32.powf(-0.25 * step as f32)))
            .map(|rest| looks(&drawn(&graph, &picture, Some(&rest))))
            .collect();
        // Hatches of the screen are regular, those of things are not: they are compared with themselves.
        let usual = if node == "ink" { &closer[4] } else { &screen };
        // Least and greatest over that of the screen.
        let spread = |of: &dyn Fn(&Looks) -> f64| {
            let values: Vec<f64> = closer.iter().map(|l| of(l) / of(usual)).collect();
            [values.iter().copied().fold(f64::INFINITY, f64::min), values.iter().copied().fold(0.0, f64::max)]
        };
        let [width, contrast] = [spread(&|l| l.width[0]), spread(&|l| l.contrast)];
        let shown = |[least, most]: [f64; 2]| format!("{least:.2} to {most:.2}");
        table.row(&[name.to_owned(), shown(width), shown(contrast)]);
        found.push((name, width, contrast));
    }
    table.print();
    for (name, width, contrast) in found {
        assert!(
            width.iter().all(|w| (0.8..1.2).contains(w)),
            "{name}: {width:.2?} of the width on the screen"
        );
        assert!(contrast.iter().all(|c| (0.85..1.15).contains(c)), "{name}: {contrast:.2?} of the contrast");
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

#[test]
fn strokes_end_at_the_borders_of_objects() {
    // Neither bristles nor colours of strokes' own, and no borders that strokes would end at by themselves.
    let graph =
        run::single("oil_paint", &[("bristle", "0"), ("shine", "0"), ("variation", "0"), ("n_a", "0")]);
    let [width, height] = [128, 96];
    let picture = from_fn(width, height, |x, _| {
        let v = if x < 64 { 0.45 } else { 0.5 };
        [v, v, v, 1.0]
    });
    let object_id = from_fn(width, height, |x, _| [if x < 64 { 1.0 } else { 2.0 }]);
    let crossed = |knows_objects: bool| {
        let guides = Guides::of(|input| knows_objects && input == GraphInput::ObjectId);
        let request = Request { guides, ..Request::new(width, height) };
        let mut inputs = vec![("color", picture.clone())];
        inputs.extend(knows_objects.then(|| ("object_id", object_id.clone())));
        let result = run::whole(run::planned(&graph, request).plan(), &inputs);
        let pairs = result.data().iter().zip(picture.data());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    assert!(crossed(false) > 0.02, "{}", crossed(false));
    assert!(crossed(true) < 0.002, "{}", crossed(true));
}

#[test]
fn hold_renews_marks_on_things() {
    let graph = run::single("oil_paint", &[("hold", "2")]);
    let inputs = [
        ("color", grey(96, 64, 0.6)),
        ("rest_position", from_fn(96, 64, |x, y| [x as f32, y as f32, 1.0, 1.0])),
    ];
    let at = |frame: i64| {
        let guides = Guides::of(|input| input == GraphInput::RestPosition);
        let request = Request { frame, guides, ..Request::new(96, 64) };
        run::whole(run::planned(&graph, request).plan(), &inputs)
    };
    assert!(at(4) == at(5), "both are of one drawing");
    assert!(at(5) != at(6), "marks are renewed");
}
