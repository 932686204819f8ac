//! Places of everything in the city.

use super::elements::{fluted_column, smooth_column};
use super::houses::House;
use super::materials::{Material, Model};
use super::mesh::Mesh;
use super::nature::{TOWN, ground_height};
use super::square::{CENTRE_Z, LEVEL};
use super::writer::{Node, Writer};
use super::{life, market, nature, square, temple};
use glam::{Mat4, Quat, Vec2, Vec3};

/// The middle of the temple.
const TEMPLE: Vec3 = Vec3::new(-2.6, 0.0, -11.0);

/// Trees that stand in the square.
const PLANTERS: [Vec3; 2] = [Vec3::new(-5.2, LEVEL, 19.3), Vec3::new(-12.4, LEVEL, 25.6)];

/// True where a place lies outside of the town.
fn is_outside(x: f32, z: f32) -> bool {
    Vec2::new(x, z).length() > TOWN - 4.0
}

/// A model of one mesh.
fn single(material: Material, mesh: Mesh) -> Model {
    let mut model = Model::default();
    *model.part(material) = mesh;
    model
}

/// The house that is also written as OBJ: two storeys, a balcony and an outside stair.
pub fn corner_house() -> Model {
    House {
        size: Vec2::new(8.4, 6.4),
        storeys: 2,
        plaster: Material::PlasterOchre,
        dado: Material::PlasterRed,
        shutters: Material::PaintedWood,
        seed: 5,
        detailed: true,
        balcony: true,
        outside_stair: true,
    }
    .build()
}

/// Adds the whole city.
pub fn city(writer: &mut Writer) {
    land(writer);
    temple_precinct(writer);
    square_and_market(writer);
    houses(writer);
    trees(writer);
    life::camera(writer);
    life::birds(writer, &[(Vec3::new(6.0, 10.5, 2.0), 4.5), (Vec3::new(-9.0, 13.5, -4.0), 6.5)]);
}

/// Ground, surroundings and the sun.
fn land(writer: &mut Writer) {
    let mesh = writer.model("land", &nature::land());
    writer.place("land", mesh, Vec3::ZERO, 0.0);
    let mesh = writer.model("surroundings", &nature::surroundings());
    writer.root(Node { name: "surroundings".into(), mesh: Some(mesh), backdrop: true, ..Node::default() });
    let mesh = writer.model("pavement", &square::pavement());
    writer.place("pavement", mesh, Vec3::ZERO, 0.0);
    // About 35 degrees high, from the left: it grazes the front of the temple and models its flutes.
    let from = Vec3::new(-0.66, 0.62, 0.60).normalize();
    let sun = writer.light("sun", "directional", Vec3::new(1.0, 0.90, 0.74), 4.6, None);
    writer.root(Node {
        name: "sun".into(),
        translation: from * 60.0,
        rotation: Quat::from_rotation_arc(Vec3::NEG_Z, -from),
        light: Some(sun),
        ..Node::default()
    });
}

/// The temple, its columns, masts and brazier.
fn temple_precinct(writer: &mut Writer) {
    let mesh = writer.model("temple", &temple::temple());
    writer.place("temple", mesh, TEMPLE, 0.0);
    let column = writer.model("fluted column", &single(Material::Marble, fluted_column(temple::COLUMN)));
    for place in temple::columns() {
        writer.place("column", column, TEMPLE + place, 0.0);
    }
    let height = 7.6;
    let mast = writer.model("mast", &market::mast(height));
    let mastheads: Vec<(Vec3, f32)> = [(-12.3, 3.6), (6.6, 3.6)]
        .into_iter()
        .map(|(x, z)| {
            let foot = Vec3::new(x, LEVEL, z);
            writer.place("mast", mast, foot, 0.0);
            (foot + Vec3::Y * (height - 0.75), 12.0)
        })
        .collect();
    life::pennants(writer, &mastheads);
    let brazier = writer.model("brazier", &market::brazier());
    let place = Vec3::new(2.6, LEVEL, 4.6);
    writer.place("brazier", brazier, place, 0.0);
    life::fire(writer, place + Vec3::Y * 1.3);
}

/// The furniture of the square.
fn square_and_market(writer: &mut Writer) {
    let fountain = writer.model("fountain", &square::fountain());
    writer.root(Node {
        name: "fountain".into(),
        translation: Vec3::new(9.0, LEVEL, 15.5),
        scale: 0.86,
        mesh: Some(fountain),
        ..Node::default()
    });
    let planter = writer.model("planter", &square::planter());
    for place in PLANTERS {
        writer.place("planter", planter, place, 0.0);
    }
    let statue = writer.model("statue", &square::statue());
    writer.place("statue", statue, Vec3::new(-8.6, LEVEL, 12.4), 24.0);
    let stall = writer.model("market stall", &market::stall());
    writer.place("market stall", stall, Vec3::new(12.4, LEVEL, 10.2), -58.0);
    writer.place("market stall", stall, Vec3::new(-13.0, LEVEL, 19.0), 75.0);
    let vase = writer.model("painted vase", &market::painted_vase());
    for x in [-5.6, 0.4] {
        writer.place("painted vase", vase, Vec3::new(x, LEVEL, 4.3), 0.0);
    }
    let amphora = market::amphora();
    let mut jars = Model::default();
    for (index, (x, z)) in [(0.0, 0.0), (0.6, 0.15), (0.25, 0.55)].into_iter().enumerate() {
        jars.place(&amphora, Vec3::new(x, 0.0, z), index as f32 * 40.0);
    }
    let fallen = Mat4::from_translation(Vec3::new(-0.5, 0.25, 0.8))
        * Mat4::from_rotation_y(0.5)
        * Mat4::from_rotation_z(1.5);
    jars.append(&amphora, fallen);
    let jars = writer.model("amphoras", &jars);
    writer.place("amphoras", jars, Vec3::new(10.0, LEVEL, 12.9), 0.0);
    writer.place("amphoras", jars, Vec3::new(-11.2, LEVEL, 21.4), 160.0);
    let gate = writer.model("gate", &square::gate());
    writer.place("gate", gate, Vec3::new(11.2, 0.0, -16.0), 0.0);
    let wall = writer.model("town wall", &square::town_wall(12.6));
    writer.place("town wall", wall, Vec3::new(14.9, 0.0, -16.0), 0.0);
    let length = 22.0;
    let portico = writer.model("portico", &square::portico(length));
    let place = Vec3::new(-18.4, 0.0, CENTRE_Z - 1.5);
    writer.place("portico", portico, place, 90.0);
    let column = writer.model("smooth column", &single(Material::Marble, smooth_column(4.0, 0.27)));
    for foot in square::portico_columns(length) {
        let turned = Quat::from_rotation_y(90.0_f32.to_radians()) * foot;
        writer.place("column", column, place + turned, 0.0);
    }
}

/// Houses about the square and on the slope behind.
fn houses(writer: &mut Writer) {
    let corner = writer.model("corner house", &corner_house());
    writer.place("corner house", corner, Vec3::new(18.8, 0.0, 1.0), -82.0);
    life::banner(writer, Vec3::new(15.0, 5.6, 12.2), -90.0);
    near_houses(writer);
    far_houses(writer);
}

/// The houses about the square, each of which is modelled for itself.
fn near_houses(writer: &mut Writer) {
    use Material::{PaintedWood, PlasterOchre, PlasterRed, PlasterRose, PlasterWhite, Wood};
    let near = [
        (
            Vec3::new(19.2, 0.0, 12.0),
            -90.0,
            Vec2::new(9.0, 7.4),
            2,
            PlasterWhite,
            PlasterRed,
            PaintedWood,
            11,
        ),
        (Vec3::new(18.6, 0.0, 22.4), -88.0, Vec2::new(8.2, 7.0), 2, PlasterRose, PlasterWhite, Wood, 12),
        (Vec3::new(17.4, 0.0, -8.4), -90.0, Vec2::new(7.6, 6.2), 3, PlasterRose, PlasterOchre, Wood, 13),
        (
            Vec3::new(-18.2, 0.0, -4.2),
            84.0,
            Vec2::new(8.2, 7.0),
            2,
            PlasterOchre,
            PlasterRed,
            PaintedWood,
            14,
        ),
        (Vec3::new(-19.0, 0.0, -14.5), 90.0, Vec2::new(8.8, 6.6), 3, PlasterWhite, PlasterOchre, Wood, 15),
    ];
    for (place, degrees, size, storeys, plaster, dado, shutters, seed) in near {
        let house = House {
            size,
            storeys,
            plaster,
            dado,
            shutters,
            seed,
            detailed: true,
            balcony: seed == 12,
            outside_stair: false,
        };
        let mesh = writer.model("house", &house.build());
        writer.place("house", mesh, place, degrees);
    }
}

/// Places of the far houses: x, z, and degrees about the vertical.
const FAR_HOUSES: [(f32, f32, f32); 20] = [
    (-31.0, -12.0, 70.0),
    (-29.0, 2.0, 95.0),
    (-28.0, -24.0, 60.0),
    (-17.0, -33.0, 12.0),
    (-6.0, -37.0, -8.0),
    (3.5, -34.0, 15.0),
    (13.0, -38.0, -20.0),
    (22.0, -30.0, -40.0),
    (30.0, -16.0, -75.0),
    (30.5, 6.0, -95.0),
    (-24.0, -44.0, 25.0),
    (-12.0, -48.0, 0.0),
    (0.0, -50.0, 20.0),
    (18.0, -49.0, -12.0),
    (31.0, -40.0, -35.0),
    (31.0, 18.0, -85.0),
    (-29.0, 31.0, 140.0),
    (-17.0, 40.0, 165.0),
    (20.0, 40.5, 195.0),
    (31.5, 31.0, -120.0),
];

/// Farther away three kinds of house repeat.
fn far_houses(writer: &mut Writer) {
    use Material::{PaintedWood, PlasterOchre, PlasterRed, PlasterRose, PlasterWhite};
    let kinds = [
        (Vec2::new(7.0, 6.0), 2, PlasterWhite, PlasterRose, 21),
        (Vec2::new(8.6, 6.4), 2, PlasterOchre, PlasterWhite, 22),
        (Vec2::new(6.2, 5.6), 3, PlasterRose, PlasterRed, 23),
    ]
    .map(|(size, storeys, plaster, dado, seed)| {
        let house = House {
            size,
            storeys,
            plaster,
            dado,
            shutters: PaintedWood,
            seed,
            detailed: false,
            balcony: false,
            outside_stair: false,
        };
        writer.model("far house", &house.build())
    });
    for (index, (x, z, degrees)) in FAR_HOUSES.into_iter().enumerate() {
        writer.root(Node {
            name: "far house".into(),
            translation: Vec3::new(x, ground_height(x, z) - 0.3, z),
            rotation: Quat::from_rotation_y(f32::to_radians(degrees)),
            mesh: Some(kinds[index % kinds.len()]),
            backdrop: is_outside(x, z),
            ..Node::default()
        });
    }
}

/// Trees, cypresses and bushes.
fn trees(writer: &mut Writer) {
    let plane = writer.model("plane tree", &nature::broadleaf(41, Vec3::new(0.95, 1.0, 0.85)));
    let olive = writer.model("olive tree", &nature::broadleaf(43, Vec3::new(0.92, 0.95, 1.0)));
    broadleaved(writer, [plane, olive]);
    grove(writer, olive);
    cypresses(writer);
    bushes(writer);
}

/// Single trees of two kinds.
fn broadleaved(writer: &mut Writer, kinds: [usize; 2]) {
    let places = [
        (0, -12.6, -7.5, 40.0, 1.15),
        (1, PLANTERS[0].x, PLANTERS[0].z, 200.0, 1.2),
        (0, PLANTERS[1].x, PLANTERS[1].z, 80.0, 1.1),
        (0, -11.0, 33.5, 130.0, 1.3),
        (1, 4.0, 38.0, 10.0, 1.15),
        (0, 27.0, 33.0, 220.0, 1.3),
        (0, 12.4, -4.6, 120.0, 1.0),
        (1, 9.6, -10.4, 300.0, 0.8),
        (0, -13.4, -20.0, 10.0, 1.25),
        (1, 24.5, -24.0, 70.0, 1.1),
        (0, -24.0, -34.0, 0.0, 1.1),
        (1, -35.0, -32.0, 50.0, 1.2),
        (0, 9.0, -29.0, 160.0, 1.0),
        (1, 37.0, -28.0, 90.0, 1.3),
        (0, -30.0, 16.0, 20.0, 1.2),
    ];
    for (kind, x, z, degrees, scale) in places {
        writer.root(Node {
            name: "tree".into(),
            translation: Vec3::new(x, ground_height(x, z), z),
            rotation: Quat::from_rotation_y(f32::to_radians(degrees)),
            scale,
            mesh: Some(kinds[kind]),
            backdrop: is_outside(x, z),
            ..Node::default()
        });
    }
}

/// An olive grove on the slope.
fn grove(writer: &mut Writer, olive: usize) {
    for row in 0..5 {
        for column in 0..5 {
            let (x, z) = (-42.0 - column as f32 * 5.2, -12.0 + row as f32 * 6.5 + column as f32 * 1.5);
            writer.root(Node {
                name: "olive tree".into(),
                translation: Vec3::new(x, ground_height(x, z), z),
                rotation: Quat::from_rotation_y((row * 5 + column) as f32 * 2.3),
                scale: 0.72 + 0.05 * ((row * 2 + column * 3) % 4) as f32,
                mesh: Some(olive),
                backdrop: is_outside(x, z),
                ..Node::default()
            });
        }
    }
}

fn cypresses(writer: &mut Writer) {
    let cypress = writer.model("cypress", &nature::cypress(47));
    let places = [
        (7.4, -4.0, 1.15),
        (8.2, -12.6, 1.3),
        (-12.2, -13.4, 1.25),
        (-13.2, -1.6, 1.0),
        (7.8, -20.0, 1.2),
        (-21.0, -26.0, 1.3),
        (-1.0, -41.0, 1.3),
        (8.5, -42.0, 1.2),
        (-19.0, -38.0, 1.35),
        (26.0, -36.0, 1.3),
        (24.6, 7.0, 1.1),
    ];
    for (index, (x, z, scale)) in places.into_iter().enumerate() {
        writer.root(Node {
            name: "cypress".into(),
            translation: Vec3::new(x, ground_height(x, z), z),
            rotation: Quat::from_rotation_y(index as f32 * 1.3),
            scale,
            mesh: Some(cypress),
            backdrop: is_outside(x, z),
            ..Node::default()
        });
    }
}

fn bushes(writer: &mut Writer) {
    let bush = writer.model("bush", &nature::bush(53));
    for (index, (x, z)) in [
        (-10.9, 3.0),
        (-10.6, 1.6),
        (5.9, 1.4),
        (6.1, -0.6),
        (-15.0, 27.6),
        (14.2, 6.6),
        (13.9, 16.8),
        (14.1, 26.6),
    ]
    .into_iter()
    .enumerate()
    {
        writer.root(Node {
            name: "bush".into(),
            translation: Vec3::new(x, 0.05, z),
            rotation: Quat::from_rotation_y(index as f32 * 2.1),
            scale: 0.9 + 0.15 * (index % 3) as f32,
            mesh: Some(bush),
            ..Node::default()
        });
    }
}
