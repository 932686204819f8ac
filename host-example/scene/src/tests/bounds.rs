//! Scenes that claim far more than they hold: they cost what their files cost, or are refused.

use std::fs;
use std::time::{Duration, Instant};

use glam::Vec3;
use serde_json::json;

use super::build::{Builder, F32, load_bytes};
use crate::Scene;
use crate::budget::Budget;
use isophote_files::error::Error;

const MIB: u64 = 1 << 20;

fn load_within(name: &str, bytes: &[u8], budget: u64) -> Result<Scene, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    Scene::load_within(&path, None, &Budget::new(budget))
}

fn assert_refused(name: &str, bytes: &[u8], budget: u64) {
    let error = load_within(name, bytes, budget).map(|_| ()).expect_err("it needs more");
    assert_eq!(error.exit_code(), 2);
    for words in [name, "would take the scene beyond", "of memory", "split the scene"] {
        assert!(error.to_string().contains(words), "'{words}' is not in '{error}'");
    }
}

/// A triangle whose primitive stands there `times` times.
fn repeated(mut b: Builder, times: usize) -> Builder {
    let primitive = b.primitive().clone();
    b.json["meshes"][0]["primitives"] = json!(vec![primitive; times]);
    b
}

#[test]
fn shared_vertices_are_read_where_they_are_used() {
    let count = 20_000;
    let mut b = Builder::new();
    let positions: Vec<f32> = (0..count * 3).map(|i| i as f32).collect();
    let positions = b.floats("VEC3", &positions);
    let zeros = b.push("accessors", json!({"componentType": F32, "type": "VEC3", "count": count}));
    let indices = b.add(5125, "SCALAR", 6, &[7u32, 19_999, 3, 3, 19_999, 400].map(u32::to_le_bytes).concat());
    *b.primitive() = json!({
        "attributes": {"POSITION": positions, "NORMAL": zeros}, "indices": indices, "targets": [{"POSITION": positions}]
    });
    let scene = load_within("scene.glb", &repeated(b, 500).glb(), 8 * MIB).unwrap();
    assert_eq!(scene.draws.len(), 500);
    let primitive = scene.primitive(&scene.draws[499]);
    let first: Vec<f32> = primitive.vertices.iter().map(|v| v.position[0]).collect();
    assert_eq!(first, [9.0, 21.0, 1200.0, 59_997.0]);
    assert_eq!(primitive.indices, [1, 3, 0, 0, 3, 2]);
    assert_eq!(primitive.morph_targets[0][2].position, [1200.0, 1201.0, 1202.0]);
}

#[test]
fn sparse_elements_reach_the_vertices_that_use_them() {
    let mut b = Builder::triangle();
    let positions = b.push(
        "accessors",
        json!({"componentType": F32, "type": "VEC3", "count": 1000, "sparse": {
            "count": 3, "indices": {"bufferView": 0, "componentType": 5123}, "values": {"bufferView": 1}
        }}),
    );
    let places = b.view(&[10u16, 20, 30].map(u16::to_le_bytes).concat());
    let values = b.view(&(1..10).flat_map(|v| (v as f32).to_le_bytes()).collect::<Vec<_>>());
    b.json["accessors"][positions]["sparse"]["indices"]["bufferView"] = json!(places);
    b.json["accessors"][positions]["sparse"]["values"]["bufferView"] = json!(values);
    let indices = b.add(5123, "SCALAR", 3, &[30u16, 10, 999].map(u16::to_le_bytes).concat());
    *b.primitive() = json!({"attributes": {"POSITION": positions}, "indices": indices});
    let scene = b.load().unwrap();
    let corners: Vec<[f32; 3]> =
        scene.primitive(&scene.draws[0]).vertices.iter().map(|v| v.position).collect();
    assert_eq!(corners, [[7.0, 8.0, 9.0], [1.0, 2.0, 3.0], [0.0; 3]]);
}

#[test]
fn claims_without_data_are_refused() {
    let mut b = Builder::new();
    let zeros = b.push("accessors", json!({"componentType": F32, "type": "VEC3", "count": 100_000}));
    *b.primitive() = json!({"attributes": {"POSITION": zeros}});
    let bytes = repeated(b, 1000).gltf();
    let started = Instant::now();
    assert_refused("scene.gltf", &bytes, 64 * MIB);
    assert!(started.elapsed() < Duration::from_secs(60));
    // Hundreds of bytes in memory for three in the file.
    let mut nodes = Builder::triangle();
    nodes.json["nodes"] = json!(vec![json!({}); 100_000]);
    assert_refused("scene.gltf", &nodes.gltf(), 64 * MIB);
    assert_refused("scene.gltf", &repeated(Builder::triangle(), 10).gltf(), 200);
    assert_refused("scene.obj", format!("v 0 0 0\n{}", "f 1 1 1\n".repeat(1000)).as_bytes(), 100_000);
}

#[test]
fn images_count_with_all_of_their_pixels() {
    let mut png = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(2048, 2048).write_to(&mut png, image::ImageFormat::Png).unwrap();
    assert!(png.get_ref().len() < 100_000);
    let mut b = Builder::triangle();
    let view = b.view(png.get_ref());
    b.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    assert_eq!(load_within("scene.glb", &b.glb(), 20 * MIB).unwrap().images[0].rgba.len() as u64, 16 * MIB);
    assert_refused("scene.glb", &b.glb(), 15 * MIB);
}

/// A flat cone of so many triangles.
fn fan(count: usize) -> String {
    let mut obj = String::from("v 0 0.1 0\n");
    for i in 0..count {
        let (sine, cosine) = (i as f64 / count as f64 * std::f64::consts::TAU).sin_cos();
        obj += &format!("v {sine} 0 {cosine}\n");
    }
    for i in 0..count {
        obj += &format!("f 1 {} {}\n", i + 2, (i + 1) % count + 2);
    }
    obj
}

#[test]
fn normals_take_as_long_as_there_are_faces() {
    // The tip has one normal, however many faces meet there: 50 are compared with each other, 300 are not.
    for count in [50, 300] {
        let scene = load_bytes("a.obj", fan(count).as_bytes()).unwrap();
        let tip = |v: &&crate::Vertex| v.position[1] > 0.0;
        let vertices = &scene.primitive(&scene.draws[0]).vertices;
        assert!(vertices.iter().filter(tip).all(|v| Vec3::from(v.normal).abs_diff_eq(Vec3::Y, 1e-4)));
    }
    // Every face with every other would be 10^10 products. Time is compared with that of as many triangles
    // of which few meet, since machines differ.
    let seconds = |obj: String| {
        let started = Instant::now();
        load_bytes("a.obj", obj.as_bytes()).unwrap();
        started.elapsed().as_secs_f32()
    };
    let count = 100_000;
    let around = fan(count);
    let vertices = around.split_once('f').map_or("", |(vertices, _)| vertices);
    let faces: String = (1..count).map(|i| format!("f {i} {} {}\n", i + 1, i + 2)).collect();
    let strip = seconds(format!("{vertices}{faces}"));
    let fan = seconds(around);
    assert!(fan < 8.0 * strip, "{fan} s around one vertex, {strip} s side by side");
}
