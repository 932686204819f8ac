//! Lines that waver, on the CPU executor: they alone move, as far as asked for, with things or with the screen.

use crate::result::{self, Inputs};
use isophote::engine::{Image, Rect};
use isophote::{ColourSpace, Graph, Planned, Request};

const SIZE: [i32; 2] = [192, 144];
/// Columns at which a dark bar begins and ends.
const BAR: [i32; 2] = [56, 136];
const STYLES: [&str; 2] = ["cartoon", "blueprint"];
/// Distance from an edge within which its line lies, wobble included.
const NEAR: i32 = 20;

fn picture([width, height]: [i32; 2], value: impl Fn(i32, i32) -> [f32; 4]) -> Image {
    let mut image = Image::new(width as u32, height as u32, 4).unwrap();
    for (at, pixel) in image.data_mut().chunks_exact_mut(4).enumerate() {
        pixel.copy_from_slice(&value(at as i32 % width, at as i32 / width));
    }
    image
}

/// The bar, moved to the right.
fn bar(moved: i32) -> Image {
    picture(SIZE, |x, _| {
        let v = if (BAR[0]..BAR[1]).contains(&(x - moved)) { 0.2 } else { 0.75 };
        [v, v, v, 1.0]
    })
}

/// Points of what the bar is painted on, moved to the right.
fn points(moved: i32) -> Image {
    picture(SIZE, |x, y| [0.05 * (x - moved) as f32, 0.05 * y as f32, 0.25, 1.0])
}

/// Coverage of the lines alone.
fn lines(style: &str, wobble: &str, request: Request, inputs: Inputs<'_>) -> Image {
    result::at(style, &[("show", "lines"), ("wobble", wobble), ("hold", "2")], request, inputs)
}

fn request() -> Request {
    Request::new(SIZE[0] as u32, SIZE[1] as u32)
}

/// Column of the line of an edge in each row.
fn columns(lines: &Image, edge: i32) -> Vec<f32> {
    let row = |y: i32| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for x in edge - NEAR..edge + NEAR {
            let alpha = lines.pixel(x, y)[3];
            (sum, weights) = (sum + alpha * (x as f32 + 0.5), weights + alpha);
        }
        assert!(weights > 0.3, "the line at {edge} has a hole in row {y}: {weights}");
        sum / weights
    };
    (8..lines.height() as i32 - 8).map(row).collect()
}

/// Distances of a wavering line from the straight one.
fn moves(wavering: &Image, straight: &Image, edge: i32) -> Vec<f32> {
    columns(wavering, edge).iter().zip(columns(straight, edge)).map(|(a, b)| a - b).collect()
}

fn most(values: &[f32]) -> f32 {
    values.iter().fold(0.0, |most, v| v.abs().max(most))
}

fn apart(a: &Image, b: &Image) -> f32 {
    a.data().iter().zip(b.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The columns of a picture from `x` on, `width` of them.
fn part(image: &Image, x: i32, width: i32) -> Image {
    picture([width, SIZE[1]], |u, v| <[f32; 4]>::try_from(image.pixel(x + u, v)).unwrap())
}

#[test]
fn lines_that_stay_take_no_pass_and_read_no_points() {
    for style in STYLES {
        let kernels = |wobble: &str| {
            let mut graph = Graph::single(style).unwrap();
            let id = graph.node(0).unwrap();
            graph.set_text(id, "wobble", wobble).unwrap();
            let mut request = request();
            request.guides.rest_position = true;
            let planned = Planned::new(&graph, request).unwrap();
            planned.plan().passes().iter().map(|pass| pass.kernel.name).collect::<Vec<_>>()
        };
        let (still, moving) = (kernels("0"), kernels("1"));
        for kernel in ["line_wobble", "solid_noise", "rest_footprint"] {
            assert!(!still.contains(&kernel) && moving.contains(&kernel), "{style}: {kernel}");
        }
    }
}

#[test]
fn lines_waver_gently_and_as_far_as_asked_for() {
    let color = bar(0);
    for style in STYLES {
        let straight = lines(style, "0", request(), &[("color", &color)]);
        let mut last = 0.0;
        for wobble in ["1", "3", "6"] {
            let wavering = lines(style, wobble, request(), &[("color", &color)]);
            let farthest: f32 = wobble.parse().unwrap();
            for edge in BAR {
                let moves = moves(&wavering, &straight, edge);
                let steps: Vec<f32> = moves.windows(2).map(|pair| pair[1] - pair[0]).collect();
                let (far, step) = (most(&moves), most(&steps));
                assert!(far > 0.4 * farthest && far < 1.3 * farthest, "{style} {wobble}: {far}");
                assert!(step < 1.0 && step < farthest, "{style} {wobble}: jumps by {step}");
            }
            let away = apart(&wavering, &straight);
            assert!(away > 0.9 * last, "{style} {wobble}");
            last = away;
            let mean = |image: &Image| image.data().chunks_exact(4).map(|p| p[3]).sum::<f32>();
            let share = mean(&wavering) / mean(&straight);
            assert!((share - 1.0).abs() < 0.08, "{style} {wobble}: {share} of the ink");
        }
    }
}

#[test]
fn what_is_between_lines_stays() {
    let color = bar(0);
    let [straight, wavering] = ["0", "3"].map(|wobble| {
        // The last smoothing spreads what is beside it.
        let settings = [("wobble", wobble), ("sigma_a", "0")];
        result::of("cartoon", &settings, ColourSpace::Srgb, &[("color", &color)])
    });
    for (at, (a, b)) in straight.data().iter().zip(wavering.data()).enumerate() {
        let x = at as i32 / 4 % SIZE[0];
        assert!(
            (a - b).abs() < 1e-5 || BAR.iter().any(|edge| (x - edge).abs() < NEAR),
            "column {x}: {a} {b}"
        );
    }
    assert!(apart(&straight, &wavering) > 0.2);
    // A sheet without lines.
    let plain = picture(SIZE, |_, _| [0.5, 0.5, 0.5, 1.0]);
    let [straight, wavering] = ["0", "3"].map(|wobble| {
        result::of("blueprint", &[("wobble", wobble)], ColourSpace::Srgb, &[("color", &plain)])
    });
    assert!(apart(&straight, &wavering) < 1e-5, "the grid moves");
}

#[test]
fn on_things_the_wobble_moves_with_them() {
    const MOVED: i32 = 11;
    let (color, there) = (bar(0), bar(MOVED));
    let (rest, rest_there) = (points(0), points(MOVED));
    for style in STYLES {
        let screen = [&color, &there].map(|color| lines(style, "3", request(), &[("color", color)]));
        let things = [(&color, &rest), (&there, &rest_there)]
            .map(|(color, rest)| lines(style, "3", request(), &[("color", color), ("rest_position", rest)]));
        // Off the borders, whose surroundings move in and out.
        let carried = |[before, after]: &[Image; 2]| {
            let width = SIZE[0] - 2 * NEAR - MOVED;
            apart(&part(before, NEAR, width), &part(after, NEAR + MOVED, width))
        };
        assert!(carried(&things) < 0.02, "{style}: {} on things", carried(&things));
        assert!(carried(&screen) > 0.2, "{style}: {} on the screen", carried(&screen));
        // Farther from the camera waves stay as long on the screen.
        let away = picture(SIZE, |x, y| [0.2 * x as f32, 0.2 * y as f32, 0.25, 1.0]);
        let straight = lines(style, "0", request(), &[("color", &color)]);
        let far = lines(style, "3", request(), &[("color", &color), ("rest_position", &away)]);
        let steps = |lines: &Image| {
            let moves = moves(lines, &straight, BAR[0]);
            moves.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f32>().sqrt()
        };
        let ratio = steps(&far) / steps(&things[0]);
        assert!((0.5..2.0).contains(&ratio), "{style}: {ratio}");
    }
}

#[test]
fn on_twos_a_drawing_lasts_two_frames() {
    let (color, rest) = (bar(0), points(0));
    for style in STYLES {
        for inputs in [&[("color", &color)][..], &[("color", &color), ("rest_position", &rest)]] {
            let at = |frame: i64| lines(style, "2", Request { frame, ..request() }, inputs);
            let (first, second) = (at(6), at(8));
            assert!(first == at(7) && second == at(9), "{style}: two frames are one drawing");
            assert!(apart(&first, &second) > 0.2, "{style}: the next drawing is another");
            assert!(at(6) == first && at(-2) == at(-1), "{style}: in any order");
        }
    }
}

#[test]
fn a_tile_is_the_same_part_of_the_picture() {
    let (color, rest) = (bar(0), points(0));
    let tile = Rect { x0: BAR[0] - 9, y0: 31, x1: BAR[0] + 6, y1: 60 };
    for style in STYLES {
        let request = request();
        for wobble in ["0.3", "2.5", "6"] {
            for inputs in [&[("color", &color)][..], &[("color", &color), ("rest_position", &rest)]] {
                let settings = [("wobble", wobble)];
                let whole = result::at(style, &settings, request, inputs).crop(tile).unwrap();
                let alone = result::part(style, &settings, request, inputs, tile);
                assert_eq!(whole.window(), alone.window());
                let same = whole.data().iter().zip(alone.data()).all(|(a, b)| a.to_bits() == b.to_bits());
                assert!(same, "{style} {wobble}");
            }
        }
    }
}

#[test]
fn a_box_within_the_picture_has_its_part_of_the_waves() {
    const LEFT: i32 = 16;
    let color = bar(0);
    let width = SIZE[0] - LEFT;
    let inner = part(&color, LEFT, width);
    for style in STYLES {
        let whole = lines(style, "3", request(), &[("color", &color)]);
        let boxed = |x: i32| {
            let request =
                Request { origin: [f64::from(x), 0.0], ..Request::new(width as u32, SIZE[1] as u32) };
            part(&lines(style, "3", request, &[("color", &inner)]), NEAR, width - 2 * NEAR)
        };
        let wanted = part(&whole, LEFT + NEAR, width - 2 * NEAR);
        assert!(apart(&boxed(LEFT), &wanted) < 1e-3, "{style}: {}", apart(&boxed(LEFT), &wanted));
        assert!(apart(&boxed(0), &wanted) > 0.2, "{style}");
    }
}

#[test]
fn proxies_waver_as_full_pictures() {
    let half = [SIZE[0] / 2, SIZE[1] / 2];
    let color = bar(0);
    let small = picture(half, |x, y| <[f32; 4]>::try_from(color.pixel(2 * x, 2 * y)).unwrap());
    for style in STYLES {
        let full = |wobble| lines(style, wobble, request(), &[("color", &color)]);
        let proxy = |wobble| {
            let request = Request { scale: 0.5, ..Request::new(half[0] as u32, half[1] as u32) };
            // As wide as the full one, so that edges lie at the same columns.
            let lines = lines(style, wobble, request, &[("color", &small)]);
            picture(SIZE, |x, y| <[f32; 4]>::try_from(lines.pixel(x / 2, y / 2)).unwrap())
        };
        let (large, small) = (moves(&full("3"), &full("0"), BAR[0]), moves(&proxy("3"), &proxy("0"), BAR[0]));
        let apart: Vec<f32> = large.iter().zip(&small).map(|(a, b)| a - b).collect();
        let mean = |values: &[f32]| (values.iter().map(|v| v * v).sum::<f32>() / values.len() as f32).sqrt();
        assert!(mean(&apart) < 0.3 * mean(&large), "{style}: {} of {}", mean(&apart), mean(&large));
    }
}
