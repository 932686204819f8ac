//! `apply --mask`: where the result is used, by files, layers and Cryptomattes. Files are written by the `exr` crate; ids are
//! those that the Python package mmh3 gives.

mod support;

use std::fs;
use std::path::Path;

use exr::prelude::*;
use image::{GrayImage, Luma, Rgb, RgbImage, Rgba, RgbaImage};
use isophote_host::apply::exr::{Guide, MaskSource, Selection};
use isophote_host::apply::masks::{MaskChoice, Masks};
use isophote_host::apply::read;

use support::{fails, folder, isophote, listing, picture, succeeds};

const SIZE: (usize, usize) = (24, 16);
const PIXELS: usize = SIZE.0 * SIZE.1;
const IDS: [(&str, u32); 6] = [
    ("bunny", 0x1385_1a76),
    ("hero", 0x82ce_30b4),
    ("props/barrel", 0x09c8_e8a6),
    ("props/box", 0xb981_b2fa),
    ("a,b*", 0x281d_d1f9),
    // Its hash is 0x005694cc, which would be denormal.
    ("thing119", 0x00d6_94cc),
];

fn id(name: &str) -> f32 {
    let known = IDS.iter().find(|(known, _)| *known == name).expect("a name with an id");
    f32::from_bits(known.1)
}

/// What covers a pixel, the most first.
fn ranks(x: usize, y: usize) -> Vec<(&'static str, f32)> {
    match (x, y) {
        (0..4, _) => vec![],
        (4..8, _) => vec![("bunny", 1.0)],
        (8, _) => vec![("bunny", 0.625), ("hero", 0.25), ("props/box", 0.125)],
        (9..14, 0..8) => vec![("hero", 1.0)],
        (9..14, _) => vec![("props/barrel", 1.0)],
        (14, _) => vec![("props/box", 0.5), ("props/barrel", 0.25), ("hero", 0.125), ("a,b*", 0.0625)],
        (15..20, _) => vec![("props/box", 1.0)],
        _ => vec![("a,b*", 0.75)],
    }
}

/// How much of a pixel some things cover.
fn coverage(names: &[&str]) -> Vec<f32> {
    let of = |at: usize| {
        ranks(at % SIZE.0, at / SIZE.0).iter().filter(|(n, _)| names.contains(n)).map(|(_, c)| c).sum()
    };
    (0..PIXELS).map(of).collect()
}

/// The channels of two layers of ranks.
fn matte(name: &str, components: [&str; 4]) -> Vec<(String, FlatSamples)> {
    let mut channels = Vec::new();
    for rank in 0..4 {
        let pixel = |at: usize| ranks(at % SIZE.0, at / SIZE.0).get(rank).copied();
        let ids = (0..PIXELS).map(|at| pixel(at).map_or(0.0, |(name, _)| id(name)));
        let covers = (0..PIXELS).map(|at| pixel(at).map_or(0.0, |(_, coverage)| coverage));
        let name =
            |component: usize| format!("{name}{:02}.{}", rank / 2, components[2 * (rank % 2) + component]);
        channels.push((name(0), FlatSamples::F32(ids.collect())));
        channels.push((name(1), FlatSamples::F32(covers.collect())));
    }
    channels
}

fn manifest(names: &[&str]) -> String {
    let entries: Vec<String> =
        names.iter().map(|n| format!("\"{}\":\"{:08x}\"", n.replace('/', "\\/"), id(n).to_bits())).collect();
    format!("{{{}}}", entries.join(","))
}

fn colours() -> Vec<(String, FlatSamples)> {
    let plane = |step: usize| {
        let value = |i: usize| {
            f16::from_f32(((i * step) % 23) as f32 / 16.0 + if i % SIZE.0 > 12 { 0.5 } else { 0.0 })
        };
        FlatSamples::F16((0..PIXELS).map(value).collect())
    };
    ["R", "G", "B"].iter().zip([3, 5, 7]).map(|(name, step)| ((*name).to_owned(), plane(step))).collect()
}

/// The attributes of a Cryptomatte.
fn attributes(key: &str, name: &str, manifest: (&str, &str)) -> Vec<(String, String)> {
    let attribute = |field: &str, value: &str| (format!("cryptomatte/{key}/{field}"), value.to_owned());
    vec![
        attribute("name", name),
        attribute("hash", "MurmurHash3_32"),
        attribute("conversion", "uint32_to_float32"),
        attribute(manifest.0, manifest.1),
    ]
}

type Part<'a> = (&'a str, Vec<(String, FlatSamples)>, Vec<(String, String)>);

/// Writes a file of these parts.
fn save(path: &Path, parts: Vec<Part<'_>>) {
    let layers = parts.into_iter().map(|(name, channels, texts)| {
        let mut attributes =
            LayerAttributes { layer_name: (!name.is_empty()).then(|| name.into()), ..Default::default() };
        for (name, value) in texts {
            let value = AttributeValue::Text(Text::new_or_none(&value).expect("a text"));
            attributes.other.insert(name.as_str().into(), value);
        }
        let channels = channels.into_iter().map(|(n, s)| AnyChannel::new(n.as_str(), s)).collect();
        Layer::new(SIZE, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels))
    });
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions(SIZE));
    let image: FlatImage = Image { attributes, layer_data: layers.collect() };
    image.write().to_file(path).expect("the picture can be written");
}

/// A picture with a Cryptomatte of objects whose manifest does not list the bunny.
fn save_usual(path: &Path) {
    let listed = manifest(&["hero", "props/barrel", "props/box", "a,b*"]);
    let channels = [colours(), matte("crypto_object", ["R", "G", "B", "A"])].concat();
    save(path, vec![("", channels, attributes("f834d0a", "crypto_object", ("manifest", &listed)))]);
}

/// The mask that a picture's file holds, before it is applied.
fn mask_of(path: &Path, text: &str, invert: bool) -> std::result::Result<Vec<f32>, String> {
    let source: MaskSource = text.parse()?;
    let masks = Masks::new(&[MaskChoice { source: source.clone(), invert }]).map_err(|e| e.to_string())?;
    let selection = Selection { masks: vec![source], ..Selection::default() };
    let mut source = read::read(path, &selection).map_err(|e| e.to_string())?;
    masks.add(&mut source, None, false).map_err(|e| e.to_string())?;
    Ok(source.pictures[0].masks[0].as_ref().expect("a mask").to_f32())
}

/// Red, green and blue of the main layer.
fn rgb(path: &Path) -> Vec<[f32; 3]> {
    let image = read_first_flat_layer_from_file(path).expect("an EXR file");
    let plane = |name: &str| -> Vec<f32> {
        let channel = image.layer_data.channel_data.list.iter().find(|c| c.name.to_string() == name);
        channel.expect("a channel").sample_data.values_as_f32().collect()
    };
    let planes = ["R", "G", "B"].map(plane);
    (0..PIXELS).map(|at| [planes[0][at], planes[1][at], planes[2][at]]).collect()
}

fn apply(folder: &Path, input: &str, output: &str, more: &[&str]) -> String {
    let mut command = isophote();
    command.current_dir(folder).args(["apply", "gaussian", input, output, "--backend", "cpu"]).args(more);
    succeeds(&mut command).1
}

fn refused(folder: &Path, args: &[&str], words: &[&str]) {
    fails(isophote().current_dir(folder).args(["apply", "gaussian"]).args(args), 2, words);
    assert!(!listing(folder).iter().any(|name| name.starts_with("no.")));
}

#[test]
fn cryptomattes_cover_what_they_name() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    save_usual(&at);
    let mask = |text: &str| mask_of(&at, text, false).unwrap_or_else(|e| panic!("{text}: {e}"));
    for (text, names) in [
        ("cryptomatte:hero", &["hero"][..]),
        ("cryptomatte:hero,props/*", &["hero", "props/barrel", "props/box"]),
        ("cryptomatte: props/b?x , hero", &["hero", "props/box"]),
        ("cryptomatte:hero,hero,he*", &["hero"]),
        (r"cryptomatte:a\,b\*", &["a,b*"]),
        ("cryptomatte:*", &["hero", "props/barrel", "props/box", "a,b*"]),
        // Not listed, but there.
        ("cryptomatte:bunny", &["bunny"]),
        ("cryptomatte[crypto_object]:bunny,hero", &["bunny", "hero"]),
    ] {
        assert_eq!(mask(text), coverage(names), "{text}");
    }
    let inverted = mask_of(&at, "cryptomatte:hero", true).expect("a mask");
    assert_eq!(inverted, coverage(&["hero"]).iter().map(|c| 1.0 - c).collect::<Vec<_>>());
    for (text, words) in [
        ("cryptomatte:heroo", &["no 'heroo'", "'crypto_object'", "did you mean hero?"][..]),
        ("cryptomatte:props/c*", &["no 'props/c*'", "props/box"]),
        ("cryptomatte:unheard-of", &["choose from", "a,b*, hero"]),
        (
            "cryptomatte[crypto_material]:a",
            &["no Cryptomatte 'crypto_material'", "cryptomatte[crypto_object]"],
        ),
    ] {
        let error = mask_of(&at, text, false).expect_err(text);
        assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
    }
}

#[test]
fn the_result_is_used_where_the_mask_is() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_usual(&at("in.exr"));
    apply(folder.path(), "in.exr", "all.exr", &[]);
    apply(folder.path(), "in.exr", "masked.exr", &["--mask", "cryptomatte:hero"]);
    apply(folder.path(), "in.exr", "inverted.exr", &["--mask", "cryptomatte:hero", "--invert"]);
    let [before, all, masked, inverted] =
        ["in.exr", "all.exr", "masked.exr", "inverted.exr"].map(|name| rgb(&at(name)));
    let mut tried = [0; 3];
    for (pixel, share) in coverage(&["hero"]).into_iter().enumerate() {
        let (inside, outside) = (masked[pixel], inverted[pixel]);
        match share {
            0.0 => assert_eq!((inside, outside), (before[pixel], all[pixel])),
            1.0 => assert_eq!((inside, outside), (all[pixel], before[pixel])),
            _ => {
                // Halves between the two.
                for c in 0..3 {
                    let (a, b) = (before[pixel][c], all[pixel][c]);
                    let between = (inside[c] - a) * (inside[c] - b) <= 1e-4;
                    assert!(between && (outside[c] - a) * (outside[c] - b) <= 1e-4, "{a} {b} {inside:?}");
                }
            }
        }
        tried[if share == 0.0 { 0 } else { 1 + usize::from(share < 1.0) }] += 1;
    }
    assert!(tried.iter().all(|count| *count >= 16), "{tried:?}");
    assert!(before.iter().zip(&all).filter(|(a, b)| a != b).count() > PIXELS / 2);

    // A graph that has no mask of its own is mixed in the same way.
    let graph = r#"{"format": "isophote-graph", "version": 1, "nodes": [
        {"name": "a", "node": "gaussian", "inputs": {"color": "@color"}}], "output": "a"}"#;
    fs::write(at("graph.json"), graph).expect("the folder is writable");
    let mut command = isophote();
    command.current_dir(folder.path()).args([
        "apply",
        "graph.json",
        "in.exr",
        "graph.exr",
        "--backend",
        "cpu",
    ]);
    succeeds(command.args(["--mask", "cryptomatte:hero"]));
    for (mixed, masked) in rgb(&at("graph.exr")).iter().zip(&masked) {
        for c in 0..3 {
            assert!((mixed[c] - masked[c]).abs() <= 2e-3 * (1.0 + masked[c]), "{mixed:?} {masked:?}");
        }
    }
    // What is no picture of colours is not laid over one.
    let args = ["apply", "flow_dog", "in.exr", "no.exr", "--mask", "cryptomatte:hero"];
    fails(isophote().current_dir(folder.path()).args(args), 2, &["flow_dog", "yields a scalar"]);
    refused(
        folder.path(),
        &["in.exr", "no.exr", "--mask", "cryptomatte:heroo"],
        &["in.exr", "did you mean hero?"],
    );
    let warned =
        apply(folder.path(), "in.exr", "none.exr", &["--mask", "cryptomatte:heroo", "--on-unknown", "empty"]);
    assert!(warned.contains("in.exr: has no 'heroo'"), "{warned}");
    assert_eq!(rgb(&at("none.exr")), before);
}

#[test]
fn manifests_beside_pictures_are_read() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("m")).expect("a folder");
    fs::write(at("m/names.json"), manifest(&["hero", "props/box", "props/barrel"]))
        .expect("the folder is writable");
    let save_with = |file: &str| {
        let channels = [colours(), matte("crypto_object", ["R", "G", "B", "A"])].concat();
        let texts = attributes("f834d0a", "crypto_object", ("manif_file", file));
        save(&at("in.exr"), vec![("", channels, texts)]);
    };
    save_with("m/names.json");
    let mask = |text: &str| mask_of(&at("in.exr"), text, false);
    assert_eq!(mask("cryptomatte:props/*"), Ok(coverage(&["props/barrel", "props/box"])));
    // No file is needed for whole names, and none is read from elsewhere.
    for (file, words) in [
        ("gone.json", &["gone.json", "cannot be read"][..]),
        ("../names.json", &["../names.json", "not below"]),
        ("/etc/hostname", &["not below"]),
        (r"m\\names.json", &["not below"]),
    ] {
        save_with(file);
        assert_eq!(mask("cryptomatte:hero"), Ok(coverage(&["hero"])), "{file}");
        let error = mask("cryptomatte:props/*").expect_err(file);
        assert!(error.contains("no 'props/*'") && words.iter().all(|w| error.contains(w)), "{error}");
    }
    fs::write(at("m/names.json"), "{\"hero\": 7}").expect("the folder is writable");
    save_with("m/names.json");
    assert!(mask("cryptomatte:h*").is_err_and(|e| e.contains("is no JSON of names")));
}

#[test]
fn one_of_several_cryptomattes_is_chosen() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    let listed = manifest(&["hero", "thing119"]);
    let material = |name: &str| -> Vec<(String, FlatSamples)> {
        let plane = |value: f32| FlatSamples::F32(vec![value; PIXELS]);
        vec![(format!("{name}00.red"), plane(id("thing119"))), (format!("{name}00.green"), plane(0.5))]
    };
    let mut texts = attributes("f834d0a", "Layer.CryptoObject", ("manifest", &listed));
    texts.extend(attributes("bda530a", "uMaterials", ("manifest", &listed)));
    let objects = matte("Layer.CryptoObject", ["r", "g", "b", "a"]);
    save(&at, vec![("", [colours(), objects, material("uMaterials")].concat(), texts.clone())]);
    let mask = |text: &str| mask_of(&at, text, false);
    assert_eq!(mask("cryptomatte:hero"), Ok(coverage(&["hero"])));
    assert_eq!(mask("cryptomatte[cryptoobject]:hero"), Ok(coverage(&["hero"])));
    assert_eq!(mask("cryptomatte[uMaterials]:thing119"), Ok(vec![0.5; PIXELS]));
    let error = mask("cryptomatte:ghost").expect_err("is nowhere");
    assert!(error.contains("'Layer.CryptoObject'"), "{error}");

    // Parts of their own, each of which names all.
    let (first, second): (Vec<_>, Vec<_>) =
        matte("crypto_object", ["R", "G", "B", "A"]).into_iter().partition(|(name, _)| name.contains("00."));
    let bare = |channels: Vec<(String, FlatSamples)>| -> Vec<(String, FlatSamples)> {
        let component = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
        channels.into_iter().map(|(name, samples)| (component(&name), samples)).collect()
    };
    let texts = attributes("f834d0a", "crypto_object", ("manifest", &listed));
    save(
        &at,
        vec![
            ("beauty", colours(), texts.clone()),
            ("crypto_object01", bare(second), texts.clone()),
            ("crypto_object00", bare(first), texts),
        ],
    );
    assert_eq!(mask("cryptomatte:hero"), Ok(coverage(&["hero"])));

    let two = [attributes("1", "a", ("manifest", "{}")), attributes("2", "b", ("manifest", "{}"))].concat();
    save(&at, vec![("", colours(), two)]);
    assert!(mask("cryptomatte:hero").is_err_and(|e| e.contains("cryptomatte[a] or cryptomatte[b]")));
    assert!(mask("cryptomatte[a]:hero").is_err_and(|e| e.contains("no layer 'a00'")));
    save(&at, vec![("", colours(), vec![])]);
    assert!(mask("cryptomatte:hero").is_err_and(|e| e.contains("no Cryptomatte")));
    let halves = |name: &str| (name.to_owned(), FlatSamples::F16(vec![f16::ONE; PIXELS]));
    let short = [colours(), vec![halves("c00.R"), halves("c00.G")]].concat();
    save(&at, vec![("", short, attributes("1", "c", ("manifest", "{}")))]);
    assert!(mask("cryptomatte:hero").is_err_and(|e| e.contains("not 32 bits")));
}

#[test]
fn layers_and_channels_are_masks() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    let plane =
        |scale: f32| FlatSamples::F32((0..PIXELS).map(|i| i as f32 * scale / PIXELS as f32).collect());
    let named = |name: &str, scale: f32| (name.to_owned(), plane(scale));
    let more = vec![named("matte.Y", 1.0), named("sets.R", 0.5), named("sets.G", 0.25), named("dust", 0.125)];
    save(&at, vec![("rgba", [colours(), more].concat(), vec![]), ("held", vec![named("Y", 2.0)], vec![])]);
    let mask = |text: &str| mask_of(&at, text, false);
    let expected = |scale: f32| {
        Ok((0..PIXELS).map(|i| (i as f32 * scale / PIXELS as f32).min(1.0)).collect::<Vec<f32>>())
    };
    for (name, scale) in
        [("matte", 1.0), ("matte.Y", 1.0), ("sets.G", 0.25), ("dust", 0.125), ("held", 2.0), ("held.Y", 2.0)]
    {
        assert_eq!(mask(name), expected(scale), "{name}");
    }
    assert!(mask("sets").is_err_and(|e| e.contains("several channels") && e.contains("sets.G, sets.R")));
    let error = mask("mat").expect_err("is no layer");
    assert!(["'mat'", "matte.Y", "dust", "held.Y", "mask.png"].iter().all(|w| error.contains(w)), "{error}");
    picture(24, 16).save(folder.path().join("in.png")).expect("the picture can be written");
    refused(folder.path(), &["in.png", "no.png", "--mask", "matte"], &["--mask", "no EXR file"]);
    refused(folder.path(), &["in.png", "no.png", "--invert"], &["--mask"]);
}

#[test]
fn files_are_masks() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (w, h) = (24, 16);
    picture(w, h).save(at("in.png")).expect("the picture can be written");
    let value = |x: u32, y: u32| (x * 10 + y % 3) as u8;
    GrayImage::from_fn(w, h, |x, y| Luma([value(x, y)]))
        .save(at("grey.png"))
        .expect("the mask can be written");
    RgbImage::from_fn(w, h, |x, y| Rgb([value(x, y); 3]))
        .save(at("rgb.tif"))
        .expect("the mask can be written");
    RgbImage::from_pixel(w, h, Rgb([255, 0, 0])).save(at("red.png")).expect("the mask can be written");
    RgbaImage::from_fn(w, h, |x, _| Rgba([255, 255, 255, (x * 9) as u8]))
        .save(at("alpha.png"))
        .expect("a mask");
    let plane = FlatSamples::F32(
        (0..PIXELS).map(|i| f32::from(value((i % 24) as u32, (i / 24) as u32)) / 255.0).collect(),
    );
    save(&at("one.exr"), vec![("", vec![("matte".to_owned(), plane.clone())], vec![])]);
    save(&at("two.exr"), vec![("", vec![("a".to_owned(), plane.clone()), ("b".to_owned(), plane)], vec![])]);
    let mask = |name: &str| mask_of(&at("in.png"), at(name).to_str().expect("a path"), false);
    let expected: Vec<f32> = (0..PIXELS as u32).map(|i| f32::from(value(i % 24, i / 24)) / 255.0).collect();
    for name in ["grey.png", "rgb.tif", "one.exr"] {
        assert_eq!(mask(name).as_ref(), Ok(&expected), "{name}");
    }
    assert_eq!(mask("red.png"), Ok(vec![0.2126; PIXELS]), "luminance");
    assert_eq!(mask("alpha.png"), Ok(vec![1.0; PIXELS]), "alpha does not count");
    assert!(mask("two.exr").is_err_and(|e| e.contains("channels a, b")));
    assert!(mask("gone.png").is_err_and(|e| e.contains("gone.png")));
    GrayImage::new(23, 16).save(at("small.png")).expect("the mask can be written");
    assert!(mask("small.png").is_err_and(|e| e.contains("23x16") && e.contains("24x16")));
    refused(folder.path(), &["in.png", "no.png", "--mask", "small.png"], &["small.png", "23x16"]);
    refused(folder.path(), &["in.png", "no.png", "--mask", "m.####.png"], &["one picture"]);

    // Each frame has its own, or all have the same.
    for frame in 1..=3 {
        picture(w, h).save(at(&format!("in.{frame:04}.png"))).expect("the picture can be written");
        let shown = |x: u32, _| Luma([if x / 8 == frame - 1 { 255 } else { 0 }]);
        GrayImage::from_fn(w, h, shown)
            .save(at(&format!("m.{frame:04}.png")))
            .expect("the mask can be written");
    }
    apply(folder.path(), "in.png", "all.png", &[]);
    apply(folder.path(), "in.####.png", "out.####.png", &["--mask", "m.####.png"]);
    apply(folder.path(), "in.####.png", "same.####.png", &["--mask", "m.0002.png"]);
    let open = |name: &str| image::open(at(name)).expect("a picture").into_rgb8();
    let (before, all) = (open("in.png"), open("all.png"));
    for frame in 1..=3 {
        for (name, column) in
            [(format!("out.{frame:04}.png"), frame - 1), (format!("same.{frame:04}.png"), 1)]
        {
            for (x, y, pixel) in open(&name).enumerate_pixels() {
                let expected = if x / 8 == column { &all } else { &before };
                assert_eq!(pixel, expected.get_pixel(x, y), "{name} {x} {y}");
            }
        }
    }
    fs::remove_file(at("m.0002.png")).expect("a file");
    let args = ["in.####.png", "no.####.png", "--mask", "m.####.png"];
    refused(folder.path(), &args, &["m.0002.png", "frames 2"]);
}

#[test]
fn cryptomattes_number_objects() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    save_usual(&at);
    let guide = |choice: Option<&str>| {
        let guides = choice.map(|text| text.parse().expect("a guide")).into_iter().collect();
        let selection = Selection { wanted: vec![Guide::ObjectId], guides, ..Selection::default() };
        let source = read::read(&at, &selection).expect("a picture");
        source.pictures[0].guides.first().map(|(name, pixels)| (*name, pixels.to_f32()))
    };
    let (name, ids) = guide(None).expect("ids");
    assert_eq!(name, "object_id");
    let front = |at: usize| ranks(at % SIZE.0, at / SIZE.0).first().map_or("", |(name, _)| name);
    for (a, id) in ids.iter().enumerate() {
        assert_eq!(*id == 0.0, front(a).is_empty(), "{a}");
        assert!(id.fract() == 0.0 && *id < 16_777_216.0);
        for (b, other) in ids.iter().enumerate().step_by(5) {
            assert_eq!(id == other, front(a) == front(b), "{a} {b}");
        }
    }
    assert_eq!(guide(Some("object_id=cryptomatte")), Some((name, ids)));
    assert_eq!(guide(Some("object_id=none")), None);
    // A layer of ids comes first.
    let plain = vec![("id".to_owned(), FlatSamples::U32(vec![7; PIXELS]))];
    let channels = [colours(), plain, matte("crypto_object", ["R", "G", "B", "A"])].concat();
    save(&at, vec![("", channels, attributes("f834d0a", "crypto_object", ("manifest", "{}")))]);
    assert_eq!(guide(None), Some((name, vec![7.0; PIXELS])));
    let refused = ["apply", "cartoon", "in.exr", "no.exr", "--guide", "object_id=cryptomatte[skin]"];
    fails(
        isophote().current_dir(folder.path()).args(refused),
        2,
        &["no Cryptomatte 'skin'", "crypto_object"],
    );
}

#[test]
fn layers_of_data_are_no_pictures() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    let layer = |name: &str| -> Vec<(String, FlatSamples)> {
        colours().into_iter().map(|(component, samples)| (format!("{name}.{component}"), samples)).collect()
    };
    let depth = vec![("Z".to_owned(), FlatSamples::F32(vec![1.0; PIXELS]))];
    let objects = matte("things", ["R", "G", "B", "A"]);
    let channels =
        [colours(), layer("N"), layer("P"), layer("things"), layer("diffuse"), depth, objects].concat();
    save(&at, vec![("", channels, attributes("1", "things", ("manifest", "{}")))]);
    for name in ["N", "P", "things", "things00"] {
        let words = [&format!("data in the layer '{name}'"), "choose from diffuse", "--force-layer"];
        refused(folder.path(), &["in.exr", "no.exr", "--layer", name], &words);
        apply(folder.path(), "in.exr", "out.exr", &["--layer", name, "--force-layer"]);
    }
    apply(folder.path(), "in.exr", "out.exr", &["--layer", "diffuse"]);
    refused(folder.path(), &["in.exr", "no.exr", "--force-layer"], &["--layer"]);
}

#[test]
fn looks_are_laid_over_each_other() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    save_usual(&at("in.exr"));
    let write = |text: &str| fs::write(at("looks.json"), text).expect("the folder is writable");
    let run = |args: &[&str]| succeeds(isophote().current_dir(folder.path()).arg("apply").args(args)).1;
    let alone = |style: &str, output: &str, more: &[&str]| {
        run(&[&[style, "in.exr", output, "--backend", "cpu"], more].concat());
        rgb(&at(output))
    };
    let layered = || {
        run(&["--layered", "looks.json", "in.exr", "out.exr", "--backend", "cpu"]);
        rgb(&at("out.exr"))
    };
    let before = rgb(&at("in.exr"));
    let soft = alone("gaussian", "soft.exr", &["--set", "sigma=3"]);
    let drawn = alone("cartoon", "drawn.exr", &[]);
    let hero = coverage(&["hero"]);

    // Complementary masks: each single result inside its own, made from the picture and not from each other.
    write(
        r#"[{"style": "gaussian", "params": {"sigma": 3}, "mask": "cryptomatte:hero"},
            {"style": "cartoon", "mask": "cryptomatte:hero", "invert": true}]"#,
    );
    for (pixel, (out, share)) in layered().iter().zip(&hero).enumerate() {
        match *share {
            1.0 => assert_eq!(*out, soft[pixel], "{pixel}"),
            0.0 => assert_eq!(*out, drawn[pixel], "{pixel}"),
            _ => assert!(out.iter().all(|v| v.is_finite())),
        }
    }

    // Later ones cover earlier ones; a preset's parameters give way; a mask file lies beside the looks.
    fs::create_dir(at("looks")).expect("a folder");
    fs::write(at("looks/soft.json"), r#"{"style": "gaussian", "parameters": {"sigma": 9}}"#)
        .expect("a preset");
    GrayImage::from_fn(24, 16, |x, _| Luma([if x < 12 { 255 } else { 0 }]))
        .save(at("looks/left.png"))
        .expect("a mask");
    fs::write(
        at("looks/looks.json"),
        r#"[{"style": "cartoon", "mask": "cryptomatte:*,bunny"},
            {"preset": "soft.json", "params": {"sigma": 3}, "mask": "left.png"}]"#,
    )
    .expect("the folder is writable");
    run(&["--layered", "looks/looks.json", "in.exr", "out.exr", "--backend", "cpu"]);
    let any = coverage(&["bunny", "hero", "props/barrel", "props/box", "a,b*"]);
    for (pixel, out) in rgb(&at("out.exr")).iter().enumerate() {
        match (pixel % SIZE.0 < 12, any[pixel]) {
            (true, _) => assert_eq!(*out, soft[pixel]),
            (_, 1.0) => assert_eq!(*out, drawn[pixel]),
            (_, 0.0) => assert_eq!(*out, before[pixel]),
            _ => {}
        }
    }

    // One look by itself is what --mask gives.
    write(r#"[{"style": "gaussian", "params": {"sigma": 3}, "mask": "cryptomatte:hero"}]"#);
    let one = layered();
    let same = alone("gaussian", "same.exr", &["--set", "sigma=3", "--mask", "cryptomatte:hero"]);
    assert_eq!(one, same);
    // Over a whole look.
    write(
        r#"[{"style": "cartoon"}, {"style": "gaussian", "params": {"sigma": 3}, "mask": "cryptomatte:hero"}]"#,
    );
    let over = layered();
    assert!((0..PIXELS).all(|at| hero[at] != 0.0 || over[at] == drawn[at]));

    let cannot = |text: &str, words: &[&str]| {
        write(text);
        let args = ["apply", "--layered", "looks.json", "in.exr", "no.exr"];
        fails(isophote().current_dir(folder.path()).args(args), 2, words);
    };
    cannot("{}", &["looks.json", "no list of looks"]);
    cannot("[]", &["0 looks"]);
    cannot(r#"[{"style": "ink"}, {"mask": "a"}]"#, &["looks.json: look 2", "names no style"]);
    cannot(r#"[{"style": "ink", "masks": "a"}]"#, &["look 1", "unknown key 'masks'"]);
    cannot(r#"[{"style": "inc"}]"#, &["inc"]);
    cannot(r#"[{"style": "ink", "params": {"sigmaa": 1}}]"#, &["look 1", "sigmaa"]);
    cannot(r#"[{"style": "ink", "invert": true}]"#, &["look 1", "invert"]);
    cannot(r#"[{"style": "ink", "mask": "cryptomatte:"}]"#, &["look 1", "names no mask"]);
    cannot(r#"[{"style": "ink", "mask": "gone.png"}]"#, &["gone.png"]);
    cannot(
        r#"[{"style": "ink"}, {"style": "flow_dog", "mask": "cryptomatte:hero"}]"#,
        &["look 2", "yields a scalar"],
    );
    let both = ["apply", "--layered", "looks.json", "in.exr", "no.exr", "--mask", "a.png"];
    fails(isophote().current_dir(folder.path()).args(both), 2, &["--layered", "--mask"]);
}
