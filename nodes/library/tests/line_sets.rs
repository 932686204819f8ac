//! Sets of lines, on the CPU executor: each kind has its colour, opacity and width, lines of what is behind end before what is in
//! front, and the ends of lines run out.

use crate::result::{self, picture};
use isophote::engine::Image;
use isophote::{Graph, Planned, Request};

const SIZE: [i32; 2] = [240, 180];
const STYLES: [&str; 3] = ["cartoon", "blueprint", "ink"];

/// Colours of the picture's own lines and of those of each kind, with a place where there is one of each, and whether it runs
/// upright.
const KINDS: [(&str, &str, [i32; 2], bool); 4] = [
    ("line_color", "#f0d000", [152, 128], false),
    ("outline_color", "#d01030", [60, 40], true),
    ("border_color", "#1050e0", [152, 100], false),
    ("crease_color", "#10a040", [174, 115], true),
];

/// A post before a beam, under which a box hangs, on nothing.
#[derive(Clone, Copy, PartialEq)]
enum Thing {
    Post,
    Beam,
    Box,
    Nothing,
}

impl Thing {
    fn at(x: i32, y: i32) -> Self {
        match (x, y) {
            (60..80, 20..160) => Self::Post,
            (10..210, 70..100) => Self::Beam,
            (140..208, 100..156) => Self::Box,
            _ => Self::Nothing,
        }
    }

    /// Its distance, 0 for none.
    fn depth(self) -> f32 {
        [2.0, 4.0, 4.0, 0.0][self as usize]
    }
}

/// The scene as a renderer knows it, with distances averaged over so many pixels to each side.
struct Scene {
    color: Image,
    normal: Image,
    depth: Image,
    id: Image,
}

impl Scene {
    fn new(smooth: i32) -> Self {
        let scalar = |value: &dyn Fn(i32, i32) -> f32| {
            let mut image = Image::new(SIZE[0] as u32, SIZE[1] as u32, 1).unwrap();
            for (at, v) in (0..).zip(image.data_mut()) {
                *v = value(at % SIZE[0], at / SIZE[0]);
            }
            image
        };
        let normal = |x, y| match Thing::at(x, y) {
            Thing::Nothing => [0.0; 4],
            Thing::Box => [if x < 174 { -0.6 } else { 0.6 }, 0.0, 0.8, 1.0],
            _ => [0.0, 0.0, 1.0, 1.0],
        };
        // Renderers average what is nearer, and empty pixels count as infinitely far.
        let depth = |x, y| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (dx, dy) in (-smooth..=smooth).flat_map(|dx| (-smooth..=smooth).map(move |dy| (dx, dy))) {
                let z = Thing::at(x + dx, y + dy).depth();
                (sum, count) = (sum + if z > 0.0 { 1.0 / z } else { 0.0 }, count + 1.0);
            }
            if sum > 0.0 { count / sum } else { 0.0 }
        };
        let color = |x, y| {
            let is_dark = Thing::at(x, y) == Thing::Box && y >= 128 && x < 174;
            let v = if is_dark { 0.45 } else { 0.65 };
            [v, v, v, 1.0]
        };
        Self {
            color: picture(SIZE, color),
            normal: picture(SIZE, normal),
            depth: scalar(&depth),
            id: scalar(&|x, y| (Thing::at(x, y) as i32 + 1) as f32),
        }
    }

    /// The lines of a style alone.
    fn lines(&self, style: &str, settings: &[(&str, &str)]) -> Image {
        self.painted(style, settings, None)
    }

    /// The same in the colours that are painted.
    fn painted(&self, style: &str, settings: &[(&str, &str)], paint: Option<&Image>) -> Image {
        let known = [
            ("color", &self.color),
            ("normal", &self.normal),
            ("depth", &self.depth),
            ("object_id", &self.id),
        ];
        let inputs: Vec<_> = known.into_iter().chain(paint.map(|paint| ("line_paint", paint))).collect();
        let plain: &[(&str, &str)] = match style {
            "cartoon" => &[("posterize", "0"), ("sigma_a", "0")],
            "ink" => &[("tone", "0"), ("grain", "0")],
            _ => &[],
        };
        let settings = [plain, &[("show", "lines")], settings].concat();
        result::at(style, &settings, Request::new(SIZE[0] as u32, SIZE[1] as u32), &inputs)
    }
}

/// The strongest pixel of a line within three of a place on it.
fn strongest(lines: &Image, [x, y]: [i32; 2], upright: bool) -> [f32; 4] {
    let across = (-3..=3).map(|d| if upright { [x + d, y] } else { [x, y + d] });
    let pixels = across.map(|[x, y]| <[f32; 4]>::try_from(lines.pixel(x, y)).unwrap());
    pixels.reduce(|a, b| if a[3] > b[3] { a } else { b }).unwrap()
}

fn channels(text: &str) -> [f32; 3] {
    [1, 3, 5].map(|at| f32::from(u8::from_str_radix(&text[at..at + 2], 16).unwrap()) / 255.0)
}

fn by_kind() -> Vec<(&'static str, &'static str)> {
    let colours = KINDS.iter().map(|(param, colour, ..)| (*param, *colour));
    colours.chain([("line_colors", "kinds")]).collect()
}

#[test]
fn each_kind_has_its_colour_however_smooth_depth_is() {
    for scene in [Scene::new(0), Scene::new(1)] {
        for style in STYLES {
            let lines = scene.lines(style, &by_kind());
            for (param, colour, place, upright) in KINDS {
                let [r, g, b, a] = strongest(&lines, place, upright);
                let wanted = channels(colour);
                let off = [r, g, b].iter().zip(wanted).map(|(v, w)| (v - w).abs()).fold(0.0, f32::max);
                assert!(a > 0.3 && off < 0.06, "{style} {param}: {:?}", [r, g, b, a]);
            }
        }
    }
}

#[test]
fn lines_have_the_colours_that_are_painted_as_far_as_those_are_opaque() {
    let scene = Scene::new(1);
    let (green, first) = ([0.0, 0.6, 0.2], 150);
    // Nothing to the left, then paint, and thin paint over the crease. Colours are multiplied by alpha.
    let weight = |x: i32| [0.0, 1.0, 0.5][usize::from(x >= first) + usize::from(x >= first + 15)];
    let paint = picture(SIZE, |x, _| [green[0], green[1], green[2], 1.0].map(|v: f32| v * weight(x)));
    let nothing = picture(SIZE, |_, _| [0.0; 4]);
    let kinds = by_kind();
    for style in STYLES {
        for settings in [&[][..], &kinds] {
            let (plain, painted) =
                (scene.lines(style, settings), scene.painted(style, settings, Some(&paint)));
            for (param, _, place, upright) in KINDS {
                let [own, found] = [&plain, &painted].map(|lines| strongest(lines, place, upright));
                let share = weight(place[0]);
                let off = (0..3).map(|c| (found[c] - (own[c] + share * (green[c] - own[c]))).abs());
                let off = off.fold((found[3] - own[3]).abs(), f32::max);
                assert!(own[3] > 0.3 && off < 0.02, "{style} {param}: {found:?}, and {own:?} by itself");
            }
            let unpainted = scene.painted(style, settings, Some(&nothing));
            let off = plain.data().iter().zip(unpainted.data()).map(|(a, b)| (a - b).abs());
            let off = off.fold(0.0, f32::max);
            assert!(off < 1e-5, "{style}: what nobody painted changes by {off}");
        }
    }
}

#[test]
fn one_colour_takes_no_pass_and_no_guides_leave_all_lines_theirs() {
    for style in STYLES {
        let kernels = |colours: &str, guided: bool| {
            let mut graph = Graph::single(style).unwrap();
            let id = graph.node(0).unwrap();
            graph.set_text(id, "line_colors", colours).unwrap();
            let mut request = Request::new(SIZE[0] as u32, SIZE[1] as u32);
            (request.guides.depth, request.guides.object_id) = (guided, guided);
            let planned = Planned::new(&graph, request).unwrap();
            planned.plan().passes().iter().map(|pass| pass.kernel.name).collect::<Vec<_>>()
        };
        assert_eq!(kernels("one", false), kernels("kinds", false), "{style}");
        let (one, kinds) = (kernels("one", true), kernels("kinds", true));
        assert!(!one.contains(&"line_kinds") && kinds.contains(&"line_kinds"), "{style}");
    }
}

#[test]
fn opacities_and_widths_are_those_of_kinds() {
    let scene = Scene::new(1);
    for style in STYLES {
        let at = |lines: &Image, kind: usize| strongest(lines, KINDS[kind].2, KINDS[kind].3)[3];
        let all = scene.lines(style, &by_kind());
        for (kind, (param, colour, ..)) in KINDS.into_iter().enumerate().skip(1) {
            let faint = format!("{colour}40");
            let lines = scene.lines(style, &[by_kind(), vec![(param, faint.as_str())]].concat());
            for (other, (name, ..)) in KINDS.into_iter().enumerate() {
                let share = at(&lines, other) / at(&all, other);
                let wanted = if other == kind { 0.25 } else { 1.0 };
                assert!((share - wanted).abs() < 0.08, "{style} {param}: {share} of {name}");
            }
        }
        // A border is drawn once, and goes as a whole.
        let none = scene.lines(style, &[("border_width", "0")]);
        let plain = scene.lines(style, &[]);
        assert!(at(&plain, 2) > 0.3 && at(&none, 2) < 0.05, "{style}: {} {}", at(&plain, 2), at(&none, 2));
        for other in [1, 3] {
            assert!((at(&none, other) - at(&plain, other)).abs() < 0.05, "{style}: {}", KINDS[other].0);
        }
    }
}

#[test]
fn lines_behind_end_before_what_is_in_front() {
    for scene in [Scene::new(0), Scene::new(1)] {
        for style in STYLES {
            let [plain, gap] = ["0", "12"].map(|gap| scene.lines(style, &[("line_gap", gap)]));
            // Along the upper edge of the beam, to the right of the post.
            let at = |lines: &Image, x: i32| strongest(lines, [x, 70], false)[3];
            let end = |lines: &Image| (84..130).find(|x| at(lines, *x) > 0.5 * at(lines, 130)).unwrap();
            assert!(end(&plain) <= 85, "{style}: {}", end(&plain));
            for lines in [&plain, &gap] {
                for y in 66..75 {
                    let row: Vec<String> =
                        (76..104).map(|x| format!("{:3}", (lines.pixel(x, y)[3] * 100.0) as i32)).collect();
                    println!("{}", row.join(" "));
                }
                println!();
            }
            let end = end(&gap);
            assert!((88..=97).contains(&end), "{style}: the line begins at {end}, and the post ends at 80");
            // What is in front has its own outline, as it was.
            for y in [40, 85, 120] {
                let [a, b] = [&plain, &gap].map(|lines| strongest(lines, [80, y], true)[3]);
                assert!((a - b).abs() < 0.1, "{style} at {y}: {a} {b}");
            }
        }
    }
}

#[test]
fn ends_run_out_and_closed_lines_keep_their_width() {
    // A stroke, and a disc.
    let color = picture(SIZE, |x, y| {
        let stroke = (20..110).contains(&x) && (120..124).contains(&y);
        let disc = ((x - 180) as f32).hypot((y - 60) as f32) < 36.0;
        let v = if disc || stroke { 0.35 } else { 0.7 };
        [v, v, v, 1.0]
    });
    let drawn = |style: &str, taper: &str| {
        let settings = [("show", "lines"), ("line_width", "5"), ("taper", taper)];
        result::at(style, &settings, Request::new(SIZE[0] as u32, SIZE[1] as u32), &[("color", &color)])
    };
    let ink = |lines: &Image, [x0, y0, x1, y1]: [i32; 4]| -> f32 {
        (x0..x1).flat_map(|x| (y0..y1).map(move |y| lines.pixel(x, y)[3])).sum()
    };
    for style in ["cartoon", "blueprint"] {
        let [plain, tapered] = ["0", "16"].map(|taper| drawn(style, taper));
        // Both ends of the stroke, its middle, and the disc.
        let parts = [[10, 105, 30, 140], [100, 105, 120, 140], [55, 105, 75, 140], [130, 0, 240, 104]];
        let shares = parts.map(|part| ink(&tapered, part) / ink(&plain, part));
        let [first, last, middle, disc] = shares;
        assert!(first < 0.75 && last < 0.75 && middle > 0.97 && disc > 0.97, "{style}: {shares:?}");
        // Narrower and narrower.
        let widths: Vec<f32> = (92..110).map(|x| ink(&tapered, [x, 105, x + 1, 140])).collect();
        assert!(widths.windows(2).all(|pair| pair[1] < pair[0] + 0.1), "{style}: {widths:?}");
    }
}
