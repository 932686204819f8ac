//! Meaning of whole glTF files.

use std::fs;

use glam::{Affine2, Mat4, Quat, Vec2, Vec3};
use serde_json::json;

use super::build::{Builder, F32, U8, U16, load_bytes, png};
use crate::pose::Pose;
use crate::{AlphaMode, LightKind, MorphDelta, Scene, TextureUse};

#[test]
fn a_triangle_gets_flat_normals_and_the_default_material() {
    for (name, bytes) in [("a.gltf", Builder::triangle().gltf()), ("a.glb", Builder::triangle().glb())] {
        let scene = load_bytes(name, &bytes).unwrap();
        assert_eq!(scene.name, "a");
        assert_eq!(scene.draws.len(), 1);
        let primitive = scene.primitive(&scene.draws[0]);
        assert_eq!(primitive.indices, [0, 1, 2]);
        assert!(primitive.vertices.iter().all(|v| v.normal == [0.0, 0.0, 1.0] && v.color == [1.0; 4]));
        assert_eq!(scene.materials[primitive.material].roughness, 1.0);
        assert_eq!((scene.bounds.min, scene.bounds.max), (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
}

#[test]
fn strips_and_fans_become_lists_and_lines_are_left_out() {
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    for (mode, triangles) in [(5, 2), (6, 2)] {
        let mut b = Builder::new();
        let positions = b.floats("VEC3", &square);
        *b.primitive() = json!({"attributes": {"POSITION": positions}, "mode": mode});
        let scene = b.load().unwrap();
        let primitive = scene.primitive(&scene.draws[0]);
        assert_eq!(primitive.indices.len(), triangles * 3);
        if mode == 5 {
            assert!(primitive.vertices.iter().all(|v| v.normal[2] == 1.0), "strips keep their winding");
        }
    }
    let mut b = Builder::triangle();
    let positions = b.primitive()["attributes"].clone();
    b.json["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(json!({"attributes": positions, "mode": 1}));
    let scene = b.load().unwrap();
    assert_eq!(scene.draws.len(), 1);
    assert!(scene.warnings[0].contains("Lines"), "{:?}", scene.warnings);
}

#[test]
fn sparse_accessors_replace_elements() {
    let mut b = Builder::triangle();
    let indices = b.view(&[2]);
    let values = b.view(&[5.0f32, 6.0, 7.0].map(f32::to_le_bytes).concat());
    b.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": indices, "componentType": U8},
        "values": {"bufferView": values}
    });
    assert_eq!(b.load().unwrap().bounds.max, Vec3::new(5.0, 6.0, 7.0));
    // Without a dense part the other elements are 0.
    b.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(b.load().unwrap().bounds.min, Vec3::ZERO);
}

#[test]
fn normalized_integers_and_strides_are_read() {
    let mut b = Builder::triangle();
    let colors = b.add(U8, "VEC3", 3, &[255, 0, 51, 99, 0, 0, 0, 99, 0, 255, 0, 99]);
    b.json["accessors"][colors]["normalized"] = json!(true);
    let view = b.json["accessors"][colors]["bufferView"].as_u64().unwrap() as usize;
    b.json["bufferViews"][view]["byteStride"] = json!(4);
    let uv = b.add(U16, "VEC2", 3, &[0, 0, 255, 255, 255, 127, 0, 0, 0, 0, 0, 0]);
    b.json["accessors"][uv]["normalized"] = json!(true);
    b.primitive()["attributes"]["COLOR_0"] = json!(colors);
    b.primitive()["attributes"]["TEXCOORD_0"] = json!(uv);
    let scene = b.load().unwrap();
    let vertex = scene.primitive(&scene.draws[0]).vertices[0];
    assert_eq!(vertex.color, [1.0, 0.0, 0.2, 1.0]);
    assert_eq!(vertex.uv0, [0.0, 1.0]);
}

#[test]
fn materials_keep_what_the_file_says() {
    let mut b = Builder::triangle();
    let view = b.view(&png());
    b.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    b.push("textures", json!({"source": 0}));
    let transform =
        json!({"KHR_texture_transform": {"offset": [0.5, 0.25], "scale": [2.0, 3.0], "texCoord": 1}});
    b.push(
        "materials",
        json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.1, 0.2, 0.3, 0.4],
                "baseColorTexture": {"index": 0, "extensions": transform},
                "metallicFactor": 0.5, "roughnessFactor": 0.25
            },
            "normalTexture": {"index": 0, "scale": 0.5, "extensions": transform},
            "emissiveFactor": [1.0, 0.5, 0.0], "alphaMode": "MASK", "alphaCutoff": 0.7, "doubleSided": true,
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}, "KHR_materials_unlit": {}}
        }),
    );
    b.primitive()["material"] = json!(0);
    let scene = b.load().unwrap();
    let m = &scene.materials[0];
    assert_eq!(m.base_color.to_array(), [0.1, 0.2, 0.3, 0.4]);
    assert_eq!((m.metallic, m.roughness, m.normal_scale), (0.5, 0.25, 0.5));
    assert_eq!(m.emissive, Vec3::new(4.0, 2.0, 0.0));
    assert_eq!(m.alpha_mode, AlphaMode::Mask { cutoff: 0.7 });
    assert!(m.double_sided && m.unlit);
    for use_ in [m.base_color_texture.unwrap(), m.normal_texture.unwrap()] {
        assert_eq!(use_.uv_set, 1);
        assert_eq!(use_.transform.transform_point2(Vec2::ONE), Vec2::new(2.5, 3.25));
    }
    assert_eq!(scene.images[0].rgba[..4], [0, 0, 7, 255]);
    // A normal map needs tangents, which the file does not have.
    assert!(scene.primitive(&scene.draws[0]).vertices.iter().all(|v| v.tangent[3] != 0.0));
}

#[test]
fn extensions_of_materials_and_nodes_are_followed() {
    let mut b = Builder::triangle();
    let shiny = |ior: f32, specular: f32| json!({"KHR_materials_ior": {"ior": ior}, "KHR_materials_specular": {"specularFactor": specular}});
    b.push("materials", json!({"extensions": shiny(2.0, 0.5)}));
    b.push("materials", json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.0, 0.0, 0.0, 1.0], "specularFactor": [1.0, 0.77, 0.34], "glossinessFactor": 0.75
    }}}));
    b.push("materials", json!({"extensions": {"KHR_materials_sheen": {}}}));
    b.json["extensionsUsed"] = json!(["KHR_materials_ior", "KHR_materials_sheen", "VENDOR_thing"]);
    b.json["nodes"] = json!([
        {"mesh": 0, "children": [1]},
        {"extensions": {"KHR_node_visibility": {"visible": false}}, "children": [2]},
        {"mesh": 0},
        {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}}
    ]);
    b.json["scenes"][0]["nodes"] = json!([0, 3]);
    let scene = b.load().unwrap();
    assert!((scene.materials[0].reflectance - 1.0 / 18.0).abs() < 1e-6);
    let gold = &scene.materials[1];
    assert!(gold.base_color.truncate().abs_diff_eq(Vec3::new(1.0, 0.77, 0.34), 1e-3), "{}", gold.base_color);
    assert!(gold.metallic > 0.999 && (gold.roughness - 0.25).abs() < 1e-6);
    assert_eq!(scene.draws.iter().map(|draw| draw.node).collect::<Vec<_>>(), [0, 3]);
    let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
    assert!(warning.contains("VENDOR_thing") && warning.contains("KHR_materials_sheen"), "{warning}");
}

#[test]
fn glossy_textures_say_what_is_metal() {
    let mut b = Builder::triangle();
    let picture = |texels: [[u8; 4]; 2]| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let image = image::RgbaImage::from_raw(2, 1, texels.concat()).unwrap();
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    };
    // Red paint beside gold.
    let diffuse = picture([[200, 20, 10, 255], [0, 0, 0, 255]]);
    let specular = picture([[56, 56, 56, 0], [255, 226, 155, 255]]);
    for (index, bytes) in [diffuse, specular].iter().enumerate() {
        let view = b.view(bytes);
        b.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
        b.push("textures", json!({"source": index}));
    }
    b.push(
        "materials",
        json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
            "diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1}
        }}}),
    );
    let scene = b.load().unwrap();
    let material = &scene.materials[0];
    let image =
        |use_: Option<TextureUse>| &scene.images[scene.textures[use_.unwrap().texture].image.unwrap()].rgba;
    let (base, rough) = (image(material.base_color_texture), image(material.metallic_roughness_texture));
    let near = |found: &[u8], right: [u8; 3]| found.iter().zip(right).all(|(a, b)| a.abs_diff(b) <= 3);
    assert!(near(&base[..3], [200, 20, 10]) && near(&base[4..7], [255, 226, 155]), "{base:?}");
    assert!(near(&rough[..3], [255, 255, 0]) && near(&rough[4..7], [255, 0, 255]), "{rough:?}");
    assert_eq!((material.metallic, material.roughness), (1.0, 1.0));
}

#[test]
fn instances_may_be_wrong() {
    for attributes in [json!({"TRANSLATION": 99}), json!({"TRANSLATION": 1}), json!({"TRANSLATION": "x"})] {
        let mut b = Builder::triangle();
        b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = json!({"attributes": attributes});
        let error = b.load().unwrap_err().to_string();
        assert!(error.contains("instances of node number 0"), "{error}");
    }
    let mut b = Builder::triangle();
    b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = json!({"attributes": {}});
    assert_eq!(b.load().unwrap().draws.len(), 1);
}

#[test]
fn texture_transforms_turn_counter_clockwise_in_the_image() {
    let turned = TextureUse::uv_transform([0.0; 2], std::f32::consts::FRAC_PI_2, [1.0; 2]);
    // V points down the image: from right to up is towards -V.
    assert!(turned.transform_point2(Vec2::X).abs_diff_eq(-Vec2::Y, 1e-6));
    assert_eq!(TextureUse::uv_transform([0.0; 2], 0.0, [1.0; 2]), Affine2::IDENTITY);
}

#[test]
fn textures_of_unknown_formats_are_left_out_with_their_names() {
    let mut b = Builder::triangle();
    let view = b.view(b"\xabKTX 20\xbb\r\n\x1a\n");
    b.push("images", json!({"bufferView": view, "mimeType": "image/ktx2", "name": "bark"}));
    b.push("textures", json!({"source": 0}));
    b.push("textures", json!({"name": "sourceless", "extensions": {"EXT_texture_avif": {"source": 0}}}));
    b.push(
        "materials",
        json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1}}}),
    );
    b.json["extensionsRequired"] = json!(["EXT_texture_avif"]);
    let scene = b.load().unwrap();
    assert_eq!(scene.materials[0].base_color_texture, None);
    assert_eq!(scene.materials[0].metallic, 0.0, "a lost metalness map does not make a mirror");
    let all = scene.warnings.join("\n");
    for part in ["EXT_texture_avif", "'bark'", "KTX2", "'sourceless'"] {
        assert!(all.contains(part), "{part} is not in {all}");
    }
}

#[test]
fn external_files_are_found_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("maps")).unwrap();
    fs::write(folder.path().join("maps/wood grain.png"), png()).unwrap();
    let mut b = Builder::triangle();
    fs::write(folder.path().join("data.bin"), &b.bytes).unwrap();
    b.json["buffers"] = json!([{"byteLength": b.bytes.len(), "uri": "data.bin"}]);
    b.push("images", json!({"uri": "maps/wood%20grain.png"}));
    let path = folder.path().join("scene.gltf");
    fs::write(&path, b.gltf()).unwrap();
    assert_eq!(Scene::load(&path, None).unwrap().images[0].width, 2);
}

#[test]
fn hierarchies_lights_and_cameras_are_placed() {
    let mut b = Builder::triangle();
    b.json["nodes"] = json!([
        {"children": [1, 2, 3], "translation": [1, 2, 3]},
        {"mesh": 0, "scale": [2, 2, 2]},
        {"camera": 0, "rotation": [0, 0, 0, 1]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "name": "in no scene"}
    ]);
    b.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}));
    b.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 5.0, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.4}}
    ]}});
    let scene = b.load().unwrap();
    assert_eq!(scene.draws.len(), 1);
    let pose = Pose::at_rest(&scene);
    assert_eq!(pose.world[1].transform_point3(Vec3::X), Vec3::new(3.0, 2.0, 3.0));
    assert_eq!(scene.bounds.max, Vec3::new(3.0, 4.0, 3.0));
    assert_eq!(scene.lights[0].kind, LightKind::Spot { inner: 0.1, outer: 0.4 });
    let node = crate::camera::file_camera(&scene).unwrap();
    let view = crate::camera::View::from_node(&scene, &pose, node).unwrap();
    assert!(view.eye().abs_diff_eq(Vec3::new(1.0, 2.0, 3.0), 1e-6));
}

/// A triangle whose corners hang on three joints, the last of which is animated.
fn skinned() -> Builder {
    let mut b = Builder::triangle();
    let joints = b.add(U8, "VEC4", 3, &[0, 0, 0, 0, 1, 0, 0, 0, 2, 1, 0, 0]);
    let weights = b.floats("VEC4", &[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    b.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    b.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    let matrices: Vec<f32> = [Mat4::IDENTITY; 3].iter().flat_map(|m| m.to_cols_array()).collect();
    let bind = b.floats("MAT4", &matrices);
    b.json["nodes"] = json!([{"mesh": 0, "skin": 0, "translation": [100, 0, 0]}, {}, {}, {}]);
    b.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    b.push("skins", json!({"joints": [1, 2, 3], "inverseBindMatrices": bind}));
    let times = b.floats("SCALAR", &[0.0, 2.0]);
    let places = b.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 8.0]);
    b.push(
        "animations",
        json!({
            "name": "Lift", "samplers": [{"input": times, "output": places}],
            "channels": [{"sampler": 0, "target": {"node": 3, "path": "translation"}}]
        }),
    );
    b
}

#[test]
fn skins_follow_their_joints_and_not_their_node() {
    let scene = skinned().load().unwrap();
    let mut pose = Pose::default();
    pose.update(&scene, scene.find_animation("lift"), 1.0);
    let mut points = Vec::new();
    pose.positions(&scene, &scene.draws[0], |p| points.push(p));
    // Half of the way of 4 at that time, since half of its weight is on the joint that moves.
    assert_eq!(points, [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 2.0)]);
    assert!(scene.bounds.max.z > 3.0, "bounds hold the animation: {}", scene.bounds.max);
}

#[test]
fn channels_that_drive_nothing_known_are_left_out() {
    let mut b = skinned();
    let channels = b.json["animations"][0]["channels"].as_array_mut().unwrap();
    channels.push(json!({"sampler": 0, "target": {"path": "translation"}}));
    let pointer = json!({"KHR_animation_pointer": {"pointer": "/materials/0/alphaCutoff"}});
    channels.push(json!({"sampler": 0, "target": {"path": "pointer", "extensions": pointer}}));
    channels.push(json!({"sampler": 0, "target": {"path": "pointer", "extensions": pointer}}));
    channels.push(json!({"sampler": 0, "target": {"path": "visibility", "node": 1}}));
    b.json["extensionsRequired"] = json!(["KHR_animation_pointer"]);
    let scene = b.load().unwrap();
    assert_eq!(scene.animations[0].channels.len(), 1);
    assert_eq!(
        scene.warnings[1..],
        [
            "2 of 5 channels of animation 'Lift' left out: KHR_animation_pointer is not supported",
            "1 of 5 channels of animation 'Lift' left out: the property 'visibility' is not known",
            "1 of 5 channels of animation 'Lift' left out: they name no node",
        ]
    );
    assert!(scene.warnings[0].contains("demands KHR_animation_pointer"), "{:?}", scene.warnings);
}

#[test]
fn accessors_without_data_hold_zeros() {
    let mut b = Builder::triangle();
    let zeros = b.push("accessors", json!({"componentType": F32, "type": "VEC3", "count": 3}));
    b.primitive()["targets"] = json!([{"POSITION": zeros, "NORMAL": zeros}]);
    let scene = b.load().unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.primitive(&scene.draws[0]).morph_targets, [[MorphDelta::default(); 3]]);
}

#[test]
fn joints_beyond_the_skin_are_an_error() {
    let mut b = skinned();
    b.json["skins"][0]["joints"] = json!([1, 2]);
    assert!(b.load().unwrap_err().to_string().contains("joint"));
}

#[test]
fn morph_targets_add_up() {
    let mut b = Builder::triangle();
    let up = b.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let right = b.floats("VEC3", &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    b.primitive()["targets"] = json!([{"POSITION": up}, {"POSITION": right}]);
    b.json["meshes"][0]["weights"] = json!([0.5, 0.0]);
    b.json["nodes"][0]["rotation"] = json!(Quat::from_rotation_z(0.0).to_array());
    let times = b.floats("SCALAR", &[0.0, 1.0]);
    let weights = b.floats("SCALAR", &[0.5, 0.0, 0.0, 4.0]);
    b.push(
        "animations",
        json!({
            "samplers": [{"input": times, "output": weights, "interpolation": "LINEAR"}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]
        }),
    );
    let scene = b.load().unwrap();
    let mut pose = Pose::at_rest(&scene);
    let first = |pose: &Pose| {
        let mut points = Vec::new();
        pose.positions(&scene, &scene.draws[0], |p| points.push(p));
        points[0]
    };
    assert_eq!(first(&pose), Vec3::new(0.0, 0.0, 0.5));
    pose.update(&scene, Some(0), 0.5);
    assert_eq!(first(&pose), Vec3::new(2.0, 0.0, 0.25));
    pose.update(&scene, Some(0), 1.5);
    assert_eq!(first(&pose), Vec3::new(2.0, 0.0, 0.25), "animations loop");
}
