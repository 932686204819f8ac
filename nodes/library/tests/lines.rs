//! The line filters, quantization and styles on the CPU executor: what the equations promise.

use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::{Image, Rect};
use isophote::request::Guides;
use isophote::{Graph, Planned, Request};

type Inputs<'a> = &'a [(&'static str, &'a Image)];

fn picture(width: u32, height: u32, channels: u32, value: impl Fn(i32, i32) -> [f32; 4]) -> Image {
    let mut image = Image::new(width, height, channels).unwrap();
    let pixels = image.data_mut().chunks_exact_mut(channels as usize);
    for (i, pixel) in pixels.enumerate() {
        let at = i as u32;
        let values = value((at % width) as i32, (at / width) as i32);
        pixel.copy_from_slice(&values[..channels as usize]);
    }
    image
}

/// Opaque grey of lightness L: the inverse of the sRGB curve and of CIELAB.
fn grey(lightness: f32) -> [f32; 4] {
    let f = (lightness + 16.0) / 116.0;
    let y = if f > 6.0 / 29.0 { f * f * f } else { (f - 16.0 / 116.0) / 7.787_037 };
    let v = if y <= 0.003_130_8 { 12.92 * y } else { 1.055 * y.powf(1.0 / 2.4) - 0.055 };
    [v, v, v, 1.0]
}

/// Deterministic noise in 0..1.
fn noise(x: i32, y: i32, seed: u32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ seed;
    for _ in 0..3 {
        h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    }
    (h >> 8) as f32 / 16_777_216.0
}

fn planned(node: &str, settings: &[(&str, &str)], inputs: Inputs<'_>, scale: f32) -> Planned {
    let mut graph = Graph::single(node).unwrap();
    let id = graph.node(0).unwrap();
    for (param, value) in settings {
        graph.set_text(id, param, value).unwrap();
    }
    let mut request = Request::new(inputs[0].1.width(), inputs[0].1.height());
    let has = |name: &str| inputs.iter().any(|(n, _)| *n == name);
    request.guides = Guides {
        normal: has("normal"),
        depth: has("depth"),
        object_id: has("object_id"),
        ..Guides::default()
    };
    request.scale = scale;
    Planned::new(&graph, request).unwrap()
}

fn run(planned: &Planned, inputs: Inputs<'_>, region: Rect) -> Image {
    let windows = planned.plan().windows(region);
    let parts: Vec<(&str, Image)> = planned
        .plan()
        .inputs()
        .iter()
        // Guides that count for nothing are declared and not read.
        .filter(|port| !windows[port.image.index()].is_empty())
        .map(|port| {
            let (name, image) = inputs.iter().find(|(n, _)| *n == port.name).unwrap();
            (*name, image.crop(windows[port.image.index()]).unwrap())
        })
        .collect();
    let parts: Vec<(&str, &Image)> = parts.iter().map(|(n, i)| (*n, i)).collect();
    CpuExecutor::new()
        .run(planned.plan(), &parts, region, &CallingThread, Control::default())
        .unwrap()
        .remove(0)
}

fn apply(node: &str, settings: &[(&str, &str)], inputs: Inputs<'_>) -> Image {
    let whole = Rect::of_size(inputs[0].1.width(), inputs[0].1.height());
    run(&planned(node, settings, inputs, 1.0), inputs, whole)
}

fn textured() -> Image {
    picture(61, 47, 4, |x, y| {
        let r = (x as f32 - 30.0).hypot(y as f32 - 20.0);
        let v = 0.5 + 0.35 * (r * 0.6).sin();
        [v + 0.1 * noise(x, y, 1), v * 0.8, 1.0 - v + 0.1 * noise(x, y, 2), 1.0]
    })
}

#[test]
fn the_response_to_a_constant_is_one_minus_tau_of_it() {
    for lightness in [3.0, 50.0, 100.0] {
        let flat = picture(23, 17, 4, |_, _| grey(lightness));
        for node in ["difference_of_gaussians", "flow_dog"] {
            let out = apply(node, &[("threshold", "none"), ("tau", "0.9")], &[("color", &flat)]);
            for v in out.data() {
                assert!((v - 0.1 * lightness).abs() < 1e-3, "{node}: {v} at L {lightness}");
            }
        }
    }
}

#[test]
fn both_forms_agree_to_rounding() {
    let image = textured();
    // p = tau / (1 - tau), epsilon_p = epsilon / (1 - tau), phi_p = phi (1 - tau) (4.10).
    let tau = 0.96_f32;
    let (p, epsilon) = ((tau / (1.0 - tau)).to_string(), (0.7 / (1.0 - tau)).to_string());
    let phi = (2.0 * (1.0 - tau)).to_string();
    for node in ["difference_of_gaussians", "flow_dog"] {
        for threshold in ["tanh", "smoothstep"] {
            let a = apply(
                node,
                &[("threshold", threshold), ("tau", "0.96"), ("epsilon", "0.7")],
                &[("color", &image)],
            );
            let sharpen = [
                ("form", "sharpen"),
                ("threshold", threshold),
                ("p", &p),
                ("epsilon_p", &epsilon),
                ("phi_p", &phi),
            ];
            let b = apply(node, &sharpen, &[("color", &image)]);
            let (mut lines, mut worst) = (0, 0.0_f32);
            for (a, b) in a.data().iter().zip(b.data()) {
                lines += usize::from(*a < 0.5);
                worst = worst.max((a - b).abs());
            }
            assert!(lines > 100, "{node}: only {lines} pixels of line");
            assert!(worst < 1e-3, "{node} {threshold}: the forms differ by {worst}");
        }
    }
}

#[test]
fn the_response_scales_like_the_laplacian() {
    // L = cos(w x): the Laplacian is -w^2 cos(w x), and smoothing by sigma multiplies by
    // exp(-sigma^2 w^2 / 2). (4.5): D is close to (k - 1) sigma^2 w^2 times that as k goes to 1.
    let (w, sigma) = (0.25_f32, 2.0_f32);
    let waves = picture(101, 9, 4, |x, _| grey(50.0 + 30.0 * (w * (x - 50) as f32).cos()));
    for (k, bound) in [("1.05", 0.06), ("1.2", 0.2)] {
        let settings = [("threshold", "none"), ("tau", "1"), ("sigma_e", "2"), ("k", k)];
        let out = apply("difference_of_gaussians", &settings, &[("color", &waves)]);
        let k: f32 = k.parse().unwrap();
        let smooth = (-0.5 * sigma * sigma * w * w).exp();
        let expected = (k - 1.0) * sigma * sigma * w * w * 30.0 * smooth;
        let got = out.pixel(50, 4)[0];
        assert!((got / expected - 1.0).abs() < bound, "k {k}: {got} for {expected}");
    }
}

#[test]
fn a_step_draws_one_thin_line_on_its_dark_side() {
    for (vertical, node) in [
        (true, "difference_of_gaussians"),
        (true, "flow_dog"),
        (false, "difference_of_gaussians"),
        (false, "flow_dog"),
    ] {
        let step =
            picture(40, 40, 4, |x, y| grey(if (if vertical { x } else { y }) < 20 { 40.0 } else { 80.0 }));
        let out = apply(node, &[], &[("color", &step)]);
        let row: Vec<f32> =
            (0..40).map(|i| if vertical { out.pixel(i, 17)[0] } else { out.pixel(17, i)[0] }).collect();
        let dark: Vec<usize> = (0..40).filter(|i| row[*i] < 0.5).collect();
        assert!((1..=4).contains(&dark.len()), "{node}: line at {dark:?}");
        assert_eq!(*dark.last().unwrap(), 19, "{node}: line at {dark:?}");
        assert_eq!(dark[0] + dark.len() - 1, 19, "{node}: more than one line at {dark:?}");
        assert!(row[19] < 0.01 && row[2] == 1.0 && row[37] == 1.0);
    }
}

#[test]
fn flow_suppresses_noise_that_the_isotropic_filter_draws() {
    let noisy = picture(80, 80, 4, |x, y| {
        let edge = (x as f32 * 0.8 + y as f32 * 0.6) < 56.0;
        grey(if edge { 55.0 } else { 75.0 } + 7.0 * (noise(x, y, 3) - 0.5))
    });
    let far = |x: i32, y: i32| (x as f32 * 0.8 + y as f32 * 0.6 - 56.0).abs() > 10.0;
    let speckles = |node: &str| {
        let out = apply(node, &[], &[("color", &noisy)]);
        (0..80 * 80)
            .map(|i| (i % 80, i / 80))
            .filter(|(x, y)| far(*x, *y) && out.pixel(*x, *y)[0] < 0.5)
            .count()
    };
    let (isotropic, flow) = (speckles("difference_of_gaussians"), speckles("flow_dog"));
    assert!(flow * 3 < isotropic.max(3), "{flow} dark pixels along the flow, {isotropic} without");
}

/// Pixels of line in columns of an edge image.
fn line_pixels(edges: &Image, columns: std::ops::Range<i32>) -> usize {
    let height = edges.height() as i32;
    columns.map(|x| (0..height).filter(|y| edges.pixel(x, *y)[0] < 0.5).count()).sum()
}

#[test]
fn local_contrast_draws_soft_edges_and_leaves_what_is_empty() {
    let of = |amount: &str, image: &Image| {
        let settings = [("tau", "0.975"), ("local_contrast", amount)];
        line_pixels(&apply("flow_dog", &settings, &[("color", image)]), 0..80)
    };
    let soft = picture(80, 60, 4, |x, _| grey(if x < 40 { 63.0 } else { 70.0 }));
    assert_eq!(of("0", &soft), 0);
    assert!(of("1", &soft) >= 60, "{} pixels of line", of("1", &soft));
    // A ramp under 2/255, light and dark, with noise of half a step.
    for lightness in [10.0, 60.0, 95.0] {
        let empty = picture(80, 60, 4, |x, y| {
            grey(lightness).map(|v| v + x as f32 * 1e-4 + (noise(x, y, 5) - 0.5) / 255.0)
        });
        assert_eq!(of("1", &empty), 0, "L {lightness}");
    }
}

#[test]
fn inhibition_takes_textures_and_leaves_contours() {
    let image = picture(240, 120, 4, |x, y| match x {
        0..100 => grey(40.0 + 50.0 * noise(x / 3, y / 3, 7)),
        180..184 => grey(30.0),
        _ => grey(65.0),
    });
    let of = |amount: &str, columns| {
        let settings = [("tau", "0.975"), ("local_contrast", "1"), ("inhibition", amount)];
        line_pixels(&apply("flow_dog", &settings, &[("color", &image)]), columns)
    };
    let (texture, contour) = (10..90, 160..220);
    assert!(3 * of("1", texture.clone()) < of("0", texture), "texture yields");
    assert!(5 * of("1", contour.clone()) > 4 * of("0", contour), "a contour stays");
}

#[test]
fn colours_of_one_lightness_have_lines_between_them() {
    let luminance = |c: [f32; 3]| {
        let linear = c.map(|v| if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) });
        0.212_67 * linear[0] + 0.715_15 * linear[1] + 0.072_18 * linear[2]
    };
    let (red, blue) = ([0.75, 0.2, 0.2], [0.25, 0.45, 0.8]);
    let (mut dark, mut light) = (0.0f32, 1.0f32);
    for _ in 0..40 {
        let middle = 0.5 * (dark + light);
        let bound = if luminance(blue.map(|v| v * middle)) < luminance(red) { &mut dark } else { &mut light };
        *bound = middle;
    }
    let blue = blue.map(|v| v * dark);
    let image = picture(60, 40, 4, |x, _| {
        let [r, g, b] = if x < 30 { red } else { blue };
        [r, g, b, 1.0]
    });
    let of = |amount: &str| {
        let out = apply("flow_dog", &[("tau", "0.975"), ("colour_edges", amount)], &[("color", &image)]);
        line_pixels(&out, 0..60)
    };
    assert_eq!(of("0"), 0);
    assert!(of("1") >= 40, "{} pixels of line", of("1"));
}

#[test]
fn iterations_make_lines_no_lighter() {
    let image = textured();
    let darkness = |n: &str| {
        let out = apply("flow_dog", &[("iterations", n)], &[("color", &image)]);
        out.data().iter().map(|v| f64::from(1.0 - v)).sum::<f64>()
    };
    assert!(darkness("3") > darkness("1") * 1.02);
}

/// Flat colour over geometry that breaks in the middle column.
fn guide(name: &str) -> Image {
    match name {
        "normal" => {
            picture(40, 40, 4, |x, _| if x < 20 { [0.6, 0.0, 0.8, 1.0] } else { [-0.6, 0.0, 0.8, 1.0] })
        }
        "depth" => picture(40, 40, 1, |x, _| [if x < 20 { 5.0 } else { 6.0 }, 0.0, 0.0, 0.0]),
        _ => picture(40, 40, 1, |x, _| [if x < 20 { 1.0 } else { 2.0 }, 0.0, 0.0, 0.0]),
    }
}

#[test]
fn lines_are_drawn_where_geometry_breaks_though_the_shading_does_not() {
    let flat = picture(40, 40, 4, |_, _| grey(70.0));
    for name in ["normal", "depth", "object_id"] {
        let guide = guide(name);
        let inputs: Inputs<'_> = &[("color", &flat), (name, &guide)];
        let out = apply("flow_dog", &[("guide_weight", "1")], inputs);
        let row: Vec<f32> = (0..40).map(|x| out.pixel(x, 20)[0]).collect();
        assert!(row[19] < 0.05 && row[20] < 0.05, "{name}: {row:?}");
        assert!(row[16] == 1.0 && row[23] == 1.0, "{name}: {row:?}");
        let without = apply("flow_dog", &[], inputs);
        assert!(without.data().iter().all(|v| *v == 1.0), "{name} without weight");
        let cartoon = apply("cartoon", &[], inputs);
        assert!(cartoon.pixel(19, 20)[0] < 0.1 && cartoon.pixel(5, 20)[0] > 0.5, "{name}");
    }
}

#[test]
fn relief_as_fine_as_the_pixels_is_not_filled_with_ink() {
    let flat = picture(60, 40, 4, |_, _| grey(70.0));
    let folds = picture(60, 40, 4, |x, _| {
        let side = if (20..40).contains(&x) && x % 2 == 0 { -0.6 } else { 0.6 };
        [side, 0.0, 0.8, 1.0]
    });
    let out = apply("flow_dog", &[("guide_weight", "1")], &[("color", &flat), ("normal", &folds)]);
    let row: Vec<f32> = (0..60).map(|x| out.pixel(x, 20)[0]).collect();
    assert!(row[26..34].iter().all(|v| *v > 0.9), "{row:?}");
    // The relief as a whole keeps its outline.
    assert!(row[18..23].iter().any(|v| *v < 0.2) && row[37..42].iter().any(|v| *v < 0.2), "{row:?}");
}

#[test]
fn a_slanted_plane_draws_no_line_at_any_scale() {
    let flat = picture(64, 40, 4, |_, _| grey(70.0));
    for scale in [1e-3, 1.0, 1e4] {
        // 1/z is linear over a plane; this one recedes from 1 to 5.
        let plane = picture(64, 40, 1, move |x, y| {
            [scale / (1.0 - 0.8 * (x as f32 + 0.1 * y as f32) / 68.0), 0.0, 0.0, 0.0]
        });
        let out = apply("flow_dog", &[("guide_weight", "1")], &[("color", &flat), ("depth", &plane)]);
        // The picture's own border, where depth is clamped, bends.
        for y in 8..32 {
            for x in 8..56 {
                assert!(out.pixel(x, y)[0] > 0.99, "{} at {x}, {y}, scale {scale}", out.pixel(x, y)[0]);
            }
        }
    }
}

#[test]
fn bad_guides_do_no_harm() {
    let image = textured();
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, -1.0, 0.0, f32::MAX] {
        let spotted = |x: i32, y: i32| if (x + y) % 7 == 0 { bad } else { 3.0 + noise(x, y, 9) };
        let (normal, one) =
            (picture(61, 47, 4, |x, y| [spotted(x, y); 4]), picture(61, 47, 1, |x, y| [spotted(x, y); 4]));
        let inputs: Inputs<'_> =
            &[("color", &image), ("normal", &normal), ("depth", &one), ("object_id", &one)];
        for node in ["flow_dog", "cartoon", "blueprint"] {
            let out = apply(node, &[("guide_weight", "2")], inputs);
            assert!(out.data().iter().all(|v| v.is_finite() && v.abs() < 4.0), "{node} with {bad}");
        }
    }
}

/// Lightness of a grey.
fn lightness_of(v: f32) -> f32 {
    let y = if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    if y > 0.008_856_452 { 116.0 * y.cbrt() - 16.0 } else { 903.2963 * y }
}

#[test]
fn quantized_lightness_keeps_its_order_and_stays_within_half_a_bin() {
    // Far apart, so that the gradient of the ramp is the same everywhere; beyond white too.
    let ramp = picture(1300, 3, 4, |x, _| grey(x as f32 * 0.1));
    for adaptive in ["true", "false"] {
        for bins in [2, 8, 31] {
            let settings = [("bins", bins.to_string()), ("adaptive", adaptive.to_string())];
            let settings: Vec<(&str, &str)> = settings.iter().map(|(k, v)| (*k, v.as_str())).collect();
            let out = apply("quantize_luminance", &settings, &[("color", &ramp)]);
            let mut last = f32::MIN;
            // The first and last column see another gradient.
            for x in 1..1299 {
                let (l, q) = (x as f32 * 0.1, lightness_of(out.pixel(x, 1)[0]));
                let half = 50.0 / bins as f32;
                assert!((l - q).abs() <= half + 0.02, "{bins} bins: {q} for {l}");
                assert!(q >= last - 0.01, "{bins} bins, adaptive {adaptive}: {q} after {last} at {l}");
                last = q;
            }
        }
    }
    let flat = apply("quantize_luminance", &[("adaptive", "false")], &[("color", &ramp)]);
    // Between two steps lightness rests on a border of bins.
    let rest = |x: &i32| {
        let q = lightness_of(flat.pixel(*x, 1)[0]) / 12.5;
        (q - q.round()).abs() * 12.5 < 0.5
    };
    let resting = (0..1000).filter(rest).count();
    assert!((900..980).contains(&resting), "{resting} of 1000 rest");
}

/// Opaque on the left, a disc cut out of hidden bright red.
fn cut_out(hidden: [f32; 3]) -> Image {
    picture(48, 40, 4, move |x, y| {
        if (x as f32 - 20.0).hypot(y as f32 - 20.0) < 14.0 {
            let [v, ..] = grey(60.0);
            [v, v * 0.9, v * 0.8, 1.0]
        } else {
            // Colour enters multiplied by alpha; a host may still leave some where alpha is 0.
            [hidden[0], hidden[1], hidden[2], 0.0]
        }
    })
}

#[test]
fn cut_outs_have_no_fringe_and_hidden_colours_do_not_count() {
    let (red, black) = (cut_out([9.0, 0.0, 0.0]), cut_out([0.0; 3]));
    for node in ["difference_of_gaussians", "flow_dog", "quantize_luminance", "cartoon", "blueprint"] {
        let (a, b) = (apply(node, &[], &[("color", &red)]), apply(node, &[], &[("color", &black)]));
        assert!(a == b, "{node}: hidden colours show");
    }
    for node in ["difference_of_gaussians", "flow_dog"] {
        let lines = apply(node, &[], &[("color", &red)]);
        assert!(lines.data().iter().all(|v| *v == 1.0), "{node}: a line along the cut");
    }
    let cartoon = apply("cartoon", &[], &[("color", &red)]);
    let middle = cartoon.pixel(20, 20).to_vec();
    for p in cartoon.data().chunks_exact(4).filter(|p| p[3] > 0.01) {
        for c in 0..3 {
            assert!((p[c] / p[3] - middle[c]).abs() < 2e-3, "{p:?} against {middle:?}");
        }
    }
}

#[test]
fn a_tile_is_the_same_part_of_the_full_frame() {
    let image = picture(61, 47, 4, |x, y| {
        let a = if noise(x / 5, y / 5, 8) < 0.2 { 0.0 } else { 1.0 - 0.3 * noise(x, y, 7) };
        [noise(x, y, 1) * a, noise(x / 3, y, 2) * a, noise(x, y / 4, 3) * a, a]
    });
    let normal = picture(61, 47, 4, |x, y| [noise(x / 6, y, 4) - 0.5, noise(x, y / 6, 5) - 0.5, 0.6, 1.0]);
    let depth = picture(61, 47, 1, |x, y| [1.0 + (4.0 * noise(x / 9, y / 7, 6)).floor(), 0.0, 0.0, 0.0]);
    let id = picture(61, 47, 1, |x, y| [(3.0 * noise(x / 8, y / 9, 7)).floor(), 0.0, 0.0, 0.0]);
    let all: Inputs<'_> = &[("color", &image), ("normal", &normal), ("depth", &depth), ("object_id", &id)];
    let cases: &[(&str, &[(&str, &str)])] = &[
        ("difference_of_gaussians", &[]),
        ("difference_of_gaussians", &[("sigma_e", "3.3"), ("threshold", "none"), ("k", "2.5")]),
        ("difference_of_gaussians", &[("form", "sharpen"), ("threshold", "smoothstep")]),
        ("flow_dog", &[]),
        ("flow_dog", &[("iterations", "3"), ("guide_weight", "1"), ("integrator", "euler")]),
        ("flow_dog", &[("sigma_e", "2.7"), ("sigma_m", "7.3"), ("threshold", "binary"), ("form", "sharpen")]),
        ("quantize_luminance", &[("bins", "5")]),
        ("cartoon", &[]),
        ("cartoon", &[("n_e", "3"), ("n_a", "1"), ("darks", "0.5"), ("posterize", "0"), ("sigma_a", "0")]),
        ("cartoon", &[("adaptive", "true"), ("line_iterations", "2"), ("mix", "0.5")]),
        ("blueprint", &[]),
        ("blueprint", &[("cover", "true"), ("grid", "7.3"), ("guide_weight", "0")]),
    ];
    for (node, settings) in cases {
        for scale in [1.0, 0.37] {
            let planned = planned(node, settings, all, scale);
            let full = run(&planned, all, Rect::of_size(61, 47));
            for (x0, y0, x1, y1) in [(13, 5, 42, 30), (60, 46, 61, 47), (1, 17, 10, 18), (0, 0, 3, 47)] {
                let tile = Rect { x0, y0, x1, y1 };
                assert!(run(&planned, all, tile) == full.crop(tile).unwrap(), "{node} {settings:?} {tile:?}");
            }
        }
    }
}

#[test]
fn a_proxy_of_a_blueprint_shows_the_same_sheet() {
    let (full, half) = (picture(128, 128, 4, |_, _| grey(60.0)), picture(64, 64, 4, |_, _| grey(60.0)));
    let settings = [("paper_texture", "0")];
    let sheet = apply("blueprint", &settings, &[("color", &full)]);
    let inputs: Inputs<'_> = &[("color", &half)];
    let proxy = run(&planned("blueprint", &settings, inputs, 0.5), inputs, Rect::of_size(64, 64));
    let mut ruled = 0;
    for y in 0..64 {
        for x in 0..64 {
            let mean: f32 = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .iter()
                .map(|(dx, dy)| sheet.pixel(2 * x + dx, 2 * y + dy)[0] / 4.0)
                .sum();
            let got = proxy.pixel(x, y)[0];
            ruled += usize::from(got > proxy.pixel(1, 1)[0] + 0.02);
            assert!((got - mean).abs() < 0.06, "{got} for {mean} at {x}, {y}");
        }
    }
    assert!(ruled > 200, "only {ruled} pixels of grid");
}

#[test]
fn look_controls_do_what_they_say() {
    let image = textured();
    let light = |image: &Image, settings: &[(&str, &str)]| {
        // All of the pictures are texture, which inhibits itself.
        let settings = [&[("inhibition", "0")], settings].concat();
        let out = apply("cartoon", &settings, &[("color", image)]);
        out.data().chunks_exact(4).map(|p| f64::from(p[0] + p[1] + p[2])).sum::<f64>()
    };
    let sum = |settings: &[(&str, &str)]| light(&image, settings);
    let default = sum(&[]);
    assert!(sum(&[("line_amount", "0")]) > sum(&[("line_amount", "0.3")]));
    assert!(sum(&[("line_amount", "0.3")]) > default && default > sum(&[("line_amount", "1")]));
    let spots = picture(60, 60, 4, |x, y| grey(if x % 15 < 3 && y % 15 < 3 { 52.0 } else { 60.0 }));
    // Faint ones, which draw lines under strong inhibition.
    let faint = [("tau", "0.99")];
    assert!(light(&spots, &[faint[0], ("suppress_small", "1")]) > light(&spots, &faint));
    let step = picture(60, 60, 4, |x, _| grey(if x < 30 { 40.0 } else { 80.0 }));
    assert!(light(&step, &[("line_width", "4")]) < light(&step, &[]));
    assert!(sum(&[("lights", "1")]) > default && sum(&[("darks", "-1")]) < default);
    // No line is left at 0: as if they were transparent.
    let clear = [("line_amount", "0.5"), ("line_color", "#00000000")];
    assert_eq!(sum(&[("line_amount", "0")]), sum(&clear));
    let grey = apply("cartoon", &[("saturation", "0")], &[("color", &image)]);
    for p in grey.data().chunks_exact(4) {
        assert!((p[0] - p[1]).abs() < 2e-3 && (p[1] - p[2]).abs() < 2e-3, "{p:?}");
    }
}
