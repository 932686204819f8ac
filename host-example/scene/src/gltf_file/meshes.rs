//! Meshes of a glTF document: attributes, morph targets and skin influences of each primitive.

use gltf::Semantic;
use gltf::mesh::Mode;

use super::accessors::{Accessors, Pick};
use super::draco::{self, Geometry};
use super::materials::label;
use crate::geometry::{self, Topology};
use crate::model::{Influence, Mesh, MorphDelta, NEUTRAL, Primitive, Scene, Vertex};

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
            let (read, warning) = read_primitive(document, primitive, topology, accessors, scene)
                .map_err(|problem| format!("mesh {name}: {problem}"))?;
            scene.warnings.extend(warning.map(|warning| format!("mesh {name}: {warning}")));
            if !read.indices.is_empty() {
                primitives.push(read);
            }
        }
        leave_medium(&mut primitives);
        scene.meshes.push(Mesh {
            name: mesh.name().unwrap_or_default().to_owned(),
            primitives,
            weights: mesh.weights().unwrap_or_default().to_vec(),
        });
    }
    Ok(())
}

/// Makes the strength of the medium neutral where all control values of a mesh have alpha 1: colours have that where
/// nobody painted alpha. Control maps of pictures are read so, too.
fn leave_medium(primitives: &mut [Primitive]) {
    let mut values = primitives.iter().flat_map(|primitive| &primitive.control);
    if values.all(|value| value[3] == 1.0) {
        let values = primitives.iter_mut().flat_map(|primitive| &mut primitive.control);
        values.for_each(|value| value[3] = NEUTRAL[3]);
    }
}

/// Reader of the parts of a primitive.
struct Reader<'a> {
    source: gltf::Primitive<'a>,
    accessors: &'a Accessors<'a>,
    /// Decoded geometry, where the file holds it compressed.
    draco: Option<Geometry>,
    /// Vertices in the file.
    count: usize,
    /// Vertices that a triangle uses.
    used: Pick<'a>,
}

/// A primitive, and a warning of what is left out of it.
fn read_primitive(
    document: &gltf::Document,
    source: gltf::Primitive,
    topology: Topology,
    accessors: &Accessors,
    scene: &Scene,
) -> Result<(Primitive, Option<String>), String> {
    let positions = source.get(&Semantic::Positions).ok_or("it has no positions")?;
    let mut draco = draco::read(document, &source, accessors)?;
    let count = draco.as_ref().map_or(positions.count(), |geometry| geometry.count);
    let mut indices = match &mut draco {
        Some(geometry) => {
            triangles(Topology::List, &std::mem::take(&mut geometry.indices), count, accessors)?
        }
        None => read_indices(&source, topology, count, accessors)?,
    };
    let kept = compact(&mut indices, count);
    let used = kept.as_deref().map_or(Pick::All, Pick::These);
    let material = source.material().index().unwrap_or(scene.materials.len() - 1);
    let reader = Reader { source, accessors, draco, count, used };
    let mut primitive = Primitive { indices, material, ..Primitive::default() };
    let positions = reader.attribute(Semantic::Positions, &[3], [0.0; 3])?.unwrap_or_default();
    let normals = reader.attribute(Semantic::Normals, &[3], [0.0; 3])?;
    let tangents = reader.attribute(Semantic::Tangents, &[4], [0.0; 4])?;
    let (flat, bent) = (normals.is_none(), normals.is_none() || tangents.is_none());
    // Flat normals need vertices of their own for every corner.
    let vertices = if flat { primitive.indices.len().max(positions.len()) } else { positions.len() };
    accessors.budget.take(vertices, size_of::<Vertex>())?;
    primitive.vertices =
        positions.into_iter().map(|position| Vertex { position, ..Vertex::default() }).collect();
    fill(&mut primitive, normals, |v, x| v.normal = x);
    fill(&mut primitive, tangents, |v, x| v.tangent = x);
    fill(&mut primitive, reader.attribute(Semantic::TexCoords(0), &[2], [0.0; 2])?, |v, x| v.uv0 = x);
    fill(&mut primitive, reader.attribute(Semantic::TexCoords(1), &[2], [0.0; 2])?, |v, x| v.uv1 = x);
    fill(&mut primitive, reader.attribute(Semantic::Colors(0), &[3, 4], [1.0; 4])?, |v, x| v.color = x);
    reader.influences(&mut primitive, vertices)?;
    reader.morph_targets(&mut primitive, vertices)?;
    let warning = reader.control(&mut primitive, vertices);
    if flat {
        geometry::flat_normals(&mut primitive);
    }
    if let Some(map) = scene.materials[primitive.material].normal_texture.filter(|_| bent) {
        geometry::tangents(&mut primitive, map.uv_set);
    }
    Ok((primitive, warning))
}

/// The triangles of a primitive as indices of its `count` vertices.
fn read_indices(
    source: &gltf::Primitive,
    topology: Topology,
    count: usize,
    accessors: &Accessors,
) -> Result<Vec<u32>, String> {
    let indices = match source.indices() {
        Some(accessor) => accessors.integers(&accessor, 1, Pick::All)?,
        None => {
            accessors.budget.take(count, size_of::<u32>())?;
            (0..count as u32).collect()
        }
    };
    triangles(topology, &indices, count, accessors)
}

/// The triangles of checked indices of `count` vertices.
fn triangles(
    topology: Topology,
    indices: &[u32],
    count: usize,
    accessors: &Accessors,
) -> Result<Vec<u32>, String> {
    if let Some(bad) = indices.iter().find(|i| **i as usize >= count) {
        return Err(format!("it has an index {bad} but only {count} vertices"));
    }
    accessors.budget.take(indices.len(), 3 * size_of::<u32>())?;
    Ok(geometry::triangle_list(topology, indices))
}

/// Most vertices to an index for which a table of all vertices is made. Beyond, the indices are sorted, so that a few of them take no
/// memory for the many vertices that they leave out.
const SPARSE: usize = 8;

/// Makes indices count only the vertices that they use, and yields these in ascending order; `None` where all
/// `count` are used. The time is that of the indices, however many vertices there are.
fn compact(indices: &mut [u32], count: usize) -> Option<Vec<u32>> {
    if count / SPARSE > indices.len() {
        return Some(compact_sparse(indices));
    }
    let mut is_used = vec![false; count];
    for index in indices.iter() {
        is_used[*index as usize] = true;
    }
    let used: Vec<u32> =
        (0..).zip(&is_used).filter_map(|(index, is_used)| is_used.then_some(index)).collect();
    if used.len() == count {
        return None;
    }
    let mut places = vec![0; count];
    for (&index, place) in used.iter().zip(0..) {
        places[index as usize] = place;
    }
    for index in indices {
        *index = places[*index as usize];
    }
    Some(used)
}

/// What [`compact`] does, where most vertices are not used.
fn compact_sparse(indices: &mut [u32]) -> Vec<u32> {
    let mut used = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    for index in indices {
        *index = used.partition_point(|used| used < index) as u32;
    }
    used
}

fn fill<T>(primitive: &mut Primitive, values: Option<Vec<T>>, set: impl Fn(&mut Vertex, T)) {
    for (vertex, value) in primitive.vertices.iter_mut().zip(values.into_iter().flatten()) {
        set(vertex, value);
    }
}

impl Reader<'_> {
    /// An attribute of every used vertex; surplus numbers are dropped, missing ones taken from `default`.
    fn attribute<const N: usize>(
        &self,
        semantic: Semantic,
        widths: &[usize],
        default: [f32; N],
    ) -> Result<Option<Vec<[f32; N]>>, String> {
        let Some(accessor) = self.source.get(&semantic) else { return Ok(None) };
        if let Some(geometry) = &self.draco
            && let Some(floats) =
                geometry.floats(&semantic.to_string(), &accessor, widths, self.accessors, self.used)?
        {
            return Ok(Some(floats.arrays(default)));
        }
        if accessor.count() != self.count {
            return Err(format!("its {semantic:?} are not as many as its positions"));
        }
        Ok(Some(self.accessors.floats(&accessor, widths, self.used)?.arrays(default)))
    }

    fn influences(&self, primitive: &mut Primitive, vertices: usize) -> Result<(), String> {
        let mut sets = Vec::new();
        loop {
            let set = sets.len() as u32;
            let (joints, weights) = (Semantic::Joints(set), Semantic::Weights(set));
            let (Some(joints), Some(_)) = (self.source.get(&joints), self.source.get(&weights)) else {
                break;
            };
            let joints = self.joints(set, &joints)?;
            sets.push((joints, self.attribute(weights, &[4], [0.0; 4])?.unwrap_or_default()));
        }
        self.accessors.budget.take(vertices, sets.len() * size_of::<Influence>())?;
        primitive.influence_sets = sets.len();
        for vertex in 0..primitive.vertices.len() {
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

    /// Reads values of the control map: the attribute `_CONTROL`, or the second set of colours. Both may be meant for others
    /// in files that know nothing of control maps, so that what cannot be read is left out, which the result says.
    fn control(&self, primitive: &mut Primitive, vertices: usize) -> Option<String> {
        let semantics = [Semantic::Extras("CONTROL".to_owned()), Semantic::Colors(1)];
        let semantic = semantics.into_iter().find(|semantic| self.source.get(semantic).is_some())?;
        let name = semantic.to_string();
        let read = self.attribute(semantic, &[3, 4], NEUTRAL).and_then(|values| {
            self.accessors.budget.take(vertices, size_of::<[f32; 4]>())?;
            Ok(values.unwrap_or_default())
        });
        let mut values = match read {
            Ok(values) => values,
            Err(problem) => return Some(format!("its {name} is no control map: {problem}")),
        };
        let mut others = values.iter_mut().flatten().filter(|value| !value.is_finite()).peekable();
        let warning =
            others.peek().map(|_| format!("its {name} has values that are not finite; they change nothing"));
        others.for_each(|value| *value = NEUTRAL[0]);
        primitive.control = values;
        warning
    }

    /// Four joints of every used vertex.
    fn joints(&self, set: u32, accessor: &gltf::Accessor) -> Result<Vec<u32>, String> {
        if let Some(geometry) = &self.draco
            && let Some(joints) =
                geometry.integers(&Semantic::Joints(set).to_string(), 4, self.accessors, self.used)?
        {
            return Ok(joints);
        }
        if accessor.count() != self.count {
            return Err("its joints or weights are not as many as its positions".into());
        }
        self.accessors.integers(accessor, 4, self.used)
    }

    fn morph_targets(&self, primitive: &mut Primitive, vertices: usize) -> Result<(), String> {
        let read = |accessor: Option<gltf::Accessor>| {
            let Some(accessor) = accessor else { return Ok(None) };
            if accessor.count() != self.count {
                return Err("a morph target has not as many deltas as the mesh has positions".to_owned());
            }
            Ok(Some(self.accessors.floats(&accessor, &[3], self.used)?.arrays([0.0; 3])))
        };
        for target in self.source.morph_targets() {
            let (positions, normals, tangents) =
                (read(target.positions())?, read(target.normals())?, read(target.tangents())?);
            self.accessors.budget.take(vertices, size_of::<MorphDelta>())?;
            let delta = |deltas: &Option<Vec<[f32; 3]>>, i: usize| deltas.as_ref().map_or([0.0; 3], |d| d[i]);
            let deltas = (0..primitive.vertices.len())
                .map(|i| MorphDelta {
                    position: delta(&positions, i),
                    normal: delta(&normals, i),
                    tangent: delta(&tangents, i),
                })
                .collect();
            primitive.morph_targets.push(deltas);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{SPARSE, compact};

    #[test]
    fn indices_count_only_the_vertices_that_they_use() {
        for count in [8, 6 * SPARSE, 100 * SPARSE] {
            let mut indices = [5, 0, 7, 7, 5, 2];
            assert_eq!(compact(&mut indices, count), Some(vec![0, 2, 5, 7]), "{count}");
            assert_eq!(indices, [2, 0, 3, 3, 2, 1], "{count}");
        }
        let mut indices = [2, 1, 0, 0, 1, 2];
        assert_eq!(compact(&mut indices, 3), None);
        assert_eq!(indices, [2, 1, 0, 0, 1, 2]);
    }
}
