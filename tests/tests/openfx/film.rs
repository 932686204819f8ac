//! A film for tests: a picture that moves, its motion as renderers store it, and what the library itself makes of it.

use super::reference::*;
use isophote::graph::GraphInput;
use isophote::{Graph, Request, Value};
use isophote_abi::openfx::*;
use isophote_engine::Image;
use isophote_tests::ofx::effect::{Instance, Wanted};
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::sequences::Player;

pub const SIZE: [i32; 2] = [53, 38];
/// First and last frame.
pub const RANGE: [i64; 2] = [3, 8];
/// Pixels that everything moves from frame to frame, x to the right and y down.
pub const STEP: [f32; 2] = [1.5, -0.75];

/// One frame: what stands still in the film's own place.
pub fn frame(number: i64) -> Vec<f32> {
    let moved = STEP.map(|s| s * number as f32);
    let pixel = |x: i32, y: i32| {
        let (x, y) = (x as f32 - moved[0], y as f32 - moved[1]);
        let ring = (0.35 * (x - 20.0).hypot(y - 22.0)).sin();
        let blob = if (x - 24.0).hypot(y - 20.0) < 9.0 { 0.35 } else { 0.0 };
        let value = |c: f32| (0.45 + 0.2 * ring + 0.12 * (0.21 * x + c).sin() + blob * c).clamp(0.0, 1.0);
        [value(0.3), value(0.7), value(1.0), 1.0]
    };
    (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).flat_map(move |x| pixel(x, y))).collect()
}

/// The same vector everywhere, in RGBA.
pub fn vectors([x, y]: [f32; 2], [z, w]: [f32; 2]) -> Vec<f32> {
    (0..SIZE[0] * SIZE[1]).flat_map(|_| [x, y, z, w]).collect()
}

pub fn picture(layout: Layout, pixels: &[f32]) -> Picture {
    Picture::packed_in(layout, SIZE[0], SIZE[1], &packed(pixels, &layout))
}

/// Connects the film.
pub fn connect(instance: &Instance<'_>, layout: Layout) {
    let frames = (RANGE[0]..=RANGE[1]).map(|n| picture(layout, &frame(n))).collect();
    instance.connect_film("Source", RANGE[0] as i32, frames);
}

/// Connects vectors of the same kind in every frame to a clip.
pub fn connect_vectors(instance: &Instance<'_>, clip: &str, pixels: &[f32]) {
    let frames = (RANGE[0]..=RANGE[1]).map(|_| picture(Layout::default(), pixels)).collect();
    instance.connect_film(clip, RANGE[0] as i32, frames);
}

/// Vectors to the frame before, as compositors have them.
pub fn connect_motion(instance: &Instance<'_>) {
    connect_vectors(instance, "Motion", &vectors([-STEP[0], STEP[1]], [0.0, 1.0]));
}

/// A frame of the film through an effect.
pub fn render(instance: &Instance<'_>, time: i64) -> Picture {
    let layout = Layout::default();
    let wanted = Wanted { time: time as f64, ..Wanted::new([0, 0, SIZE[0], SIZE[1]]) };
    let (status, picture) = instance.try_render(layout, SIZE, &wanted);
    assert_eq!(status, kOfxStatOK, "{} at {time}", instance.plugin.identifier());
    picture
}

/// A frame of the film as the library's own sequences have it, with motion from images or by optical flow.
pub fn through_the_library(effect: &Expected, window: i32, estimated: bool, time: i64) -> Vec<f32> {
    let mut graph = Graph::single(effect.node.id).unwrap();
    let node = graph.node(0).unwrap();
    graph.set(node, "steadiness", Value::Float(0.5)).unwrap();
    graph.set(node, "window", Value::Int(window)).unwrap();
    if estimated {
        for (port, direction) in [("motion", "backward"), ("motion_forward", "forward")] {
            let flow = graph.add(port, "optical_flow").unwrap();
            graph.set_text(flow, "direction", direction).unwrap();
            graph.set_text(flow, "quality", "fast").unwrap();
            graph.connect_input(GraphInput::Color, flow, "color").unwrap();
            graph.connect(flow, node, port).unwrap();
        }
    }
    let [w, h] = SIZE.map(|n| n as u32);
    let show = |input, number: i64| {
        let vector = match input {
            GraphInput::Color if (RANGE[0]..=RANGE[1]).contains(&number) => {
                return Some(Image::from_vec(w, h, 4, frame(number)).unwrap());
            }
            GraphInput::Motion => STEP.map(|s| -s),
            GraphInput::MotionForward => STEP,
            _ => return None,
        };
        let is_there = !estimated && (RANGE[0]..=RANGE[1]).contains(&number);
        is_there.then(|| Image::from_vec(w, h, 2, vector.repeat((w * h) as usize)).unwrap())
    };
    let image = Player::new(graph, 0).frame(Request::new(w, h), time, &show);
    match image.channels() {
        4 => image.into_data(),
        // Lines are shown as opaque grey.
        _ => image.data().iter().flat_map(|v| [*v, *v, *v, 1.0]).collect(),
    }
}
