//! Bad input of every kind: one line that says what, where and how to fix it, the right exit code, and no file
//! left behind.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{self, fails, folder, isophote, listing, picture};

/// Runs `apply STYLE INPUT out.png` in `folder`, which must fail because of its input and leave no file.
fn apply_fails(folder: &Path, style: &str, input: &str, more: &[&str], words: &[&str]) {
    let before = listing(folder);
    fails(
        isophote()
            .current_dir(folder)
            .args(["apply", style, input, "out.png", "--backend", "cpu"])
            .args(more),
        2,
        words,
    );
    assert_eq!(listing(folder), before);
}

fn render_fails(folder: &Path, scene: &str, more: &[&str], words: &[&str]) {
    let before = listing(folder);
    fails(
        isophote().current_dir(folder).args(["render", scene, "out.png", "--size", "32x32"]).args(more),
        2,
        words,
    );
    assert_eq!(listing(folder), before);
}

#[test]
fn pictures() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let image = picture(48, 32);
    for name in ["good.png", "good.jpg"] {
        image.save(at(name)).expect("the picture can be written");
    }
    exr::prelude::write_rgb_file(at("good.exr"), 48, 32, |x, y| (x as f32, y as f32, 0.5f32))
        .expect("the picture can be written");
    for kind in ["png", "jpg", "exr"] {
        let bytes = fs::read(at(&format!("good.{kind}"))).expect("just written");
        for (name, keep) in [("start", 16), ("half", bytes.len() / 2), ("end", bytes.len() - 24)] {
            let name = format!("{name}.{kind}");
            fs::write(at(&name), &bytes[..keep]).expect("the folder is writable");
            apply_fails(folder.path(), "gaussian", &name, &[], &[&name, "damaged", "intact"]);
        }
        let mut spoiled = bytes.clone();
        // Sizes and compression stand in the first bytes after the signature.
        for byte in spoiled.iter_mut().skip(8).take(24) {
            *byte ^= 0x5a;
        }
        let name = format!("spoiled.{kind}");
        fs::write(at(&name), &spoiled).expect("the folder is writable");
        apply_fails(folder.path(), "gaussian", &name, &[], &[&name]);
    }
    fs::write(at("empty.png"), []).expect("the folder is writable");
    fs::write(at("text.png"), "not a picture").expect("the folder is writable");
    apply_fails(folder.path(), "gaussian", "empty.png", &[], &["empty.png", "is empty"]);
    apply_fails(folder.path(), "gaussian", "text.png", &[], &["text.png", "neither PNG, JPEG nor EXR"]);
    apply_fails(folder.path(), "gaussian", "missing.png", &[], &["missing.png", "cannot be read"]);
    apply_fails(folder.path(), "gaussian", ".", &[], &["cannot be read"]);
    let depth = exr::prelude::SpecificChannels::build()
        .with_channel("depth")
        .with_pixel_fn(|_: exr::prelude::Vec2<usize>| (1.0f32,));
    exr::prelude::WritableImage::write(&exr::prelude::Image::from_channels((4, 4), depth))
        .to_file(at("depth.exr"))
        .expect("the picture can be written");
    apply_fails(
        folder.path(),
        "gaussian",
        "depth.exr",
        &[],
        &["depth.exr", "no layer with channels R, G and B"],
    );
}

#[test]
fn styles_and_settings() {
    let folder = folder();
    picture(24, 16).save(folder.path().join("in.png")).expect("the picture can be written");
    let fails =
        |style: &str, more: &[&str], words: &[&str]| apply_fails(folder.path(), style, "in.png", more, words);
    fails("gausian", &[], &["there is no such style", "did you mean 'gaussian'", "isophote nodes"]);
    fails("nowhere/graph.json", &[], &["nowhere/graph.json", "cannot be read"]);
    fails("structure_tensor", &[], &["yields a tensor", "choose a node"]);
    fails("gaussian", &["--set", "sigma=-1"], &["--set sigma=-1", "'sigma'", "must be 0 to"]);
    fails("gaussian", &["--set", "sigma=1e9"], &["must be 0 to"]);
    fails("gaussian", &["--set", "sigma=NaN"], &["must be 0 to"]);
    fails("gaussian", &["--set", "sigma=inf"], &["must be 0 to"]);
    fails("gaussian", &["--set", "sigma=wide"], &["is a number", "'wide'"]);
    fails("gaussian", &["--set", "sigma="], &["is a number"]);
    fails("gaussian", &["--set", "sgima=2"], &["no parameter 'sgima'", "did you mean 'sigma'"]);
    fails("gaussian", &["--set", "other.sigma=2"], &["no node 'other'", "choose from gaussian"]);
    fails("gaussian", &["--set", "sigma"], &["id=value", "--help"]);
    fails("structure_tensor", &["--set", "derivative=sobel9"], &["'derivative'", "'sobel9'", "scharr3"]);
    fails("gaussian", &["--threads", "5000"], &["--threads", "1024"]);
    fails("gaussian", &["--space", "cmyk"], &["cmyk", "--help"]);
}

#[test]
fn graph_files() {
    let folder = folder();
    picture(24, 16).save(folder.path().join("in.png")).expect("the picture can be written");
    let graph = |nodes: &str, output: &str| {
        format!(r#"{{"format":"isophote-graph","version":1,"nodes":[{nodes}],"output":"{output}"}}"#)
    };
    let blur = |name: &str, from: &str| {
        format!(r#"{{"name":"{name}","node":"gaussian","inputs":{{"color":"{from}"}}}}"#)
    };
    let good = graph(&blur("a", "@color"), "a");
    let cases: &[(&str, String, &[&str])] = &[
        ("empty", String::new(), &[]),
        ("text", "not a graph".into(), &[]),
        ("truncated", good[..good.len() - 9].into(), &[]),
        ("other", r#"{"format":"something","version":1,"nodes":[],"output":"a"}"#.into(), &["format"]),
        ("version", good.replace("\"version\":1", "\"version\":99"), &["version"]),
        ("unknown", good.replace("gaussian", "gausian"), &["'gausian'", "did you mean 'gaussian'"]),
        ("cycle", graph(&[blur("a", "b"), blur("b", "a")].join(","), "a"), &["cycle"]),
        ("itself", graph(&blur("a", "a"), "a"), &["cycle"]),
        ("nowhere", graph(&blur("a", "b"), "a"), &["'b'"]),
        (
            "kinds",
            graph(
                &(r#"{"name":"t","node":"structure_tensor","inputs":{"color":"@color"}},"#.to_owned()
                    + &blur("a", "t")),
                "a",
            ),
            &["tensor", "color"],
        ),
        ("port", graph(&blur("a", "@color").replace("\"color\":", "\"colour\":"), "a"), &["colour"]),
        ("open", graph(r#"{"name":"a","node":"gaussian"}"#, "a"), &["color", "not connected"]),
        ("output", graph(&blur("a", "@color"), "z"), &["'z'"]),
        ("twice", graph(&[blur("a", "@color"), blur("a", "@color")].join(","), "a"), &["'a'"]),
        ("range", good.replace("\"inputs\"", r#""params":{"sigma":-3},"inputs""#), &["sigma", "must be"]),
        ("type", good.replace("\"inputs\"", r#""params":{"sigma":"wide"},"inputs""#), &["sigma"]),
        ("param", good.replace("\"inputs\"", r#""params":{"sgima":3},"inputs""#), &["sgima"]),
    ];
    for (name, text, words) in cases {
        let file = format!("{name}.json");
        fs::write(folder.path().join(&file), text).expect("the folder is writable");
        apply_fails(folder.path(), &file, "in.png", &[], words);
    }
    fs::write(folder.path().join("binary.json"), [0xff, 0xfe, 0, 1]).expect("the folder is writable");
    apply_fails(folder.path(), "binary.json", "in.png", &[], &["binary.json"]);
    // The one that all others were made from is good.
    fs::write(folder.path().join("good.json"), good).expect("the folder is writable");
    support::succeeds(isophote().current_dir(folder.path()).args([
        "apply",
        "good.json",
        "in.png",
        "out.png",
    ]));
}

#[test]
fn places_to_write() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(24, 16).save(at("in.png")).expect("the picture can be written");
    fs::write(at("file"), "").expect("the folder is writable");
    support::cube(folder.path());
    let mut places = vec![
        ("missing/out.png", "cannot be written"),
        ("file/out.png", "cannot be written"),
        ("out.bmp", "is not a kind of picture"),
        ("out", "is not a kind of picture"),
    ];
    if cfg!(target_os = "linux") {
        // Not even root may write there.
        places.push(("/proc/out.png", "cannot be written"));
    }
    let before = listing(folder.path());
    for (place, word) in places {
        let run = || {
            let mut command = isophote();
            command.current_dir(folder.path());
            command
        };
        fails(run().args(["apply", "gaussian", "in.png", place]), 2, &[place, word]);
        fails(run().args(["render", "cube.gltf", place, "--size", "16x16"]), 2, &[place, word]);
    }
    assert_eq!(listing(folder.path()), before);
}

#[test]
fn gltf_scenes() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let write = |name: &str, bytes: &[u8]| fs::write(at(name), bytes).expect("the folder is writable");
    let inner = at("inner");
    fs::create_dir(&inner).expect("the folder is writable");
    let cube = support::cube(&inner);
    let json = fs::read_to_string(&cube).expect("just written");
    let length = 36 * 12;
    write("outside.bin", &vec![0; 2 * length]);
    let inside = |name: &str, text: &str| {
        fs::write(inner.join(name), text).expect("the folder is writable");
        format!("inner/{name}")
    };
    render_fails(folder.path(), "missing.gltf", &[], &["missing.gltf"]);
    render_fails(folder.path(), "inner/cube.bin", &[], &["cube.bin"]);
    let empty = inside("empty.gltf", "");
    render_fails(folder.path(), &empty, &[], &[&empty]);
    let truncated = inside("truncated.gltf", &json[..json.len() / 2]);
    render_fails(folder.path(), &truncated, &[], &[&truncated]);
    let missing = inside("missing_buffer.gltf", &support::cube_json("nowhere.bin", length));
    render_fails(folder.path(), &missing, &[], &["nowhere.bin"]);
    for uri in [
        "../outside.bin",
        "sub/../../outside.bin",
        "%2e%2e/outside.bin",
        "/etc/hostname",
        "file:///etc/hostname",
    ] {
        let outside = inside("outside.gltf", &support::cube_json(uri, length));
        render_fails(folder.path(), &outside, &[], &["outside.gltf"]);
    }
    let short = inside("short.gltf", &json.replace("\"count\":36", "\"count\":3600"));
    render_fails(folder.path(), &short, &[], &["short.gltf"]);
    let glb = inside("magic.glb", "glTF");
    render_fails(folder.path(), &glb, &[], &["magic.glb"]);
    let mut header = b"glTF".to_vec();
    header.extend(2u32.to_le_bytes());
    header.extend(1_000_000u32.to_le_bytes());
    header.extend(900_000u32.to_le_bytes());
    header.extend(b"JSON{\"asset\":");
    write("truncated.glb", &header);
    render_fails(folder.path(), "truncated.glb", &[], &["truncated.glb"]);
}

#[test]
fn obj_scenes() {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| {
        fs::write(folder.path().join(name), bytes).expect("the folder is writable");
    };
    write("face.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n");
    render_fails(folder.path(), "face.obj", &[], &["face.obj"]);
    write("vertex.obj", b"v 0 0\nv zero 0 0\nf 1 2 3\n");
    render_fails(folder.path(), "vertex.obj", &[], &["vertex.obj"]);
    write("empty.obj", b"");
    render_fails(folder.path(), "empty.obj", &[], &["empty.obj"]);
    write("good.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    render_fails(folder.path(), "good.obj", &["--texture", "nowhere.png"], &["nowhere.png"]);
}

#[test]
fn options_of_render() {
    let folder = folder();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).expect("the folder is writable");
    support::cube(&inner);
    let good = "inner/cube.gltf";
    for (more, words) in [
        (&["--style", "cartoonish"][..], &["cartoonish", "isophote nodes"][..]),
        (&["--style", "structure_tensor"], &["yields a tensor"]),
        (&["--set", "sigma=1"], &["the style none has no parameters"]),
        (&["--style", "gaussian", "--set", "sigma=-1"], &["must be 0 to"]),
        (&["--size", "0x16"], &["--size", "0x16"]),
        (&["--size", "wide"], &["--size", "1280x720"]),
        (&["--size", "99999x2"], &["99999x2"]),
        (&["--frames", "0"], &["--frames", "such as 48"]),
        (&["--frames", "1-"], &["--frames", "no range of frames"]),
        (&["--frames", "1000001"], &["--frames", "1000000 frames"]),
        (&["--animate"], &["no animation"]),
        (&["--animation", "run"], &["'run'"]),
        (&["--fps", "nan"], &["--fps"]),
        (&["--up", "x"], &["--up", "y, z"]),
        (&["--background", "blue"], &["--background", "#aabbcc"]),
        (&["--background", "#12345"], &["--background", "#aabbcc"]),
        (&["--light", "30"], &["--light", "-60,40"]),
        (&["--light", "30,91"], &["--light", "from -90 to 90"]),
        (&["--distance", "0"], &["--distance", "from 0.1 to 100"]),
        (&["--fov", "180"], &["--fov", "from 1 to 150"]),
        (&["--azimuth", "nan"], &["--azimuth"]),
        (&["--camera", "0"], &["'0'", "the scene has no cameras"]),
        (&["--camera", "0", "--turntable"], &["--camera", "--turntable"]),
    ] {
        let more: Vec<&str> =
            if more[0] == "--size" { more.to_vec() } else { [more, &["--size", "16x16"]].concat() };
        let before = listing(folder.path());
        fails(isophote().current_dir(folder.path()).args(["render", good, "out.png"]).args(&more), 2, words);
        assert_eq!(listing(folder.path()), before);
    }
}

#[test]
fn usage() {
    fails(
        isophote().args(["apply", "gaussian", "a.png", "b.png", "--backend", "abacus"]),
        2,
        &["abacus", "--help"],
    );
    fails(isophote().arg("paint"), 2, &["paint: is no command", "isophote apply painting"]);
    fails(isophote().args(["apply", "gaussian"]), 2, &["<INPUT>", "--help"]);
    fails(isophote().args(["nodes", "gausian"]), 2, &["did you mean 'gaussian'"]);
    fails(
        isophote().args(["bench", "--node", "gausian", "--backend", "cpu"]),
        2,
        &["did you mean 'gaussian'"],
    );
    fails(isophote().args(["bench", "--runs", "0"]), 2, &["--runs"]);
}

/// Makes a dynamic library from a few lines of C.
fn compiled(folder: &Path, name: &str, source: &str) -> Option<std::path::PathBuf> {
    let code = folder.join(format!("{name}.c"));
    fs::write(&code, source).expect("the folder is writable");
    let library = folder.join(libloading::library_filename(name));
    let compiler = Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&library).arg(&code).status();
    match compiler {
        Ok(status) => assert!(status.success(), "{name} does not compile"),
        Err(_) => {
            assert!(std::env::var_os("CI").is_none(), "cc is missing; install it");
            eprintln!("\n*** SKIPPED: foreign libraries need cc ***\n");
            return None;
        }
    }
    Some(library)
}

#[test]
fn libraries() {
    let folder = folder();
    let fails = |library: &Path, words: &[&str]| {
        fails(isophote().env("ISOPHOTE_LIBRARY", library).arg("nodes"), 1, words);
    };
    let missing = folder.path().join("nowhere.so");
    fails(&missing, &["nowhere.so", "does not exist", "ISOPHOTE_LIBRARY"]);
    fails(folder.path(), &["does not exist", "ISOPHOTE_LIBRARY"]);
    let text = folder.path().join("text.so");
    fs::write(&text, "not a library").expect("the folder is writable");
    fails(&text, &["text.so", "cannot be loaded as a dynamic library"]);
    if cfg!(target_os = "linux") {
        let bytes = fs::read(support::library()).expect("the library is there");
        for keep in [100, 4096, bytes.len() / 2, bytes.len() - 100] {
            fs::write(&text, &bytes[..keep]).expect("the folder is writable");
            fails(&text, &["text.so", "cannot be loaded as a dynamic library"]);
        }
    }
    if let Some(library) = compiled(folder.path(), "foreign", "int something_else(void) { return 1; }\n") {
        fails(&library, &["foreign", "not Isophote", "isophote_api"]);
    }
    let none = "const void *isophote_api(unsigned version) { (void)version; return 0; }\n";
    if let Some(library) = compiled(folder.path(), "none", none) {
        fails(&library, &["none", "no ABI version 1", "one release"]);
    }
    let other = "static const unsigned table[2] = {2, 8};\n\
                 const void *isophote_api(unsigned version) { (void)version; return table; }\n";
    if let Some(library) = compiled(folder.path(), "other", other) {
        fails(&library, &["other", "ABI version 2", "one release"]);
    }
    let size = "static const unsigned table[2] = {1, 8};\n\
                const void *isophote_api(unsigned version) { (void)version; return table; }\n";
    if let Some(library) = compiled(folder.path(), "size", size) {
        fails(&library, &["size", "8 bytes", "one release"]);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn machines_without_an_adapter() {
    let folder = folder();
    picture(24, 16).save(folder.path().join("in.png")).expect("the picture can be written");
    support::cube(folder.path());
    let run = || {
        let mut command = isophote();
        command.current_dir(folder.path());
        // No driver is found, as on a machine that has none.
        for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            command.env(variable, "/nonexistent.json");
        }
        command
    };
    let before = listing(folder.path());
    let install = &["mesa-vulkan-drivers", "libvulkan1"];
    fails(run().args(["render", "cube.gltf", "out.png", "--size", "16x16"]), 1, install);
    fails(run().args(["apply", "gaussian", "in.png", "out.png", "--backend", "gpu"]), 1, install);
    fails(run().args(["bench", "--backend", "gpu", "--size", "16x16"]), 1, install);
    assert_eq!(listing(folder.path()), before);
    support::succeeds(run().args(["apply", "gaussian", "in.png", "out.png"]));
}

/// A file's name and names in files can hold commands to the terminal and marks that turn the direction of writing.
#[test]
#[cfg(unix)]
fn names_are_no_commands_to_the_terminal() {
    let folder = folder();
    let hostile = "\u{1b}]0;title\u{7}\u{9b}2J\u{202e}gnp.exe";
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write(&format!("{hostile}.png"), "no picture");
    write("param.json", &serde_json::json!({"style": "gaussian", "parameters": {hostile: 1}}).to_string());
    write("name.json", &serde_json::json!({"style": "gaussian", "name": "\u{202e}gnp.exe"}).to_string());
    picture(8, 8).save(folder.path().join("in.png")).expect("the picture can be written");
    let runs: [&[&str]; 5] = [
        &["apply", "gaussian", &format!("{hostile}.png"), "out.png"],
        &["apply", "param.json", "in.png", "out.png"],
        &["apply", hostile, "in.png", "out.png"],
        &["apply", "gaussian", "in.png", "out.png", hostile],
        &["preset", "show", "name.json"],
    ];
    for run in runs {
        let output = isophote().current_dir(folder.path()).args(run).output().expect("the program starts");
        for said in [&output.stdout, &output.stderr] {
            let said = String::from_utf8_lossy(said);
            let bad =
                said.chars().find(|c| c.is_control() && *c != '\n' || ('\u{202a}'..='\u{202e}').contains(c));
            assert_eq!(bad, None, "{said:?}");
        }
        let said =
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(r"\u202egnp.exe"), "{run:?}: {said:?}");
    }
}
