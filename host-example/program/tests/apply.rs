//! `apply` on good pictures: every node on both backends, every kind of file, what is kept beside the pixels.

use std::fs;
use std::path::Path;
use std::process::Command;

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, WritableImage};
use image::{GenericImageView, Rgba, RgbaImage};
use serde_json::Value;

use crate::support::{self, IN_PIXELS, fails, folder, isophote, listing, picture, root, succeeds};

fn apply(folder: &Path, style: &str, input: &str, output: &str, more: &[&str]) -> String {
    let mut command = isophote();
    // Results of one test follow each other under one name.
    command.current_dir(folder).args(["apply", style, input, output, "--force"]).args(IN_PIXELS).args(more);
    succeeds(&mut command).1
}

/// The catalogue as `nodes --json` prints it.
fn nodes() -> Vec<Value> {
    let (text, _) = succeeds(isophote().args(["nodes", "--json"]));
    let catalogue: Value = serde_json::from_str(&text).expect("the catalogue is JSON");
    catalogue["nodes"].as_array().expect("the catalogue has nodes").clone()
}

#[test]
fn the_catalogue_is_complete() {
    let nodes = nodes();
    for id in ["structure_tensor", "gaussian", "oriented_bilateral", "flow_dog", "cartoon", "blueprint"] {
        let node = nodes.iter().find(|n| n["id"] == id).unwrap_or_else(|| panic!("{id} is not listed"));
        for field in ["label", "group", "doc"] {
            assert!(node[field].as_str().is_some_and(|t| !t.is_empty()), "{id}.{field}");
        }
        for param in node["params"].as_array().expect("parameters") {
            assert!(param["type"].is_string() && !param["default"].is_null(), "{id}: {param}");
        }
        let (text, _) = succeeds(isophote().args(["nodes", id]));
        for param in node["params"].as_array().expect("parameters") {
            assert!(text.contains(param["id"].as_str().expect("an id")), "{id}: {text}");
        }
    }
}

#[test]
fn every_node_gives_the_same_on_both_backends() {
    let folder = folder();
    picture(72, 48).save(folder.path().join("in.png")).expect("the picture can be written");
    let mut tried = 0;
    for node in nodes() {
        let kind = node["output"]["kind"].as_str().expect("a kind").to_owned();
        if kind != "color" && kind != "scalar" {
            continue;
        }
        let id = node["id"].as_str().expect("an id");
        for backend in ["cpu", "gpu"] {
            apply(folder.path(), id, "in.png", &format!("{backend}.png"), &["--backend", backend]);
        }
        let read = |name: &str| image::open(folder.path().join(name)).expect("a picture was written");
        let (cpu, gpu) = (read("cpu.png"), read("gpu.png"));
        assert_eq!(cpu.dimensions(), (72, 48), "{id}");
        assert_eq!(cpu.color().has_color(), kind == "color", "{id}");
        let (cpu, gpu) = (cpu.into_bytes(), gpu.into_bytes());
        assert_eq!(cpu.len(), gpu.len(), "{id}");
        assert!(cpu.iter().any(|v| *v != cpu[0]), "{id} gives a blank picture");
        // One step of 8 bits is rounding; soft steps and stream lines may go the other way at a few pixels.
        let far = cpu.iter().zip(&gpu).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        assert!(far * 100 <= cpu.len(), "{id}: {far} of {} samples differ", cpu.len());
        tried += 1;
    }
    assert!(tried >= 8, "only {tried} nodes");
}

#[test]
fn all_kinds_of_files_are_read_and_written() {
    let folder = folder();
    picture(40, 24).save(folder.path().join("in.png")).expect("the picture can be written");
    for (from, to) in
        [("in.png", "a.jpg"), ("a.jpg", "b.exr"), ("b.exr", "c.png"), ("c.png", "d.exr"), ("d.exr", "e.jpeg")]
    {
        apply(folder.path(), "gaussian", from, to, &["--set", "mix=0", "--backend", "cpu"]);
    }
    let at = |name: &str| folder.path().join(name);
    picture(40, 24).save(at("w.webp")).expect("the picture can be written");
    let light = image::Rgb32FImage::from_fn(40, 24, |x, y| image::Rgb([x as f32 * 0.5, y as f32, 0.25]));
    light.save(at("h.hdr")).expect("the picture can be written");
    for (from, to) in [
        ("in.png", "p.tif"),
        ("w.webp", "w.png"),
        ("h.hdr", "h.exr"),
        ("h.hdr", "h.tiff"),
        ("h.tiff", "i.exr"),
    ] {
        apply(folder.path(), "gaussian", from, to, &["--set", "mix=0", "--backend", "cpu"]);
    }
    let open = |name: &str| image::open(at(name)).expect("a picture was written");
    assert_eq!(open("p.tif").into_rgb8(), open("in.png").into_rgb8());
    assert_eq!(open("w.png").into_rgb8(), open("in.png").into_rgb8());
    assert!(open("h.tiff").into_rgb32f().get_pixel(39, 20).0[1] > 19.0, "light is lost");
    let exr = |name: &str| exr::prelude::read_first_flat_layer_from_file(at(name)).expect("an EXR file");
    for (a, b) in
        exr("h.exr").layer_data.channel_data.list.iter().zip(&exr("i.exr").layer_data.channel_data.list)
    {
        let far = a.sample_data.values_as_f32().zip(b.sample_data.values_as_f32());
        assert!(far.into_iter().all(|(a, b)| (a - b).abs() <= 1e-3 * (1.0 + a)), "{}", a.name);
    }
    assert_eq!(open("c.png").color(), image::ColorType::Rgb16, "floats need more than 8 bits");
    let (first, last) = (open("a.jpg").into_rgb8(), open("e.jpeg").into_rgb8());
    let worst = first.as_raw().iter().zip(last.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
    // JPEG itself loses a little.
    assert!(worst.is_some_and(|w| w <= 6), "{worst:?}");
    let known = "a.jpg b.exr c.png d.exr e.jpeg h.exr h.hdr h.tiff i.exr in.png p.tif w.png w.webp";
    assert_eq!(listing(folder.path()).join(" "), known);
}

#[test]
fn nothing_is_lost_where_a_node_changes_nothing() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let deep = image::ImageBuffer::<Rgba<u16>, _>::from_fn(31, 17, |x, y| {
        Rgba([(x * 2111) as u16, (y * 3803) as u16, (x * y * 97) as u16, 9000 + (x * 1800) as u16])
    });
    deep.save(at("deep.png")).expect("the picture can be written");
    apply(folder.path(), "gaussian", "deep.png", "out.png", &["--set", "mix=0", "--backend", "cpu"]);
    let out = image::open(at("out.png")).expect("a picture was written");
    assert_eq!(out.color(), image::ColorType::Rgba16);
    let out = out.into_rgba16();
    let worst = deep.as_raw().iter().zip(out.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst.is_some_and(|w| w <= 1), "{worst:?}");

    // The smallest picture, and one that is its own result.
    RgbaImage::from_pixel(1, 1, Rgba([10, 200, 30, 255]))
        .save(at("one.png"))
        .expect("the picture can be written");
    for style in ["gaussian", "cartoon", "flow_dog"] {
        apply(folder.path(), style, "one.png", "one_out.png", &["--backend", "cpu"]);
        apply(folder.path(), style, "one.png", "one_out.png", &["--backend", "gpu"]);
    }
    apply(folder.path(), "gaussian", "one.png", "one.png", &["--in-place"]);
    let one = image::open(at("one.png")).expect("a picture was written").into_rgba8();
    assert_eq!(one.get_pixel(0, 0), &Rgba([10, 200, 30, 255]));
}

#[test]
fn colours_mean_the_same_in_every_file() {
    use isophote_pictures::convert::Conversion;
    use isophote_pictures::exr::Selection;
    use isophote_pictures::meaning::Meaning;
    let folder = folder();
    let light = |name: &str| {
        let read = isophote_pictures::read::read(&folder.path().join(name), &Selection::default());
        let picture = read.expect("a picture").pictures.remove(0);
        let change = Conversion::between(&picture.meaning, &Meaning::light());
        let pixels = change.map_or_else(|| picture.pixels.clone(), |change| change.apply(&picture.pixels).0);
        ([0, 1, 2].map(|at: usize| pixels.to_f32()[at]), picture.meaning)
    };
    let case = root().join("tests/data/cases/icc_profiles/p3.png");
    fs::copy(case, folder.path().join("p3.png")).expect("the case can be copied");
    let nothing = ["--set", "mix=0", "--backend", "cpu"];
    let (wanted, p3) = light("p3.png");
    let names =
        ["srgb", "linear", "acescg", "p3", "aces2065-1", "display-p3", "encoded-rec2020", "rec2100-pq"];
    for (output, space) in [("a.exr", ""), ("a.png", ""), ("a.tif", "")]
        .into_iter()
        .chain(names.into_iter().flat_map(|space| [("b.png", space), ("b.tif", space), ("b.exr", space)]))
    {
        let more: &[&str] = if space.is_empty() { &[] } else { &["--output-space", space] };
        let is_encoded = matches!(space, "srgb" | "display-p3" | "encoded-rec2020" | "rec2100-pq");
        let more = [&nothing, more].concat();
        if output == "b.exr" && is_encoded {
            let mut command = isophote();
            command.current_dir(folder.path()).args(["apply", "gaussian", "p3.png", "c.exr"]).args(more);
            fails(&mut command, 2, &["--output-space", space, "EXR files are of light"]);
            continue;
        }
        apply(folder.path(), "gaussian", "p3.png", output, &more);
        let (found, meaning) = light(output);
        // 8 bits hold steps of this in light; sRGB holds no negative ones.
        let is_near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 8e-3);
        assert!(is_near, "{output} {space}: {found:?}, not {wanted:?}; {}", meaning.words());
    }
    // A picture of the same kind keeps its profile and its very numbers.
    assert_eq!(light("a.png").1.profile, p3.profile);
    let bytes = |name: &str| image::open(folder.path().join(name)).expect("a picture").into_bytes();
    assert_eq!(bytes("a.png"), bytes("p3.png"));
    assert_eq!(bytes("a.tif"), bytes("p3.png"));
}

#[test]
fn transparent_pixels_keep_their_alpha_and_lend_no_colour() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let half =
        RgbaImage::from_fn(32, 32, |x, _| if x < 16 { Rgba([255, 0, 0, 0]) } else { Rgba([0, 0, 255, 255]) });
    half.save(at("in.png")).expect("the picture can be written");
    apply(folder.path(), "gaussian", "in.png", "out.png", &["--backend", "cpu"]);
    let out = image::open(at("out.png")).expect("a picture was written").into_rgba8();
    assert!(out.pixels().any(|p| p[3] > 0 && p[3] < 255), "alpha is smoothed");
    assert!(out.pixels().all(|p| p[3] == 0 || p[0] == 0), "the red of transparent pixels shows");
    let warnings = apply(folder.path(), "gaussian", "in.png", "out.jpg", &["--backend", "cpu"]);
    assert!(warnings.starts_with("warning: out.jpg: JPEG keeps no transparency"), "{warnings}");
    let white = image::open(at("out.jpg")).expect("a picture was written").into_rgb8();
    assert!(white.get_pixel(2, 16).0.iter().all(|v| *v > 240));
}

#[test]
fn exr_keeps_its_other_channels_and_its_windows() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let size = (20usize, 10usize);
    let plane = |scale: f32| (0..size.0 * size.1).map(|i| i as f32 * scale).collect::<Vec<_>>();
    let half = |scale: f32| FlatSamples::F16(plane(scale).into_iter().map(half::f16::from_f32).collect());
    let channels = exr::prelude::AnyChannels::sort(
        [("R", half(0.01)), ("G", half(0.02)), ("B", half(0.005)), ("Z", FlatSamples::F32(plane(1.5)))]
            .map(|(name, samples)| exr::prelude::AnyChannel::new(name, samples))
            .into_iter()
            .collect(),
    );
    let attributes = exr::prelude::LayerAttributes {
        layer_position: exr::prelude::Vec2(-3, 7),
        owner: Some("somebody".into()),
        ..Default::default()
    };
    let layer =
        exr::prelude::Layer::new(size, attributes, exr::prelude::Encoding::SMALL_LOSSLESS, channels.clone());
    exr::prelude::Image::from_layer(layer).write().to_file(at("in.exr")).expect("the picture can be written");
    apply(folder.path(), "gaussian", "in.exr", "out.exr", &["--set", "sigma=1", "--backend", "cpu"]);
    let read = |name: &str| {
        exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(at(name))
            .expect("an EXR file")
    };
    let (before, after) = (read("in.exr"), read("out.exr"));
    assert_eq!(after.attributes.display_window, before.attributes.display_window);
    assert_eq!(after.layer_data.attributes.layer_position, exr::prelude::Vec2(-3, 7));
    assert_eq!(after.layer_data.attributes.owner, Some("somebody".into()));
    for (old, new) in before.layer_data.channel_data.list.iter().zip(&after.layer_data.channel_data.list) {
        assert_eq!(old.name, new.name);
        let same = old.sample_data == new.sample_data;
        assert_eq!(same, old.name.to_string() == "Z", "{}", old.name);
        assert_eq!(matches!(new.sample_data, FlatSamples::F16(_)), old.name.to_string() != "Z");
    }
}

#[test]
fn bad_pixels_are_replaced_and_reported() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    exr::prelude::write_rgb_file(at("in.exr"), 16, 16, |x, y| {
        (
            if (x, y) == (5, 5) { f32::NAN } else { 0.25f32 },
            if x == 9 { f32::INFINITY } else { 0.5f32 },
            0.1f32,
        )
    })
    .expect("the picture can be written");
    for backend in ["cpu", "gpu"] {
        let warnings = apply(folder.path(), "gaussian", "in.exr", "out.exr", &["--backend", backend]);
        assert!(warnings.starts_with("warning: in.exr: 17 samples were NaN or infinite"), "{warnings}");
        let out = exr::prelude::read_first_flat_layer_from_file(at("out.exr")).expect("an EXR file");
        for channel in &out.layer_data.channel_data.list {
            assert!(channel.sample_data.values_as_f32().all(f32::is_finite), "{backend} {}", channel.name);
        }
    }
}

#[test]
fn graphs_and_settings_reach_the_library() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(48, 32).save(at("in.png")).expect("the picture can be written");
    let run = |style: &str, out: &str, more: &[&str]| {
        apply(folder.path(), style, "in.png", out, &[&["--backend", "cpu"], more].concat());
        fs::read(at(out)).expect("a picture was written")
    };
    let plain = run("gaussian", "a.png", &[]);
    assert_eq!(run("gaussian", "b.png", &["--set", "sigma=2"]), plain, "2 is the default");
    assert_ne!(run("gaussian", "c.png", &["--set", "sigma=6"]), plain);
    assert_eq!(run("gaussian", "d.png", &["--set", "gaussian.sigma=2"]), plain);
    let graph = r#"{"format":"isophote-graph","version":1,"nodes":[
        {"name":"first","node":"gaussian","inputs":{"color":"@color"}},
        {"name":"second","node":"gaussian","inputs":{"color":"first"}}],"output":"second"}"#;
    fs::write(at("twice.json"), graph).expect("the folder is writable");
    let twice = run("twice.json", "e.png", &[]);
    assert_ne!(twice, plain);
    assert_eq!(run("twice.json", "f.png", &["--set", "second.sigma=0"]), plain);
    fails(
        isophote().current_dir(folder.path()).args([
            "apply",
            "twice.json",
            "in.png",
            "g.png",
            "--set",
            "sigma=0",
        ]),
        2,
        &["first.sigma", "second.sigma"],
    );
    for threads in ["1", "2", "5"] {
        assert_eq!(run("cartoon", "h.png", &["--threads", threads]), run("cartoon", "i.png", &[]));
    }
}

#[test]
fn the_graphs_that_come_with_the_program_run() {
    let folder = folder();
    picture(64, 48).save(folder.path().join("in.png")).expect("the picture can be written");
    let mut count = 0;
    for entry in fs::read_dir(root().join("host-example/graphs")).expect("the folder of graphs") {
        let graph = entry.expect("an entry").path();
        apply(folder.path(), &graph.to_string_lossy(), "in.png", "out.png", &["--backend", "cpu"]);
        count += 1;
    }
    assert!(count > 0, "there are no graphs");
}

#[test]
fn the_benchmark_reports_every_pass() {
    let (text, _) =
        succeeds(isophote().args(["bench", "--json", "--size", "96x64", "--node", "cartoon", "--runs", "2"]));
    let report: Value = serde_json::from_str(&text).expect("the report is JSON");
    assert!(report["peak"]["multiply_adds_per_second"].as_f64().is_some_and(|v| v > 1e8));
    assert!(report["peak"]["copied_bytes_per_second"].as_f64().is_some_and(|v| v > 1e8));
    let results = report["results"].as_array().expect("results");
    assert_eq!(results.iter().map(|r| r["backend"].as_str()).collect::<Vec<_>>(), [Some("cpu"), Some("gpu")]);
    let kernels = |at: usize| -> Vec<String> {
        let passes = results[at]["passes"].as_array().expect("passes");
        passes.iter().map(|p| p["kernel"].as_str().expect("a kernel").to_owned()).collect()
    };
    assert!(kernels(0).len() > 5);
    // A dispatch may do the work of several passes, where the last of them stands. An adapter without timestamps tells
    // nothing of either.
    let sorted = |names: Vec<String>| {
        let single = names.iter().flat_map(|name| name.split(['+', '&']));
        let mut single: Vec<String> =
            single.map(|name| name.split(['@', '*']).next().unwrap_or_default().to_owned()).collect();
        single.sort();
        single
    };
    assert!(kernels(1).is_empty() || sorted(kernels(1)) == sorted(kernels(0)));
    for way in ["upload_milliseconds", "download_milliseconds"] {
        assert!(results[1][way].as_f64().is_some_and(|v| v > 0.0) && results[0].get(way).is_none(), "{way}");
    }
    let memory = results[0]["peak_bytes"].as_u64();
    assert!(memory.is_none_or(|bytes| bytes > 96 * 64 * 16) && memory.is_some() == cfg!(target_os = "linux"));
    assert!(results[1]["bytes"].as_u64().is_some_and(|bytes| bytes > 96 * 64 * 100));
    for result in results {
        assert!(result["milliseconds"].as_f64().is_some_and(|v| v > 0.0));
        assert!(result["megapixels_per_second"].as_f64().is_some_and(|v| v > 0.0));
    }
    for pass in results[0]["passes"].as_array().expect("passes") {
        assert!(pass["share_of_peak_multiply_adds"].as_f64().is_some_and(|v| v > 0.0), "{pass}");
        assert!(pass["share_of_peak_copy"].as_f64().is_some_and(|v| v > 0.0), "{pass}");
    }
}

#[test]
fn the_benchmark_compares_itself_with_a_saved_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let saved = folder.path().join("before.json");
    let bench = |node: &str, option: &str| {
        let mut command = isophote();
        command.args(["bench", "--backend", "cpu", "--size", "64x48", "--runs", "1", "--node", node, option]);
        command.arg(&saved);
        command
    };
    succeeds(&mut bench("gaussian,sigma=3", "--save"));
    let (text, _) = succeeds(&mut bench("gaussian,sigma=3", "--compare"));
    assert!(text.contains("gaussian,sigma=3 (cpu, 64x48)"), "{text}");
    assert!(text.matches(" of before").count() > 3 && text.contains("geometric mean of 1"), "{text}");
    let (text, _) = succeeds(bench("gaussian", "--compare").arg("--markdown"));
    assert!(text.contains("| `gaussian` | cpu | 64x48 |"), "{text}");
    assert!(text.contains("Nothing of this was measured before"), "{text}");
}

/// As on a machine to which the program and the library were brought, and nothing else.
#[test]
fn a_card_is_measured_in_an_empty_folder_with_an_empty_environment() {
    let folder = folder();
    let [program, library] = [Path::new(env!("CARGO_BIN_EXE_isophote")), support::library()];
    for file in [program, library] {
        fs::copy(file, folder.path().join(file.file_name().expect("a name"))).expect("a copy");
    }
    let mut command = Command::new(folder.path().join(program.file_name().expect("a name")));
    command.env_clear().current_dir(folder.path()).args(["bench", "--card", "report", "--size", "96x64"]);
    command.args(["--node", "gaussian", "--node", "cartoon", "--runs", "2", "--seconds", "0.2"]);
    succeeds(&mut command);
    assert_eq!(listing(&folder.path().join("report")), ["card.json", "card.md"]);
    let read = |name: &str| fs::read_to_string(folder.path().join("report").join(name)).expect("a report");
    let report: Value = serde_json::from_str(&read("card.json")).expect("the report is JSON");
    let list = |name: &str| report[name].as_array().expect("a list").clone();
    let positive = |value: &Value| assert!(value.as_f64().is_some_and(|v| v > 0.0), "{value}");
    positive(&report["copied"]);
    let twins: Vec<Value> = list("twins").iter().map(|twin| twin["precision"].clone()).collect();
    assert_eq!(twins, ["exact", "half", "fast", "exact", "half", "fast"]);
    assert_eq!((list("compiled").len(), list("loops").len(), list("sequences").len()), (4, 2, 2));
    for node in list("nodes") {
        positive(&node["share_of_copying"]);
        // An adapter without timestamps tells nothing of passes.
        node["passes"].as_array().expect("a list").iter().for_each(|pass| positive(&pass["bytes"]));
    }
    let (exact, fast) = (&list("nodes")[0]["bytes"], &list("nodes")[2]["bytes"]);
    assert!(fast.as_u64() < exact.as_u64(), "{fast} of {exact}");
    for one in list("loops") {
        positive(&one["median_seconds"]);
        assert!(one["most_seconds"].as_f64() >= one["median_seconds"].as_f64());
    }
    let text = read("card.md");
    for words in
        ["## Every frame", "| `cartoon` | 96x64 | fast |", "<summary>gaussian, 96x64, exact</summary>"]
    {
        assert!(text.contains(words), "'{words}' is not in\n{text}");
    }
}
