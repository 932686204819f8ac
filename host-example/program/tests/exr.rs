//! `apply` on EXR files: everything but the picture comes out as it went in. Files are compared by the `exr`
//! crate's own reader, which the program does not use for this.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use exr::prelude::*;
use isophote_loader::{Control, Input, Library, abi};
use isophote_pictures::pixels::{Pixels, Precision, Samples};
use isophote_tests::two_parts;

use crate::support::{self, IN_PIXELS, assets, fails, folder, isophote, listing, succeeds};

type Planes = Vec<(String, FlatSamples)>;

/// Every part: its header but for what follows from the number of channels, and its channels.
fn parts(path: &Path) -> Vec<(LayerAttributes, ImageAttributes, Encoding, Planes)> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_file(path)
        .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let planes = |layer: &Layer<AnyChannels<FlatSamples>>| {
        layer.channel_data.list.iter().map(|c| (c.name.to_string(), c.sample_data.clone())).collect()
    };
    let attributes = &image.attributes;
    let part = |layer| -> (_, _, _, Planes) {
        let layer: &Layer<AnyChannels<FlatSamples>> = layer;
        (layer.attributes.clone(), attributes.clone(), layer.encoding, planes(layer))
    };
    image.layer_data.iter().map(part).collect()
}

/// Bits and not values, so that what is no number counts too.
fn bits(samples: &FlatSamples) -> Vec<u32> {
    match samples {
        FlatSamples::F16(v) => v.iter().map(|s| u32::from(s.to_bits())).collect(),
        FlatSamples::F32(v) => v.iter().map(|s| s.to_bits()).collect(),
        FlatSamples::U32(v) => v.clone(),
    }
}

/// Names of the channels that differ, when nothing else does. New channels count as different.
fn changed(before: &Path, after: &Path) -> Vec<String> {
    let (old, new) = (parts(before), parts(after));
    assert_eq!(old.len(), new.len());
    let mut names = Vec::new();
    for ((own, all, encoding, planes), (new_own, new_all, new_encoding, new_planes)) in old.iter().zip(&new) {
        assert_eq!((own, all, encoding), (new_own, new_all, new_encoding));
        for (name, samples) in planes {
            let found = new_planes.iter().find(|(n, _)| n == name).expect("no channel is lost");
            assert_eq!(std::mem::discriminant(samples), std::mem::discriminant(&found.1), "{name}");
            if bits(samples) != bits(&found.1) {
                names.push(name.clone());
            }
        }
        let is_new = |n: &&(String, FlatSamples)| !planes.iter().any(|(old, _)| *old == n.0);
        names.extend(new_planes.iter().filter(is_new).map(|n| n.0.clone()));
    }
    names
}

const SIZE: (usize, usize) = (37, 41);

fn wave(scale: f32) -> Vec<f32> {
    (0..SIZE.0 * SIZE.1)
        .map(|i| ((i % SIZE.0) as f32 * 0.7).sin().abs() * scale + (i % 5) as f32 * 0.1)
        .collect()
}

fn half(scale: f32) -> FlatSamples {
    FlatSamples::F16(wave(scale).into_iter().map(f16::from_f32).collect())
}

fn layer(
    name: &str,
    encoding: Encoding,
    channels: Vec<(&str, FlatSamples)>,
) -> Layer<AnyChannels<FlatSamples>> {
    let mut attributes = LayerAttributes {
        layer_name: (!name.is_empty()).then(|| name.into()),
        layer_position: Vec2(-5, 9),
        owner: Some("somebody".into()),
        ..Default::default()
    };
    attributes.other.insert("render seed".into(), AttributeValue::I32(77));
    attributes.other.insert(
        "unheard of".into(),
        AttributeValue::Custom { kind: "ours".into(), bytes: vec![1, 2, 3, 255].into() },
    );
    let channels = channels.into_iter().map(|(n, s)| AnyChannel::new(n, s)).collect();
    Layer::new(SIZE, attributes, encoding, AnyChannels::sort(channels))
}

fn save(path: &Path, layers: Vec<Layer<AnyChannels<FlatSamples>>>) {
    save_shaped(path, 1.5, layers);
}

/// With pixels of this width over height; those that are not square pass through others.
fn save_shaped(path: &Path, pixel_aspect: f32, layers: Vec<Layer<AnyChannels<FlatSamples>>>) {
    let mut attributes = ImageAttributes::new(IntegerBounds::new((-20, 3), (90, 80)));
    attributes.pixel_aspect = pixel_aspect;
    let image: FlatImage = Image { attributes, layer_data: layers.into() };
    image.write().to_file(path).expect("the picture can be written");
}

/// The usual channels of a renderer.
fn usual() -> Vec<(&'static str, FlatSamples)> {
    let ids = (0..SIZE.0 * SIZE.1).map(|i| (i as u32).wrapping_mul(2_654_435_761)).collect();
    let mut depth = wave(1e4);
    depth[7] = f32::from_bits(0x7fc0_1234);
    depth[8] = f32::INFINITY;
    vec![
        ("R", half(0.9)),
        ("G", half(0.4)),
        ("B", half(3.0)),
        ("A", half(1.0)),
        ("Z", FlatSamples::F32(depth)),
        ("id", FlatSamples::U32(ids)),
        ("crypto00.R", FlatSamples::F32(wave(1e-30))),
        ("diffuse.R", half(0.2)),
        ("diffuse.G", half(0.3)),
        ("diffuse.B", half(0.5)),
    ]
}

fn apply(folder: &Path, style: &str, input: &str, output: &str, more: &[&str]) -> String {
    let mut command = isophote();
    command
        .current_dir(folder)
        .args(["apply", style, input, output, "--force", "--backend", "cpu"])
        .args(IN_PIXELS)
        .args(more);
    succeeds(&mut command).1
}

const RGBA: [&str; 4] = ["A", "B", "G", "R"];

#[test]
fn every_compression_keeps_everything_else() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
    ] {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 24))] {
            let line_order = LineOrder::Increasing;
            let mut channels = usual();
            if compression == Compression::PXR24 {
                // The file itself holds 24 bits of each float.
                channels.retain(|(_, samples)| !matches!(samples, FlatSamples::F32(_)));
            }
            save(&at("in.exr"), vec![layer("", Encoding { compression, blocks, line_order }, channels)]);
            apply(folder.path(), "gaussian", "in.exr", "out.exr", &[]);
            assert_eq!(changed(&at("in.exr"), &at("out.exr")), RGBA, "{compression} {blocks:?}");
        }
    }
}

#[test]
fn layers_views_and_alpha_are_chosen() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save(&at("in.exr"), vec![layer("", Encoding::SMALL_LOSSLESS, usual())]);
    let changes = |more: &[&str]| {
        apply(folder.path(), "gaussian", "in.exr", "out.exr", more);
        changed(&at("in.exr"), &at("out.exr"))
    };
    assert_eq!(changes(&["--layer", "diffuse"]), ["diffuse.B", "diffuse.G", "diffuse.R"]);
    assert_eq!(changes(&["--alpha", "none"]), ["B", "G", "R"]);
    assert_eq!(changes(&["--into", "soft"]), ["soft.A", "soft.B", "soft.G", "soft.R"]);
    let soft = parts(&at("out.exr"));
    apply(folder.path(), "gaussian", "in.exr", "plain.exr", &[]);
    let plain = parts(&at("plain.exr"));
    let plane = |parts: &[(_, _, _, Planes)], name: &str| {
        bits(&parts[0].3.iter().find(|(n, _)| n == name).expect("a channel").1)
    };
    assert_eq!(plane(&soft, "soft.G"), plane(&plain, "G"));
    assert_eq!(changes(&["--into", &"long".repeat(20)]).len(), 4);
    // Lines are one number: of a new layer the only one, otherwise of every colour.
    apply(folder.path(), "flow_dog", "in.exr", "out.exr", &["--into", "lines"]);
    assert_eq!(changed(&at("in.exr"), &at("out.exr")), ["lines.Y"]);

    let encoding = Encoding::SMALL_LOSSLESS;
    let named = |name: &str, view: &str| {
        let mut part = layer(name, encoding, usual());
        part.attributes.view_name = Some(view.into());
        part
    };
    save(
        &at("in.exr"),
        vec![
            named("rgba.left", "left"),
            named("rgba.right", "right"),
            layer("extra", encoding, vec![("mask", half(1.0))]),
        ],
    );
    assert_eq!(changes(&[]), [RGBA, RGBA].concat());
    assert_eq!(changes(&["--view", "right"]), RGBA);
    assert_eq!(changes(&["--layer", "extra"]), ["mask"]);

    let refused = |more: &[&str], words: &[&str]| {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["apply", "gaussian", "in.exr", "no.exr"]).args(more);
        fails(&mut command, 2, words);
    };
    refused(&["--layer", "difuse"], &["no layer 'difuse'", "diffuse"]);
    refused(&["--view", "middle"], &["view 'middle'", "left, right"]);
    refused(&["--alpha", "mask"], &["no float channel 'mask'"]);
    refused(&["--into", "diffuse"], &["has a layer 'diffuse' already"]);
    refused(&["--into", "a..b"], &["--into", "no name of a layer"]);
    refused(&["--guide", "size=N"], &["normal=LAYER"]);
    support::picture(8, 8).save(at("in.png")).expect("the picture can be written");
    let mut command = isophote();
    command.current_dir(folder.path()).args(["apply", "gaussian", "in.png", "no.png", "--layer", "a"]);
    fails(&mut command, 2, &["--layer", "no EXR file"]);
    assert!(!listing(folder.path()).contains(&"no.exr".to_owned()));
}

#[test]
fn parts_under_other_compressions_pass_untouched() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    // HTJ2K in chunks of 256 and of 32 lines. The second part is the depth that guides a cartoon, were it read.
    for (compression, lines, name) in [(10, 256, "HTJ2K256"), (11, 32, "HTJ2K32")] {
        let (bytes, chunks) = two_parts::file(compression, lines);
        fs::write(at("in.exr"), &bytes).expect("the folder is writable");
        apply(folder.path(), "cartoon", "in.exr", "out.exr", &[]);
        let out = fs::read(at("out.exr")).expect("a result");
        let tail: usize = chunks.iter().map(|chunk| 12 + chunk.len()).sum();
        assert!(out[out.len() - tail..] == bytes[bytes.len() - tail..], "{name}");
        assert!(out != bytes, "{name}");
        let arguments = ["apply", "cartoon", "in.exr", "no.exr", "--guide", "depth=depth"];
        fails(isophote().current_dir(folder.path()).args(arguments), 2, &["in.exr", name]);
    }
}

/// DWAA and DWAB are read where a style wants them, and not where nothing does.
#[test]
fn parts_beside_the_picture_are_not_decoded() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for (compression, lines) in [(8, 32), (9, 256)] {
        let (bytes, chunks) = two_parts::file(compression, lines);
        fs::write(at("in.exr"), &bytes).expect("the folder is writable");
        apply(folder.path(), "gaussian", "in.exr", "out.exr", &[]);
        let out = fs::read(at("out.exr")).expect("a result");
        let tail: usize = chunks.iter().map(|chunk| 12 + chunk.len()).sum();
        assert!(out[out.len() - tail..] == bytes[bytes.len() - tail..], "{compression}");
    }
}

/// Result of the library for a picture in linear light.
fn by_the_library(color: &Pixels, guides: &[(&str, &Pixels)]) -> Pixels {
    let library = Library::from_file(support::library()).expect("the library");
    let mut graph = library.single("cartoon").expect("the node");
    let request = library.request((color.width(), color.height())).expect("a size");
    let request = abi::IsophoteRequest { space: abi::ISOPHOTE_SPACE_LINEAR, ..request };
    let mut inputs = vec![Input { name: "color", pixels: color }];
    inputs.extend(guides.iter().map(|(name, pixels)| Input { name, pixels }));
    let mut result = Pixels::zeroed(color.width(), color.height(), 4, Precision::F16);
    graph.process(None, &request, &inputs, &mut result, &mut Control::default()).expect("a result");
    result
}

#[test]
fn the_result_is_the_librarys() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mut channels = usual();
    channels.retain(|(name, _)| !matches!(*name, "id" | "Z"));
    channels.push(("N.X", half(0.3)));
    channels.push(("N.Y", half(0.1)));
    channels.push(("N.Z", half(0.8)));
    save_shaped(&at("in.exr"), 1.0, vec![layer("", Encoding::SMALL_LOSSLESS, channels.clone())]);
    let interleaved = |names: &[&str]| -> Vec<f16> {
        let plane = |name: &&str| match &channels.iter().find(|(n, _)| n == name).expect("a channel").1 {
            FlatSamples::F16(v) => v.clone(),
            _ => Vec::new(),
        };
        let planes: Vec<_> = names.iter().map(plane).collect();
        (0..SIZE.0 * SIZE.1 * names.len()).map(|i| planes[i % names.len()][i / names.len()]).collect()
    };
    let size = (SIZE.0 as u32, SIZE.1 as u32);
    let color =
        Pixels::new(size.0, size.1, 4, Samples::F16(interleaved(&["R", "G", "B", "A"]))).expect("a picture");
    // What has no length is no surface.
    let normals = interleaved(&["N.X", "N.Y", "N.Z"]).into_iter().map(f16::to_f32).collect::<Vec<_>>();
    let valid = |n: &[f32; 3]| [n[0], n[1], n[2], f32::from(*n != [0.0; 3])];
    let normals = normals.as_chunks::<3>().0.iter().flat_map(valid).collect();
    let normal = Pixels::new(size.0, size.1, 4, Samples::F32(normals)).expect("normals");
    for (more, guides) in [
        (vec!["--guide", "normal=none"], vec![]),
        (vec![], vec![("normal", &normal)]),
        (vec!["--guide", "normal=N"], vec![("normal", &normal)]),
    ] {
        apply(folder.path(), "cartoon", "in.exr", "out.exr", &more);
        let Samples::F16(expected) = by_the_library(&color, &guides).samples().clone() else {
            panic!("halves")
        };
        let out = parts(&at("out.exr"));
        for (offset, name) in ["R", "G", "B", "A"].iter().enumerate() {
            let plane = &out[0].3.iter().find(|(n, _)| n == name).expect("a channel").1;
            let expected: Vec<u32> =
                expected.iter().skip(offset).step_by(4).map(|v| u32::from(v.to_bits())).collect();
            assert_eq!(bits(plane), expected, "{name} {more:?}");
        }
    }
}

#[test]
fn primaries_of_files_are_kept_and_converted() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let grey = || FlatSamples::F32(vec![0.25; SIZE.0 * SIZE.1]);
    let channels = vec![("R", FlatSamples::F32(wave(2.0))), ("G", grey()), ("B", grey())];
    save_shaped(&at("in.exr"), 1.0, vec![layer("", Encoding::SMALL_LOSSLESS, channels)]);
    for space in ["p3", "rec2020", "acescg", "linear"] {
        apply(folder.path(), "gaussian", "in.exr", "out.exr", &["--space", space, "--set", "mix=0"]);
        for ((name, old), (_, new)) in parts(&at("in.exr"))[0].3.iter().zip(&parts(&at("out.exr"))[0].3) {
            let far = old.values_as_f32().zip(new.values_as_f32()).any(|(a, b)| (a - b).abs() > 2e-5);
            assert!(!far, "{space} {name}");
        }
    }
}

fn exr_assets() -> Option<PathBuf> {
    let found = assets().map(|folder| folder.join("exr")).filter(|folder| folder.is_dir());
    if found.is_none() {
        eprintln!("\n*** SKIPPED: there are no EXR assets beside the repository ***\n");
    }
    found
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

#[test]
fn real_files_keep_everything_else() {
    let Some(assets) = exr_assets() else { return };
    let folder = folder();
    let out = folder.path().join("out.exr");
    for path in files(&assets) {
        let name = path.display().to_string();
        let is_damaged = name.contains("Damaged");
        if !is_damaged && !name.ends_with(".exr") {
            continue;
        }
        let started = Instant::now();
        let mut command = isophote();
        command
            .args(["apply", "gaussian", "--force", "--backend", "cpu", "--set", "sigma=1"])
            .args(IN_PIXELS)
            .arg(&path)
            .arg(&out);
        if is_damaged || name.contains("Trunks") {
            fails(&mut command, 2, &[]);
            assert!(started.elapsed() < Duration::from_secs(60), "{name}");
            continue;
        }
        let (_, warnings) = succeeds(&mut command);
        let colours = ["R", "G", "B", "A", "Y", "RY", "BY"];
        let is_picture = |n: &String| {
            colours.iter().any(|c| n == c || *n == format!("left.{c}") || *n == format!("right.{c}"))
        };
        if name.contains("Flowers") {
            // The crate does not read channels with fewer samples than pixels.
            let meta = |path: &Path| MetaData::read_from_file(path, false).expect("headers").headers;
            assert_eq!(meta(&path), meta(&out));
            continue;
        }
        let names = changed(&path, &out);
        assert!(!names.is_empty() && names.iter().all(is_picture), "{name}: {names:?}");
        let (_, _, _, planes) = &parts(&out)[0];
        let bright = |c: &(String, FlatSamples)| c.1.values_as_f32().fold(0.0f32, |a, v| a.max(v.abs()));
        for channel in planes.iter().filter(|c| is_picture(&c.0)) {
            assert!(channel.1.values_as_f32().all(f32::is_finite), "{name}: {}", channel.0);
        }
        if name.contains("BrightRingsNanInf") {
            assert!(warnings.contains("samples were NaN or infinite"), "{warnings}");
            assert!(planes.iter().map(bright).fold(0.0, f32::max) > 100.0, "bright values are lost");
        }
        if name.contains("WideFloatRange") {
            // The library works up to the largest half.
            assert!(bright(&planes[0]) > 65000.0, "bright values are lost: {}", bright(&planes[0]));
        }
    }
}

/// A flat picture of this data window in a display window of 160x128.
fn flat(path: &Path, position: Vec2<i32>, size: (usize, usize)) {
    let attributes = LayerAttributes { layer_position: position, ..Default::default() };
    let channels = SpecificChannels::rgba(|_: Vec2<usize>| (0.3_f32, 0.25_f32, 0.2_f32, 1.0_f32));
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new((0, 0), (160, 128));
    image.write().to_file(path).expect("the picture can be written");
}

#[test]
fn a_data_window_shows_the_marks_of_the_display_window() {
    let folder = folder();
    let (position, size) = (Vec2(27, 13), (110, 100));
    flat(&folder.path().join("whole.exr"), Vec2(0, 0), (160, 128));
    flat(&folder.path().join("part.exr"), position, size);
    for style in ["blueprint", "watercolor"] {
        for name in ["whole", "part"] {
            let (input, output) = (format!("{name}.exr"), format!("{name}-{style}.exr"));
            apply(folder.path(), style, &input, &output, &[]);
        }
        let red = |name: &str| {
            let (_, _, _, planes) = parts(&folder.path().join(format!("{name}-{style}.exr"))).remove(0);
            bits(&planes.iter().find(|(name, _)| name == "R").expect("a red channel").1)
        };
        let (whole, part) = (red("whole"), red("part"));
        for y in 36..size.1 - 36 {
            for x in 36..size.0 - 36 {
                let (i, j) = (y * size.0 + x, (y + position.y() as usize) * 160 + x + position.x() as usize);
                assert_eq!(part[i], whole[j], "{style} at {x}, {y}");
            }
        }
        assert!(part.iter().any(|v| *v != part[0]), "{style} has marks");
    }
}
