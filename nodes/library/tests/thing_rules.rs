//! Rules for things on the CPU executor: they are what the same maps from a host would be.

use crate::result::{self, Inputs};
use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::{Image, Rect};
use isophote::request::Guides;
use isophote::things::ThingRule;
use isophote::{Graph, Planned, Request, preset};

const SIZE: [i32; 2] = [96, 64];

/// A picture with edges everywhere.
fn picture() -> Image {
    result::picture(SIZE, |x, y| {
        let light = if (x / 8 + y / 8) % 2 == 0 { 0.8 } else { 0.3 };
        [light, 0.9 * light, 0.7 * light, 1.0]
    })
}

fn plain(value: impl Fn(i32, i32) -> f32) -> Image {
    let mut image = Image::new(SIZE[0] as u32, SIZE[1] as u32, 1).unwrap();
    for (at, pixel) in (0..).zip(image.data_mut()) {
        *pixel = value(at % SIZE[0], at / SIZE[0]);
    }
    image
}

/// Numbers of three things side by side, and of nothing.
fn numbers() -> Image {
    plain(|x, _| [1.0, 2.0, 7.0, f32::NAN][(x / 24) as usize])
}

fn rule(numbers: &[u32], control: [Option<f32>; 4], line_color: Option<[f32; 4]>) -> ThingRule {
    ThingRule { numbers: numbers.to_vec(), control, line_color }
}

fn ruled(rules: Vec<ThingRule>, inputs: Inputs<'_>) -> Image {
    let mut graph = Graph::single("cartoon").unwrap();
    graph.set_rules(rules);
    run(&graph, inputs)
}

fn run(graph: &Graph, inputs: Inputs<'_>) -> Image {
    let has = |name: &str| inputs.iter().any(|(n, _)| *n == name);
    let size = SIZE.map(|side| side as u32);
    let request = Request { guides: Guides::of(|guide| has(guide.id())), ..Request::new(size[0], size[1]) };
    let planned = Planned::new(graph, request).unwrap();
    let region = Rect::of_size(size[0], size[1]);
    CpuExecutor::new()
        .run(planned.plan(), inputs, region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

fn by_map(inputs: Inputs<'_>) -> Image {
    ruled(Vec::new(), inputs)
}

fn bits(image: &Image) -> Vec<u32> {
    image.data().iter().map(|v| v.to_bits()).collect()
}

fn are_equal(one: &Image, other: &Image) -> bool {
    bits(one) == bits(other)
}

#[test]
fn rules_are_the_maps_that_they_say() {
    let (color, ids) = (picture(), numbers());
    let rules = vec![
        rule(&[1, 7], [Some(0.75), Some(0.9), None, None], None),
        rule(&[7], [Some(0.25), None, Some(0.0), None], Some([0.9, 0.1, 0.1, 1.0])),
    ];
    let control = result::picture(SIZE, |x, _| match x / 24 {
        0 => [0.75, 0.9, 0.5, 0.5],
        2 => [0.25, 0.9, 0.0, 0.5],
        _ => [0.5; 4],
    });
    let paint = result::picture(SIZE, |x, _| if x / 24 == 2 { [0.9, 0.1, 0.1, 1.0] } else { [0.0; 4] });
    let found = ruled(rules.clone(), &[("color", &color), ("object_id", &ids)]);
    let wanted =
        by_map(&[("color", &color), ("object_id", &ids), ("control", &control), ("line_paint", &paint)]);
    assert!(are_equal(&found, &wanted));
    assert!(!are_equal(&found, &by_map(&[("color", &color), ("object_id", &ids)])));
    // Without numbers nothing is known of things.
    assert!(are_equal(&ruled(rules, &[("color", &color)]), &by_map(&[("color", &color)])));
}

#[test]
fn what_is_painted_refines_rules_and_brings_no_lines_back() {
    let (color, ids) = (picture(), numbers());
    let rules = vec![rule(&[1], [Some(0.75), None, Some(0.0), None], Some([0.9, 0.1, 0.1, 1.0]))];
    let hand = result::picture(SIZE, |_, _| [0.75, 0.25, 1.0, f32::NAN]);
    let ink = result::picture(SIZE, |_, y| [0.0, 0.0, 0.5, if y < 32 { 1.0 } else { 0.0 }]);
    let control =
        result::picture(SIZE, |x, _| if x < 24 { [1.0, 0.25, 0.0, 0.5] } else { [0.75, 0.25, 1.0, 0.5] });
    let paint = result::picture(SIZE, |x, y| match (x < 24, y < 32) {
        (_, true) => [0.0, 0.0, 0.5, 1.0],
        (true, false) => [0.9, 0.1, 0.1, 1.0],
        (false, false) => [0.0; 4],
    });
    let inputs = |control, paint| -> Vec<(&'static str, &Image)> {
        vec![("color", &color), ("object_id", &ids), ("control", control), ("line_paint", paint)]
    };
    let found = ruled(rules, &inputs(&hand, &ink));
    assert!(are_equal(&found, &by_map(&inputs(&control, &paint))));
}

#[test]
fn lines_beside_a_nearer_thing_follow_its_rules() {
    let (color, ids) = (picture(), numbers());
    // The second thing stands in front of the first.
    let depth = plain(|x, _| [4.0, 2.0, f32::INFINITY, 0.0][(x / 24) as usize]);
    let rules = vec![rule(&[2], [None, None, Some(0.0), None], None)];
    let found = ruled(rules, &[("color", &color), ("object_id", &ids), ("depth", &depth)]);
    let reached = |left: i32, right: i32| {
        let map =
            result::picture(SIZE, |x, _| [0.5, 0.5, if (left..right).contains(&x) { 0.0 } else { 0.5 }, 0.5]);
        by_map(&[("color", &color), ("object_id", &ids), ("depth", &depth), ("control", &map)])
    };
    // Two pixels at least: five of a picture 1080 lines high are less.
    assert!(are_equal(&found, &reached(22, 50)));
    assert!(!are_equal(&found, &reached(24, 48)));
}

#[test]
fn presets_bring_rules_by_number_and_name_those_that_they_leave_out() {
    let json = r##"{"style": "cartoon", "objects": [
        {"match": "id:1,7", "detail": 2, "line_color": "#ff0000"},
        {"match": "cryptomatte:hero", "lines": false},
        {"match": "id:2", "look": "ink"},
        {"match": "id:7", "lines": false}]}"##;
    let (graph, settings) = preset::open_json("p.json", json, None).unwrap();
    assert_eq!(settings.left_out(), ["cryptomatte:hero", "id:2"]);
    let [first, last] = graph.rules() else { panic!("{:?}", graph.rules()) };
    assert_eq!((&first.numbers[..], first.line_color), (&[1, 7][..], Some([1.0, 0.0, 0.0, 1.0])));
    assert_eq!(last.control, [None, None, Some(0.0), None]);
    let (color, ids) = (picture(), numbers());
    let inputs: Inputs<'_> = &[("color", &color), ("object_id", &ids)];
    assert!(!are_equal(&run(&graph, inputs), &by_map(inputs)));
}
