//! Properties that a reader of the scene relies on: valid references, data within bounds, unit vectors, and
//! the same bytes every time.

use super::{Files, generate};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::OnceLock;

/// The scene, made once for all tests.
fn scene() -> &'static Files {
    static SCENE: OnceLock<Files> = OnceLock::new();
    SCENE.get_or_init(|| generate().expect("the scene can be made"))
}

/// The contents of a file of the scene.
fn file(name: &str) -> &'static [u8] {
    &scene().iter().find(|file| file.0 == name).unwrap_or_else(|| panic!("no {name}")).1
}

/// The parsed glTF.
fn document() -> &'static Value {
    static DOCUMENT: OnceLock<Value> = OnceLock::new();
    DOCUMENT.get_or_init(|| serde_json::from_slice(file("city.gltf")).expect("city.gltf is JSON"))
}

/// An array of the document.
fn array(key: &str) -> &'static [Value] {
    document()[key].as_array().unwrap_or_else(|| panic!("no {key}"))
}

/// A number that must be there.
fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is not an index")) as usize
}

/// Components of an accessor's type and bytes of one component.
fn layout(accessor: &Value) -> (usize, usize) {
    let components = match accessor["type"].as_str() {
        Some("SCALAR") => 1,
        Some("VEC2") => 2,
        Some("VEC3") => 3,
        Some("VEC4") => 4,
        Some("MAT4") => 16,
        other => panic!("accessor of type {other:?}"),
    };
    let bytes = match number(&accessor["componentType"]) {
        5121 => 1,
        5123 => 2,
        5125 | 5126 => 4,
        other => panic!("component type {other}"),
    };
    (components, bytes)
}

/// The bytes of an accessor.
fn bytes(accessor: &Value) -> &'static [u8] {
    let view = &array("bufferViews")[number(&accessor["bufferView"])];
    let (components, size) = layout(accessor);
    let start = number(&view["byteOffset"]);
    &file("city.bin")[start..start + number(&accessor["count"]) * components * size]
}

/// An accessor as elements of `N` floats.
fn floats<const N: usize>(accessor: &Value) -> Vec<[f32; N]> {
    assert_eq!((N, 4), layout(accessor));
    assert_eq!(number(&accessor["componentType"]), 5126);
    let values: Vec<f32> =
        bytes(accessor).as_chunks::<4>().0.iter().map(|value| f32::from_le_bytes(*value)).collect();
    values.as_chunks::<N>().0.to_vec()
}

/// Every primitive of every mesh.
fn primitives() -> impl Iterator<Item = (&'static str, &'static Value)> {
    array("meshes").iter().flat_map(|mesh| {
        let name = mesh["name"].as_str().unwrap_or("");
        mesh["primitives"].as_array().into_iter().flatten().map(move |primitive| (name, primitive))
    })
}

#[test]
fn accessors_lie_within_their_buffer() {
    let buffer = file("city.bin").len();
    assert_eq!(number(&document()["buffers"][0]["byteLength"]), buffer);
    for view in array("bufferViews") {
        assert!(number(&view["byteOffset"]) + number(&view["byteLength"]) <= buffer, "{view}");
    }
    for accessor in array("accessors") {
        let view = &array("bufferViews")[number(&accessor["bufferView"])];
        let (components, size) = layout(accessor);
        assert_eq!(number(&accessor["count"]) * components * size, number(&view["byteLength"]), "{accessor}");
        assert_eq!(number(&view["byteOffset"]) % 4, 0);
    }
}

#[test]
fn indices_are_in_range_and_attributes_agree() {
    let mut triangles = 0;
    for (name, primitive) in primitives() {
        let accessors = array("accessors");
        let attributes = primitive["attributes"].as_object().expect("attributes");
        let count = number(&accessors[number(&attributes["POSITION"])]["count"]);
        for accessor in attributes.values() {
            assert_eq!(number(&accessors[number(accessor)]["count"]), count, "{name}");
        }
        for target in primitive["targets"].as_array().into_iter().flatten() {
            assert_eq!(number(&accessors[number(&target["POSITION"])]["count"]), count, "{name}");
        }
        let indices = &accessors[number(&primitive["indices"])];
        let size = layout(indices).1;
        let largest = bytes(indices)
            .chunks_exact(size)
            .map(|index| index.iter().rev().fold(0, |value, &byte| value << 8 | usize::from(byte)))
            .max();
        assert!(largest.expect("a primitive has indices") < count, "{name}");
        assert_eq!(number(&indices["count"]) % 3, 0);
        triangles += number(&indices["count"]) / 3;
        assert!(number(&primitive["material"]) < array("materials").len());
    }
    assert!(triangles > 100_000, "{triangles} triangles");
}

#[test]
fn normals_have_unit_length_and_bounds_are_exact() {
    for (name, primitive) in primitives() {
        let attributes = &primitive["attributes"];
        for normal in floats::<3>(&array("accessors")[number(&attributes["NORMAL"])]) {
            let length = normal.iter().map(|value| value * value).sum::<f32>().sqrt();
            assert!((length - 1.0).abs() < 1e-3, "{name}: normal {normal:?}");
        }
        let accessor = &array("accessors")[number(&attributes["POSITION"])];
        let positions = floats::<3>(accessor);
        for axis in 0..3 {
            let values = || positions.iter().map(|position| position[axis]);
            assert!(values().all(f32::is_finite), "{name}");
            let bound = |key: &str| accessor[key][axis].as_f64().map(|value| value as f32);
            assert_eq!(bound("min"), Some(values().fold(f32::INFINITY, f32::min)), "{name}");
            assert_eq!(bound("max"), Some(values().fold(f32::NEG_INFINITY, f32::max)), "{name}");
        }
    }
}

#[test]
fn faces_and_normals_point_the_same_way() {
    for (name, primitive) in primitives() {
        let material = &array("materials")[number(&primitive["material"])];
        if material["doubleSided"] == true {
            continue;
        }
        let attributes = &primitive["attributes"];
        let positions = floats::<3>(&array("accessors")[number(&attributes["POSITION"])]);
        let normals = floats::<3>(&array("accessors")[number(&attributes["NORMAL"])]);
        let indices = &array("accessors")[number(&primitive["indices"])];
        let size = layout(indices).1;
        let indices: Vec<usize> = bytes(indices)
            .chunks_exact(size)
            .map(|index| index.iter().rev().fold(0, |value, &byte| value << 8 | usize::from(byte)))
            .collect();
        let point = |index: usize| glam::Vec3::from(positions[index]);
        let wrong = indices
            .chunks_exact(3)
            .filter(|corner| {
                let [a, b, c] = [point(corner[0]), point(corner[1]), point(corner[2])];
                let sum: glam::Vec3 = corner.iter().map(|&index| glam::Vec3::from(normals[index])).sum();
                let face = (b - a).cross(c - a);
                face.length() > 1e-6 && face.normalize().dot(sum) < -0.2
            })
            .count();
        let material = material["name"].as_str().unwrap_or("");
        assert_eq!(wrong, 0, "{name}, {material}: of {} triangles", indices.len() / 3);
    }
}

#[test]
fn skin_weights_sum_to_one() {
    let mut skinned = 0;
    for (name, primitive) in primitives() {
        let Some(accessor) = primitive["attributes"].get("WEIGHTS_0") else { continue };
        skinned += 1;
        for weights in floats::<4>(&array("accessors")[number(accessor)]) {
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{name}: {weights:?}");
        }
    }
    assert!(skinned >= 2);
}

#[test]
fn animations_are_well_formed() {
    let animation = &array("animations")[0];
    let samplers = animation["samplers"].as_array().expect("samplers");
    let mut interpolations = BTreeSet::new();
    let mut paths = BTreeSet::new();
    for channel in animation["channels"].as_array().expect("channels") {
        let sampler = &samplers[number(&channel["sampler"])];
        let interpolation = sampler["interpolation"].as_str().unwrap_or("");
        let path = channel["target"]["path"].as_str().unwrap_or("");
        interpolations.insert(interpolation);
        paths.insert(path);
        let input = &array("accessors")[number(&sampler["input"])];
        let times: Vec<f32> = floats::<1>(input).into_iter().flatten().collect();
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
        let output = number(&array("accessors")[number(&sampler["output"])]["count"]);
        let per_key =
            if interpolation == "CUBICSPLINE" { 3 } else { 1 } * if path == "weights" { 2 } else { 1 };
        assert_eq!(output, times.len() * per_key, "{channel}");
        assert!(number(&channel["target"]["node"]) < array("nodes").len());
    }
    assert_eq!(interpolations, BTreeSet::from(["CUBICSPLINE", "LINEAR", "STEP"]));
    assert_eq!(paths, BTreeSet::from(["rotation", "scale", "translation", "weights"]));
}

#[test]
fn every_file_that_is_named_is_written_and_decodes() {
    for image in array("images") {
        let name = image["uri"].as_str().expect("an image has a file");
        let picture = image::load_from_memory(file(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(picture.width() >= 256 && picture.height() >= 256, "{name}");
    }
    let materials = std::str::from_utf8(file("house.mtl")).expect("house.mtl is text");
    let named: Vec<&str> = materials.lines().filter_map(|line| line.strip_prefix("map_Kd ")).collect();
    assert!(!named.is_empty());
    for name in named {
        file(name);
    }
}

#[test]
fn the_house_is_a_valid_obj() {
    let text = std::str::from_utf8(file("house.obj")).expect("house.obj is text");
    let count = |prefix: &str| text.lines().filter(|line| line.starts_with(prefix)).count();
    let vertices = count("v ");
    assert!(vertices > 1000);
    assert_eq!((vertices, vertices), (count("vt "), count("vn ")));
    for face in text.lines().filter_map(|line| line.strip_prefix("f ")) {
        for corner in face.split([' ', '/']) {
            let index: usize = corner.parse().expect("an index");
            assert!((1..=vertices).contains(&index), "{face}");
        }
    }
    let materials = std::str::from_utf8(file("house.mtl")).expect("house.mtl is text");
    for name in text.lines().filter_map(|line| line.strip_prefix("usemtl ")) {
        assert!(materials.lines().any(|line| line == format!("newmtl {name}")), "{name}");
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    let again = generate().expect("the scene can be made");
    assert_eq!(again.len(), scene().len());
    for (first, second) in scene().iter().zip(&again) {
        assert_eq!(first.0, second.0);
        assert!(first.1 == second.1, "{} differs", first.0);
    }
}
