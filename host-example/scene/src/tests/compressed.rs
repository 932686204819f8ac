//! Compressed geometry and textures, against the same ones as they are without compression. Those of the balls were made
//! by the reference encoders.

use std::fs;

use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use super::build::Builder;
use super::cases::{first, place, whole};
use crate::Scene;
use crate::budget::Budget;
#[cfg(feature = "compressed")]
use crate::{Image, Influence, Primitive};

/// Files whose parts are compressed in each way.
const FILES: [&str; 9] = [
    "gltf_meshopt/ball_ext.glb",
    "gltf_meshopt/ball_khr.glb",
    "gltf_draco/ball_edgebreaker.glb",
    "gltf_draco/ball_sequential.glb",
    "gltf_draco/ball_valence.glb",
    "gltf_ktx2/etc1s_alpha.glb",
    "gltf_ktx2/ktx2.glb",
    "gltf_ktx2/uastc.glb",
    "gltf_ktx2/uastc_zstd.glb",
];

/// Vertices and indices of a primitive that are as far apart at most as given, for each attribute.
fn assert_alike(name: &str, scene: &Scene, plain: &Scene, draw: usize, far: [f32; 4]) {
    let [found, expected] = [scene, plain].map(|scene| scene.primitive(&scene.draws[draw]));
    assert_eq!(found.indices, expected.indices, "{name}");
    assert_eq!(found.vertices.len(), expected.vertices.len(), "{name}");
    for (a, b) in found.vertices.iter().zip(&expected.vertices) {
        assert!(Vec3::from(a.position).abs_diff_eq(b.position.into(), far[0]), "{name}: {a:?} {b:?}");
        assert!(Vec3::from(a.normal).abs_diff_eq(b.normal.into(), far[1]), "{name}: {a:?} {b:?}");
        assert!(Vec2::from(a.uv0).abs_diff_eq(b.uv0.into(), far[2]), "{name}: {a:?} {b:?}");
        assert!(Vec4::from(a.color).abs_diff_eq(b.color.into(), far[3]), "{name}: {a:?} {b:?}");
    }
}

#[test]
fn cases_of_meshopt_are_decoded() {
    let plain = whole("gltf_meshopt/ball_plain.glb");
    for name in ["gltf_meshopt/ball_ext.glb", "gltf_meshopt/ball_khr.glb"] {
        let scene = whole(name);
        assert_eq!(scene.draws.len(), 6, "{name}: two primitives of three instances");
        for draw in 0..6 {
            // Decoders may differ by one in the last place of normals and colours.
            assert_alike(name, &scene, &plain, draw, [0.0, 1.5 / 32767.0, 0.0, 1.01 / 255.0]);
        }
        let apart = |bounds: fn(&Scene) -> Vec3| (bounds(&scene) - bounds(&plain)).abs().max_element();
        assert!(apart(|scene| scene.bounds.min).max(apart(|scene| scene.bounds.max)) < 1e-3, "{name}");
    }
    let (scene, plain) = (whole("gltf_meshopt/box_meshopt.glb"), whole("gltf_webp/box.glb"));
    assert_eq!(first(&scene).0.indices.len(), 36);
    assert!(scene.bounds.min.abs_diff_eq(plain.bounds.min, 1e-4), "{}", scene.bounds.min);
    assert!(scene.bounds.max.abs_diff_eq(plain.bounds.max, 1e-4), "{}", scene.bounds.max);
    let straight = |normal: [f32; 3]| normal.iter().filter(|n| n.abs() > 0.99).count() == 1;
    assert!(first(&scene).0.vertices.iter().all(|vertex| straight(vertex.normal)));
}

/// Asserts that the triangles of two primitives are the same ones, in any order.
#[cfg(feature = "compressed")]
fn assert_same_triangles(name: &str, found: &Primitive, expected: &Primitive) {
    let corner = |primitive: &Primitive, index: u32| {
        let (vertex, own) = (primitive.vertices[index as usize], index as usize * primitive.influence_sets);
        (vertex, primitive.influences.get(own).copied())
    };
    let corners = |primitive: &Primitive| {
        let triangles = primitive.indices.as_chunks::<3>().0.iter();
        triangles.map(|triangle| triangle.map(|index| corner(primitive, index))).collect::<Vec<_>>()
    };
    let (found, expected) = (corners(found), corners(expected));
    assert_eq!(found.len(), expected.len(), "{name}");
    for triangle in &expected {
        let near = |other: &&[_; 3]| {
            (0..3).any(|turn| {
                (0..3).all(|k| {
                    let ((a, a_joint), (b, b_joint)): ((crate::Vertex, Option<Influence>), _) =
                        (other[(k + turn) % 3], triangle[k]);
                    Vec3::from(a.position).abs_diff_eq(b.position.into(), 1e-3)
                        && Vec3::from(a.normal).abs_diff_eq(b.normal.into(), 1e-2)
                        && Vec2::from(a.uv0).abs_diff_eq(b.uv0.into(), 1e-3)
                        && Vec4::from(a.color).abs_diff_eq(b.color.into(), 1.01 / 255.0)
                        && b_joint.is_none_or(|b: Influence| a_joint.is_some_and(|a| a.joints == b.joints))
                })
            })
        };
        assert!(found.iter().any(|other| near(&other)), "{name}: no triangle is at {:?}", triangle[0].0);
    }
}

#[cfg(feature = "compressed")]
#[test]
fn cases_of_draco_are_decoded() {
    let plain = whole("gltf_webp/box.glb");
    assert_same_triangles("box", first(&whole("gltf_draco/box_draco.glb")).0, first(&plain).0);
    let plain = whole("gltf_meshopt/ball_plain.glb");
    let sequential = whole("gltf_draco/ball_sequential.glb");
    for name in ["ball_sequential", "ball_edgebreaker", "ball_valence"] {
        let scene = whole(&format!("gltf_draco/{name}.glb"));
        let found = first(&scene).0;
        assert_eq!(found.vertices.len(), 334, "{name}");
        assert_same_triangles(name, found, first(&plain).0);
        assert_same_triangles(name, found, first(&sequential).0);
        let joints = found.influences.iter().map(|influence| influence.joints[0]);
        assert_eq!(joints.sum::<u32>(), 167, "{name}: every other vertex follows the second joint");
    }
}

/// Largest difference of a channel from what `expected` is at each place of 0 to 1.
#[cfg(feature = "compressed")]
fn furthest(image: &Image, expected: impl Fn(Vec2) -> Vec4) -> f32 {
    let (width, height) = (image.width as usize, image.height as usize);
    let mut furthest = 0.0f32;
    for (at, texel) in image.rgba.as_chunks::<4>().0.iter().enumerate() {
        let place = Vec2::new((at % width) as f32, (at / width) as f32);
        let place = place / Vec2::new(width as f32 - 1.0, height as f32 - 1.0);
        let texel = Vec4::from(texel.map(f32::from)) / 255.0;
        furthest = furthest.max((texel - expected(place)).abs().max_element());
    }
    furthest
}

#[cfg(feature = "compressed")]
#[test]
fn cases_of_basis_universal_are_decoded() {
    use super::cases::picture;
    // The pictures: gradients, and a disc that is covered where the rest is less so.
    let gradients = |scale: f32| {
        move |place: Vec2| {
            let Vec2 { x, y } = place * scale;
            let covered = (x - 0.5).powi(2) + (y - 0.5).powi(2) < 0.16;
            Vec4::new(x, y, 1.0 - x, if covered { 1.0 } else { 0.25 })
        }
    };
    for (name, size, scale, far) in
        [("etc1s_alpha", 64, 1.0, 0.07), ("uastc_zstd", 64, 1.0, 0.06), ("uastc", 32, 31.0 / 63.0, 0.06)]
    {
        let scene = whole(&format!("gltf_ktx2/{name}.glb"));
        let image = picture(&scene);
        assert_eq!((image.width, image.height), (size, size), "{name}");
        let furthest = furthest(image, gradients(scale));
        assert!(furthest < far, "{name}: {furthest}");
    }
    let scene = whole("gltf_ktx2/ktx2.glb");
    let image = picture(&scene);
    assert_eq!((image.width, image.height), (40, 40));
    let texel = |x: usize, y: usize| image.rgba.as_chunks::<4>().0[y * 40 + x];
    // Letters on a ground: the ground, and the stem of the first letter.
    assert_eq!(texel(0, 39), [184, 151, 0, 255]);
    assert!(texel(3, 6)[..3].iter().all(|channel| *channel > 150), "{:?}", texel(3, 6));
}

/// Numbers that look random, the same ones always.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound
    }
}

/// Bytes of the document of a `.glb`.
fn json_length(glb: &[u8]) -> usize {
    u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize
}

/// Changes a few bytes of the binary chunk of a `.glb` whose document is whole.
fn damaged(whole: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let json = json_length(whole);
    let start = 28 + json;
    // Headers are at the beginnings of what is compressed: half of the changes are near one.
    let views: Value = serde_json::from_slice(&bytes[20..20 + json]).unwrap();
    let offset = |view: &Value| {
        let extensions = view["extensions"].as_object().and_then(|extensions| extensions.values().next());
        extensions.unwrap_or(view)["byteOffset"].as_u64().unwrap_or(0) as usize
    };
    let offsets: Vec<usize> = views["bufferViews"].as_array().unwrap().iter().map(offset).collect();
    for _ in 0..=random.below(3) {
        let near = offsets[random.below(offsets.len())] + random.below(128);
        let at = if random.below(2) == 0 { near } else { random.below(bytes.len() - start) };
        let Some(byte) = bytes.get_mut(start + at) else { continue };
        *byte = [0, 1, 0x7f, 0xff, *byte ^ 1 << random.below(8), random.below(256) as u8][random.below(6)];
    }
    bytes
}

#[test]
fn damage_is_no_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.glb");
    for name in FILES {
        let whole = fs::read(place(name)).unwrap();
        let mut random = Random(7);
        for _ in 0..250 {
            fs::write(&path, damaged(&whole, &mut random)).unwrap();
            if let Err(e) = Scene::load_within(&path, None, &Budget::new(1 << 26)) {
                assert_eq!(e.to_string().lines().count(), 1, "{name}: {e}");
            }
        }
    }
}

/// A file whose document can be changed.
fn document(name: &str) -> Builder {
    let bytes = fs::read(place(name)).unwrap();
    let json = json_length(&bytes);
    let mut json: Value = serde_json::from_slice(&bytes[20..20 + json]).unwrap();
    let data: String = bytes[28 + json_length(&bytes)..].iter().map(|b| format!("%{b:02x}")).collect();
    json["buffers"][0]["uri"] = json!(format!("data:application/octet-stream,{data}"));
    Builder { json, bytes: Vec::new() }
}

#[cfg(feature = "compressed")]
#[test]
fn control_maps_are_decoded() {
    for name in ["gltf_meshopt/ball_khr.glb", "gltf_draco/ball_sequential.glb", "gltf_draco/ball_valence.glb"]
    {
        let plain = whole(name);
        let mut b = document(name);
        for mesh in b.json["meshes"].as_array_mut().unwrap() {
            for primitive in mesh["primitives"].as_array_mut().unwrap() {
                for pointer in ["/attributes", "/extensions/KHR_draco_mesh_compression/attributes"] {
                    let Some(attributes) = primitive.pointer_mut(pointer) else { continue };
                    let attributes = attributes.as_object_mut().unwrap();
                    let colours = attributes.remove("COLOR_0").unwrap();
                    attributes.insert("_CONTROL".to_owned(), colours);
                }
            }
        }
        let scene = b.load().unwrap();
        let colours = first(&plain).0.vertices.iter().map(|vertex| vertex.color);
        // Their alpha is 1 everywhere, which nobody painted.
        let expected: Vec<[f32; 4]> = colours.map(|[r, g, b, _]| [r, g, b, 0.5]).collect();
        assert!(expected.iter().any(|value| *value != expected[0]), "{name}");
        assert_eq!(first(&scene).0.control, expected, "{name}");
    }
}

/// One thing that is changed in a good document, and a word of the message.
type Change = (&'static str, fn(&mut Value));

fn assert_refused(name: &str, part: &str, changes: &[Change]) {
    document(name).load().expect("the file is good before it is changed");
    for (word, change) in changes {
        let mut b = document(name);
        change(&mut b.json);
        let error = b.load().map(|_| ()).expect_err(word).to_string();
        assert!(error.contains(word) && error.contains(part), "'{word}' is not in '{error}'");
    }
}

#[test]
fn views_that_cannot_be_decoded_are_named() {
    fn compressed(json: &mut Value) -> &mut Value {
        &mut json["bufferViews"][0]["extensions"]["KHR_meshopt_compression"]
    }
    assert_refused(
        "gltf_meshopt/ball_khr.glb",
        "meshopt compression of buffer view 0: ",
        &[
            ("beyond 4 GiB of memory", |json| {
                json["bufferViews"][0]["byteLength"] = json!(12u64 << 40);
                compressed(json)["count"] = json!(1u64 << 40);
            }),
            ("not what it can hold", |json| compressed(json)["count"] = json!(333)),
            ("not what it can hold", |json| compressed(json)["filter"] = json!("COLOR")),
            ("beyond the end", |json| compressed(json)["byteOffset"] = json!(u64::MAX)),
            ("beyond the end", |json| compressed(json)["buffer"] = json!(7)),
            ("THING", |json| compressed(json)["mode"] = json!("THING")),
            ("damaged", |json| compressed(json)["byteLength"] = json!(500)),
        ],
    );
}

#[cfg(feature = "compressed")]
#[test]
fn geometry_that_cannot_be_decoded_is_named() {
    fn compressed(json: &mut Value) -> &mut Value {
        &mut json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]
    }
    assert_refused(
        "gltf_draco/ball_valence.glb",
        "mesh number 0: its Draco compression: ",
        &[
            ("buffer view that does not exist", |json| compressed(json)["bufferView"] = json!(99)),
            ("no attribute 99", |json| compressed(json)["attributes"]["NORMAL"] = json!(99)),
            ("no attributes", |json| compressed(json)["attributes"] = json!(null)),
            ("cannot be decoded", |json| json["bufferViews"][0]["byteLength"] = json!(100)),
        ],
    );
}

#[cfg(feature = "compressed")]
#[test]
fn textures_that_cannot_be_decoded_leave_surfaces_plain() {
    let changes: [Change; 2] = [
        ("cut off", |json| json["bufferViews"][5]["byteLength"] = json!(500)),
        ("Vulkan format 97", |json| json["images"][0] = json!({"uri": half_floats()})),
    ];
    for (word, change) in changes {
        let mut b = document("gltf_ktx2/ktx2.glb");
        change(&mut b.json);
        let scene = b.load().unwrap();
        assert!(scene.warnings.iter().any(|warning| warning.contains(word)), "{:?}", scene.warnings);
        assert_eq!(first(&scene).1.base_color_texture, None, "{word}");
    }
}

/// A KTX2 file of pixels of half floats.
#[cfg(feature = "compressed")]
fn half_floats() -> String {
    let mut bytes = b"\xabKTX 20\xbb\r\n\x1a\n".to_vec();
    bytes.extend([97u32, 1, 4, 4, 0, 0, 1, 1, 0, 104, 44].map(u32::to_le_bytes).concat());
    bytes.resize(200, 0);
    let data: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    format!("data:image/ktx2,{data}")
}
