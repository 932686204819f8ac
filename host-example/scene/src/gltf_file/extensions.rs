//! Versions and extensions of glTF: what is understood, and what a file is shown without.

use serde::Deserialize;
use serde_json::Value;
use serde_json::value::RawValue;

use crate::phrases::list;

/// Extensions that are understood.
const UNDERSTOOD: [&str; 16] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "MSFT_texture_dds",
];

/// Extensions that are understood besides, by decoders that the feature `compressed` brings.
const COMPRESSED: [&str; 2] = ["KHR_draco_mesh_compression", "KHR_texture_basisu"];

/// Extensions that add a layer to a surface, which is shown without that layer.
const LAYERS: [&str; 7] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_volume",
];

/// Extensions without which a scene still has its shape: a file may demand them and is shown without.
fn only_looks(extension: &str) -> bool {
    extension.starts_with("KHR_materials_")
        || matches!(extension, "KHR_animation_pointer" | "KHR_texture_basisu" | "EXT_texture_avif")
}

fn is_understood(extension: &str) -> bool {
    UNDERSTOOD.contains(&extension) || cfg!(feature = "compressed") && COMPRESSED.contains(&extension)
}

/// All extensions of a file, each once, and whether it is understood.
pub fn all(used: &[String], required: &[String]) -> Vec<(String, bool)> {
    let mut all: Vec<(String, bool)> = Vec::new();
    for name in used.iter().chain(required) {
        if all.iter().all(|(known, _)| known != name) {
            all.push((name.clone(), is_understood(name)));
        }
    }
    all
}

/// One warning that names all extensions of a file that are not understood, if there are any.
///
/// # Errors
/// A clause that names a demanded extension without which there is nothing to show.
pub fn check(used: &[String], required: &[String]) -> Result<Vec<String>, String> {
    let unknown = |names: &[String]| {
        let mut unknown: Vec<String> = Vec::new();
        for name in names {
            let is_known = is_understood(name) || LAYERS.contains(&name.as_str());
            if !is_known && !unknown.contains(name) {
                unknown.push(name.clone());
            }
        }
        unknown
    };
    let demanded = unknown(required);
    if let Some(extension) = demanded.iter().find(|name| !only_looks(name)) {
        return Err(format!("demands the extension {extension}, which is not supported"));
    }
    let mut other = unknown(used);
    other.retain(|name| !demanded.contains(name));
    let mut layers: Vec<String> = LAYERS.map(str::to_owned).to_vec();
    layers.retain(|name| used.contains(name) || required.contains(name));
    let mut clauses = Vec::new();
    if !demanded.is_empty() {
        clauses.push(format!("demands {}", list(&demanded)));
    }
    if !other.is_empty() {
        clauses.push(format!("uses {}", list(&other)));
    }
    let mut parts = Vec::new();
    if !clauses.is_empty() {
        let verb = if demanded.len() + other.len() == 1 { "is" } else { "are" };
        parts.push(format!(
            "the file {}, which {verb} not supported; it is shown without",
            clauses.join(" and ")
        ));
    }
    if !layers.is_empty() {
        parts.push(format!("of {} the surface below is shown", list(&layers)));
    }
    Ok(if parts.is_empty() { Vec::new() } else { vec![parts.join("; ")] })
}

/// Refuses documents of other versions, of which the rest would be called damaged.
///
/// # Errors
/// A clause that names the version.
pub fn check_version(text: &str) -> Result<(), String> {
    #[derive(Deserialize)]
    struct Outline<'a> {
        #[serde(default)]
        asset: Value,
        #[serde(borrow)]
        meshes: Option<&'a RawValue>,
        #[serde(borrow)]
        nodes: Option<&'a RawValue>,
    }
    let is_table = |list: Option<&RawValue>| list.is_some_and(|list| list.get().starts_with('{'));
    // What is no document at all is told where all of it is read.
    let Ok(outline) = serde_json::from_str::<Outline>(text) else { return Ok(()) };
    let version = match &outline.asset["version"] {
        Value::String(version) => version.clone(),
        Value::Number(version) => version.to_string(),
        // Version 1 can do without, and has tables where version 2 has lists.
        _ if is_table(outline.meshes) || is_table(outline.nodes) => "1.0".to_owned(),
        _ => return Ok(()),
    };
    if version.split('.').next() == Some("2") {
        return Ok(());
    }
    Err(format!("is glTF version {version}, not 2.0, which is what is read here"))
}

/// True where KHR_node_visibility hides a node and all below it.
pub fn is_hidden(node: &gltf::Node) -> bool {
    node.extension_value("KHR_node_visibility").is_some_and(|value| value["visible"] == false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(list: &[&str]) -> Vec<String> {
        list.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn one_warning_names_all() {
        let check = |used: &[&str], required: &[&str]| check(&names(used), &names(required));
        assert_eq!(check(&["KHR_materials_unlit"], &["KHR_mesh_quantization"]), Ok(Vec::new()));
        assert_eq!(
            check(&["A", "B", "A", "EXT_texture_avif"], &["EXT_texture_avif"]).unwrap(),
            [
                "the file demands EXT_texture_avif and uses A and B, which are not supported; it is shown without"
            ]
        );
        assert_eq!(
            check(&["A", "KHR_materials_sheen"], &[]).unwrap(),
            ["the file uses A, which is not supported; it is shown without; \
              of KHR_materials_sheen the surface below is shown"]
        );
        assert!(check(&[], &["EXT_mesh_things"]).unwrap_err().contains("EXT_mesh_things"));
        assert_eq!(check(&[], &["KHR_draco_mesh_compression"]).is_ok(), cfg!(feature = "compressed"));
    }

    #[test]
    fn other_versions_are_named() {
        for text in [
            r#"{"asset": {"version": "1.0"}, "meshes": {}}"#,
            r#"{"asset": {"version": 1.0}}"#,
            r#"{"meshes": {"a": {}}}"#,
        ] {
            assert!(check_version(text).unwrap_err().contains("glTF version 1.0"), "{text}");
        }
        for text in [r#"{"asset": {"version": "2.0"}}"#, r#"{"asset": {}}"#, "{}", "[", ""] {
            assert_eq!(check_version(text), Ok(()), "{text}");
        }
    }
}
