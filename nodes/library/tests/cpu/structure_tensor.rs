//! `structure_tensor` on the CPU executor.

use isophote::kernels::shared::tensor::scalar;
use isophote::request::Guides;
use isophote::{Graph, Planned, Request};
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::{Image, Rect};

fn image(width: u32, height: u32, channels: u32, value: impl Fn(u32, u32, u32) -> f32) -> Image {
    let pixels = width * height * channels;
    let values = (0..pixels).map(|i| {
        let (pixel, channel) = (i / channels, i % channels);
        value(pixel % width, pixel / width, channel)
    });
    Image::from_vec(width, height, channels, values.collect()).unwrap()
}

/// Noise of every bit pattern that a picture could have, in 0..1.
fn noise(seed: u32) -> impl Fn(u32, u32, u32) -> f32 {
    move |x, y, c| {
        let mut h = seed.wrapping_add(x.wrapping_mul(0x9e37_79b1)) ^ y.wrapping_mul(0x85eb_ca77) ^ (c << 28);
        for _ in 0..3 {
            h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
        }
        (h >> 8) as f32 / 16_777_216.0
    }
}

struct Scene {
    images: Vec<(&'static str, Image)>,
    size: [u32; 2],
}

impl Scene {
    fn color(color: Image) -> Self {
        Self { size: [color.width(), color.height()], images: vec![("color", color)] }
    }

    fn planned(&self, settings: &[(&str, &str)]) -> Planned {
        let mut graph = Graph::single("structure_tensor").unwrap();
        let node = graph.node(0).unwrap();
        for (param, value) in settings {
            graph.set_text(node, param, value).unwrap();
        }
        let has = |name: &str| self.images.iter().any(|(n, _)| *n == name);
        let mut request = Request::new(self.size[0], self.size[1]);
        request.guides = Guides {
            normal: has("normal"),
            depth: has("depth"),
            object_id: has("object_id"),
            ..Guides::default()
        };
        Planned::new(&graph, request).unwrap()
    }

    fn run(&self, planned: &Planned, region: Rect) -> Image {
        let windows = planned.plan().windows(region);
        let parts: Vec<(&str, Image)> = planned
            .plan()
            .inputs()
            .iter()
            .map(|port| {
                let (name, image) = self.images.iter().find(|(n, _)| *n == port.name).unwrap();
                (*name, image.crop(windows[port.image.index()]).unwrap())
            })
            .collect();
        let inputs: Vec<(&str, &Image)> = parts.iter().map(|(n, i)| (*n, i)).collect();
        CpuExecutor::new()
            .run(planned.plan(), &inputs, region, &CallingThread, Control::default())
            .unwrap()
            .remove(0)
    }

    fn tensor(&self, settings: &[(&str, &str)]) -> Image {
        self.run(&self.planned(settings), Rect::of_size(self.size[0], self.size[1]))
    }
}

/// Sine of the angle between the tangent at a pixel and a direction.
fn off(tensor: &Image, x: i32, y: i32, direction: [f32; 2]) -> f32 {
    let t = tensor.pixel(x, y);
    let [tx, ty] = scalar::tangent(t[0], t[1], t[2]);
    (tx * direction[1] - ty * direction[0]).abs() / direction[0].hypot(direction[1])
}

#[test]
fn tangents_follow_rings() {
    let rings = Scene::color(image(81, 81, 4, |x, y, c| {
        let r = (x as f32 - 40.0).hypot(y as f32 - 40.0);
        if c == 3 { 1.0 } else { 0.5 + 0.4 * (r * 0.7).sin() }
    }));
    for derivative in ["central", "sobel", "scharr3", "scharr5", "gaussian"] {
        for space in ["rgb", "luminance", "lab"] {
            let tensor = rings.tensor(&[("derivative", derivative), ("space", space)]);
            for (x, y) in [(60, 40), (40, 65), (57, 57), (22, 47)] {
                let error = off(&tensor, x, y, [40.0 - y as f32, x as f32 - 40.0]);
                assert!(error < 0.03, "{derivative} {space} at {x}, {y}: {error}");
            }
        }
    }
}

#[test]
fn a_tile_is_the_same_part_of_the_full_frame() {
    let mut scene = Scene::color(image(61, 47, 4, noise(1)));
    scene.images.push(("normal", image(61, 47, 4, |x, y, c| 2.0 * noise(2)(x, y, c) - 1.0)));
    scene.images.push(("depth", image(61, 47, 1, noise(3))));
    scene.images.push(("object_id", image(61, 47, 1, |x, y, c| (3.0 * noise(4)(x / 7, y / 5, c)).floor())));
    let settings: [&[(&str, &str)]; 10] = [
        &[],
        &[("derivative", "central"), ("space", "lab"), ("rho", "0.7")],
        &[("derivative", "sobel"), ("space", "luminance"), ("normalize", "true")],
        &[("derivative", "scharr5"), ("guide_weight", "0.3")],
        &[("derivative", "gaussian"), ("sigma_g", "2.5"), ("rho", "0")],
        &[("relax_threshold", "1.1"), ("guide_weight", "0"), ("relax_steps", "3")],
        &[("relax_threshold", "9"), ("normalize", "true")],
        &[("levels", "3")],
        &[("oversample", "true"), ("relax_threshold", "0.9")],
        &[("levels", "8"), ("oversample", "true"), ("rho", "0.2"), ("space", "lab")],
    ];
    for settings in settings {
        let planned = scene.planned(settings);
        let full = scene.run(&planned, Rect::of_size(61, 47));
        for (x0, y0, x1, y1) in [(0, 0, 61, 47), (13, 5, 42, 30), (60, 46, 61, 47), (1, 17, 10, 18)] {
            let tile = Rect { x0, y0, x1, y1 };
            assert!(scene.run(&planned, tile) == full.crop(tile).unwrap(), "{settings:?} {tile:?}");
        }
    }
}

#[test]
fn flat_parts_take_the_orientation_around_them() {
    // A bar at 45 degrees crosses a flat picture.
    let bar = Scene::color(image(64, 64, 4, |x, y, c| {
        let d = (x as f32 - y as f32).abs();
        if c == 3 { 1.0 } else { 0.2 + 0.6 * (1.0 - (d - 6.0) / 3.0).clamp(0.0, 1.0) }
    }));
    let plain = bar.tensor(&[]);
    assert_eq!(plain.pixel(60, 4), [0.0, 0.0, 0.0, plain.pixel(60, 4)[3]]);
    let filled = bar.tensor(&[("relax_threshold", "0.05")]);
    for (x, y) in [(60, 4), (5, 50), (32, 32), (63, 0)] {
        assert!(filled.pixel(x, y)[0] > 1e-4, "nothing at {x}, {y}");
        assert!(off(&filled, x, y, [1.0, 1.0]) < 0.1, "at {x}, {y}: {:?}", filled.pixel(x, y));
    }
    // Where no pixel is valid there is nothing to spread.
    let nothing = bar.tensor(&[("relax_threshold", "9")]);
    assert!(nothing.data().iter().all(|v| *v == 0.0));
}

#[test]
fn guides_show_what_colour_does_not() {
    let flat = || Scene::color(image(40, 40, 4, |_, _, c| if c == 3 { 1.0 } else { 0.5 }));
    let left = |x: u32| x < 20;
    let guides: [(&'static str, Image); 4] = [
        (
            "normal",
            image(40, 40, 4, |x, _, c| match (c, left(x)) {
                (0, true) | (2, false) | (3, _) => 1.0,
                _ => 0.0,
            }),
        ),
        ("depth", image(40, 40, 1, |x, _, _| if left(x) { 5.0 } else { 0.0 })),
        ("depth", image(40, 40, 1, |x, _, _| if left(x) { 1.0 } else { 1e20 })),
        ("object_id", image(40, 40, 1, |x, _, _| if left(x) { 1.0 } else { 7.0 })),
    ];
    for (name, guide) in guides {
        let mut scene = flat();
        scene.images.push((name, guide));
        let tensor = scene.tensor(&[]);
        let at = tensor.pixel(20, 20);
        assert!(at[0] > 0.02 && at[0] < 1.0 && at[1] == 0.0 && at[2] == 0.0, "{name}: {at:?}");
        assert!(tensor.pixel(3, 20)[0] == 0.0, "{name}");
        let doubled = scene.tensor(&[("guide_weight", "2")]);
        assert!((doubled.pixel(20, 20)[0] / at[0] - 2.0).abs() < 1e-5, "{name}");
        assert!(scene.tensor(&[("guide_weight", "0")]).pixel(20, 20)[0] == 0.0, "{name}");
    }
}

#[test]
fn depth_counts_relatively_and_bad_guides_do_no_harm() {
    let ramp = |scale: f32| {
        let mut scene = Scene::color(image(40, 40, 4, |_, _, _| 1.0));
        scene.images.push(("depth", image(40, 40, 1, move |_, y, _| scale * (0.01 * y as f32).exp())));
        scene.tensor(&[])
    };
    let (near, far) = (ramp(0.001), ramp(1000.0));
    assert!((near.pixel(20, 20)[2] / 1e-4 - 1.0).abs() < 1e-3, "{:?}", near.pixel(20, 20));
    assert!((near.pixel(20, 20)[2] / far.pixel(20, 20)[2] - 1.0).abs() < 1e-3);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -f32::MAX, 1e-40] {
        let mut scene = Scene::color(image(40, 40, 4, noise(6)));
        for (name, channels) in [("normal", 4), ("depth", 1), ("object_id", 1)] {
            let spotted = move |x: u32, y: u32, c: u32| {
                if (x + y).is_multiple_of(11) { bad } else { noise(7)(x, y, c) }
            };
            scene.images.push((name, image(40, 40, channels, spotted)));
        }
        let tensor = scene.tensor(&[]);
        assert!(tensor.data().iter().all(|v| v.is_finite() && v.abs() < 100.0), "{bad}");
    }
}
