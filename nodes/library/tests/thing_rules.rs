//! Rules for things on the CPU executor: they are what the same maps from a host would be.

use crate::result::{self, Inputs};
use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::{Image, Rect};
use isophote::request::Guides;
use isophote::things::{ThingRule, Things};
use isophote::{Graph, Planned, Request, preset};
use isophote_cryptomatte::id;

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
    ThingRule { things: Things::Numbers(numbers.to_vec()), control, line_color }
}

fn numbered(numbers: &[u32]) -> Things {
    Things::Numbers(numbers.to_vec())
}

/// The same things by their names: the second covers half of each pixel of the first, and the third is thin.
fn names() -> Image {
    let name = |name: &str| f32::from_bits(id(name));
    result::picture(SIZE, |x, _| match x / 24 {
        0 => [name("left"), 0.5, name("middle"), 0.5],
        1 => [name("middle"), 1.0, 0.0, 0.0],
        2 => [name("right"), 0.25, 0.0, f32::NAN],
        _ => [0.0; 4],
    })
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
fn presets_bring_rules_and_name_those_that_they_leave_out() {
    let json = r##"{"style": "cartoon", "objects": [
        {"match": "id:1,7", "detail": 2, "line_color": "#ff0000"},
        {"match": "cryptomatte:hero,b", "lines": false},
        {"match": "cryptomatte:props/*", "lines": false},
        {"match": "id:2", "look": "beside.json"},
        {"match": "id:7", "line_amount": 0.25}]}"##;
    let (graph, settings) = preset::open_json("p.json", json, None).unwrap();
    let left_out: Vec<&str> = settings.left_out().iter().map(|fault| fault.place.as_str()).collect();
    assert_eq!(left_out, ["cryptomatte:props/*", "id:2: its look"]);
    let [first, second, of_look, last] = graph.rules() else { panic!("{:?}", graph.rules()) };
    assert_eq!((&first.things, first.line_color), (&numbered(&[1, 7]), Some([1.0, 0.0, 0.0, 1.0])));
    assert_eq!(second.things, Things::Names(vec![id("hero"), id("b")]));
    assert_eq!((&of_look.things, of_look.is_neutral()), (&numbered(&[2]), true));
    assert_eq!(last.control, [None, None, Some(0.0), None]);
    let (color, ids) = (picture(), numbers());
    let inputs: Inputs<'_> = &[("color", &color), ("object_id", &ids)];
    assert!(!are_equal(&run(&graph, inputs), &by_map(inputs)));
}

#[test]
fn rules_by_name_count_as_much_as_their_things_cover() {
    let (color, names) = (picture(), names());
    let said = |name: &str, control, line_color| {
        let things = Things::of(&format!("cryptomatte:{name}")).unwrap();
        ThingRule { things, control, line_color }
    };
    let red = Some([1.0, 0.0, 0.0, 1.0]);
    let rules = vec![
        said("middle", [Some(0.75), None, Some(0.0), None], None),
        said("middle,right", [None, Some(0.9), None, None], red),
    ];
    let inputs: Inputs<'_> = &[("color", &color), ("cryptomatte", &names)];
    let found = ruled(rules.clone(), inputs);
    let control = result::picture(SIZE, |x, _| match x / 24 {
        0 => [0.625, 0.7, 0.25, 0.5],
        1 => [0.75, 0.9, 0.0, 0.5],
        2 => [0.5, 0.6, 0.5, 0.5],
        _ => [0.5; 4],
    });
    let paint = result::picture(SIZE, |x, _| {
        [1.0, 0.0, 0.0, 1.0].map(|v: f32| v * [1.0, 1.0, 1.0, 0.0][(x / 24) as usize])
    })
    .data()
    .chunks_exact(4)
    .zip((0..).map(|at| at % SIZE[0] / 24))
    .flat_map(|(pixel, thing)| [pixel[0], pixel[1], pixel[2], [0.5, 1.0, 0.25, 0.0][thing as usize]])
    .collect::<Vec<f32>>();
    let mut painted = Image::new(SIZE[0] as u32, SIZE[1] as u32, 4).unwrap();
    painted.data_mut().copy_from_slice(&paint);
    let wanted = by_map(&[("color", &color), ("control", &control), ("line_paint", &painted)]);
    let most = found.data().iter().zip(wanted.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(most < 1e-5, "{most}");
    assert!(!are_equal(&found, &by_map(inputs)));
    // Numbers of objects tell no names.
    let ids = numbers();
    let numbered: Inputs<'_> = &[("color", &color), ("object_id", &ids)];
    assert!(are_equal(&ruled(rules, numbered), &by_map(numbered)));
}

#[test]
fn looks_of_things_lie_over_the_picture_where_the_things_are() {
    let json = r##"{"style": "cartoon", "objects": [
        {"match": "cryptomatte:left,right", "line_width": 2,
         "look": {"style": "ink", "parameters": {"line_width": {"1": 2, "9": 6}}}, "line_color": "#0000ff"},
        {"match": "cryptomatte:middle", "look": "watercolor"}]}"##;
    let (mut graph, settings) = preset::open_json("p.json", json, None).unwrap();
    assert_eq!(settings.left_out(), []);
    assert_eq!(settings.frames(), [1, 9]);
    assert!(settings.at_frame(&mut graph, 9).unwrap());
    let (color, names) = (picture(), names());
    let inputs: Inputs<'_> = &[("color", &color), ("cryptomatte", &names)];
    let found = run(&graph, inputs);

    let control =
        result::picture(SIZE, |x, _| [0.5, 0.5 + [0.125, 0.0, 0.0625, 0.0][(x / 24) as usize], 0.5, 0.5]);
    let look = |style: &str, values: &[(&str, &str)]| {
        let mut graph = Graph::single(style).unwrap();
        let node = graph.node(0).unwrap();
        values.iter().for_each(|(name, value)| graph.set_text(node, name, value).unwrap());
        run(&graph, &[("color", &color), ("cryptomatte", &names), ("control", &control)])
    };
    let cartoon = look("cartoon", &[]);
    let ink = look("ink", &[("line_width", "6"), ("line_color", "#0000ff"), ("line_colors", "one")]);
    let watercolor = look("watercolor", &[]);
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let [c, i, w] = [&cartoon, &ink, &watercolor].map(|image| image.pixel(x, y));
            let over = |a: &[f32], b: &[f32], share: f32| -> Vec<f32> {
                a.iter().zip(b).map(|(a, b)| a + (b - a) * share).collect()
            };
            let wanted = match x / 24 {
                0 => over(&over(c, i, 0.5), w, 0.5),
                1 => w.to_vec(),
                2 => over(c, i, 0.25),
                _ => c.to_vec(),
            };
            let own = found.pixel(x, y);
            assert!(
                own.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-5),
                "{x} {y}: {own:?} {wanted:?}"
            );
        }
    }
    // Without names nothing is known of things, and the graph is as it was.
    let plain: Inputs<'_> = &[("color", &color)];
    assert!(are_equal(&run(&graph, plain), &run(&Graph::single("cartoon").unwrap(), plain)));
}

#[test]
fn looks_of_things_that_no_graph_can_hold_are_named() {
    for (look, problem) in [
        (r#"{"style": "ink", "lengths": "pixels"}"#, "lengths that are pixels"),
        (r#"{"style": "structure_tensor"}"#, "makes no colours"),
        (r#"{"style": "ink", "parameters": {"line_wide": 3}}"#, "line_wide"),
        (r#""inc""#, "inc"),
    ] {
        let json = format!(r#"{{"style": "cartoon", "objects": [{{"match": "id:1", "look": {look}}}]}}"#);
        let (graph, settings) = preset::open_json("p.json", &json, None).unwrap();
        let [fault] = settings.left_out() else { panic!("{look}") };
        assert!(fault.place.starts_with("id:1: its look") && fault.to_string().contains(problem), "{fault}");
        assert!(graph.looks().is_empty() && graph.rules().len() == 1);
    }
}
