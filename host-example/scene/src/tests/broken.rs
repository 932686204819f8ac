//! Broken files: one clear line, exit code 2, and never a panic.

use std::fs;

use serde_json::{Value, json};

use super::build::{Builder, F32, U8, U16, load_bytes, png};
use crate::Scene;
use isophote_files::error::Error;

fn assert_clear(error: &Error, what: &str) {
    let text = error.to_string();
    assert_eq!(error.exit_code(), 2, "{what}: {text}");
    assert_eq!(text.lines().count(), 1, "{what}: {text}");
    assert!(text.contains("scene."), "{what} is not located: {text}");
}

#[test]
fn files_cut_off_anywhere_are_errors() {
    let (gltf, glb) = (Builder::triangle().gltf(), Builder::triangle().glb());
    for (name, whole) in [("scene.gltf", gltf), ("scene.glb", glb)] {
        for length in 0..whole.len() {
            let error = load_bytes(name, &whole[..length]).expect_err("a part is not a whole");
            assert_clear(&error, &format!("{name} cut to {length} bytes"));
        }
    }
}

#[test]
fn lying_headers_are_errors() {
    let whole = Builder::triangle().glb();
    let mut old = whole.clone();
    old[4] = 1;
    assert!(load_bytes("scene.glb", &old).unwrap_err().to_string().contains("glTF version 1"));
    for (at, value) in [(4, 1u32), (8, 0), (8, 4), (8, 19), (8, u32::MAX), (12, 0), (12, u32::MAX), (16, 7)] {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        assert_clear(&load_bytes("scene.glb", &bytes).expect_err("a lie"), &format!("word {at} = {value}"));
    }
}

/// One thing that is changed in a good file: what it is, a word of the message, the change.
type Change = (&'static str, &'static str, fn(&mut Builder));

/// Changes of buffers, views, accessors and primitives.
const DATA: [Change; 16] = [
    ("count beyond the buffer", "beyond", |b| b.json["accessors"][0]["count"] = json!(4)),
    ("huge count", "beyond", |b| b.json["accessors"][0]["count"] = json!(u64::MAX)),
    ("offset beyond the view", "beyond", |b| b.json["accessors"][0]["byteOffset"] = json!(u32::MAX)),
    ("view beyond the buffer", "beyond", |b| b.json["bufferViews"][0]["byteLength"] = json!(1 << 20)),
    ("huge view", "beyond", |b| {
        b.json["bufferViews"][0]["byteOffset"] = json!(u64::MAX);
        b.json["bufferViews"][0]["byteLength"] = json!(u64::MAX);
    }),
    ("stride below the element", "", |b| b.json["bufferViews"][0]["byteStride"] = json!(4)),
    ("no data but a huge count", "beyond 4 GiB of memory", |b| {
        b.json["accessors"][0] = json!({"componentType": F32, "type": "VEC3", "count": 1u64 << 40});
        b.primitive().as_object_mut().unwrap().remove("indices");
    }),
    ("unknown view", "", |b| b.json["accessors"][0]["bufferView"] = json!(99)),
    ("unknown position accessor", "accessor", |b| b.primitive()["attributes"]["POSITION"] = json!(99)),
    ("unknown index accessor", "", |b| b.primitive()["indices"] = json!(99)),
    ("unknown material", "", |b| b.primitive()["material"] = json!(99)),
    ("no positions", "", |b| b.primitive()["attributes"] = json!({})),
    ("flat positions", "numbers per element", |b| b.json["accessors"][0]["type"] = json!("VEC2")),
    ("indices of floats", "component type", |b| {
        b.json["accessors"][1]["componentType"] = json!(F32);
        b.json["accessors"][1]["count"] = json!(1);
    }),
    ("index beyond the vertices", "only 3 vertices", |b| b.bytes[36] = 9),
    ("positions that are not numbers", "not finite", |b| {
        b.bytes[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    }),
];

/// Changes of what refers to data.
const STRUCTURE: [Change; 12] = [
    ("attribute of another length", "as many", |b| {
        let short = b.floats("VEC3", &[0.0, 0.0, 1.0]);
        b.primitive()["attributes"]["NORMAL"] = json!(short);
    }),
    ("morph target of another length", "morph target", |b| {
        let short = b.floats("VEC3", &[0.0, 0.0, 1.0]);
        b.primitive()["targets"] = json!([{"POSITION": short}]);
    }),
    ("node in a cycle", "ancestor", |b| {
        b.json["nodes"] = json!([{"mesh": 0}, {"children": [2]}, {"children": [1]}]);
    }),
    ("node with two parents", "two parents", |b| {
        b.json["nodes"] = json!([{"mesh": 0}, {"children": [0]}, {"children": [0]}]);
    }),
    ("unknown child", "", |b| b.json["nodes"][0]["children"] = json!([7])),
    ("unknown mesh", "", |b| b.json["nodes"][0]["mesh"] = json!(7)),
    ("sparse index beyond the accessor", "element 200 of 3", |b| {
        let indices = b.view(&[200]);
        let values = b.view(&[0; 12]);
        b.json["accessors"][0]["sparse"] = json!({
            "count": 1, "indices": {"bufferView": indices, "componentType": U8}, "values": {"bufferView": values}
        });
    }),
    ("geometry in an unknown extension", "EXT_mesh_things", |b| {
        b.json["extensionsRequired"] = json!(["EXT_mesh_things"]);
    }),
    ("version 1", "version 1", |b| b.json["asset"]["version"] = json!("1.0")),
    ("animation of an unknown node", "target that does not exist", |b| animate(b, 0, 7)),
    ("animation without its sampler", "no sampler 1", |b| animate(b, 1, 0)),
    ("nothing to draw", "no triangles", |b| b.json["nodes"] = json!([{}])),
];

fn animate(b: &mut Builder, sampler: usize, node: usize) {
    let input = b.floats("SCALAR", &[0.0]);
    b.push(
        "animations",
        json!({
            "samplers": [{"input": input, "output": 0}],
            "channels": [{"sampler": sampler, "target": {"node": node, "path": "scale"}}]
        }),
    );
}

/// Changes one thing in a good file with every feature, and expects an error that holds a word.
#[test]
fn lying_documents_are_errors() {
    Builder::triangle().load().expect("the file is good before it is changed");
    for (what, word, change) in DATA.into_iter().chain(STRUCTURE) {
        let mut b = Builder::triangle();
        change(&mut b);
        let error = b.load().map(|_| ()).expect_err(what);
        assert_clear(&error, what);
        assert!(error.to_string().contains(word), "{what}: '{word}' is not in '{error}'");
    }
}

#[test]
fn faults_of_the_text_are_found_by_their_line() {
    let mut b = Builder::triangle();
    animate(&mut b, 0, 0);
    b.json["buffers"] = json!([{"byteLength": b.bytes.len()}]);
    let whole = serde_json::to_string_pretty(&b.json).unwrap();
    for (good, bad, reason) in [
        ("\"byteOffset\": 0", "\"byteOffset\": -1", "integer `-1`"),
        ("\"sampler\": 0", "\"sampler\": true", "boolean `true`"),
        ("\"path\": \"scale\"", "\"path\": scale", "expected value"),
    ] {
        let line = whole.lines().position(|line| line.contains(good)).unwrap() + 1;
        let error = load_bytes("scene.gltf", whole.replacen(good, bad, 1).as_bytes()).expect_err(bad);
        assert_clear(&error, bad);
        for words in [format!("at line {line} column"), reason.to_owned()] {
            assert!(error.to_string().contains(&words), "'{words}' is not in '{error}'");
        }
    }
}

#[test]
fn missing_and_foreign_files_are_errors() {
    let length = Builder::triangle().bytes.len();
    for uri in ["gone.bin", "../gone.bin", "/etc/hostname", "http://localhost/a.bin", "data:;base64,@@@"] {
        let mut b = Builder::triangle();
        b.json["buffers"] = json!([{"byteLength": length, "uri": uri}]);
        assert_clear(&b.load().expect_err(uri), uri);
    }
    let folder = tempfile::tempdir().unwrap();
    for name in ["scene.gltf", "scene.obj", "scene.fbx", "scene."] {
        assert_clear(&Scene::load(&folder.path().join(name), None).expect_err("no such file"), name);
    }
    fs::create_dir(folder.path().join("scene.glb")).unwrap();
    assert_clear(&Scene::load(&folder.path().join("scene.glb"), None).expect_err("a folder"), "a folder");
}

#[test]
fn textures_that_cannot_be_read_leave_their_material_plain() {
    let textured = |image: fn(&mut Builder) -> Value| {
        let mut b = Builder::triangle();
        let image = image(&mut b);
        b.push("images", image);
        b.push("textures", json!({"source": 0, "name": "skin"}));
        b.push("materials", json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
        b.primitive()["material"] = json!(0);
        let scene = b.load().unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(scene.materials[0].base_color_texture, None);
        let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
        assert!(warning.contains("texture 'skin'"), "{warning}");
        assert_eq!(warning.lines().count(), 1, "{warning}");
        warning.clone()
    };
    fn cut(b: &mut Builder, length: usize) -> Value {
        let view = b.view(&png()[..length]);
        json!({"bufferView": view, "mimeType": "image/png", "name": "bark"})
    }
    let damaged: [fn(&mut Builder) -> Value; 3] =
        [|b| cut(b, 8), |b| cut(b, 20), |b| cut(b, png().len() - 14)];
    for image in damaged {
        assert!(textured(image).contains("'bark'"));
    }
    assert!(textured(|_| json!({"uri": "gone.png"})).contains("'gone.png'"));
    assert!(textured(|_| json!({"uri": "http://localhost/a.png"})).contains("is a URL"));
    assert!(textured(|_| json!({"uri": "data:;base64,@@@"})).contains("data URI"));
    assert!(textured(|_| json!({"bufferView": 0, "mimeType": "image/png"})).contains("unknown format"));
}

#[test]
fn channels_that_do_not_fit_are_left_out() {
    for (times, values) in [(&[0.0f32, 0.0][..], 6), (&[1.0, 0.5], 6), (&[0.0, 1.0], 3), (&[], 0)] {
        let mut b = Builder::triangle();
        let input = b.floats("SCALAR", times);
        let output = b.floats("VEC3", &vec![0.0; values]);
        b.push(
            "animations",
            json!({
                "samplers": [{"input": input, "output": output}],
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]
            }),
        );
        let scene = b.load().unwrap();
        assert!(scene.animations[0].channels.is_empty());
        assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    }
}

/// A document in which every kind of value stands that is read.
fn whole() -> Builder {
    let mut b = Builder::triangle();
    let joints = b.add(U16, "VEC4", 3, &[0; 24]);
    let weights = b.floats("VEC4", &[1.0; 12]);
    let bind = b.floats("MAT4", &[1.0; 16]);
    let view = b.view(&png());
    b.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    b.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    b.primitive()["targets"] = json!([{"POSITION": 0}]);
    b.primitive()["material"] = json!(0);
    b.json["nodes"] = json!([{"mesh": 0, "skin": 0, "camera": 0, "weights": [1], "children": [1]}, {}]);
    b.push("skins", json!({"joints": [1], "inverseBindMatrices": bind}));
    b.push(
        "cameras",
        json!({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 2, "znear": 1}}),
    );
    b.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    b.push("samplers", json!({"magFilter": 9729, "wrapS": 10497}));
    b.push("textures", json!({"source": 0, "sampler": 0, "extensions": {"EXT_texture_webp": {"source": 0}}}));
    let places = b.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let instances = json!({"attributes": {"TRANSLATION": places}});
    let extensions = json!({"EXT_mesh_gpu_instancing": instances, "KHR_node_visibility": {"visible": true}});
    b.json["nodes"][0]["children"] = json!([1, 2]);
    b.push("nodes", json!({"mesh": 0, "skin": 0, "extensions": extensions}));
    let map = json!({"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"offset": [0, 0]}}});
    b.push("materials", json!({"normalTexture": map, "pbrMetallicRoughness": {"baseColorTexture": map}, "extensions": {
        "KHR_materials_pbrSpecularGlossiness": {"specularGlossinessTexture": map, "specularFactor": [1, 1, 1]},
        "KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": map},
        "KHR_materials_ior": {"ior": 1.5}, "KHR_materials_specular": {"specularFactor": 1}
    }}));
    b.json["extensionsUsed"] = json!(["KHR_materials_ior", "VENDOR_thing"]);
    let times = b.floats("SCALAR", &[0.0, 1.0]);
    let values = b.floats("SCALAR", &[0.0, 1.0]);
    b.push(
        "animations",
        json!({
            "samplers": [{"input": times, "output": values, "interpolation": "STEP"}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]
        }),
    );
    b
}

/// Replaces every value of a document, one at a time, by awkward ones: whatever comes of it is no panic.
#[test]
fn no_value_makes_the_loader_panic() {
    let b = whole();
    b.load().expect("the file is good before it is changed");
    let mut paths = Vec::new();
    collect(&b.json, String::new(), &mut paths);
    assert!(paths.len() > 100);
    let awkward = [
        json!(null),
        json!(-1),
        json!(0),
        json!(1),
        json!(77),
        json!(1e300),
        json!("x"),
        json!([]),
        json!({}),
    ];
    for path in paths {
        for value in &awkward {
            let mut changed = Builder { json: b.json.clone(), bytes: b.bytes.clone() };
            *changed.json.pointer_mut(&path).unwrap() = value.clone();
            if let Err(error) = changed.load() {
                assert_clear(&error, &format!("{path} = {value}"));
            }
        }
    }
}

fn collect(value: &Value, path: String, out: &mut Vec<String>) {
    let children: Vec<(String, &Value)> = match value {
        Value::Array(list) => list.iter().enumerate().map(|(i, v)| (i.to_string(), v)).collect(),
        Value::Object(map) => map.iter().map(|(k, v)| (k.clone(), v)).collect(),
        _ => Vec::new(),
    };
    for (key, child) in children {
        collect(child, format!("{path}/{key}"), out);
    }
    if !path.is_empty() {
        out.push(path);
    }
}
