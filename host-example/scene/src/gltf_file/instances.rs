//! Instances of EXT_mesh_gpu_instancing: each is a node of its own below the node that asks for them.

use glam::{Quat, Vec3, Vec4};

use super::accessors::{Accessors, Pick};
use super::materials::label;
use crate::model::{Node, Scene, Transform};

const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// Puts the instances of all nodes into the scene, whose nodes must be there already.
///
/// # Errors
/// A clause naming the node and what is wrong with it.
pub fn read(document: &gltf::Document, accessors: &Accessors, scene: &mut Scene) -> Result<(), String> {
    for node in document.nodes() {
        let Some(extension) = node.extension_value(EXTENSION) else { continue };
        let index = node.index();
        if scene.nodes[index].mesh.is_none() {
            continue;
        }
        let places = places(document, &extension["attributes"], accessors)
            .map_err(|problem| format!("instances of node {}: {problem}", label(node.name(), index)))?;
        // Without any attribute there is the node itself.
        let Some(places) = places else { continue };
        let weights = size_of_val(scene.nodes[index].weights.as_slice());
        accessors.budget.take(places.len(), size_of::<Node>() + weights)?;
        let (mesh, skin) = (scene.nodes[index].mesh.take(), scene.nodes[index].skin.take());
        for transform in places {
            let own = scene.nodes[index].clone();
            let (camera, light) = (None, None);
            scene.nodes.push(Node { parent: Some(index), transform, mesh, skin, camera, light, ..own });
        }
    }
    Ok(())
}

/// Transforms of the instances; `None` where nothing says how many there are.
fn places(
    document: &gltf::Document,
    attributes: &serde_json::Value,
    accessors: &Accessors,
) -> Result<Option<Vec<Transform>>, String> {
    let read = |name: &str, width: usize| {
        let Some(index) = attributes.get(name) else { return Ok(None) };
        let accessor =
            index.as_u64().and_then(|index| document.accessors().nth(usize::try_from(index).ok()?));
        let accessor = accessor.ok_or_else(|| format!("{name} names an accessor that does not exist"))?;
        Ok::<_, String>(Some(accessors.floats(&accessor, &[width], Pick::All)?))
    };
    let moves = read("TRANSLATION", 3)?.map(|floats| floats.arrays([0.0; 3]));
    let turns = read("ROTATION", 4)?.map(|floats| floats.arrays([0.0; 4]));
    let sizes = read("SCALE", 3)?.map(|floats| floats.arrays([1.0; 3]));
    let counts = [moves.as_ref().map(Vec::len), turns.as_ref().map(Vec::len), sizes.as_ref().map(Vec::len)];
    let Some(count) = counts.into_iter().flatten().next() else { return Ok(None) };
    if counts.into_iter().flatten().any(|other| other != count) {
        return Err("their attributes are not as many as each other".into());
    }
    let turn = |turn: [f32; 4]| Quat::from_vec4(Vec4::from(turn).normalize_or(Vec4::W));
    let place = |i: usize| Transform::Parts {
        translation: moves.as_ref().map_or(Vec3::ZERO, |all| Vec3::from(all[i])),
        rotation: turns.as_ref().map_or(Quat::IDENTITY, |all| turn(all[i])),
        scale: sizes.as_ref().map_or(Vec3::ONE, |all| Vec3::from(all[i])),
    };
    Ok(Some((0..count).map(place).collect()))
}
