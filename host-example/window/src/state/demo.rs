//! The scene that comes with the program: a still life, made here, so that a machine without any files has something to try
//! looks on. Round and flat shapes, fine pattern, dark and light: what styles are judged by.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3, Vec4};

use isophote_files::error::Result;
use isophote_scene::animation::hermite;
use isophote_scene::geometry::smooth_normals;
use isophote_scene::{Image, Material, Mesh, Primitive, Sampler, Scene, Texture, TextureUse, Vertex};

/// Corners around a turned shape.
const AROUND: u32 = 72;
/// Faces that meet at more than this keep a sharp edge, in radians.
const CREASE: f32 = 0.7;
/// Side of the pattern of the cloth in texels.
const CLOTH: u32 = 512;

/// By how much the scene is turned to be seen nearly from the front, in radians.
const TOWARDS: f32 = 0.42;

/// Materials of things.
#[derive(Clone, Copy)]
enum Stuff {
    Cloth,
    Glaze,
    Clay,
    Apple,
    Lemon,
    Leaf,
    Wood,
    Paper,
    Red,
    Teal,
    Brass,
    Wall,
    Table,
}

/// Makes the scene.
///
/// # Errors
/// As [`Scene::assembled`].
pub fn scene() -> Result<Scene> {
    let mut meshes = vec![
        slab("cloth", Stuff::Cloth, Vec3::new(0.0, -0.03, 0.1), Vec3::new(3.1, 0.06, 2.1), 0.0),
        slab("wall", Stuff::Wall, Vec3::new(0.0, 1.9, -2.1), Vec3::new(30.0, 12.0, 0.1), 0.0),
        slab("table", Stuff::Table, Vec3::new(0.0, -0.12, 2.9), Vec3::new(30.0, 0.12, 9.9), 0.0),
        slab("board", Stuff::Wood, Vec3::new(0.62, 0.03, 0.42), Vec3::new(1.1, 0.05, 0.62), 0.22),
    ];
    meshes.extend(pottery());
    meshes.extend(books());
    meshes.extend(fruit());
    let materials = materials();
    let textures = vec![Texture { image: Some(0), sampler: Sampler::default() }];
    // They fill the picture and need not be seen whole.
    let behind = ["wall", "table"];
    Scene::assembled("Demo", meshes, &behind, materials, textures, vec![cloth()])
}

/// Outline of the jug: distances from its axis and heights.
const JUG: [(f32, f32); 13] = [
    (0.0, 0.0),
    (0.24, 0.0),
    (0.30, 0.06),
    (0.40, 0.26),
    (0.42, 0.42),
    (0.36, 0.62),
    (0.24, 0.80),
    (0.19, 0.92),
    (0.20, 1.02),
    (0.26, 1.10),
    (0.23, 1.10),
    (0.17, 1.00),
    (0.16, 0.90),
];

/// Band around the jug.
const BAND: [(f32, f32); 4] = [(0.425, 0.36), (0.436, 0.38), (0.436, 0.44), (0.425, 0.46)];

/// Outline of the bowl.
const BOWL: [(f32, f32); 9] = [
    (0.0, 0.03),
    (0.16, 0.0),
    (0.18, 0.04),
    (0.34, 0.14),
    (0.44, 0.28),
    (0.47, 0.31),
    (0.43, 0.29),
    (0.32, 0.17),
    (0.0, 0.10),
];

/// Outline of the bottle.
const BOTTLE: [(f32, f32); 11] = [
    (0.0, 0.0),
    (0.17, 0.0),
    (0.19, 0.03),
    (0.19, 0.70),
    (0.15, 0.86),
    (0.07, 0.96),
    (0.06, 1.30),
    (0.08, 1.31),
    (0.08, 1.37),
    (0.05, 1.37),
    (0.0, 1.36),
];

/// Outline of the candlestick.
const STICK: [(f32, f32); 11] = [
    (0.0, 0.0),
    (0.20, 0.0),
    (0.21, 0.03),
    (0.10, 0.06),
    (0.04, 0.12),
    (0.04, 0.30),
    (0.07, 0.34),
    (0.04, 0.38),
    (0.09, 0.42),
    (0.10, 0.46),
    (0.0, 0.44),
];

/// Outline of the candle.
const CANDLE: [(f32, f32); 5] = [(0.0, 0.44), (0.055, 0.44), (0.055, 0.80), (0.03, 0.82), (0.0, 0.81)];

/// Jug, bowl, bottle and candlestick.
fn pottery() -> Vec<Mesh> {
    let mut handle = tube("handle", Stuff::Glaze, Vec3::new(-0.62, 0.66, -0.32), 0.28, 0.045);
    handle.name = "handle".into();
    vec![
        turned("jug", Stuff::Glaze, Vec3::new(-0.62, 0.0, -0.32), &JUG),
        turned("band", Stuff::Paper, Vec3::new(-0.62, 0.0, -0.32), &BAND),
        handle,
        turned("bowl", Stuff::Clay, Vec3::new(-0.12, 0.0, 0.42), &BOWL),
        turned("bottle", Stuff::Teal, Vec3::new(0.22, 0.0, -0.62), &BOTTLE),
        turned("candlestick", Stuff::Brass, Vec3::new(1.16, 0.0, -0.28), &STICK),
        turned("candle", Stuff::Paper, Vec3::new(1.16, 0.0, -0.28), &CANDLE),
    ]
}

/// A small pile.
fn books() -> Vec<Mesh> {
    let at = |height: f32| Vec3::new(0.72, height, -0.52);
    vec![
        slab("book", Stuff::Red, at(0.07), Vec3::new(0.72, 0.14, 0.5), -0.12),
        slab("pages", Stuff::Paper, at(0.07) + Vec3::new(0.02, 0.0, 0.02), Vec3::new(0.71, 0.10, 0.5), -0.12),
        slab("upper book", Stuff::Wood, at(0.19), Vec3::new(0.58, 0.10, 0.44), 0.18),
    ]
}

/// Apples, lemons and leaves.
fn fruit() -> Vec<Mesh> {
    let apple = [
        (0.0, 0.03),
        (0.06, 0.0),
        (0.13, 0.03),
        (0.18, 0.11),
        (0.19, 0.19),
        (0.16, 0.27),
        (0.09, 0.31),
        (0.04, 0.29),
        (0.0, 0.26),
    ];
    let lemon = [
        (0.0, 0.0),
        (0.05, 0.02),
        (0.10, 0.06),
        (0.13, 0.12),
        (0.13, 0.17),
        (0.10, 0.22),
        (0.05, 0.26),
        (0.02, 0.29),
        (0.0, 0.29),
    ];
    let stem = [(0.0, 0.25), (0.012, 0.25), (0.018, 0.37), (0.0, 0.38)];
    let mut all = Vec::new();
    for (name, place) in [
        ("apple", Vec3::new(-0.24, 0.14, 0.36)),
        ("second apple", Vec3::new(0.04, 0.14, 0.40)),
        ("third apple", Vec3::new(0.42, 0.05, 0.36)),
    ] {
        all.push(turned(name, Stuff::Apple, place, &apple));
        all.push(turned("stem", Stuff::Wood, place, &stem));
    }
    for (name, place) in [
        ("lemon", Vec3::new(-0.10, 0.16, 0.58)),
        ("second lemon", Vec3::new(0.86, 0.05, 0.44)),
        ("third lemon", Vec3::new(-0.86, 0.0, 0.56)),
    ] {
        all.push(turned(name, Stuff::Lemon, place, &lemon));
    }
    for (turn, place) in [(0.4, Vec3::new(0.46, 0.42, 0.36)), (2.2, Vec3::new(-0.24, 0.50, 0.36))] {
        all.push(leaf(turn, place));
    }
    all
}

fn materials() -> Vec<Material> {
    let plain = |name: &str, color: [f32; 3], roughness: f32, metallic: f32| Material {
        name: name.to_owned(),
        base_color: Vec3::from(color).extend(1.0),
        roughness,
        metallic,
        ..Material::default()
    };
    let cloth =
        Material { base_color_texture: Some(TextureUse::plain(0)), ..plain("cloth", [1.0; 3], 0.95, 0.0) };
    vec![
        cloth,
        plain("glaze", [0.09, 0.20, 0.46], 0.22, 0.0),
        plain("clay", [0.52, 0.21, 0.10], 0.75, 0.0),
        plain("apple", [0.55, 0.045, 0.035], 0.35, 0.0),
        plain("lemon", [0.86, 0.58, 0.05], 0.5, 0.0),
        plain("leaf", [0.10, 0.26, 0.05], 0.6, 0.0),
        plain("wood", [0.30, 0.15, 0.07], 0.7, 0.0),
        plain("paper", [0.82, 0.77, 0.66], 0.85, 0.0),
        plain("red", [0.40, 0.06, 0.05], 0.6, 0.0),
        plain("teal", [0.02, 0.16, 0.13], 0.12, 0.0),
        plain("brass", [0.72, 0.49, 0.19], 0.3, 1.0),
        plain("wall", [0.46, 0.47, 0.44], 0.95, 0.0),
        plain("table", [0.24, 0.13, 0.075], 0.55, 0.0),
    ]
}

/// A checked cloth with a border.
fn cloth() -> Image {
    let mut rgba = Vec::with_capacity((CLOTH * CLOTH * 4) as usize);
    for y in 0..CLOTH {
        for x in 0..CLOTH {
            let stripe = |at: u32| u32::from((at / 32).is_multiple_of(2)) + u32::from(at / 8 % 8 == 6);
            let dark = stripe(x) + stripe(y);
            let color: [u8; 3] = match dark {
                0 => [236, 228, 210],
                1 => [214, 196, 176],
                2 => [186, 118, 104],
                3 => [150, 70, 66],
                _ => [120, 48, 50],
            };
            rgba.extend(color);
            rgba.push(255);
        }
    }
    Image { name: "cloth".into(), width: CLOTH, height: CLOTH, rgba }
}

fn mesh(name: &str, stuff: Stuff, vertices: Vec<Vertex>, indices: Vec<u32>) -> Mesh {
    let material = stuff as usize;
    let mut primitive = Primitive { vertices, indices, material, ..Primitive::default() };
    smooth_normals(&mut primitive, CREASE);
    Mesh { name: name.to_owned(), primitives: vec![primitive], weights: Vec::new() }
}

/// A vertex, turned towards the default camera with everything else.
fn vertex(position: Vec3, uv: Vec2) -> Vertex {
    let position = Quat::from_rotation_y(TOWARDS) * position;
    Vertex {
        position: position.to_array(),
        uv0: uv.to_array(),
        color: Vec4::ONE.to_array(),
        ..Vertex::default()
    }
}

/// Indices of a grid whose rows follow one another, each of `columns` cells.
fn grid(rows: u32, columns: u32) -> Vec<u32> {
    let cell = |row: u32, column: u32| {
        let [a, b] = [row, row + 1].map(|row| row * (columns + 1) + column);
        [a, b, b + 1, a, b + 1, a + 1]
    };
    (0..rows).flat_map(|row| (0..columns).flat_map(move |column| cell(row, column))).collect()
}

/// A shape as a potter makes it: its outline from the bottom to the top, radius and height, made smooth.
fn turned(name: &str, stuff: Stuff, place: Vec3, outline: &[(f32, f32)]) -> Mesh {
    let points = smooth(outline);
    let mut vertices = Vec::new();
    for (row, point) in points.iter().enumerate() {
        for column in 0..=AROUND {
            let (sine, cosine) = (TAU * (column % AROUND) as f32 / AROUND as f32).sin_cos();
            let position = Vec3::new(point.x * sine, point.y, point.x * cosine);
            let uv = Vec2::new(column as f32 / AROUND as f32, row as f32 / points.len() as f32);
            vertices.push(vertex(place + position, uv));
        }
    }
    let indices = grid(points.len() as u32 - 1, AROUND);
    // Rows go upwards, so that cells wind the other way around.
    mesh(name, stuff, vertices, indices.chunks(3).flat_map(|c| [c[0], c[2], c[1]]).collect())
}

/// Points on a spline through those given.
fn smooth(outline: &[(f32, f32)]) -> Vec<Vec2> {
    const STEPS: usize = 5;
    let at = |index: isize| {
        let (x, y) = outline[index.clamp(0, outline.len() as isize - 1) as usize];
        Vec2::new(x, y)
    };
    let mut points = Vec::new();
    for index in 0..outline.len() as isize - 1 {
        let [a, b, c, d] = [-1, 0, 1, 2].map(|offset| at(index + offset));
        for step in 0..STEPS {
            let [first, leaving, second, arriving] = hermite(step as f32 / STEPS as f32);
            // Slopes are those between the neighbours.
            let curve = b * first + (c - a) * 0.5 * leaving + c * second + (d - b) * 0.5 * arriving;
            points.push(curve.max(Vec2::new(0.0, f32::MIN)));
        }
    }
    points.push(at(outline.len() as isize - 1));
    points
}

/// A box, turned about the vertical by an angle in radians.
fn slab(name: &str, stuff: Stuff, middle: Vec3, size: Vec3, turn: f32) -> Mesh {
    let (sine, cosine) = turn.sin_cos();
    let turned = |p: Vec3| Vec3::new(p.x * cosine + p.z * sine, p.y, p.z * cosine - p.x * sine);
    let mut vertices = Vec::new();
    let mut indices = Vec::new();
    for (normal, across) in [
        (Vec3::X, Vec3::NEG_Z),
        (Vec3::NEG_X, Vec3::Z),
        (Vec3::Y, Vec3::X),
        (Vec3::NEG_Y, Vec3::X),
        (Vec3::Z, Vec3::X),
        (Vec3::NEG_Z, Vec3::NEG_X),
    ] {
        let up = normal.cross(across);
        let first = vertices.len() as u32;
        for (x, y) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
            let place = (normal * 0.5 + across * x + up * y) * size;
            vertices.push(vertex(middle + turned(place), Vec2::new(x + 0.5, 0.5 - y)));
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    mesh(name, stuff, vertices, indices)
}

/// Half a ring, as the handle of a jug: standing at its left.
fn tube(name: &str, stuff: Stuff, middle: Vec3, radius: f32, thickness: f32) -> Mesh {
    const ALONG: u32 = 28;
    const SIDES: u32 = 14;
    let mut vertices = Vec::new();
    for row in 0..=ALONG {
        let angle = TAU * (0.2 + 0.6 * row as f32 / ALONG as f32);
        let out = Vec3::new(angle.cos() * 1.1, angle.sin(), 0.0);
        for column in 0..=SIDES {
            let (sine, cosine) = (TAU * (column % SIDES) as f32 / SIDES as f32).sin_cos();
            let position =
                Vec3::NEG_X * 0.24 + out * (radius + thickness * cosine) + Vec3::Z * thickness * sine;
            vertices.push(vertex(middle + position, Vec2::ZERO));
        }
    }
    mesh(name, stuff, vertices, grid(ALONG, SIDES))
}

/// A pointed leaf that bends down, seen from both sides.
fn leaf(turn: f32, place: Vec3) -> Mesh {
    const ALONG: u32 = 10;
    let (sine, cosine) = turn.sin_cos();
    let mut vertices = Vec::new();
    for row in 0..=ALONG {
        let t = row as f32 / ALONG as f32;
        let width = 0.055 * (t * (1.0 - t) * 4.0).sqrt();
        for side in [-1.0, 0.0, 1.0] {
            let (x, z) = (t * 0.24, side * width);
            let y = 0.05 * (t * 3.0).sin() + 0.02 * side * side;
            vertices
                .push(vertex(place + Vec3::new(x * cosine - z * sine, y, x * sine + z * cosine), Vec2::ZERO));
        }
    }
    let front = grid(ALONG, 2);
    let back: Vec<u32> = front.chunks(3).flat_map(|c| [c[0], c[2], c[1]]).collect();
    let behind = vertices.len() as u32;
    let mut all = vertices.clone();
    all.extend(vertices);
    mesh("leaf", Stuff::Leaf, all, front.into_iter().chain(back.into_iter().map(|i| i + behind)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_a_scene() {
        let scene = scene().unwrap();
        assert!(scene.draws.len() > 15 && scene.warnings.is_empty());
        let size = scene.bounds.max - scene.bounds.min;
        assert!(size.is_finite() && size.x > 3.0 && size.y > 1.0, "{size}");
        for mesh in &scene.meshes {
            let primitive = &mesh.primitives[0];
            assert!(primitive.material < scene.materials.len());
            let count = primitive.vertices.len() as u32;
            assert!(primitive.indices.iter().all(|index| *index < count), "{}", mesh.name);
        }
    }
}
