//! OBJ files, whole and broken.

use std::fs;
use std::path::Path;

use glam::Vec3;

use super::build::{load_bytes, png};
use crate::error::Result;
use crate::scene::{AlphaMode, Scene};

fn load(files: &[(&str, &[u8])], texture: Option<&str>) -> Result<Scene> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let texture = texture.map(|name| folder.path().join(name));
    Scene::load(&folder.path().join(files[0].0), texture.as_deref())
}

/// A cube of side 2 around the origin, of quads.
const CUBE: &str = "
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn sharp_edges_keep_their_normals() {
    let scene = load_bytes("cube.obj", CUBE.as_bytes()).unwrap();
    let primitive = scene.primitive(&scene.draws[0]);
    assert_eq!(primitive.indices.len(), 36);
    assert_eq!(primitive.vertices.len(), 24, "three normals at each corner");
    for v in &primitive.vertices {
        let normal = Vec3::from(v.normal);
        assert_eq!(normal.abs().max_element(), 1.0);
        assert_eq!(Vec3::from(v.position).dot(normal), 1.0, "normals point outward");
    }
    assert!(scene.materials.last().unwrap().double_sided);
}

#[test]
fn gentle_bends_are_smooth() {
    // Two squares that meet at 30 degrees along the Z axis.
    let roof = "v -1 0 0\nv 0 0 0\nv 0 0 1\nv -1 0 1\nv 0.866 -0.5 0\nv 0.866 -0.5 1\nf 1 4 3 2\nf 2 3 6 5\n";
    let scene = load_bytes("roof.obj", roof.as_bytes()).unwrap();
    let primitive = scene.primitive(&scene.draws[0]);
    assert_eq!(primitive.vertices.len(), 6);
    let ridge = primitive.vertices.iter().find(|v| v.position == [0.0, 0.0, 0.0]).unwrap();
    let half = 15f32.to_radians();
    assert!(Vec3::from(ridge.normal).abs_diff_eq(Vec3::new(half.sin(), half.cos(), 0.0), 1e-4));
}

#[test]
fn materials_come_from_the_mtl() {
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.75\nusemtl wall\nf 1/1 2/1 3/1\n";
    let mtl = "newmtl wall\nKd 0.5 0.25 0.125\nNs 100\nd 0.5\nmap_Kd -s 1 1 1 wall.png\n";
    let files: [(&str, &[u8]); 3] =
        [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), ("wall.png", &png())];
    let scene = load(&files, None).unwrap();
    let primitive = scene.primitive(&scene.draws[0]);
    let material = &scene.materials[primitive.material];
    assert_eq!(material.base_color.to_array(), [0.5, 0.25, 0.125, 0.5]);
    assert_eq!(material.alpha_mode, AlphaMode::Blend);
    assert!((0.3..0.45).contains(&material.roughness), "{}", material.roughness);
    assert_eq!(scene.images.len(), 1);
    assert_eq!(primitive.vertices[0].uv0, [0.25, 0.25], "V is turned around");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn what_the_mtl_lacks_costs_a_warning() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wall\nf 1 2 3\n";
    for (mtl, word) in [
        (None, "does not exist"),
        (Some("newmtl wall\nmap_Kd gone.png\n"), "gone.png"),
        (Some("newmtl wall\nmap_Kd ../a.png\n"), "outside"),
        (Some("newmtl wall\nmap_Kd a.obj\n"), "neither PNG nor JPEG"),
        (Some("newmtl wall\nKd one two\n"), "not a valid MTL"),
    ] {
        let obj = format!("mtllib a.mtl\n{triangle}");
        let mut files: Vec<(&str, &[u8])> = vec![("a.obj", obj.as_bytes())];
        files.extend(mtl.map(|text| ("a.mtl", text.as_bytes())));
        let scene = load(&files, None).unwrap();
        assert_eq!(scene.draws.len(), 1);
        assert!(scene.warnings.iter().any(|w| w.contains(word)), "'{word}' is not in {:?}", scene.warnings);
    }
}

#[test]
fn the_texture_of_the_caller_is_used_or_refused() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    let scene = load(&[("a.obj", obj.as_bytes()), ("skin.png", &png())], Some("skin.png")).unwrap();
    let material = &scene.materials[scene.primitive(&scene.draws[0]).material];
    assert_eq!(material.base_color_texture.map(|u| u.texture), Some(0));
    for bad in [&b""[..], b"GIF89a", &png()[..30]] {
        let error = load(&[("a.obj", obj.as_bytes()), ("skin.png", bad)], Some("skin.png")).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("skin.png"), "{error}");
    }
    assert!(load(&[("a.obj", obj.as_bytes())], Some("gone.png")).is_err());
}

#[test]
fn broken_files_are_errors() {
    for text in [
        "",
        "v 0 0 0\n",
        "v 0 0\nf 1 1 1\n",
        "v 0 0 zero\n",
        "f 1 2 3\n",
        "v 0 0 0\nf 1 2 3\n",
        "v 0 0 0\nf -1 -2 -3\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 99999999999999999999 2 3\n",
        "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        "\u{0}\u{1}\u{2}",
        "solid not an obj\n",
    ] {
        let error = load_bytes("a.obj", text.as_bytes()).map(|_| ()).expect_err(text);
        assert_eq!(error.exit_code(), 2, "{text:?}: {error}");
        assert_eq!(error.to_string().lines().count(), 1, "{text:?}: {error}");
    }
    assert!(Scene::load(Path::new("/nonexistent/a.obj"), None).is_err());
}

#[test]
fn files_cut_off_anywhere_do_not_panic() {
    let text = format!(
        "mtllib a.mtl\no box\ng side\ns 1\nvn 0 0 1\nvt 0 0 0\n{CUBE}f 1/1/1 2/1/1 3/1/1 4/1/1\nl 1 2\np 1\n"
    );
    for length in 0..text.len() {
        if let Err(error) = load_bytes("a.obj", &text.as_bytes()[..length]) {
            assert_eq!(error.exit_code(), 2);
        }
    }
}
