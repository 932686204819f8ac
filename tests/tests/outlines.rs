//! Lines where geometry breaks: silhouettes and creases that a renderer knows of are drawn, whatever lies behind them, and
//! on plain forms nothing else is. At every size of the picture they are all there, as are those that colours draw.

use isophote::Request;
use isophote::request::Guides;
use isophote_engine::cpu::Control;
use isophote_engine::{Image, Plan, Rect};
use isophote_tests::pictures::from_fn;
use isophote_tests::scenery::forms;
use isophote_tests::{device, png, run};

/// Controls that hide nothing of the lines.
const SMOOTH_TONES: (&str, &str) = ("posterize", "0");
const NO_GRAIN: (&str, &str) = ("grain", "0");

/// A style, its parameters without tones, and whether a luma is of a line.
type Style = (&'static str, &'static [(&'static str, &'static str)], fn(f32) -> bool);

const STYLES: [Style; 3] = [
    ("cartoon", &[("line_color", "#ff00ff")], |_| false),
    ("ink", &[("tone", "0"), ("grain", "0")], |luma| luma < 0.5),
    ("blueprint", &[("grid", "0"), ("paper_texture", "0"), ("fill", "0")], |luma| luma > 0.5),
];

/// Pixels on both sides of a break of what `differs`, which lies half a pixel from them.
fn beside(width: i32, height: i32, differs: impl Fn([i32; 2], [i32; 2]) -> bool) -> Vec<[i32; 2]> {
    let mut found = Vec::new();
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            for other in [[x + 1, y], [x, y + 1]] {
                if differs([x, y], other) {
                    found.extend([[x, y], other]);
                }
            }
        }
    }
    found
}

fn is_near(marks: &[bool], width: i32, height: i32, [x, y]: [i32; 2], distance: f32) -> bool {
    let reach = distance.ceil() as i32;
    (-reach..=reach).any(|dy| {
        (-reach..=reach).any(|dx| {
            let (u, v) = (x + dx, y + dy);
            let inside = (0..width).contains(&u) && (0..height).contains(&v);
            inside && (dx as f32).hypot(dy as f32) <= distance && marks[(v * width + u) as usize]
        })
    })
}

fn drawn((id, params, is_line): Style) -> Vec<bool> {
    let color = &forms()[0].1;
    let guides = Guides { normal: true, depth: true, object_id: true, ..Guides::default() };
    let request = Request { guides, ..Request::new(color.width(), color.height()) };
    let result = run::whole(run::planned(&run::single(id, params), request).plan(), forms());
    png::write(&png::results().join(format!("outlines-{id}.png")), &result);
    let pixels = result.data().chunks_exact(4);
    pixels
        .map(|p| {
            // Lines of a colour that nothing else has.
            let is_magenta = p[0] > 0.5 && p[2] > 0.5 && p[1] < 0.35;
            is_magenta || is_line(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2])
        })
        .collect()
}

/// The forms in black: what is lit of them, and the floor, is at most as light as coal.
fn black_forms() -> Vec<(&'static str, Image)> {
    let [(_, color), (_, normal), (_, depth), (_, id)] = forms() else { panic!("four pictures") };
    let black = from_fn(color.width(), color.height(), |x, y| {
        let p = at(color, [x, y]);
        let share = if at(id, [x, y])[0] > 0.0 { 0.16 } else { 1.0 };
        [p[0] * share, p[1] * share, p[2] * share, 1.0]
    });
    vec![("color", black), ("normal", normal.clone()), ("depth", depth.clone()), ("object_id", id.clone())]
}

/// Pixels of a picture in which lines change the luma by so much that they are seen, and those that differ as much from their
/// neighbours without any line, as black things do from the sky.
fn seen(id: &str, params: &[(&str, &str)], inputs: &[(&'static str, Image)]) -> [Vec<bool>; 2] {
    let color = &inputs[0].1;
    let guides = Guides { normal: true, depth: true, object_id: true, ..Guides::default() };
    let request = Request { guides, ..Request::new(color.width(), color.height()) };
    let none = [params, GUIDES_OFF, COLOURS_OFF].concat();
    let [with, without] = [params, &none].map(|params| {
        let result = run::whole(run::planned(&run::single(id, params), request).plan(), inputs);
        let luma = |p: &[f32]| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
        (result.data().chunks_exact(4).map(luma).collect::<Vec<_>>(), result)
    });
    png::write(&png::results().join(format!("outlines-black-{id}-{}.png", params[0].1)), &with.1);
    let lines = with.0.iter().zip(&without.0).map(|(a, b)| (a - b).abs() >= 0.2).collect();
    let (width, height) = (color.width() as i32, color.height() as i32);
    let mut edges = vec![false; without.0.len()];
    let luma = |[x, y]: [i32; 2]| without.0[(y * width + x) as usize];
    for [x, y] in beside(width, height, |a, b| (luma(a) - luma(b)).abs() >= 0.2) {
        edges[(y * width + x) as usize] = true;
    }
    [lines, edges]
}

fn at(image: &Image, [x, y]: [i32; 2]) -> &[f32] {
    image.pixel(x, y)
}

/// Pixels beside outlines of the forms, and beside their creases.
fn outlines_and_creases() -> [Vec<[i32; 2]>; 2] {
    let [(_, color), (_, normal), _, (_, id)] = forms() else { panic!("four pictures") };
    let (width, height) = (color.width() as i32, color.height() as i32);
    let outlines = beside(width, height, |a, b| at(id, a) != at(id, b));
    let creases = beside(width, height, |a, b| {
        let dot: f32 = (0..3).map(|c| at(normal, a)[c] * at(normal, b)[c]).sum();
        let is_there = at(normal, a)[3] > 0.5 && at(normal, b)[3] > 0.5;
        is_there && at(id, a) == at(id, b) && dot < 30f32.to_radians().cos() * 0.98
    });
    assert!(outlines.len() > 200 && creases.len() > 40, "{} {}", outlines.len(), creases.len());
    [outlines, creases]
}

/// The share of `wanted` that has a line within a pixel and a half.
fn recall(lines: &[bool], wanted: &[[i32; 2]]) -> f32 {
    let color = &forms()[0].1;
    let (width, height) = (color.width() as i32, color.height() as i32);
    let found = wanted.iter().filter(|p| is_near(lines, width, height, **p, 1.5)).count();
    found as f32 / wanted.len() as f32
}

#[test]
fn silhouettes_and_creases_are_drawn() {
    let wanted = outlines_and_creases();
    for style in STYLES {
        let lines = drawn(style);
        let [outline, crease] = [0, 1].map(|kind| recall(&lines, &wanted[kind]));
        assert!(outline >= 0.97 && crease >= 0.9, "{}: outlines {outline:.3}, creases {crease:.3}", style.0);
    }
}

#[test]
fn black_things_have_their_silhouettes_and_creases() {
    let wanted = outlines_and_creases();
    let forms = black_forms();
    // An outline that parts black from light is seen without a line.
    let recalls = |id: &str, params: &[(&str, &str)]| {
        let [lines, edges] = seen(id, params, &forms);
        let either: Vec<bool> = lines.iter().zip(&edges).map(|(line, edge)| *line || *edge).collect();
        let alone = recall(&lines, &wanted[0]);
        let found = [recall(&either, &wanted[0]), recall(&lines, &wanted[1])];
        println!("{id} {params:?}: outlines {:.3}, by lines {alone:.3}, creases {:.3}", found[0], found[1]);
        found
    };
    for (id, on_dark, more) in [("cartoon", "light", SMOOTH_TONES), ("ink", "light", NO_GRAIN)] {
        let [outline, crease] = recalls(id, &[("line_on_dark", on_dark), more]);
        assert!(
            outline >= 0.97 && crease >= 0.9,
            "{id} {on_dark}: outlines {outline:.3}, creases {crease:.3}"
        );
        // Dark lines on dark ground are lost.
        let [_, lost] = recalls(id, &[("line_on_dark", "off"), more]);
        assert!(lost < 0.8, "{id}: creases {lost:.3}");
    }
}

#[test]
fn no_line_is_without_cause() {
    let [(_, color), (_, normal), _, (_, id)] = forms() else { panic!("four pictures") };
    let (width, height) = (color.width() as i32, color.height() as i32);
    let differs = |a: [i32; 2], b: [i32; 2]| {
        let shade: f32 = (0..3).map(|c| (at(color, a)[c] - at(color, b)[c]).abs()).sum();
        let dot: f32 = (0..3).map(|c| at(normal, a)[c] * at(normal, b)[c]).sum();
        at(id, a) != at(id, b) || at(normal, a)[3] > 0.5 && dot < 0.85 || shade > 0.15
    };
    let mut causes = vec![false; (width * height) as usize];
    for [x, y] in beside(width, height, differs) {
        causes[(y * width + x) as usize] = true;
    }
    for style in STYLES {
        let lines = drawn(style);
        let all: Vec<[i32; 2]> = (0..height)
            .flat_map(|y| (0..width).map(move |x| [x, y]))
            .filter(|[x, y]| lines[(y * width + x) as usize])
            .collect();
        // Lines of ink are up to six pixels wide about their border.
        let caused = all.iter().filter(|p| is_near(&causes, width, height, **p, 3.0)).count();
        let precision = caused as f32 / all.len() as f32;
        assert!(precision >= 0.95, "{}: {precision:.3} of {} line pixels", style.0, all.len());
    }
}

/// The floor of the black forms: solid ink as ever, and a third of it or so paper where masses open.
#[test]
fn black_masses_open_to_hatching() {
    let forms = black_forms();
    let guides = Guides { normal: true, depth: true, object_id: true, ..Guides::default() };
    let request = Request { guides, ..Request::new(forms[0].1.width(), forms[0].1.height()) };
    let [solid, open] = ["off", "open"].map(|on_dark| {
        let graph = run::single("ink", &[("line_on_dark", on_dark), NO_GRAIN]);
        let drawn = run::whole(run::planned(&graph, request).plan(), &forms);
        let floor = (165..180).flat_map(|y| (0..240).map(move |x| [x, y]));
        floor.clone().filter(|p| at(&drawn, *p)[1] > 0.5).count() as f32 / floor.count() as f32
    });
    println!("paper: {solid:.3}, {open:.3} where masses open");
    assert!(solid < 0.02 && open > 0.15 && open < 0.5, "{solid} {open}");
}

/// Line filter, and how it is told to draw no lines.
#[derive(Clone, Copy)]
struct Lines {
    id: &'static str,
    params: &'static [(&'static str, &'static str)],
    none: &'static [(&'static str, &'static str)],
}

const GUIDES_OFF: &[(&str, &str)] = &[("outline_width", "0"), ("crease_width", "0")];

/// Paper without marks and grain, which would hide lines.
const BARE: (&str, &str) = ("shading", "0");
const SMOOTH: (&str, &str) = ("grain", "0");

/// All that draw lines by guides.
const GUIDED: [Lines; 10] = [
    Lines { id: "cartoon", params: &[], none: GUIDES_OFF },
    Lines { id: "blueprint", params: &[], none: GUIDES_OFF },
    Lines { id: "ink", params: &[("style", "ink"), BARE, SMOOTH], none: GUIDES_OFF },
    Lines { id: "ink", params: &[("style", "pencil"), BARE, SMOOTH], none: GUIDES_OFF },
    Lines { id: "ink", params: &[("style", "charcoal"), BARE, SMOOTH], none: GUIDES_OFF },
    Lines { id: "ink", params: &[("style", "woodcut"), BARE, SMOOTH], none: GUIDES_OFF },
    Lines { id: "ink", params: &[("style", "pastel"), BARE, SMOOTH], none: GUIDES_OFF },
    Lines { id: "flow_dog", params: &[("guide_weight", "1")], none: &[("guide_weight", "0")] },
    Lines {
        id: "flow_dog",
        params: &[("guide_weight", "1"), ("integrator", "cabral_leedom")],
        none: &[("guide_weight", "0")],
    },
    Lines {
        id: "flow_dog",
        params: &[("guide_weight", "1"), ("kernel", "two_dimensional"), ("iterations", "2")],
        none: &[("guide_weight", "0")],
    },
];

const COLOURS_OFF: &[(&str, &str)] = &[("texture_lines", "0")];
const EDGES_OFF: &[(&str, &str)] = &[("tau", "0")];
const HEIGHTS_OFF: &[(&str, &str)] = &[("low", "200"), ("high", "200")];

/// All that draw lines where colours differ.
const COLOURED: [Lines; 12] = [
    Lines { id: "cartoon", params: &[], none: COLOURS_OFF },
    Lines { id: "cartoon", params: &[("line_filter", "isotropic")], none: &[("line_amount", "0")] },
    Lines { id: "blueprint", params: &[], none: COLOURS_OFF },
    Lines { id: "ink", params: &[("style", "ink"), BARE, SMOOTH], none: COLOURS_OFF },
    Lines { id: "ink", params: &[("style", "pencil"), BARE, SMOOTH], none: COLOURS_OFF },
    Lines { id: "ink", params: &[("style", "charcoal"), BARE, SMOOTH], none: COLOURS_OFF },
    Lines { id: "ink", params: &[("style", "woodcut"), BARE, SMOOTH], none: COLOURS_OFF },
    Lines { id: "flow_dog", params: &[], none: EDGES_OFF },
    Lines { id: "difference_of_gaussians", params: &[], none: EDGES_OFF },
    Lines { id: "edge_detector", params: &[], none: HEIGHTS_OFF },
    Lines { id: "edge_detector", params: &[("method", "sobel")], none: HEIGHTS_OFF },
    Lines { id: "edge_detector", params: &[("method", "log_zero_crossing")], none: HEIGHTS_OFF },
];

/// A disc in a picture whose lengths are those of one 1080 lines high, cut to what lies around it. Tall pictures show a
/// smaller disc: lines do not know how far they go.
#[derive(Clone, Copy)]
struct Disc {
    scale: f32,
    side: u32,
    centre: [f32; 2],
    radius: f32,
}

impl Disc {
    fn of(height: u32) -> Self {
        let radius = (0.31 * height as f32).min(if height > 1080 { 90.0 } else { 45.0 });
        let side = 2 * (1.2 * radius + 6.0) as u32;
        let centre = [0.5 * side as f32 + 0.3, 0.5 * side as f32 + 0.2];
        Self { scale: height as f32 / 1080.0, side, centre, radius }
    }

    fn has(&self, x: i32, y: i32) -> bool {
        self.distance(x, y) < self.radius
    }

    fn distance(&self, x: i32, y: i32) -> f32 {
        (x as f32 + 0.5 - self.centre[0]).hypot(y as f32 + 0.5 - self.centre[1])
    }

    /// The disc as `guide` tells of it, or the colours alone.
    fn inputs(&self, guide: &str) -> Vec<(&'static str, Image)> {
        let scalar = |inside, outside| {
            from_fn(self.side, self.side, move |x, y| [if self.has(x, y) { inside } else { outside }])
        };
        let grey = |inside: f32, outside: f32| {
            from_fn(self.side, self.side, move |x, y| {
                let v = if self.has(x, y) { inside } else { outside };
                [v, v, v, 1.0]
            })
        };
        match guide {
            "depth" => vec![("color", grey(0.5, 0.5)), ("depth", scalar(5.0, 0.0))],
            "object_id" => vec![("color", grey(0.5, 0.5)), ("object_id", scalar(3.0, 1.0))],
            "normal" => {
                let tilted = |x, y| [if self.has(x, y) { 0.6 } else { -0.6 }, 0.0, 0.8, 1.0];
                vec![("color", grey(0.5, 0.5)), ("normal", from_fn(self.side, self.side, tilted))]
            }
            _ => vec![("color", grey(0.9, 0.4))],
        }
    }

    /// Share of the outline at which something differs visibly within a pixel and a half, or as far on larger pictures, and
    /// how much differs per pixel of the outline.
    fn drawn(&self, with: &Image, without: &Image) -> [f32; 2] {
        let channels = with.channels() as usize;
        let luma = |image: &Image, x, y| match channels {
            1 => image.pixel(x, y)[0],
            _ => image.pixel(x, y)[..3].iter().sum::<f32>() / 3.0,
        };
        let differs = |x, y| (luma(with, x, y) - luma(without, x, y)).abs();
        const POINTS: usize = 360;
        let near = 1.5 * self.scale.max(1.0);
        let reach = near.ceil() as i32;
        let is_drawn = |point: &usize| {
            let (sin, cos) = (*point as f32 / POINTS as f32 * std::f32::consts::TAU).sin_cos();
            let (px, py) =
                (self.radius.mul_add(cos, self.centre[0]), self.radius.mul_add(sin, self.centre[1]));
            (-reach..=reach).any(|dy| {
                (-reach..=reach).any(|dx| {
                    let (x, y) = (px.floor() as i32 + dx, py.floor() as i32 + dy);
                    let is_near = (x as f32 + 0.5 - px).hypot(y as f32 + 0.5 - py) <= near;
                    is_near && differs(x, y) >= 12.0 / 255.0
                })
            })
        };
        let drawn = (0..POINTS).filter(is_drawn).count();
        let side = self.side as i32;
        let all = (0..side).flat_map(|y| (0..side).map(move |x| differs(x, y))).sum::<f32>();
        [drawn as f32 / POINTS as f32, all / (std::f32::consts::TAU * self.radius)]
    }

    /// The plan of a filter for what enters.
    fn plan(&self, lines: Lines, inputs: &[(&'static str, Image)], off: bool) -> Plan {
        let has = |name: &str| inputs.iter().any(|(input, _)| *input == name);
        let guides = Guides {
            normal: has("normal"),
            depth: has("depth"),
            object_id: has("object_id"),
            ..Guides::default()
        };
        let request = Request { guides, scale: self.scale, ..Request::new(self.side, self.side) };
        let params: Vec<_> = lines.params.iter().chain(lines.none.iter().filter(|_| off)).copied().collect();
        run::planned(&run::single(lines.id, &params), request).plan().clone()
    }
}

/// A way of running a plan on pictures by their inputs.
type RunPlan<'a> = dyn FnMut(&Plan, &[(&str, Image)]) -> Image + 'a;

/// The share of a disc's outline that `run` draws at a height, and how much it draws per pixel of it.
fn measured(lines: Lines, guide: &str, height: u32, run: &mut RunPlan<'_>) -> [f32; 2] {
    let disc = Disc::of(height);
    let inputs = disc.inputs(guide);
    let [with, without] = [false, true].map(|off| run(&disc.plan(lines, &inputs, off), &inputs));
    let [drawn, ink] = disc.drawn(&with, &without);
    println!("{} {:?}, {guide}, {height} lines: {:.1} %, {ink:.2}", lines.id, lines.params, 100.0 * drawn);
    [drawn, ink]
}

/// Heights of pictures from thumbnails to 8K; the largest are left to the quickest filters.
const HEIGHTS: [u32; 10] = [90, 180, 270, 360, 480, 540, 720, 1080, 2160, 4320];

fn on_cpu(lines: Lines, guide: &str) -> Vec<[f32; 2]> {
    let is_slow = lines.params.contains(&("kernel", "two_dimensional"));
    let is_quick = !["cartoon", "blueprint", "ink"].contains(&lines.id) && !is_slow;
    let heights = HEIGHTS.into_iter().filter(|height| *height <= 1080 || is_quick);
    heights
        .map(|height| measured(lines, guide, height, &mut |plan, inputs| run::whole(plan, inputs)))
        .collect()
}

/// The disc of `tests/data/cases/lines_small/`, which lost its outline below 540 lines.
#[test]
fn cases_of_small_pictures_have_all_lines_of_guides() {
    for lines in GUIDED {
        for guide in ["depth", "object_id", "normal"] {
            let found = on_cpu(lines, guide);
            let name = format!("{} {:?}, {guide}", lines.id, lines.params);
            assert!(found.iter().all(|[drawn, _]| *drawn >= 1.0), "{name}: {found:?}");
            // At 90 lines they are the lighter, since there they are to be narrower than a pixel; at 540 they are not.
            assert!(found[0][1] < 0.6 * found[5][1], "{name}: {found:?}");
        }
    }
}

#[test]
fn cases_of_small_pictures_have_all_lines_of_colours() {
    for lines in COLOURED {
        let found = on_cpu(lines, "");
        // Soft ones leave out a little at any size.
        let whole = found[7][0];
        assert!(whole > 0.8, "{} {:?}: {found:?}", lines.id, lines.params);
        assert!(found.iter().all(|[drawn, _]| *drawn >= whole), "{} {:?}: {found:?}", lines.id, lines.params);
    }
}

#[test]
fn devices_draw_all_lines_of_small_pictures() {
    let Some(mut gpu) = device::executor("outlines") else { return };
    let mut run = |plan: &Plan, inputs: &[(&str, Image)]| {
        let inputs: Vec<(&str, &Image)> = inputs.iter().map(|(name, image)| (*name, image)).collect();
        let [width, height] = plan.size();
        gpu.run_images(plan, &inputs, Rect::of_size(width, height), Control::default()).unwrap().remove(0)
    };
    for height in [90, 240] {
        for lines in [GUIDED[0], GUIDED[1], GUIDED[2], GUIDED[8], GUIDED[9]] {
            assert_eq!(measured(lines, "depth", height, &mut run)[0], 1.0, "{} at {height}", lines.id);
        }
        for lines in [COLOURED[1], COLOURED[9]] {
            assert_eq!(measured(lines, "", height, &mut run)[0], 1.0, "{} at {height}", lines.id);
        }
    }
}
