//! Frames that know each other: every order gives the same bits, a cut gives the still, and what cannot be carried
//! leaves a frame alone.

use isophote::graph::{GraphInput, ThingLook};
use isophote::spec::NodeSpec;
use isophote::things::{ThingRule, Things};
use isophote::{Graph, Request, Value};
use isophote_engine::Image;
use isophote_tests::pictures::{from_fn, id_of_thing, scenery};
use isophote_tests::sequences::Player;

const SIZE: [u32; 2] = [97, 61];
/// Pixels that the picture moves from frame to frame.
const STEP: [f32; 2] = [1.5, -0.75];

/// Nodes that carry something from frame to frame.
fn steady_nodes() -> impl Iterator<Item = &'static NodeSpec> {
    isophote::registry::nodes().iter().copied().filter(|node| node.is_steady())
}

fn graph(node: &NodeSpec, steadiness: f32, window: i32) -> Graph {
    let mut graph = Graph::single(node.id).unwrap();
    let id = graph.node(0).unwrap();
    graph.set(id, "steadiness", Value::Float(steadiness)).unwrap();
    graph.set(id, "window", Value::Int(window)).unwrap();
    graph
}

/// A picture that moves by [`STEP`] a frame, with its motion both ways; frames 0 to `last`.
fn moving(input: GraphInput, frame: i64, last: i64) -> Option<Image> {
    if !(0..=last).contains(&frame) {
        return None;
    }
    let [w, h] = SIZE;
    let moved = STEP.map(|s| s * frame as f32);
    match input {
        GraphInput::Color => Some(from_fn(w, h, |x, y| texture(x as f32 - moved[0], y as f32 - moved[1]))),
        GraphInput::Motion => Some(from_fn(w, h, |_, _| [-STEP[0], -STEP[1]])),
        GraphInput::MotionForward => Some(from_fn(w, h, |_, _| STEP)),
        GraphInput::Depth => Some(from_fn(w, h, |_, _| [3.0])),
        GraphInput::ObjectId => Some(from_fn(w, h, |_, _| [1.0])),
        GraphInput::Cryptomatte => {
            let [left, right] = [1, 2].map(|number| f32::from_bits(id_of_thing(number)));
            Some(from_fn(w, h, |x, _| match x as f32 - moved[0] {
                x if x < 40.0 => [left, 1.0, 0.0, 0.0],
                x if x < 41.0 => [right, 0.75, left, 0.25],
                _ => [right, 1.0, 0.0, 0.0],
            }))
        }
        _ => None,
    }
}

/// A cartoon in which a thing has a look of its own and another one wider lines; all are steady.
fn directed() -> Graph {
    let cartoon = isophote::registry::find("cartoon").unwrap();
    let watercolor = isophote::registry::find("watercolor").unwrap();
    let mut graph = graph(cartoon, 0.6, 2);
    let names = |number| Things::Names(vec![id_of_thing(number)]);
    let control = [None, Some(0.9), None, None];
    graph.set_rules(vec![ThingRule { things: names(2), control, line_color: None }]);
    graph.looks_mut().push(ThingLook { things: names(1), graph: self::graph(watercolor, 0.6, 1) });
    graph
}

fn texture(x: f32, y: f32) -> [f32; 4] {
    let ring = (0.35 * (x - 40.0).hypot(y - 30.0)).sin();
    let blob = if (x - 60.0).hypot(y - 20.0) < 9.0 { 0.35 } else { 0.0 };
    let value = |c: f32| (0.45 + 0.2 * ring + 0.12 * (0.21 * x + c).sin() + blob * c).clamp(0.0, 1.0);
    [value(0.3), value(0.7), value(1.0), 1.0]
}

fn request() -> Request {
    Request::new(SIZE[0], SIZE[1])
}

/// The frames of a graph, which every order gives to the bit.
fn in_every_order(graph: &Graph, name: &str) -> Vec<Image> {
    let source = |input, frame| moving(input, frame, 6);
    let mut in_order = Player::new(graph.clone(), 1 << 30);
    let frames: Vec<Image> = (0..=6).map(|n| in_order.frame(request(), n, &source)).collect();
    let mut shuffled = Player::new(graph.clone(), 1 << 30);
    for n in [5, 2, 2, 6, 0, 4, 1, 3] {
        assert!(shuffled.frame(request(), n, &source) == frames[n as usize], "{name} {n}");
    }
    // Without room for anything, and with room for a frame or two.
    for bytes in [0, 400_000] {
        let mut forgetful = Player::new(graph.clone(), bytes);
        for n in [6, 5, 3] {
            assert!(forgetful.frame(request(), n, &source) == frames[n as usize], "{name} {n}");
        }
    }
    frames
}

#[test]
fn every_order_gives_the_same_bits() {
    for node in steady_nodes() {
        in_every_order(&graph(node, 0.6, 2), node.id);
    }
}

#[test]
fn things_with_rules_and_looks_are_the_same_in_every_order() {
    let frames = in_every_order(&directed(), "directed");
    let [cartoon, watercolor] = [("cartoon", 2), ("watercolor", 1)].map(|(node, window)| {
        let node = isophote::registry::find(node).unwrap();
        in_every_order(&graph(node, 0.6, window), node.id)
    });
    // Far from borders of things each shows its own.
    assert!(frames[3].pixel(4, 30) == watercolor[3].pixel(4, 30));
    assert!(frames[3] != cartoon[3] && frames[3] != watercolor[3]);
}

#[test]
fn in_order_every_frame_is_read_once() {
    for node in steady_nodes() {
        let source = |input, frame| moving(input, frame, 6);
        let mut player = Player::new(graph(node, 0.6, 2), 1 << 30);
        for n in 0..=6 {
            player.frame(request(), n, &source);
        }
        // Its guides are those of the frame, which lines are drawn by; its colour is read for its stage alone.
        assert!(player.reads <= 7 + 7, "{}: {} reads", node.id, player.reads);
    }
}

#[test]
fn a_frame_after_a_cut_equals_the_still() {
    for node in steady_nodes() {
        let [w, h] = SIZE;
        let source = |input, frame| match input {
            GraphInput::Color if frame == 3 => {
                Some(from_fn(w, h, |x, y| texture(y as f32, 2.0 * x as f32).map(|v| 1.0 - v)))
            }
            GraphInput::MotionForward => None,
            // A cut has no motion, or a wrong one.
            GraphInput::Motion if frame == 3 => Some(from_fn(w, h, |_, _| [f32::NAN; 2])),
            _ => moving(input, frame, 3),
        };
        let still = Player::new(graph(node, 0.0, 2), 0).frame(request(), 3, &source);
        let after = Player::new(graph(node, 1.0, 2), 1 << 30).frame(request(), 3, &source);
        assert!(after == still, "{}", node.id);
        let before = Player::new(graph(node, 1.0, 2), 1 << 30).frame(request(), 2, &source);
        assert!(before != Player::new(graph(node, 0.0, 2), 0).frame(request(), 2, &source), "{}", node.id);
    }
}

#[test]
fn an_exactly_carried_picture_stays() {
    // Whole steps need no interpolation: the average of what is the same is the same.
    let picture = scenery(SIZE[0] + 20, SIZE[1]);
    let source = |input, frame: i64| {
        let [w, h] = SIZE;
        (0..=4).contains(&frame).then_some(())?;
        match input {
            GraphInput::Color => Some(from_fn(w, h, |x, y| {
                let mut pixel = [0.0; 4];
                pixel.copy_from_slice(picture.pixel(x + 2 * frame as i32, y));
                pixel
            })),
            GraphInput::Motion => Some(from_fn(w, h, |_, _| [2.0, 0.0])),
            _ => None,
        }
    };
    // Lines that move are decided over areas.
    for (id, bound) in [("steady", 1e-5), ("cartoon", 0.04), ("coherent", 0.02)] {
        let node = isophote::registry::find(id).unwrap();
        let still = Player::new(graph(node, 0.0, 2), 0).frame(request(), 3, &source);
        let carried = Player::new(graph(node, 1.0, 2), 1 << 30).frame(request(), 3, &source);
        let inner = |image: &Image| -> Vec<f32> {
            (12..SIZE[1] as i32 - 12)
                .flat_map(|y| (12..SIZE[0] as i32 - 24).flat_map(move |x| (0..3).map(move |c| (x, y, c))))
                .map(|(x, y, c)| image.pixel(x, y)[c])
                .collect()
        };
        let differences = inner(&still).into_iter().zip(inner(&carried)).map(|(a, b)| (a - b).abs());
        let mean = differences.sum::<f32>() / (inner(&still).len() as f32);
        assert!(mean < bound, "{id}: {mean}");
    }
}
