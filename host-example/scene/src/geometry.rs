//! Parts of meshes that files leave out: normals, tangents, and triangle lists made of strips and fans.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::model::Primitive;

/// The way in which the indices of a primitive form triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    /// Three indices per triangle.
    List,
    /// Every index after the second closes a triangle with the two before it.
    Strip,
    /// Every index after the second closes a triangle with the one before it and the first.
    Fan,
}

/// Turns any topology into a triangle list, dropping incomplete and degenerate triangles.
pub fn triangle_list(topology: Topology, indices: &[u32]) -> Vec<u32> {
    let triangles: Vec<[u32; 3]> = match topology {
        Topology::List => indices.as_chunks::<3>().0.to_vec(),
        Topology::Strip => indices
            .windows(3)
            .enumerate()
            // The winding alternates along a strip.
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
            .collect(),
        Topology::Fan => match indices.split_first() {
            Some((&first, rest)) => rest.windows(2).map(|w| [first, w[0], w[1]]).collect(),
            None => Vec::new(),
        },
    };
    triangles.into_iter().filter(|[a, b, c]| a != b && b != c && c != a).flatten().collect()
}

/// Gives every triangle vertices of its own, so that they can carry its normal.
fn unweld(primitive: &mut Primitive) {
    let pick = |index: &u32| *index as usize;
    let sets = primitive.influence_sets;
    primitive.influences = primitive
        .indices
        .iter()
        .filter(|_| !primitive.influences.is_empty())
        .flat_map(|i| &primitive.influences[pick(i) * sets..(pick(i) + 1) * sets])
        .copied()
        .collect();
    for target in &mut primitive.morph_targets {
        *target = primitive.indices.iter().map(|i| target[pick(i)]).collect();
    }
    if !primitive.control.is_empty() {
        primitive.control = primitive.indices.iter().map(|i| primitive.control[pick(i)]).collect();
    }
    primitive.vertices = primitive.indices.iter().map(|i| primitive.vertices[pick(i)]).collect();
    primitive.indices = (0..primitive.vertices.len() as u32).collect();
}

/// Flat normals, as glTF demands where a file has none.
pub fn flat_normals(primitive: &mut Primitive) {
    unweld(primitive);
    for triangle in primitive.vertices.as_chunks_mut::<3>().0 {
        let [a, b, c] = [0, 1, 2].map(|i| Vec3::from(triangle[i].position));
        let normal = (b - a).cross(c - a).normalize_or(Vec3::Z).to_array();
        for vertex in triangle {
            vertex.normal = normal;
        }
    }
}

/// Faces that share their normals at a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Smoothing {
    /// Faces of one part that meet at an angle below the crease.
    Crease(usize),
    /// Triangles of one polygon.
    Flat(usize),
    /// Faces of one group, whatever their angle.
    Group(u32),
}

/// Smooth normals: the mean of the faces around a position, weighted by their angles there so that it does
/// not matter how polygons were cut into triangles. Faces that meet this one at more than `crease` radians
/// are left out, so that the sharp edges of machined parts stay sharp. The time grows with the number of faces,
/// however many of them meet at a point.
pub fn smooth_normals(primitive: &mut Primitive, crease: f32) {
    let position = |index: &u32| Vec3::from(primitive.vertices[*index as usize].position);
    let corners: Vec<Vec3> = primitive.indices.iter().map(position).collect();
    let normals = corner_normals(&corners, crease, |_| Smoothing::Crease(0));
    weld_normals(primitive, &normals);
}

/// Normals of the corners of triangles, three of each, as those of [`smooth_normals`], where `smoothing` says for every
/// triangle which others share them.
pub fn corner_normals(corners: &[Vec3], crease: f32, smoothing: impl Fn(usize) -> Smoothing) -> Vec<Vec3> {
    // Vertices that differ only in texture coordinates still share their surface, hence the key. Adding 0
    // makes one of the two zeros.
    let key = |p: Vec3, smoothing: Smoothing| ((p + 0.0).to_array().map(f32::to_bits), smoothing);
    let mut around: HashMap<_, Vec<(Vec3, f32)>> = HashMap::new();
    let mut faces = Vec::with_capacity(corners.len() / 3);
    for (face, [a, b, c]) in corners.as_chunks::<3>().0.iter().copied().enumerate() {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        faces.push(normal);
        for [p, q, r] in [[a, b, c], [b, c, a], [c, a, b]] {
            let angle = corner_angle(p, q, r);
            around.entry(key(p, smoothing(face))).or_default().push((normal, angle));
        }
    }
    for faces in around.values_mut().filter(|faces| faces.len() > MOST_FACES) {
        *faces = by_direction(faces);
    }
    let cosine = crease.cos();
    let normal = |(slot, corner): (usize, &Vec3)| {
        let (own, smoothing) = (faces[slot / 3], smoothing(slot / 3));
        let sharp = matches!(smoothing, Smoothing::Crease(_));
        let sum: Vec3 = around
            .get(&key(*corner, smoothing))
            .into_iter()
            .flatten()
            .filter(|(normal, _)| !sharp || normal.dot(own) >= cosine)
            .map(|(normal, angle)| *normal * *angle)
            .sum();
        // Adding 0 makes one of the two zeros.
        sum.normalize_or(own.normalize_or(Vec3::Z)) + 0.0
    };
    corners.iter().enumerate().map(normal).collect()
}

/// Faces around one position up to which all are compared with each other. Poles and fans can have far more.
const MOST_FACES: usize = 64;

/// Cells along each side of the cube that directions are sorted by; a cell spans at most 15 degrees.
const CELLS: usize = 8;

/// Faces of nearly one direction as one, so that there is a bounded number of them. A face is its normal and
/// its angle.
fn by_direction(faces: &[(Vec3, f32)]) -> Vec<(Vec3, f32)> {
    let mut places = [None; 6 * CELLS * CELLS];
    let mut sums: Vec<Vec3> = Vec::new();
    for (normal, angle) in faces {
        let axis = normal.abs().max_position();
        let longest = normal[axis];
        let cell = |value: f32| ((value / longest.abs() * 0.5 + 0.5) * CELLS as f32) as usize;
        let [u, v] = [1, 2].map(|k| cell(normal[(axis + k) % 3]).min(CELLS - 1));
        let side = axis * 2 + usize::from(longest < 0.0);
        let place = *places[(side * CELLS + u) * CELLS + v].get_or_insert_with(|| {
            sums.push(Vec3::ZERO);
            sums.len() - 1
        });
        sums[place] += *normal * *angle;
    }
    sums.into_iter().map(|sum| (sum.normalize_or_zero(), sum.length())).collect()
}

/// Angle at `p` in a triangle; 0 where it has none.
fn corner_angle(p: Vec3, q: Vec3, r: Vec3) -> f32 {
    let angle = (q - p).angle_between(r - p);
    if angle.is_finite() { angle } else { 0.0 }
}

/// Splits a vertex only where its corners disagree about the normal.
fn weld_normals(primitive: &mut Primitive, corner_normals: &[Vec3]) {
    let mut known: HashMap<(u32, [u32; 3]), u32> = HashMap::new();
    let mut vertices = Vec::with_capacity(primitive.vertices.len());
    for (slot, index) in primitive.indices.iter_mut().enumerate() {
        let normal = corner_normals[slot].to_array();
        *index = *known.entry((*index, normal.map(f32::to_bits))).or_insert_with(|| {
            let mut vertex = primitive.vertices[*index as usize];
            vertex.normal = normal;
            vertices.push(vertex);
            vertices.len() as u32 - 1
        });
    }
    primitive.vertices = vertices;
}

/// Tangents for a normal map on one set of texture coordinates: the directions of growing U of the faces
/// around a vertex, weighted by angle, made perpendicular to the normal. Mirrored halves of a texture that
/// share vertices are split, since one vertex cannot have two handednesses.
pub fn tangents(primitive: &mut Primitive, uv_set: u32) {
    split_mirrored(primitive, uv_set);
    let mut sums = vec![(Vec3::ZERO, 0.0f32); primitive.vertices.len()];
    for corners in primitive.indices.as_chunks::<3>().0 {
        let (tangent, sign) = face_tangent(primitive, corners, uv_set);
        for k in 0..3 {
            let [p, q, r] = [k, (k + 1) % 3, (k + 2) % 3]
                .map(|i| Vec3::from(primitive.vertices[corners[i] as usize].position));
            let angle = corner_angle(p, q, r);
            let sum = &mut sums[corners[k] as usize];
            sum.0 += tangent * angle;
            sum.1 += sign * angle;
        }
    }
    for (vertex, (sum, sign)) in primitive.vertices.iter_mut().zip(sums) {
        let normal = Vec3::from(vertex.normal);
        let tangent = (sum - normal * normal.dot(sum)).normalize_or(normal.any_orthonormal_vector());
        vertex.tangent = tangent.extend(if sign < 0.0 { -1.0 } else { 1.0 }).to_array();
    }
}

fn uv_of(primitive: &Primitive, index: u32, uv_set: u32) -> Vec2 {
    let vertex = &primitive.vertices[index as usize];
    Vec2::from(if uv_set == 0 { vertex.uv0 } else { vertex.uv1 })
}

/// Unit direction of growing U on a face, and the handedness of its texture. V of glTF points down the
/// image while the bitangent points up, which the sign takes into account.
fn face_tangent(primitive: &Primitive, corners: &[u32; 3], uv_set: u32) -> (Vec3, f32) {
    let [a, b, c] = corners.map(|i| Vec3::from(primitive.vertices[i as usize].position));
    let [s, t, u] = corners.map(|i| uv_of(primitive, i, uv_set));
    let (e1, e2, d1, d2) = (b - a, c - a, t - s, u - s);
    let area = d1.perp_dot(d2);
    (((e1 * d2.y - e2 * d1.y) * area.signum()).normalize_or_zero(), -area.signum())
}

fn split_mirrored(primitive: &mut Primitive, uv_set: u32) {
    let count = primitive.vertices.len();
    let mut handedness = vec![0.0f32; count];
    let mut twins: HashMap<u32, u32> = HashMap::new();
    let faces = primitive.indices.len() / 3;
    for face in 0..faces {
        let slots = face * 3..face * 3 + 3;
        let corners = [0, 1, 2].map(|k| primitive.indices[slots.start + k]);
        let (_, sign) = face_tangent(primitive, &corners, uv_set);
        for slot in slots {
            let index = primitive.indices[slot];
            let known = &mut handedness[index as usize];
            if *known == 0.0 {
                *known = sign;
            } else if *known != sign {
                let next = primitive.vertices.len() as u32;
                let twin = *twins.entry(index).or_insert(next);
                if twin == next {
                    duplicate(primitive, index as usize);
                }
                primitive.indices[slot] = twin;
            }
        }
    }
}

/// Appends a copy of a vertex with everything that belongs to it.
fn duplicate(primitive: &mut Primitive, index: usize) {
    primitive.vertices.push(primitive.vertices[index]);
    let sets = primitive.influence_sets;
    if !primitive.influences.is_empty() {
        primitive.influences.extend_from_within(index * sets..(index + 1) * sets);
    }
    for target in &mut primitive.morph_targets {
        target.push(target[index]);
    }
    if !primitive.control.is_empty() {
        primitive.control.push(primitive.control[index]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Vertex;

    /// A square in the plane z = 0 seen from +Z, with U to the right and V down, or U mirrored.
    fn square(mirrored: bool) -> Primitive {
        let corner = |x: f32, y: f32| Vertex {
            position: [x, y, 0.0],
            uv0: [if mirrored { 1.0 - x } else { x }, 1.0 - y],
            ..Vertex::default()
        };
        Primitive {
            vertices: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Primitive::default()
        }
    }

    #[test]
    fn tangents_follow_u_and_bitangents_point_up_the_image() {
        for (mirrored, x, sign) in [(false, 1.0, 1.0), (true, -1.0, -1.0)] {
            let mut primitive = square(mirrored);
            tangents(&mut primitive, 0);
            for vertex in &primitive.vertices {
                assert_eq!(vertex.tangent, [x, 0.0, 0.0, sign]);
                let bitangent = Vec3::from(vertex.normal).cross(Vec3::X * x) * sign;
                assert_eq!(bitangent, Vec3::Y, "the image's up is +Y here");
            }
        }
    }

    #[test]
    fn mirrored_halves_are_split() {
        // Two triangles that share an edge whose texture is mirrored along it.
        let mut primitive = square(false);
        primitive.vertices[3].uv0 = primitive.vertices[1].uv0;
        tangents(&mut primitive, 0);
        assert_eq!(primitive.vertices.len(), 6);
        let sign = |slot: usize| primitive.vertices[primitive.indices[slot] as usize].tangent[3];
        assert_eq!([sign(0), sign(1), sign(2)], [1.0; 3]);
        assert_eq!([sign(3), sign(4), sign(5)], [-1.0; 3]);
    }

    #[test]
    fn incomplete_and_degenerate_triangles_are_dropped() {
        assert_eq!(triangle_list(Topology::List, &[0, 1, 2, 3, 3, 4, 5, 6]), [0, 1, 2]);
        assert_eq!(triangle_list(Topology::Strip, &[0, 1, 2, 3]), [0, 1, 2, 2, 1, 3]);
        assert_eq!(triangle_list(Topology::Fan, &[0, 1, 2, 3]), [0, 1, 2, 0, 2, 3]);
        for topology in [Topology::List, Topology::Strip, Topology::Fan] {
            assert!(triangle_list(topology, &[]).is_empty());
        }
    }
}
