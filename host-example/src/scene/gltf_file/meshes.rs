//! Meshes of a glTF document: attributes, morph targets and skin influences of each primitive.

use gltf::Semantic;
use gltf::mesh::Mode;

use super::accessors::Accessors;
use super::materials::label;
use crate::scene::geometry::{self, Topology};
use crate::scene::model::{Influence, Mesh, MorphDelta, Primitive, Scene, Vertex};

/// Reads all meshes into the scene, whose materials must be there already.
///
/// # Errors
/// A clause naming the mesh and what is wrong with it.
pub fn read(document: &gltf::Document, accessors: &Accessors, scene: &mut Scene) -> Result<(), String> {
    for mesh in document.meshes() {
        let name = label(mesh.name(), mesh.index());
        let mut primitives = Vec::new();
        for primitive in mesh.primitives() {
            let topology = match primitive.mode() {
                Mode::Triangles => Topology::List,
                Mode::TriangleStrip => Topology::Strip,
                Mode::TriangleFan => Topology::Fan,
                other => {
                    scene
                        .warnings
                        .push(format!("mesh {name} has a primitive of {other:?}, which is left out"));
                    continue;
                }
            };
            let read = read_primitive(&primitive, topology, accessors, scene)
                .map_err(|problem| format!("mesh {name}: {problem}"))?;
            if !read.indices.is_empty() {
                primitives.push(read);
            }
        }
        scene.meshes.push(Mesh {
            name: mesh.name().unwrap_or_default().to_owned(),
            primitives,
            weights: mesh.weights().unwrap_or_default().to_vec(),
        });
    }
    Ok(())
}

fn read_primitive(
    source: &gltf::Primitive,
    topology: Topology,
    accessors: &Accessors,
    scene: &Scene,
) -> Result<Primitive, String> {
    let positions = source.get(&Semantic::Positions).ok_or("it has no positions")?;
    let positions = accessors.floats(&positions, &[3])?.arrays([0.0; 3]);
    let count = positions.len();
    let mut primitive = Primitive {
        vertices: positions.into_iter().map(|position| Vertex { position, ..Vertex::default() }).collect(),
        material: source.material().index().unwrap_or(scene.materials.len() - 1),
        ..Primitive::default()
    };
    let read = |semantic: Semantic, widths: &[usize]| {
        let Some(accessor) = source.get(&semantic) else { return Ok(None) };
        let floats = accessors.floats(&accessor, widths)?;
        if floats.values.len() != count * floats.width {
            return Err(format!("its {semantic:?} are not as many as its positions"));
        }
        Ok(Some(floats))
    };
    let normals = read(Semantic::Normals, &[3])?;
    let tangents = read(Semantic::Tangents, &[4])?;
    fill(&mut primitive, normals.as_ref().map(|f| f.arrays([0.0; 3])), |v, x| v.normal = x);
    fill(&mut primitive, tangents.as_ref().map(|f| f.arrays([0.0; 4])), |v, x| v.tangent = x);
    fill(&mut primitive, read(Semantic::TexCoords(0), &[2])?.map(|f| f.arrays([0.0; 2])), |v, x| v.uv0 = x);
    fill(&mut primitive, read(Semantic::TexCoords(1), &[2])?.map(|f| f.arrays([0.0; 2])), |v, x| v.uv1 = x);
    fill(&mut primitive, read(Semantic::Colors(0), &[3, 4])?.map(|f| f.arrays([1.0; 4])), |v, x| v.color = x);
    read_influences(source, accessors, &mut primitive)?;
    read_morph_targets(source, accessors, &mut primitive)?;

    let indices = match source.indices() {
        Some(accessor) => accessors.integers(&accessor, 1)?,
        None => (0..count as u32).collect(),
    };
    if let Some(bad) = indices.iter().find(|i| **i as usize >= count) {
        return Err(format!("it has an index {bad} but only {count} vertices"));
    }
    primitive.indices = geometry::triangle_list(topology, &indices);
    if normals.is_none() {
        geometry::flat_normals(&mut primitive);
    }
    if let Some(map) = scene.materials[primitive.material].normal_texture
        && (tangents.is_none() || normals.is_none())
    {
        geometry::tangents(&mut primitive, map.uv_set);
    }
    Ok(primitive)
}

fn fill<T>(primitive: &mut Primitive, values: Option<Vec<T>>, set: impl Fn(&mut Vertex, T)) {
    for (vertex, value) in primitive.vertices.iter_mut().zip(values.into_iter().flatten()) {
        set(vertex, value);
    }
}

fn read_influences(
    source: &gltf::Primitive,
    accessors: &Accessors,
    primitive: &mut Primitive,
) -> Result<(), String> {
    let count = primitive.vertices.len();
    let mut sets = Vec::new();
    while let (Some(joints), Some(weights)) =
        (source.get(&Semantic::Joints(sets.len() as u32)), source.get(&Semantic::Weights(sets.len() as u32)))
    {
        let joints = accessors.integers(&joints, 4)?;
        let weights = accessors.floats(&weights, &[4])?.arrays([0.0; 4]);
        if joints.len() != count * 4 || weights.len() != count {
            return Err("its joints or weights are not as many as its positions".into());
        }
        sets.push((joints, weights));
    }
    primitive.influence_sets = sets.len();
    for vertex in 0..count {
        let start = primitive.influences.len();
        for (joints, weights) in &sets {
            let joints = [0, 1, 2, 3].map(|k| joints[vertex * 4 + k]);
            primitive.influences.push(Influence { joints, weights: weights[vertex].map(|w| w.max(0.0)) });
        }
        // Quantized weights rarely sum to 1 exactly; a vertex without any follows the first joint.
        let own = &mut primitive.influences[start..];
        let sum: f32 = own.iter().flat_map(|i| i.weights).sum();
        if sum > 0.0 {
            own.iter_mut().for_each(|i| i.weights = i.weights.map(|w| w / sum));
        } else if let Some(first) = own.first_mut() {
            first.weights[0] = 1.0;
        }
    }
    Ok(())
}

fn read_morph_targets(
    source: &gltf::Primitive,
    accessors: &Accessors,
    primitive: &mut Primitive,
) -> Result<(), String> {
    let count = primitive.vertices.len();
    for target in source.morph_targets() {
        let read = |accessor: Option<gltf::Accessor>| {
            let Some(accessor) = accessor else { return Ok(vec![[0.0; 3]; count]) };
            // Tested first: an accessor without data may claim any number of zeros.
            if accessor.count() != count {
                return Err("a morph target has not as many deltas as the mesh has positions".to_owned());
            }
            Ok(accessors.floats(&accessor, &[3])?.arrays([0.0; 3]))
        };
        let (positions, normals, tangents) =
            (read(target.positions())?, read(target.normals())?, read(target.tangents())?);
        let deltas = (0..count)
            .map(|i| MorphDelta { position: positions[i], normal: normals[i], tangent: tangents[i] })
            .collect();
        primitive.morph_targets.push(deltas);
    }
    Ok(())
}
