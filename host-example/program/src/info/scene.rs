//! Facts about a scene.

use std::path::Path;

use serde_json::{Value, json};

use super::facts::Facts;
use isophote_files::error::Result;
use isophote_scene::Scene;
use isophote_scene::camera::list_file_cameras;
use isophote_scene::material::AlphaMode;
use isophote_scene::model::{LightKind, Mesh};

/// Adds what a scene holds.
///
/// # Errors
/// As [`Scene::load`].
pub fn add(facts: &mut Facts, path: &Path) -> Result<()> {
    let scene = Scene::load(path, None)?;
    let is_obj = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"));
    facts.add("kind", "scene");
    facts.add("format", if is_obj { "OBJ" } else { "glTF 2.0" });
    let (low, high) = (scene.bounds.min.to_array(), scene.bounds.max.to_array());
    facts.told(
        "bounds",
        json!({ "min": low, "max": high }),
        format!("{} to {}", numbers(low), numbers(high)),
    );
    let triangles = scene.draws.iter().map(|draw| scene.primitive(draw).indices.len() / 3).sum::<usize>();
    facts.add("triangles", triangles);
    facts.add("meshes", scene.meshes.iter().map(mesh).collect::<Vec<_>>());
    let material = |material: &isophote_scene::material::Material| {
        let alpha = match material.alpha_mode {
            AlphaMode::Opaque => "opaque",
            AlphaMode::Mask { .. } => "mask",
            AlphaMode::Blend => "blend",
        };
        json!({ "name": name(&material.name), "alpha": alpha, "textured": material.base_color_texture.is_some() })
    };
    facts.add("materials", scene.materials.iter().map(material).collect::<Vec<_>>());
    let image = |image: &isophote_scene::material::Image| format!("{}x{}", image.width, image.height);
    facts.add("images", scene.images.iter().map(image).collect::<Vec<_>>());
    facts.add("lights", lights(&scene));
    facts.add("cameras", list_file_cameras(&scene));
    facts.add("skins", scene.skins.len());
    let animation = |animation: &isophote_scene::animation::Animation| json!({ "name": name(&animation.name), "seconds": animation.duration(), "channels": animation.channels.len() });
    facts.add("control_map", scene.has_control());
    facts.add("animations", scene.animations.iter().map(animation).collect::<Vec<_>>());
    let extension =
        |(name, is_understood): &(String, bool)| json!({ "name": name, "understood": is_understood });
    facts.add("extensions", scene.extensions.iter().map(extension).collect::<Vec<_>>());
    facts.add("warnings", scene.warnings);
    Ok(())
}

fn mesh(mesh: &Mesh) -> Value {
    let sum = |count: fn(&isophote_scene::model::Primitive) -> usize| -> usize {
        mesh.primitives.iter().map(count).sum()
    };
    json!({
        "name": name(&mesh.name),
        "triangles": sum(|primitive| primitive.indices.len() / 3),
        "vertices": sum(|primitive| primitive.vertices.len()),
        "skinned": mesh.primitives.iter().any(|primitive| primitive.influence_sets > 0),
        "morph_targets": mesh.primitives.iter().map(|primitive| primitive.morph_targets.len()).max().unwrap_or(0),
    })
}

/// The lights that are shown, by the names of their nodes.
fn lights(scene: &Scene) -> Vec<Value> {
    let of_node = |node: &isophote_scene::model::Node| {
        let light = scene.lights.get(node.light.filter(|_| node.visible)?)?;
        let kind = match light.kind {
            LightKind::Directional => "directional",
            LightKind::Point => "point",
            LightKind::Spot { .. } => "spot",
        };
        Some(json!({ "name": name(&node.name), "type": kind, "intensity": light.intensity }))
    };
    scene.nodes.iter().filter_map(of_node).collect()
}

/// A name that a file gives, or a word where it gives none.
fn name(name: &str) -> &str {
    if name.is_empty() { "(no name)" } else { name }
}

fn numbers(numbers: [f32; 3]) -> String {
    numbers.map(|number| format!("{number:.3}")).join(" ")
}
