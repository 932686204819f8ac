//! Triangles of an OBJ file: those of one object with their normals, and primitives made of those of one material.

use std::collections::HashMap;

use glam::Vec3;

use super::normal_form::Group;
use super::polygons::triangulate;
use crate::geometry::{self, Smoothing};
use crate::model::{Primitive, Vertex};

/// Faces that meet at more than this keep a sharp edge between them when normals are averaged.
const CREASE: f32 = 60.0 * std::f32::consts::PI / 180.0;

/// A corner of a face: places in the lists of its mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Corner {
    position: u32,
    texcoord: Option<u32>,
    normal: Option<u32>,
}

impl Corner {
    fn of(mesh: &tobj::Mesh, slot: usize) -> Self {
        Self {
            position: mesh.indices[slot],
            texcoord: mesh.texcoord_indices.get(slot).copied(),
            normal: mesh.normal_indices.get(slot).copied(),
        }
    }

    fn position(self, mesh: &tobj::Mesh) -> Vec3 {
        Vec3::from(mesh.positions.as_chunks::<3>().0[self.position as usize])
    }

    /// The normal that the file has, if it has a direction.
    fn normal(self, mesh: &tobj::Mesh) -> Option<Vec3> {
        Vec3::from(mesh.normals.as_chunks::<3>().0[self.normal? as usize]).try_normalize()
    }
}

/// A triangle.
pub struct Triangle {
    corners: [Corner; 3],
    normals: [Option<Vec3>; 3],
}

/// Numbers of corners of the faces of a mesh; there are none where all are triangles.
fn arities(mesh: &tobj::Mesh) -> impl Iterator<Item = usize> {
    let triangles = if mesh.face_arities.is_empty() { mesh.indices.len() / 3 } else { 0 };
    mesh.face_arities.iter().map(|arity| *arity as usize).chain(std::iter::repeat_n(3, triangles))
}

/// The triangles of each mesh of one object, whose faces have smoothing `groups`, of which those that come next are
/// taken; normals are computed where the file has none. Smoothing groups reach from one material into the next.
pub fn triangles(meshes: &[&tobj::Mesh], groups: &mut impl Iterator<Item = Group>) -> Vec<Vec<Triangle>> {
    let (mut all, mut smoothing, mut number) = (Vec::new(), Vec::new(), 0);
    let (mut points, mut places): (Vec<Vec3>, Vec<[usize; 3]>) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let (mut triangles, mut start) = (Vec::new(), 0);
        for (arity, group) in arities(mesh).zip(&mut *groups) {
            points.clear();
            points.extend((start..start + arity).map(|slot| Corner::of(mesh, slot).position(mesh)));
            places.clear();
            triangulate(&points, &mut places);
            for corners in places.iter().map(|triangle| triangle.map(|place| Corner::of(mesh, start + place)))
            {
                let [a, b, c] = corners;
                if a == b || b == c || c == a {
                    continue;
                }
                triangles.push(Triangle { corners, normals: corners.map(|corner| corner.normal(mesh)) });
                smoothing.push(match group {
                    Group::Unsaid => Smoothing::Crease(mesh.material_id.map_or(0, |material| material + 1)),
                    Group::Off => Smoothing::Flat(number),
                    Group::Number(group) => Smoothing::Group(group),
                });
            }
            start += arity;
            number += 1;
        }
        all.push(triangles);
    }
    if all.iter().flatten().flat_map(|triangle| triangle.normals).any(|normal| normal.is_none()) {
        compute_normals(meshes, &mut all, &smoothing);
    }
    all
}

/// Computes the normals that are missing.
fn compute_normals(meshes: &[&tobj::Mesh], all: &mut [Vec<Triangle>], smoothing: &[Smoothing]) {
    let corners = meshes.iter().zip(all.iter()).flat_map(|(mesh, triangles)| {
        triangles.iter().flat_map(|triangle| triangle.corners).map(|corner| corner.position(mesh))
    });
    let points: Vec<Vec3> = corners.collect();
    let computed = geometry::corner_normals(&points, CREASE, |triangle| smoothing[triangle]);
    let normals = all.iter_mut().flatten().flat_map(|triangle| &mut triangle.normals);
    for (normal, computed) in normals.zip(computed) {
        normal.get_or_insert(computed);
    }
}

/// The primitive of the triangles of a mesh.
pub fn primitive(mesh: &tobj::Mesh, triangles: &[Triangle], material: usize) -> Primitive {
    let mut places: HashMap<(Corner, [u32; 3]), u32> = HashMap::new();
    let mut primitive = Primitive { material, ..Primitive::default() };
    for (corner, normal) in
        triangles.iter().flat_map(|triangle| triangle.corners.iter().zip(triangle.normals))
    {
        let normal = normal.unwrap_or(Vec3::Z).to_array();
        let next = primitive.vertices.len() as u32;
        let index = *places.entry((*corner, normal.map(f32::to_bits))).or_insert(next);
        if index == next {
            primitive.vertices.push(vertex(mesh, *corner, normal));
        }
        primitive.indices.push(index);
    }
    if !mesh.texcoords.is_empty() {
        geometry::tangents(&mut primitive, 0);
    }
    primitive
}

fn vertex(mesh: &tobj::Mesh, corner: Corner, normal: [f32; 3]) -> Vertex {
    let position = corner.position(mesh).to_array();
    let mut vertex = Vertex { position, normal, ..Vertex::default() };
    if let Some(texcoord) = corner.texcoord {
        // V of OBJ points up the image.
        let [u, v] = mesh.texcoords.as_chunks::<2>().0[texcoord as usize];
        vertex.uv0 = [u, 1.0 - v];
    }
    if let Some(color) = mesh.vertex_color.as_chunks::<3>().0.get(corner.position as usize) {
        let [r, g, b] = color.map(linear);
        vertex.color = [r, g, b, 1.0];
    }
    vertex
}

/// Linear light of an sRGB value; beyond 1 as it is.
fn linear(value: f32) -> f32 {
    match value {
        ..=0.04045 => value / 12.92,
        ..1.0 => ((value + 0.055) / 1.055).powf(2.4),
        _ => value,
    }
}
