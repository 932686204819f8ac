//! Marks belong to the canonical picture: noise, paper, hatching and grids of a bounding box are those that the whole
//! picture shows there. `hold` renews what is drawn by hand.

use isophote::spec::NodeSpec;
use isophote::{Planned, Request};
use isophote_engine::{Image, Rect};
use isophote_tests::cases;
use isophote_tests::pictures::from_fn;
use isophote_tests::run;
use isophote_tests::trials::Trials;

/// The whole picture, a box within it, and how far from the box's border marks may still read beyond it.
const WHOLE: [u32; 2] = [208, 176];
const BOX: [i32; 4] = [18, 10, 194, 160];
const MARGIN: i32 = 56;
/// Nodes that draw marks of their own.
const MARKS: [&str; 7] =
    ["blueprint", "flow_dilation", "halftone", "ink", "oil_paint", "tensor_view", "watercolor"];

/// The node whose result belongs to the picture that it has, to the middle of it for one.
const OF_ITS_PICTURE: &str = "importance";

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in isophote::registry::nodes() {
        if spec.id != OF_ITS_PICTURE {
            trials.add("origin", spec.id, || a_box_shows_the_marks_of_the_whole(spec));
        }
        if spec.params().any(|p| p.id == "hold") {
            trials.add("hold", spec.id, || noise_lasts_as_long_as_it_is_held(spec));
        }
    }
}

/// A grey that ends nowhere, on which nothing but marks can differ.
fn plain([width, height]: [u32; 2]) -> Image {
    from_fn(width, height, |_, _| [0.55, 0.5, 0.4, 1.0])
}

/// Stripes, which give lines something to follow and dilation something to fetch.
fn stripes(width: u32, height: u32) -> Image {
    from_fn(width, height, |x, y| {
        let v = 0.5 + 0.3 * (x as f32 * 0.7).sin() + 0.15 * (y as f32 * 0.4).sin();
        [v, 0.5, 1.0 - v, 1.0]
    })
}

fn result(spec: &'static NodeSpec, request: Request, color: &Image) -> Image {
    let graph = cases::setup(spec, true).graph;
    let planned = Planned::new(&graph, request).unwrap();
    run::whole(planned.plan(), &[("color", color.clone())])
}

fn a_box_shows_the_marks_of_the_whole(spec: &'static NodeSpec) {
    let [x0, y0, x1, y1] = BOX;
    let size = [(x1 - x0) as u32, (y1 - y0) as u32];
    for scale in [1.0, 0.5] {
        let request = |size: [u32; 2], origin| Request { scale, origin, ..Request::new(size[0], size[1]) };
        let whole = result(spec, request(WHOLE, [0.0; 2]), &plain(WHOLE));
        // Where the box stands is told in full-size pixels.
        let origin = [x0, y0].map(|o| f64::from(o) / f64::from(scale));
        let part = result(spec, request(size, origin), &plain(size));
        let elsewhere = result(spec, request(size, [0.0; 2]), &plain(size));
        let inner = Rect { x0: MARGIN, y0: MARGIN, x1: x1 - x0 - MARGIN, y1: y1 - y0 - MARGIN };
        let mut moved = false;
        for y in inner.y0..inner.y1 {
            for x in inner.x0..inner.x1 {
                let (found, wanted) = (part.pixel(x, y), whole.pixel(x + x0, y + y0));
                let same = found.iter().zip(wanted).all(|(a, b)| a.to_bits() == b.to_bits());
                assert!(same, "{x}, {y} at {scale}: {found:?} for {wanted:?}");
                moved |= found != elsewhere.pixel(x, y);
            }
        }
        // On a flat picture dilation has nothing to show.
        let shown = MARKS.contains(&spec.id) && spec.id != "flow_dilation";
        assert_eq!(moved, shown, "{} at {scale}: whether marks depend on the place", spec.id);
    }
}

fn noise_lasts_as_long_as_it_is_held(spec: &'static NodeSpec) {
    let picture = stripes(72, 60);
    let mut setup = cases::setup(spec, false);
    // By their defaults ink draws no strokes, and lines stay where they are.
    let set = if spec.id == "ink" { [("style", "woodcut")] } else { [("wobble", "2")] };
    for (param, value) in set.into_iter().filter(|(param, _)| spec.param(param).is_some()) {
        setup.graph.set_text(setup.node, param, value).unwrap();
    }
    let mut at = |hold: i32, frame: i64| {
        setup.graph.set_text(setup.node, "hold", &hold.to_string()).unwrap();
        let request = Request { frame, ..Request::new(72, 60) };
        run::whole(Planned::new(&setup.graph, request).unwrap().plan(), &[("color", picture.clone())])
    };
    let still = at(0, 0);
    assert!(at(0, 7) == still && at(0, -3) == still, "for ever");
    assert!(at(1, 0) == still && at(1, 1) != still && at(1, 2) != at(1, 1), "anew in each frame");
    assert!(at(3, 2) == still && at(3, 3) != still && at(3, 5) == at(3, 3) && at(3, -1) == at(3, -3));
    assert!(at(3, -1) != still);
}
