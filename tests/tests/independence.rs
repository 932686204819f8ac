//! A filter does not know where up is: the rotated picture gives the rotated result, the mirrored picture
//! the mirrored one, for every node that gives a colour or a scalar.
//!
//! The picture has grain, so that no two neighbours are equal and no orientation is undetermined. Where
//! decisions are made (a stream line that ends, a least pixel, a bin), a last bit may still send single
//! pixels elsewhere; the mean difference bounds how many.

use isophote::spec::{ImageKind, NodeSpec};
use isophote::{Graph, Request, Value};
use isophote_engine::Image;
use isophote_tests::cases::{self, Setting};
use isophote_tests::compare::distance;
use isophote_tests::pictures::{self, from_fn};
use isophote_tests::run;
use isophote_tests::trials::Trials;

/// Largest mean difference; colours are 0..=1.
const MEAN: f64 = 2e-5;

/// Nodes that know where up is, all of them or with a setting, and why.
const DIRECTED: &[(&str, &str, &str)] = &[
    ("tensor_view", "default", "the noise along the stream lines belongs to the place"),
    ("tensor_view", "show=orientation", "hues stand for directions"),
    ("bilateral", "kernel=xy", "the separable filter runs along x first (§ 3.3)"),
    ("cartoon", "abstraction=xy", "the separable filter runs along x first (§ 3.3)"),
    ("watercolor", "abstraction=xy", "the separable filter runs along x first (§ 3.3)"),
    ("flow_dilation", "", "noise belongs to the place"),
    ("ink", "", "paper and strokes belong to the place"),
    ("halftone", "", "screens belong to the place"),
    ("oil_paint", "abstraction=xy", "the separable filter runs along x first (§ 3.3)"),
    ("palette", "abstraction=xy", "the separable filter runs along x first (§ 3.3)"),
    ("palette", "dither=bayer", "patterns belong to the place"),
    ("palette", "dither=noise", "patterns belong to the place"),
    ("toon_shading", "abstraction=xy", "the separable filter runs along x first (§ 3.3)"),
    ("blueprint", "abstraction=xy", "the separable filter runs along x first (§ 3.3)"),
];

/// Parameters that belong to the place in nodes of which the rest does not, turned off: paper, grids, noise.
const PLACED: &[(&str, &[&str])] = &[
    ("blueprint", &["grid", "paper_texture"]),
    ("cartoon", &["dots"]),
    ("watercolor", &["clouds", "granulation", "wobble", "bleeding", "gaps", "dry_brush", "backruns"]),
    ("oil_paint", &["bristle", "shine", "dilation_length"]),
];

fn is_directed(id: &str, setting: &str) -> bool {
    DIRECTED.iter().any(|(node, with, _)| *node == id && (with.is_empty() || *with == setting))
}

/// A way to turn a picture.
type Turn = fn(&Image) -> Image;

fn at<const N: usize>(image: &Image, x: i32, y: i32) -> [f32; N] {
    std::array::from_fn(|c| image.pixel(x, y)[c])
}

fn turned(image: &Image, swaps: bool, from: impl Fn(i32, i32) -> [i32; 2]) -> Image {
    let (w, h) = if swaps { (image.height(), image.width()) } else { (image.width(), image.height()) };
    if image.channels() == 1 {
        from_fn(w, h, |x, y| at::<1>(image, from(x, y)[0], from(x, y)[1]))
    } else {
        from_fn(w, h, |x, y| at::<4>(image, from(x, y)[0], from(x, y)[1]))
    }
}

fn rotated(image: &Image) -> Image {
    let height = image.height() as i32;
    turned(image, true, |x, y| [y, height - 1 - x])
}

fn mirrored(image: &Image) -> Image {
    let width = image.width() as i32;
    turned(image, false, |x, y| [width - 1 - x, y])
}

const TURNS: [(&str, Turn); 2] = [("rotated", rotated), ("mirrored", mirrored)];

fn apply(graph: &Graph, picture: &Image) -> Image {
    run::graph(graph, Request::new(picture.width(), picture.height()), picture)
}

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in isophote::registry::nodes() {
        // Tensors and motion turn with the picture.
        if !matches!(spec.output.kind, ImageKind::Tensor | ImageKind::Motion) {
            trials.add("independence", spec.id, || turned_pictures_give_turned_results(spec));
        }
    }
}

/// The graph of a node with everything that belongs to the place turned off.
fn unplaced(spec: &'static NodeSpec, setting: &Setting) -> Graph {
    let mut setup = cases::setup(spec, false);
    setting.apply(&mut setup.graph, setup.node);
    for (_, params) in PLACED.iter().filter(|(node, _)| *node == spec.id) {
        for param in *params {
            setup.graph.set(setup.node, param, Value::Float(0.0)).unwrap();
        }
    }
    setup.graph
}

fn turned_pictures_give_turned_results(spec: &'static NodeSpec) -> Vec<String> {
    // Sides that can be halved again and again: pyramids then group the same pixels from every corner.
    let picture = pictures::scenery(128, 64);
    let mut wrong = Vec::new();
    // The defaults, and every option of choices and switches.
    for setting in cases::settings(spec, 0) {
        let shown = setting.label == "default" || setting.label.contains('=');
        if !shown || is_directed(spec.id, &setting.label) {
            continue;
        }
        let graph = unplaced(spec, &setting);
        let straight = apply(&graph, &picture);
        for (name, turn) in TURNS {
            let (worst, mean) = distance(&apply(&graph, &turn(&picture)), &turn(&straight));
            println!("{:26} {:34} {name:9} mean {mean:.1e} worst {worst:.1e}", spec.id, setting.label);
            if mean.is_nan() || mean > MEAN {
                wrong.push(format!("{} {name}: mean {mean:.1e}, worst {worst:.1e}", setting.label));
            }
        }
    }
    wrong
}
