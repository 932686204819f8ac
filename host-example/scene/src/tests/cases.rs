//! Files of other programs and the kinds of things that they hold, in `tests/data/cases`; the `note.txt` of each says
//! what is right.

use std::path::{Path, PathBuf};

use glam::{Vec2, Vec3};

use crate::material::Wrap;
use crate::{AlphaMode, Image, Material, Primitive, Scene};

pub fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/cases").join(name)
}

fn load(name: &str) -> Scene {
    Scene::load(&place(name), None).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Loads a file of which nothing is left out.
pub fn whole(name: &str) -> Scene {
    let scene = load(name);
    assert!(scene.warnings.is_empty(), "{name}: {:?}", scene.warnings);
    scene
}

pub fn first(scene: &Scene) -> (&Primitive, &Material) {
    let primitive = scene.primitive(&scene.draws[0]);
    (primitive, &scene.materials[primitive.material])
}

/// The picture of the base colour.
pub fn picture(scene: &Scene) -> &Image {
    let use_ = first(scene).1.base_color_texture.expect("a texture");
    &scene.images[scene.textures[use_.texture].image.expect("an image")]
}

#[test]
fn textures_of_webp_are_read_and_those_of_others_are_left_out() {
    let (png, webp) = (whole("gltf_webp/box.glb"), whole("gltf_webp/box_webp.glb"));
    let (lossy, exact) = (&picture(&webp).rgba, &picture(&png).rgba);
    assert_eq!(lossy.len(), exact.len());
    let sum: u64 = lossy.iter().zip(exact).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    assert!(sum < 16 * exact.len() as u64, "{sum} over {} values", exact.len());
    let left_out = |name: &str, extension: &str| {
        let scene = load(name);
        assert_eq!((scene.draws.len(), first(&scene).1.base_color_texture), (1, None), "{name}");
        assert!(scene.warnings[0].contains(&format!("demands {extension}")), "{:?}", scene.warnings);
    };
    left_out("gltf_avif/box_avif.glb", "EXT_texture_avif");
    if cfg!(not(feature = "compressed")) {
        left_out("gltf_ktx2/ktx2.glb", "KHR_texture_basisu");
    }
}

#[test]
fn instances_stand_where_meshes_of_their_own_would() {
    let six = whole("gltf_instancing/six.glb");
    assert_eq!(six.draws.len(), 6);
    for name in ["gltf_instancing/instanced.glb", "gltf_instancing/instanced_required.glb"] {
        let scene = whole(name);
        assert_eq!(scene.draws.len(), 6, "{name}");
        assert!(scene.bounds.min.abs_diff_eq(six.bounds.min, 1e-4), "{name}: {}", scene.bounds.min);
        assert!(scene.bounds.max.abs_diff_eq(six.bounds.max, 1e-4), "{name}: {}", scene.bounds.max);
    }
}

#[test]
fn files_of_gltf_are_found_where_they_clearly_are() {
    for name in ["good", "backslash", "case", "up", "windows_path"] {
        let scene = whole(&format!("gltf_paths/{name}.gltf"));
        assert!(picture(&scene).rgba == picture(&whole("gltf_paths/good.gltf")).rgba, "{name}");
    }
    let scene = load("gltf_paths/missing.gltf");
    assert_eq!((scene.draws.len(), first(&scene).1.base_color_texture), (1, None));
    assert!(scene.warnings.iter().any(|warning| warning.contains("'nope.png'")), "{:?}", scene.warnings);
}

#[test]
fn surfaces_of_specular_and_glossiness_are_converted() {
    let scene = whole("gltf_specgloss/specgloss.glb");
    let material = first(&scene).1;
    assert!(
        material.base_color.truncate().abs_diff_eq(Vec3::new(0.8, 0.1, 0.05), 1e-3),
        "{}",
        material.base_color
    );
    assert!(material.metallic < 1e-3, "{}", material.metallic);
    assert!((material.roughness - 0.6).abs() < 1e-6, "{}", material.roughness);
}

#[test]
fn what_lets_light_through_is_blended() {
    let scene = whole("gltf_transmission/transmission.glb");
    let material = first(&scene).1;
    assert_eq!(material.alpha_mode, AlphaMode::Blend);
    assert!((0.05..0.3).contains(&material.base_color.w), "{}", material.base_color);
}

/// Without its decoder.
#[cfg(not(feature = "compressed"))]
#[test]
fn compressed_geometry_is_refused_by_name() {
    let name = "gltf_draco/box_draco.glb";
    let error = Scene::load(&place(name), None).unwrap_err().to_string();
    assert!(error.contains("KHR_draco_mesh_compression"), "{error}");
}

#[test]
fn files_of_mtl_are_found_where_they_clearly_are() {
    for name in [
        "mtl_other_folder/folderm",
        "obj_paths/case",
        "obj_paths/folderm",
        "obj_paths/mtlcase",
        "obj_paths/quoted",
        "obj_paths/winpath",
    ] {
        let scene = whole(&format!("{name}.obj"));
        assert!(picture(&scene).width > 1, "{name}");
    }
}

#[test]
fn faces_that_turn_inward_are_covered_once() {
    for (name, area, empty) in [("c_shape", 7.0, Vec2::new(1.8, 1.5)), ("dart", 2.0, Vec2::new(0.0, 1.5))] {
        let scene = whole(&format!("obj_concave/{name}.obj"));
        let primitive = first(&scene).0;
        let mut sum = 0.0;
        for triangle in primitive.indices.as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|i| Vec3::from(primitive.vertices[i as usize].position).truncate());
            let part = (b - a).perp_dot(c - a) * 0.5;
            assert!(part > 0.0, "{name}: all triangles face the same way");
            sum += part;
            let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(empty - from));
            assert!(sides.iter().any(|side| *side < 0.0), "{name}: {empty} is empty");
        }
        assert!((sum - area).abs() < 1e-4, "{name}: {sum}");
        assert!(primitive.vertices.iter().all(|v| v.normal == [0.0, 0.0, 1.0]), "{name}");
    }
}

#[test]
fn textures_of_all_formats_are_read() {
    let expected = whole("obj_formats/bmp.obj");
    for name in ["dds", "gif", "tga", "tif", "webp"] {
        let scene = whole(&format!("obj_formats/{name}.obj"));
        let (found, expected) = (picture(&scene), picture(&expected));
        assert_eq!((found.width, found.height), (expected.width, expected.height), "{name}");
        assert!(found.rgba == expected.rgba, "{name}");
    }
}

#[test]
fn masks_and_alpha_cut_out() {
    for name in ["kd_alpha", "map_d", "map_d_only"] {
        let scene = whole(&format!("obj_map_d/{name}.obj"));
        assert_eq!(first(&scene).1.alpha_mode, AlphaMode::Mask { cutoff: 0.5 }, "{name}");
        let covered = picture(&scene).rgba.as_chunks::<4>().0.iter().filter(|texel| texel[3] > 127).count();
        let texels = picture(&scene).rgba.len() / 4;
        assert!((texels / 5..texels * 4 / 5).contains(&covered), "{name}: {covered} of {texels}");
    }
    // The colour of a mask alone is that of Kd.
    let scene = whole("obj_map_d/map_d_only.obj");
    assert_eq!(first(&scene).1.base_color.to_array(), [0.2, 0.6, 0.2, 1.0]);
    assert!(picture(&scene).rgba.as_chunks::<4>().0.iter().all(|texel| texel[..3] == [255; 3]));
    let scene = whole("obj_tr/tr7.obj");
    let material = first(&scene).1;
    assert!((material.base_color.w - 0.3).abs() < 1e-6, "{}", material.base_color);
    assert_eq!(material.alpha_mode, AlphaMode::Blend);
}

#[test]
fn smoothing_groups_say_which_edges_are_hard() {
    for (name, smooth) in [
        ("sg_30_diff", false),
        ("sg_30_off", false),
        ("sg_30_same", true),
        ("sg_80_off", false),
        ("sg_80_same", true),
    ] {
        let scene = whole(&format!("obj_smoothing/{name}.obj"));
        let primitive = first(&scene).0;
        let edge = primitive.vertices.iter().filter(|v| v.position[0] == 0.0 && v.position[1] == 0.0);
        let mut normals: Vec<Vec3> = edge.map(|v| Vec3::from(v.normal)).collect();
        normals.dedup_by(|a, b| a.abs_diff_eq(*b, 1e-5));
        assert_eq!(normals.len(), if smooth { 1 } else { 2 }, "{name}: {normals:?}");
        if !smooth {
            assert!(normals.contains(&Vec3::Z), "{name}: {normals:?}");
        }
    }
}

#[test]
fn options_of_textures_are_followed() {
    let used = |name: &str| {
        let scene = whole(&format!("obj_texture_options/{name}.obj"));
        let use_ = first(&scene).1.base_color_texture.expect(name);
        // At the lower left and the upper right of the picture.
        let corners =
            [Vec2::new(0.0, 1.0), Vec2::new(1.0, 0.0)].map(|uv| use_.transform.transform_point2(uv));
        (corners, scene.textures[use_.texture].sampler.wrap_u)
    };
    let (left, right) = (Vec2::new(0.0, 1.0), Vec2::new(1.0, 0.0));
    assert_eq!(used("colorspace"), ([left, right], Wrap::Repeat));
    assert_eq!(used("type"), ([left, right], Wrap::Repeat));
    assert_eq!(used("scale"), ([left, Vec2::new(4.0, -3.0)], Wrap::Repeat));
    assert_eq!(used("clamp"), ([left, Vec2::new(2.0, -1.0)], Wrap::Clamp));
    assert_eq!(used("offset"), ([Vec2::new(0.5, 0.75), Vec2::new(1.5, -0.25)], Wrap::Repeat));
}
