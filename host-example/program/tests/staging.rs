//! Views and light of scenes: `render` with its options for camera, light, background and ground.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{self, fails, folder, isophote, succeeds};
use exr::prelude::read_first_flat_layer_from_file;
use image::{Rgb, Rgba, RgbaImage};

/// Renders a scene, 96 by 64 pixels large, to a file of the same folder.
fn render(scene: &Path, out: &str, more: &[&str]) -> PathBuf {
    render_in(scene, out, "96x64", more)
}

fn render_in(scene: &Path, out: &str, size: &str, more: &[&str]) -> PathBuf {
    let out = scene.parent().expect("a folder").join(out);
    let mut command = isophote();
    command.arg("render").arg(scene).arg(&out).args(["--force", "--size", size]).args(more);
    succeeds(&mut command);
    out
}

fn picture(scene: &Path, more: &[&str]) -> RgbaImage {
    image::open(render(scene, "out.png", more)).expect("a picture was written").into_rgba8()
}

/// A channel of a rendered EXR file.
fn channel(file: &Path, name: &str) -> Vec<f32> {
    let image = read_first_flat_layer_from_file(file).expect("a picture");
    let list = &image.layer_data.channel_data.list;
    let found = list.iter().find(|c| c.name.to_string() == name).unwrap_or_else(|| panic!("no {name}"));
    found.sample_data.values_as_f32().collect()
}

/// Writes a grey ball of radius 1 around (0, 0, 0).
fn ball(folder: &Path) -> PathBuf {
    let (around, down) = (48, 24);
    let mut text = String::new();
    for row in 0..=down {
        for column in 0..around {
            let (s, c) = (std::f32::consts::PI * row as f32 / down as f32).sin_cos();
            let (x, z) = (std::f32::consts::TAU * column as f32 / around as f32).sin_cos();
            text += &format!("v {} {c} {}\n", s * x, s * z);
        }
    }
    for row in 0..down {
        for column in 0..around {
            let at = |row: usize, column: usize| 1 + row * around + column % around;
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(r, k)| at(row + r, column + k));
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    let file = folder.join("ball.obj");
    fs::write(&file, text).expect("the folder is writable");
    file
}

/// CIE lightness of a pixel.
fn lightness(pixel: &Rgba<u8>) -> f32 {
    let decode = |v: u8| {
        let v = f32::from(v) / 255.0;
        if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    };
    let [r, g, b, _] = pixel.0;
    let y = 0.2126 * decode(r) + 0.7152 * decode(g) + 0.0722 * decode(b);
    if y > 0.008_856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
}

/// Mean lightness of the opaque pixels of a part of the picture.
fn mean(picture: &RgbaImage, is_within: impl Fn(u32, u32) -> bool) -> f32 {
    let within = picture.enumerate_pixels().filter(|(x, y, p)| p[3] == 255 && is_within(*x, *y));
    let values: Vec<f32> = within.map(|(_, _, pixel)| lightness(pixel)).collect();
    values.iter().sum::<f32>() / values.len().max(1) as f32
}

const BARE: [&str; 3] = ["--background", "transparent", "--no-ground"];

#[test]
fn the_default_sun_gives_grey_models_light_half_tone_and_shade() {
    let folder = folder();
    let ball = ball(folder.path());
    let shown = picture(&ball, &BARE);
    let mut values: Vec<f32> = shown.pixels().filter(|p| p[3] == 255).map(lightness).collect();
    values.sort_unstable_by(f32::total_cmp);
    let at = |share: f32| values[(share * (values.len() - 1) as f32) as usize];
    let (shade, light) = (at(0.03), at(0.97));
    assert!((15.0..35.0).contains(&shade) && (70.0..92.0).contains(&light), "{shade} to {light}");
    assert!(at(0.3) > shade + 5.0 && at(0.7) < light - 3.0, "no half tones: {} {}", at(0.3), at(0.7));
    assert!(shown.pixels().all(|p| p.0[..3].iter().all(|v| *v < 250)), "highlights are clipped");
    // It stands on the left and above, wherever the camera is.
    for azimuth in ["0", "120"] {
        let shown = picture(&ball, &[&BARE[..], &["--azimuth", azimuth]].concat());
        assert!(mean(&shown, |x, _| x < 48) > mean(&shown, |x, _| x >= 48) + 8.0);
        assert!(mean(&shown, |_, y| y < 32) > mean(&shown, |_, y| y >= 32) + 8.0);
    }
}

#[test]
fn the_sun_is_where_light_says() {
    let folder = folder();
    let ball = ball(folder.path());
    let lit = |light: &str| picture(&ball, &[&BARE[..], &["--light", light]].concat());
    let (left, right, front, back) = (lit("-80,0"), lit("80,0"), lit("0,16"), lit("180,0"));
    let lead = |p: &RgbaImage| mean(p, |x, _| x < 48) - mean(p, |x, _| x >= 48);
    assert!(lead(&left) > 15.0 && lead(&right) < -15.0, "{} {}", lead(&left), lead(&right));
    assert!(lead(&front).abs() < 3.0);
    let all = |p: &RgbaImage| mean(p, |_, _| true);
    assert!(all(&front) > all(&back) + 25.0, "{} {}", all(&front), all(&back));
    let tall = |p: &RgbaImage| mean(p, |_, y| y < 32) - mean(p, |_, y| y >= 32);
    assert!(tall(&lit("0,80")) > 15.0 && tall(&lit("0,-80")) < -10.0);
}

#[test]
fn scenes_of_z_up_programs_are_turned() {
    let folder = folder();
    // A wedge that is different along each axis.
    let points = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 2.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0f32]];
    let write = |name: &str, turned: fn([f32; 3]) -> [f32; 3]| {
        let lines = points.map(|p| turned(p).map(|v| v.to_string()).join(" "));
        let text = lines.map(|line| format!("v {line}\n")).concat()
            + "f 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
        fs::write(folder.path().join(name), text).expect("the folder is writable");
        folder.path().join(name)
    };
    let (z_up, y_up) = (write("z.obj", |p| p), write("y.obj", |[x, y, z]| [x, z, -y]));
    let expected = picture(&y_up, &[]);
    let far = |p: &RgbaImage| {
        p.pixels()
            .zip(expected.pixels())
            .filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 2))
            .count()
    };
    assert_eq!(far(&picture(&z_up, &["--up", "z"])), 0);
    assert_eq!(far(&picture(&y_up, &["--up", "y"])), 0);
    assert!(far(&picture(&z_up, &[])) > 500);
}

#[test]
fn backgrounds_are_transparent_or_exactly_their_colour() {
    let folder = folder();
    let cube = support::cube(folder.path());
    let cut = picture(&cube, &BARE);
    assert_eq!((cut.get_pixel(0, 0)[3], cut.get_pixel(48, 32)[3]), (0, 255));
    for (color, expected) in
        [("#000000", [0; 3]), ("#ffffff", [255; 3]), ("#ff0000", [255, 0, 0]), ("#3366a1", [51, 102, 161])]
    {
        let shown = picture(&cube, &["--background", color, "--no-ground"]);
        for (pixel, cut) in shown.pixels().zip(cut.pixels()) {
            match cut[3] {
                0 => assert_eq!(pixel.0[..3], expected),
                255 => assert_eq!(pixel.0[..3], cut.0[..3], "the model is the same"),
                _ => {}
            }
            assert_eq!(pixel[3], 255);
        }
        let linear = render(&cube, "color.exr", &["--background", color, "--no-ground"]);
        for (name, value) in ["R", "G", "B"].iter().zip(expected) {
            let encoded = f64::from(value) / 255.0;
            let light =
                if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
            let found = f64::from(channel(&linear, name)[0]);
            assert!((found - light).abs() < 1e-3 * light + 1e-6, "{color}: {name} is {found}");
        }
        assert!(channel(&linear, "A").iter().all(|a| *a == 1.0));
    }
    let (sky, none) = (render(&cube, "sky.exr", &["--no-ground"]), render(&cube, "none.exr", &BARE));
    let (alpha, ids) = (channel(&none, "A"), channel(&none, "id"));
    assert!(alpha.iter().zip(&ids).all(|(a, id)| *id == 0.0 || *a > 0.0) && alpha[0] == 0.0);
    for name in ["N.X", "Z", "id", "Pref.Y"] {
        assert_eq!(channel(&sky, name), channel(&none, name), "{name}");
    }
    // What styles make of it is as transparent.
    let styled = picture(&cube, &[&BARE[..], &["--style", "gaussian", "--set", "sigma=1"]].concat());
    assert_eq!((styled.get_pixel(0, 0)[3], styled.get_pixel(48, 32)[3]), (0, 255));
}

/// Adds two cameras to the cube: one before it, and one above without a name of its own.
fn with_cameras(folder: &Path) -> PathBuf {
    let cube = support::cube(folder);
    let text = fs::read_to_string(&cube).expect("just written");
    let cameras = r#""cameras":[{"type":"perspective","name":"lens","perspective":{"yfov":0.8,"znear":0.1}}],
"nodes":[{"mesh":0},{"name":"front","camera":0,"translation":[0,0,6]},
{"camera":0,"translation":[0,9,0],"rotation":[-0.70710678,0,0,0.70710678]}]"#;
    let text =
        text.replace(r#""nodes":[{"mesh":0}]"#, cameras).replace(r#"{"nodes":[0]}"#, r#"{"nodes":[0,1,2]}"#);
    fs::write(&cube, text).expect("the folder is writable");
    cube
}

#[test]
fn cameras_of_the_file_are_chosen_by_name_and_number() {
    let folder = folder();
    let scene = with_cameras(folder.path());
    let seen = |more: &[&str]| channel(&render(&scene, "a.exr", more), "Z");
    let usual = seen(&[]);
    let (front, above) = (seen(&["--camera", "Front"]), seen(&["--camera", "1"]));
    assert_eq!((usual, front.clone()), (front.clone(), seen(&["--camera", "0"])));
    let nearest = |z: &[f32]| z.iter().copied().filter(|z| *z > 0.0).fold(f32::MAX, f32::min);
    assert!((nearest(&front) - 5.0).abs() < 1e-3 && (nearest(&above) - 8.0).abs() < 1e-3);
    assert_eq!(seen(&["--camera", "lens"]), front);
    // Whoever frames the scene does not look through its camera.
    assert_ne!(seen(&["--azimuth", "0"]), front);
    let out = folder.path().join("b.png");
    let mut command = isophote();
    command.arg("render").arg(&scene).arg(&out).args(["--camera", "side"]);
    fails(&mut command, 2, &["--camera", "'side'", "0 (front)", "1 (lens)"]);
    let cube = support::cube(folder.path());
    let mut command = isophote();
    fails(command.arg("render").arg(cube).arg(&out).args(["--camera", "0"]), 2, &["'0'", "has no cameras"]);
    assert!(!out.exists());
}

#[test]
fn the_default_camera_goes_away_and_widens() {
    let folder = folder();
    let cube = support::cube(folder.path());
    let seen = |more: &[&str]| channel(&render(&cube, "a.exr", more), "Z");
    let covered = |z: &[f32]| z.iter().filter(|z| **z > 0.0).count() as f32;
    let (usual, far, wide) = (seen(&[]), seen(&["--distance", "2"]), seen(&["--fov", "100"]));
    let share = covered(&far) / covered(&usual);
    assert!((0.17..0.3).contains(&share), "{share}");
    // A wide view comes closer to keep the scene in the picture.
    let nearest = |z: &[f32]| z.iter().copied().filter(|z| *z > 0.0).fold(f32::MAX, f32::min);
    let (closer, share) = (nearest(&wide) / nearest(&usual), covered(&wide) / covered(&usual));
    assert!(closer < 0.5 && (0.2..1.5).contains(&share), "{closer} {share}");
}

#[test]
fn models_cast_a_shadow_on_the_ground_and_nothing_else() {
    let folder = folder();
    let cube = support::cube(folder.path());
    let color = ["--background", "#c0c0c0"];
    let (on, off) = (picture(&cube, &color), picture(&cube, &[&color[..], &["--no-ground"]].concat()));
    let darker: Vec<(u32, u32)> = on
        .enumerate_pixels()
        .filter(|(x, y, pixel)| u32::from(pixel[1]) + 20 < u32::from(off.get_pixel(*x, *y)[1]))
        .map(|(x, y, _)| (x, y))
        .collect();
    assert!(darker.len() > 60, "{} pixels are darker", darker.len());
    let cut = picture(&cube, &BARE);
    assert!(
        darker.iter().all(|(x, y)| *y > 20 && cut.get_pixel(*x, *y)[3] < 255),
        "the model is darker, too"
    );
    assert!(on.pixels().zip(off.pixels()).all(|(on, off)| on.0.iter().zip(off.0).all(|(a, b)| *a <= b)));
    // Where nothing is behind, the shadow is all that is there.
    let shadow = picture(&cube, &["--background", "transparent"]);
    let soft = shadow.pixels().filter(|p| (10..245).contains(&p[3]) && p.0[..3] == [0; 3]).count();
    assert!(soft > 100, "{soft} pixels are in half shadow");
    let (on, off) = (render(&cube, "on.exr", &[]), render(&cube, "off.exr", &["--no-ground"]));
    assert_ne!(channel(&on, "G"), channel(&off, "G"));
    // A shadow has no outline, and nothing else is elsewhere for it.
    for name in ["N.X", "N.Y", "N.Z", "Z", "id", "A"] {
        assert_eq!(channel(&on, name), channel(&off, name), "{name}");
    }
    let [rest, without, id] = [channel(&on, "Pref.Y"), channel(&off, "Pref.Y"), channel(&off, "id")];
    assert!(rest.iter().zip(&without).zip(&id).all(|((on, off), id)| *id == 0.0 || on == off));
    // Its marks stick to the ground, which lies just below the model.
    let ground: Vec<f32> =
        rest.iter().zip(&id).filter(|(y, id)| **id == 0.0 && **y != 0.0).map(|(y, _)| *y).collect();
    let low = without.iter().copied().fold(0.0, f32::min);
    assert!(ground.len() > 100, "{} pixels are on the ground", ground.len());
    assert!(ground.iter().all(|y| *y < low && *y > low - 0.01 && (y - ground[0]).abs() < 1e-5), "{low}");
    // From below, and with the sun below, there is none.
    for more in [["--elevation", "-20"], ["--light", "0,-20"]] {
        let both =
            [&[][..], &["--no-ground"][..]].map(|ground| picture(&cube, &[&more[..], ground].concat()));
        assert_eq!(both[0], both[1], "{more:?}");
    }
}

#[test]
fn the_shadow_on_the_ground_is_smooth() {
    let folder = folder();
    let ball = ball(folder.path());
    let view = ["--elevation", "50", "--background", "transparent", "--depth", "float"];
    let file = render_in(&ball, "shadow.exr", "320x200", &view);
    let (alpha, id) = (channel(&file, "A"), channel(&file, "id"));
    // That of a ball grows and falls along every line, once.
    let (mut ripples, mut heights) = (0.0, 0.0);
    for (alpha, id) in alpha.chunks(320).zip(id.chunks(320)) {
        let (first, last) = (id.iter().position(|id| *id > 0.0), id.iter().rposition(|id| *id > 0.0));
        // Beside the ball, pixels are in part of it.
        let (left, right) =
            (first.map_or(320, |x| x.saturating_sub(2)), last.map_or(320, |x| (x + 3).min(320)));
        for part in [&alpha[..left], &alpha[right..]] {
            let (Some(first), Some(last)) = (part.first(), part.last()) else { continue };
            let height = part.iter().copied().fold(0.0, f32::max);
            let changes: f32 = part.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
            ripples += changes - (2.0 * height - first - last);
            heights += height;
        }
    }
    assert!(heights > 5.0, "{heights}");
    assert!(ripples < 0.01 * heights, "{} of the shadow's height are ripples", ripples / heights);
}

#[test]
fn drawn_shadows_on_the_ground_move_with_it() {
    let folder = folder();
    let ball = ball(folder.path());
    // A turn of three degrees a frame, of which so many are rendered.
    let turn = ["--turntable", "--elevation", "40", "--distance", "1.6"];
    for (out, style) in [("a.####.exr", &[][..]), ("a.####.png", &["--style", "ink", "--lengths", "pixels"])]
    {
        render_in(&ball, out, "320x200", &[&turn[..], &["--frames", "1-4,120"], style].concat());
    }
    let file = |number: u32, kind: &str| folder.path().join(format!("a.{number:04}.{kind}"));
    let drawn = |number| image::open(file(number, "png")).expect("a frame").into_rgb8();
    let (mut moved, mut still, mut all) = (0, 0, 0);
    for number in 2..=4 {
        let (before, now, guides) = (drawn(number - 1), drawn(number), file(number, "exr"));
        let [id, u, v] = ["id", "backward.u", "backward.v"].map(|name| channel(&guides, name));
        let was = channel(&file(number - 1, "exr"), "id");
        // True where the ball is neither there nor beside.
        let is_free = |id: &[f32], [x, y]: [usize; 2]| {
            let mut around = (y - 4..=y + 4).flat_map(|y| (x - 4..=x + 4).map(move |x| 320 * y + x));
            around.all(|at| id[at] == 0.0)
        };
        for [x, y] in (6..194).flat_map(|y| (6..314).map(move |x| [x, y])) {
            let at = 320 * y + x;
            let from = [x as f32 + u[at], y as f32 - v[at]].map(|v| v.round() as usize);
            let inside = (4..316).contains(&from[0]) && (4..196).contains(&from[1]);
            if !inside || !is_free(&id, [x, y]) || !is_free(&was, from) {
                continue;
            }
            let now = now.get_pixel(x as u32, y as u32)[0];
            let changes = |[x, y]: [usize; 2]| now.abs_diff(before.get_pixel(x as u32, y as u32)[0]) > 25;
            (moved, still) = (moved + u32::from(changes(from)), still + u32::from(changes([x, y])));
            all += 1;
        }
    }
    assert!(all > 100_000, "{all} pixels are compared");
    let [moved, still] = [moved, still].map(|count| count as f32 / all as f32);
    assert!(moved < 0.015, "{moved} of the background changes with every frame");
    assert!(2.0 * moved < still, "{moved} changes where the ground goes, {still} on the screen");
}

#[test]
fn scenes_with_a_floor_have_no_other_ground() {
    let folder = folder();
    let file = folder.path().join("floor.obj");
    let floor = "v -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\nv 0 2 0\nv 1 0 0\nv 0 0 1\nf 4 3 2 1\nf 5 6 7\n";
    fs::write(&file, floor).expect("the folder is writable");
    let [usual, with, without] = [&[][..], &["--ground"], &["--no-ground"]].map(|more| picture(&file, more));
    assert_eq!(usual, without);
    assert_ne!(usual, with, "the floor casts a shadow beside it when asked to");
    let cube = support::cube(folder.path());
    assert_eq!(picture(&cube, &[]), picture(&cube, &["--no-ground", "--ground"]), "the last one counts");
}

/// Writes a picture of all directions.
fn surroundings(file: &Path, color: impl Fn(f32, f32) -> [f32; 3]) {
    let (width, height) = (64, 32);
    let pixels: Vec<Rgb<f32>> = (0..width * height)
        .map(|at| Rgb(color((at % width) as f32 / width as f32, (at / width) as f32 / height as f32)))
        .collect();
    let file = fs::File::create(file).expect("the folder is writable");
    image::codecs::hdr::HdrEncoder::new(file).encode(&pixels, width, height).expect("a picture");
}

#[test]
fn pictures_of_the_surroundings_are_shown_and_light_the_scene() {
    let folder = folder();
    let ball = ball(folder.path());
    let at = |name: &str| folder.path().join(name).display().to_string();
    // Red on the left of who looks along -Z, blue on the right; black below.
    surroundings(&folder.path().join("sides.hdr"), |u, v| match (u < 0.5, v < 0.75) {
        (_, false) => [0.0; 3],
        (true, _) => [0.6, 0.05, 0.05],
        (false, _) => [0.05, 0.05, 0.6],
    });
    let sides = at("sides.hdr");
    // The default camera stands 31.5 degrees to the right of +Z.
    let more = ["--background", &sides, "--azimuth", "-31.5", "--no-ground"];
    let shown = picture(&ball, &more);
    let (left, right) = (shown.get_pixel(4, 20), shown.get_pixel(91, 20));
    assert!(left[0] > 150 && left[2] < 90 && right[2] > 150 && right[0] < 90, "{left:?} {right:?}");
    let dark = picture(&ball, &[&more[..], &["--light", "0,-90"]].concat());
    let (left, right) = (dark.get_pixel(34, 24), dark.get_pixel(61, 24));
    assert!(left[0] > left[2] + 15 && right[2] > right[0] + 15, "{left:?} {right:?} stand in coloured light");
    // The same picture in other units looks about the same.
    surroundings(&folder.path().join("dim.hdr"), |_, _| [1e-4, 2e-4, 3e-4]);
    surroundings(&folder.path().join("bright.hdr"), |_, _| [100.0, 200.0, 300.0]);
    let [dim, bright] =
        [at("dim.hdr"), at("bright.hdr")].map(|file| picture(&ball, &["--background", &file]));
    let (dim, bright) = (dim.get_pixel(2, 2), bright.get_pixel(2, 2));
    assert!(dim[2] > 60 && dim[2] > dim[0] && bright[2] < 255 && bright[2] > bright[0], "{dim:?} {bright:?}");
    // As EXR, with what is no number.
    let exr = folder.path().join("odd.exr");
    let color = |x: usize, _: usize| (if x == 3 { f32::NAN } else { 0.3f32 }, 0.4f32, f32::INFINITY);
    exr::prelude::write_rgb_file(&exr, 64, 32, color).expect("a picture");
    let frame = render(&ball, "frame.exr", &["--background", &exr.display().to_string()]);
    for name in ["R", "G", "B"] {
        assert!(channel(&frame, name).iter().all(|v| v.is_finite()), "{name}");
    }
}

#[test]
fn pictures_that_show_no_surroundings_are_refused() {
    let folder = folder();
    let cube = support::cube(folder.path());
    let at = |name: &str| folder.path().join(name);
    support::picture(48, 32).save(at("photo.png")).expect("the picture can be written");
    fs::copy(at("photo.png"), at("photo.hdr")).expect("the folder is writable");
    fs::write(at("text.exr"), "no picture").expect("the folder is writable");
    for (file, words) in [
        ("photo.hdr", &["photo.hdr", "48x32", "twice as wide as high"][..]),
        ("text.exr", &["text.exr"]),
        ("missing.hdr", &["missing.hdr", "cannot be read"]),
    ] {
        let mut command = isophote();
        command
            .arg("render")
            .arg(&cube)
            .arg(at("out.png"))
            .args(["--size", "16x16", "--background"])
            .arg(at(file));
        fails(&mut command, 2, words);
        assert!(!at("out.png").exists());
    }
}

#[test]
fn exposure_and_target_are_those_of_the_window() {
    let folder = folder();
    let scene = ball(folder.path());
    let all = |picture: &RgbaImage| mean(picture, |_, _| true);
    let plain = picture(&scene, &["--background", "transparent"]);
    let bright = picture(&scene, &["--background", "transparent", "--exposure", "1"]);
    let dark = picture(&scene, &["--background", "transparent", "--exposure", "-1.5"]);
    assert!(all(&dark) + 5.0 < all(&plain) && all(&plain) + 5.0 < all(&bright));
    let covered = |picture: &RgbaImage| {
        let columns = picture.enumerate_pixels().filter(|(_, _, p)| p[3] == 255).map(|(x, ..)| f64::from(x));
        let columns: Vec<f64> = columns.collect();
        columns.iter().sum::<f64>() / columns.len() as f64
    };
    let aside = ["--background", "transparent", "--no-ground", "--azimuth", "0", "--distance", "3"];
    let middle = covered(&picture(&scene, &aside));
    let moved = covered(&picture(&scene, &[&aside[..], &["--target", "1,0,1"]].concat()));
    assert!((middle - 47.5).abs() < 1.5 && (moved - middle).abs() > 2.0, "{middle} and {moved}");
    fails(
        isophote().arg("render").arg(&scene).args(["out.png", "--target", "1,2"]),
        2,
        &["three coordinates"],
    );
}
