//! OBJ files, whole and broken.

use std::fs;
use std::path::Path;

use glam::Vec3;

use super::build::{load_bytes, png};
use crate::{AlphaMode, Scene};
use isophote_files::error::Result;

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
        (Some("newmtl wall\nmap_Kd a.obj\n"), "of unknown format"),
        (Some("newmtl wall\nKd one two\n"), "a.mtl, line 2: Kd 'one' is not a number"),
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

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn grey_colours_have_one_value() {
    let obj = format!("mtllib a.mtl\n{TRIANGLE}usemtl wall\nf 1 2 3\n");
    let mtl =
        "newmtl wall\nKa 1\nKs 0.5 # grey\nKd 0.25\nKe\t0.5\nillum 2.0\nmap_Kd\nd -halo 0.5\nNs \\\n 100\n";
    let scene = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())], None).unwrap();
    let material = &scene.materials[scene.primitive(&scene.draws[0]).material];
    assert_eq!(material.base_color.to_array(), [0.25, 0.25, 0.25, 0.5]);
    assert_eq!(material.emissive, Vec3::splat(0.5));
    assert!(material.roughness < 0.45);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn statements_of_the_mtl_that_cannot_be_read_are_left_out_alone() {
    let obj = format!("mtllib a.mtl\n{TRIANGLE}usemtl wall\nf 1 2 3\n");
    let mtl =
        "newmtl wall\nKs spectral file.rfl 1\nKd 0.5 0.25\nKe xyz 1 1 1\nKa\nd half\nNs\nKd 0.5 0.25 0.125\n";
    let scene = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())], None).unwrap();
    let material = &scene.materials[scene.primitive(&scene.draws[0]).material];
    assert_eq!(material.base_color.to_array(), [0.5, 0.25, 0.125, 1.0]);
    let expected = [
        "line 2: Ks is given as spectral",
        "line 3: Kd takes 1 or 3 numbers, not 2",
        "line 4: Ke is given as xyz",
        "line 5: Ka takes 1 or 3 numbers, not 0",
        "line 6: d 'half' is not a number",
        "line 7: Ns takes a number",
    ];
    assert_eq!(scene.warnings.len(), expected.len(), "{:?}", scene.warnings);
    for (warning, words) in scene.warnings.iter().zip(expected) {
        assert!(warning.starts_with(&format!("a.mtl, {words}")), "{warning}");
    }
}

#[test]
fn materials_without_a_name_are_materials() {
    let obj = format!("mtllib a.mtl\n{TRIANGLE}usemtl\nf 1 2 3\nusemtl\twall\nf 1 2 3\n  usemtl \nf 1 2 3\n");
    let colors = |mtl: &str| -> Vec<f32> {
        let scene = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())], None).unwrap();
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        scene.draws.iter().map(|d| scene.materials[scene.primitive(d).material].base_color.x).collect()
    };
    let plain = 0.45;
    assert_eq!(colors("newmtl wall\nKd 1 0 0\n"), [plain, 1.0, plain]);
    assert_eq!(colors("newmtl\nKd 0.75 0 0\nnewmtl wall\nKd 1 0 0\n"), [0.75, 1.0, 0.75]);
}

#[test]
fn one_statement_may_name_several_libraries() {
    let obj = format!("mtllib a.mtl 100%.mtl\n{TRIANGLE}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
    let files: [(&str, &[u8]); 3] = [
        ("a.obj", obj.as_bytes()),
        ("a.mtl", b"newmtl a\nKd 1 0 0\n"),
        ("100%.mtl", b"newmtl b\nKd 0.5 0 0\n"),
    ];
    let scene = load(&files, None).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let red = |draw: usize| scene.materials[scene.primitive(&scene.draws[draw]).material].base_color.x;
    assert_eq!((red(0), red(1)), (1.0, 0.5));
}

#[test]
fn vertices_without_a_colour_are_white_among_coloured_ones() {
    for (obj, colors) in [
        ("v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n", [[1.0; 3], [1.0, 0.0, 0.0], [1.0; 3]]),
        (
            "v 0 0 0 0 1 0\nv 1 0 0 # plain\nv 0 1 0 0 0 1 0.5\nf 1 2 3\n",
            [[0.0, 1.0, 0.0], [1.0; 3], [0.0, 0.0, 1.0]],
        ),
    ] {
        let scene = load_bytes("a.obj", obj.as_bytes()).unwrap();
        let vertices = &scene.primitive(&scene.draws[0]).vertices;
        let found: Vec<[f32; 4]> = vertices.iter().map(|v| v.color).collect();
        assert_eq!(found, colors.map(|[r, g, b]| [r, g, b, 1.0]));
    }
}

#[test]
fn colours_of_vertices_are_srgb_and_take_the_place_of_grey() {
    let scene = load_bytes("a.obj", b"v 0 0 0 0.5 0.5 0.5\nv 1 0 0 0 0 0\nv 0 1 0 1 1 1\nf 1 2 3\n").unwrap();
    let primitive = scene.primitive(&scene.draws[0]);
    assert!((primitive.vertices[0].color[0] - 0.214).abs() < 1e-3, "{:?}", primitive.vertices[0].color);
    assert_eq!(scene.materials[primitive.material].base_color.to_array(), [1.0; 4]);
}

#[test]
fn texts_of_old_and_other_systems_are_read() {
    let text = "mtllib \u{e4}.mtl\rv 0 0 0\rv 1 0 0\rv 0 1 0\rusemtl gr\u{fc}n\rf 1 2 3\r";
    let mtl = "newmtl gr\u{fc}n\rKd 0 0.5 0\r";
    let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    let latin = |text: &str| text.chars().map(|c| c as u8).collect::<Vec<u8>>();
    let utf8 = |text: &str| text.as_bytes().to_vec();
    for (obj, mtl) in [(wide(text), utf8(mtl)), (latin(text), wide(mtl)), (utf8(text), latin(mtl))] {
        let scene = load(&[("a.obj", &obj), ("\u{e4}.mtl", &mtl)], None).unwrap();
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        let material = &scene.materials[scene.primitive(&scene.draws[0]).material];
        assert_eq!(material.base_color.to_array(), [0.0, 0.5, 0.0, 1.0]);
    }
}

#[test]
fn metals_emission_and_normals_come_from_the_mtl() {
    let obj = format!("mtllib a.mtl\n{TRIANGLE}vt 0 0\nusemtl wall\nf 1/1 2/1 3/1\n");
    let mtl = "newmtl wall\nPm 1\nPr 0.3\nmap_Ke glow.png\nmap_Bump -bm 0.5 bumps.png\nmap_Pr glow.png # a comment\n";
    let bumps = {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let image = image::RgbImage::from_pixel(2, 2, image::Rgb([128, 128, 255]));
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    };
    let files: [(&str, &[u8]); 4] =
        [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), ("glow.png", &png()), ("bumps.png", &bumps)];
    let scene = load(&files, None).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let material = &scene.materials[scene.primitive(&scene.draws[0]).material];
    assert_eq!((material.metallic, material.roughness, material.normal_scale), (1.0, 0.3, 0.5));
    assert_eq!(material.emissive, Vec3::ONE);
    assert!(material.emissive_texture.is_some() && material.normal_texture.is_some());
    let rough = material.metallic_roughness_texture.expect("a texture of roughness");
    let image = &scene.images[scene.textures[rough.texture].image.unwrap()];
    assert_eq!(image.rgba[..4], [255, 1, 255, 255], "roughness is the luminance of the map");
}

#[test]
fn heights_become_normals() {
    let obj = format!("mtllib a.mtl\n{TRIANGLE}vt 0 0\nvt 1 0\nvt 0 1\nusemtl wall\nf 1/1 2/2 3/3\n");
    for (options, [right, up]) in
        [("", [-1, 1]), ("-bm 0", [0, 0]), ("-bm 8 -mm 0 0.5", [-1, 1]), ("-imfchan b", [1, 0])]
    {
        let mtl = format!("newmtl wall\nmap_Bump -clamp on {options} heights.png\n");
        // It rises to the right and down, but blue falls to the right.
        let heights = image::RgbImage::from_fn(16, 16, |x, y| {
            let height = (x * 6 + y * 9) as u8;
            image::Rgb([height, height, 200 - x as u8 * 8])
        });
        let mut bytes = std::io::Cursor::new(Vec::new());
        heights.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let files: [(&str, &[u8]); 3] =
            [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), ("heights.png", bytes.get_ref())];
        let scene = load(&files, None).unwrap();
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        let primitive = scene.primitive(&scene.draws[0]);
        let use_ = scene.materials[primitive.material].normal_texture.expect("a texture of normals");
        let image = &scene.images[scene.textures[use_.texture].image.unwrap()];
        let [r, g, b, a] = image.rgba.as_chunks::<4>().0[8 * 16 + 8].map(i32::from);
        assert_eq!([(r - 128).signum(), (g - 128).signum()], [right, up], "{options}: {r} {g} {b}");
        assert!(b > 240 && a == 255, "{options}: {b}");
    }
}

#[test]
fn smoothing_groups_reach_into_other_materials() {
    let roof =
        "v -1 0 0\nv 0 0 0\nv 0 0 1\nv -1 0 1\nv 0 -1 0\nv 0 -1 1\nS\nf 1 4 3 2\nusemtl b\nf 2 3 6 5\n";
    for (statement, smooth) in [("s 7", true), ("s off", false), ("# s 7", false)] {
        let mtl: &[u8] = b"newmtl b\nKd 1 0 0\n";
        let obj = format!("mtllib a.mtl\n{}", roof.replace('S', statement));
        let scene = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)], None).unwrap();
        assert_eq!(scene.draws.len(), 2);
        for draw in &scene.draws {
            let ridge = scene.primitive(draw).vertices.iter().find(|v| v.position == [0.0; 3]).unwrap();
            let bent =
                Vec3::from(ridge.normal).abs_diff_eq(Vec3::new(0.5f32.sqrt(), 0.5f32.sqrt(), 0.0), 1e-4);
            assert_eq!(bent, smooth, "{statement}: {:?}", ridge.normal);
        }
    }
}

#[test]
fn normals_of_the_file_stay_beside_those_that_are_computed() {
    let obj = format!("{TRIANGLE}v 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1 3 4\n");
    let scene = load_bytes("a.obj", obj.as_bytes()).unwrap();
    let primitive = scene.primitive(&scene.draws[0]);
    let normal = |slot: usize| primitive.vertices[primitive.indices[slot] as usize].normal;
    assert_eq!([normal(0), normal(1), normal(2)], [[0.0, 1.0, 0.0]; 3]);
    assert_eq!([normal(3), normal(4), normal(5)], [[1.0, 0.0, 0.0]; 3]);
}

#[test]
fn statements_go_on_after_a_backslash() {
    let obj = "v 0 0 0\nv 1 0 \\\n0\nv 0 1 0\r\nv 1 1 0\nf 1 \\\r\n 2 4 \\\n 3\n";
    let scene = load_bytes("a.obj", obj.as_bytes()).unwrap();
    assert_eq!(scene.primitive(&scene.draws[0]).indices.len(), 6);
}

#[test]
fn corners_keep_their_own_texture_coordinates() {
    let obj = format!("{TRIANGLE}v 0 0 1\nvt 0.25\nvt 0.5 0.75 0\nf 4 1/1 2/2\nf 1/1 2/2 3/2\n");
    let scene = load_bytes("a.obj", obj.as_bytes()).unwrap();
    for vertex in &scene.primitive(&scene.draws[0]).vertices {
        let expected = match vertex.position {
            [0.0, 0.0, 1.0] => [0.0, 0.0],
            [0.0, 0.0, 0.0] => [0.25, 1.0],
            _ => [0.5, 0.25],
        };
        assert_eq!(vertex.uv0, expected, "at {:?}", vertex.position);
    }
}

#[test]
fn lines_are_no_faces() {
    let scene = load_bytes("a.obj", format!("{TRIANGLE}l 1 2 3\nf 1 2 3\np 1 2 3\n").as_bytes()).unwrap();
    assert_eq!(scene.primitive(&scene.draws[0]).indices.len(), 3);
}

#[test]
fn faults_are_found_by_their_line() {
    for (text, words) in [
        ("v 0 0 0\n\nv 0 zero 0\nf 1 1 1\n", "line 3: v takes numbers, but 'zero' is not a number"),
        ("v 0 0 0\nf 1 2 3\n", "line 2: f has the corner '2', whose index 2 is not one of 1"),
        ("vn 1 2\n", "line 1: vn has 2 of at least 3 numbers"),
    ] {
        let error = load_bytes("a.obj", text.as_bytes()).map(|_| ()).expect_err(text).to_string();
        assert!(error.contains(words), "'{words}' is not in '{error}'");
    }
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
