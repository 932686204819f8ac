//! Values of control maps that vertices of glTF files bring.

use serde_json::json;

use super::build::{Builder, U8, U16};
use crate::model::NEUTRAL;
use crate::{Primitive, Scene};

/// Values of three vertices, whose alpha was painted.
const PAINTED: [f32; 12] = [0.0, 0.25, 0.5, 0.75, 1.0, 0.5, 0.25, 0.0, 0.5, 0.5, 0.5, 1.0];

/// A triangle with values in attributes of these names.
fn triangle(attributes: &[(&str, &str, &[f32])]) -> Scene {
    let mut b = Builder::triangle();
    for (name, kind, values) in attributes {
        let accessor = b.floats(kind, values);
        b.primitive()["attributes"][name] = json!(accessor);
    }
    b.load().unwrap()
}

fn first(scene: &Scene) -> &Primitive {
    scene.primitive(&scene.draws[0])
}

#[test]
fn values_come_from_the_attribute_of_that_name_or_else_from_the_second_colours() {
    let painted = PAINTED.as_chunks::<4>().0;
    let others = [0.125; 12];
    for attributes in [
        &[("_CONTROL", "VEC4", &PAINTED[..])][..],
        &[("COLOR_1", "VEC4", &PAINTED[..])],
        &[("COLOR_1", "VEC4", &others[..]), ("_CONTROL", "VEC4", &PAINTED[..])],
        &[("_CONTROL", "VEC4", &PAINTED[..]), ("COLOR_0", "VEC4", &others[..])],
    ] {
        let scene = triangle(attributes);
        assert!(scene.has_control() && scene.warnings.is_empty(), "{:?}", scene.warnings);
        assert_eq!(first(&scene).control, painted, "{attributes:?}");
    }
    for attributes in [&[("COLOR_0", "VEC4", &PAINTED[..])][..], &[("_OTHER", "VEC4", &PAINTED[..])], &[]] {
        let scene = triangle(attributes);
        assert!(!scene.has_control() && first(&scene).control.is_empty(), "{attributes:?}");
    }
}

#[test]
fn what_is_no_strength_of_the_medium_leaves_it_alone() {
    let scene = triangle(&[("_CONTROL", "VEC3", &PAINTED[..9])]);
    let expected = [[0.0, 0.25, 0.5, 0.5], [0.75, 1.0, 0.5, 0.5], [0.25, 0.0, 0.5, 0.5]];
    assert_eq!(first(&scene).control, expected);
    // Alpha of 1 everywhere is that of colours whose alpha nobody painted.
    let opaque = [0.0, 0.25, 0.5, 1.0, 0.75, 1.0, 0.5, 1.0, 0.25, 0.0, 0.5, 1.0];
    let scene = triangle(&[("_CONTROL", "VEC4", &opaque)]);
    assert_eq!(first(&scene).control, expected);
}

#[test]
fn normalized_integers_are_values() {
    for (kind, bytes) in [
        (U8, [255, 0, 51, 102].repeat(3)),
        (U16, [65535u16, 0, 13107, 26214].map(u16::to_le_bytes).concat().repeat(3)),
    ] {
        let mut b = Builder::triangle();
        let values = b.add(kind, "VEC4", 3, &bytes);
        b.json["accessors"][values]["normalized"] = json!(true);
        b.primitive()["attributes"]["_CONTROL"] = json!(values);
        assert_eq!(first(&b.load().unwrap()).control, [[1.0, 0.0, 0.2, 0.4]; 3]);
    }
}

#[test]
fn values_go_with_vertices_that_are_copied() {
    // Without normals every triangle gets vertices of its own.
    let mut b = Builder::new();
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    let positions = b.floats("VEC3", &square);
    // As many values as places say where they belong.
    let values = b.floats("VEC3", &square);
    *b.primitive() = json!({"attributes": {"POSITION": positions, "_CONTROL": values}, "mode": 5});
    let scene = b.load().unwrap();
    let primitive = first(&scene);
    assert_eq!(primitive.vertices.len(), 6);
    for (vertex, value) in primitive.vertices.iter().zip(&primitive.control) {
        assert_eq!((vertex.position, 0.5), ([value[0], value[1], value[2]], value[3]));
    }
    assert_eq!(primitive.control.len(), 6);
}

#[test]
fn what_is_no_control_map_is_left_out_with_a_warning() {
    let warned = |scene: &Scene, words: &str| {
        assert!(scene.warnings.iter().any(|w| w.contains(words)), "'{words}': {:?}", scene.warnings);
    };
    for (name, kind, count) in [("_CONTROL", "VEC2", 6), ("COLOR_1", "SCALAR", 3), ("_CONTROL", "VEC4", 8)] {
        let scene = triangle(&[(name, kind, &PAINTED[..count])]);
        warned(&scene, &format!("mesh number 0: its {name} is no control map"));
        assert!(!scene.has_control(), "{name} {kind}");
    }
    let mut broken = PAINTED;
    (broken[1], broken[4]) = (f32::NAN, f32::INFINITY);
    let scene = triangle(&[("_CONTROL", "VEC4", &broken)]);
    warned(&scene, "its _CONTROL has values that are not finite");
    assert_eq!(first(&scene).control[..2], [[0.0, NEUTRAL[1], 0.5, 0.75], [NEUTRAL[0], 0.5, 0.25, 0.0]]);
}
