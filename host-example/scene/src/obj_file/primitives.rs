//! Triangles of an OBJ file: those of one object with their normals, and primitives made of those of one material.

use std::collections::HashMap;

use glam::Vec3;

use super::polygons::triangulate;
use super::surfaces::{Corner, Face, Group, Surfaces};
use crate::geometry::{self, Smoothing};
use crate::model::{Primitive, Vertex};

/// Faces that meet at more than this keep a sharp edge between them when normals are averaged.
const CREASE: f32 = 60.0 * std::f32::consts::PI / 180.0;

/// A triangle.
pub struct Triangle {
    /// Index of its material.
    pub material: usize,
    corners: [Corner; 3],
    normals: [Vec3; 3],
}

/// The triangles of the faces of one object; normals are computed where the file has none. Smoothing groups reach from
/// one material into the next.
pub fn triangles(surfaces: &Surfaces, faces: &[Face], material: impl Fn(&Face) -> usize) -> Vec<Triangle> {
    let position = |corner: &Corner| Vec3::from(surfaces.positions[corner.position as usize - 1]);
    let (mut all, mut smoothing) = (Vec::new(), Vec::new());
    let (mut points, mut places) = (Vec::new(), Vec::new());
    for (number, face) in faces.iter().enumerate() {
        let corners = &surfaces.corners[face.corners.clone()];
        points.clear();
        points.extend(corners.iter().map(position));
        places.clear();
        triangulate(&points, &mut places);
        let material = material(face);
        for [a, b, c] in places.iter().map(|triangle| triangle.map(|place| corners[place])) {
            if a == b || b == c || c == a {
                continue;
            }
            let normal = |corner: Corner| match corner.normal.checked_sub(1) {
                Some(normal) => Vec3::from(surfaces.normals[normal as usize]).normalize_or(Vec3::Z),
                None => Vec3::ZERO,
            };
            all.push(Triangle { material, corners: [a, b, c], normals: [a, b, c].map(normal) });
            smoothing.push(match face.smoothing {
                Group::Unsaid => Smoothing::Crease(material),
                Group::Off => Smoothing::Flat(number),
                Group::Number(group) => Smoothing::Group(group),
            });
        }
    }
    if all.iter().flat_map(|triangle| &triangle.corners).any(|corner| corner.normal == 0) {
        let points: Vec<Vec3> =
            all.iter().flat_map(|triangle| triangle.corners.iter().map(position)).collect();
        let computed = geometry::corner_normals(&points, CREASE, |triangle| smoothing[triangle]);
        for (triangle, computed) in all.iter_mut().zip(computed.as_chunks::<3>().0) {
            let normals = triangle.corners.iter().zip(&mut triangle.normals).zip(computed);
            for ((_, normal), computed) in normals.filter(|((corner, _), _)| corner.normal == 0) {
                *normal = *computed;
            }
        }
    }
    all
}

/// The primitive of triangles of one material.
pub fn primitive(surfaces: &Surfaces, triangles: &[Triangle], material: usize) -> Primitive {
    let mut builder =
        Builder { surfaces, places: HashMap::new(), out: Primitive { material, ..Primitive::default() } };
    for triangle in triangles {
        for place in 0..3 {
            let index = builder.index(triangle.corners[place], triangle.normals[place]);
            builder.out.indices.push(index);
        }
    }
    let mut primitive = builder.out;
    if !surfaces.texcoords.is_empty() {
        geometry::tangents(&mut primitive, 0);
    }
    primitive
}

struct Builder<'a> {
    surfaces: &'a Surfaces,
    /// Vertex of each kind of corner with each normal.
    places: HashMap<(Corner, [u32; 3]), u32>,
    out: Primitive,
}

impl Builder<'_> {
    /// The vertex of a corner.
    fn index(&mut self, corner: Corner, normal: Vec3) -> u32 {
        let next = self.out.vertices.len() as u32;
        let index = *self.places.entry((corner, normal.to_array().map(f32::to_bits))).or_insert(next);
        if index == next {
            let vertex = self.vertex(corner);
            self.out.vertices.push(Vertex { normal: normal.to_array(), ..vertex });
        }
        index
    }

    fn vertex(&self, corner: Corner) -> Vertex {
        let place = |place: u32| (place as usize).checked_sub(1);
        let at = corner.position as usize - 1;
        let mut vertex = Vertex { position: self.surfaces.positions[at], ..Vertex::default() };
        if let Some(texcoord) = place(corner.texcoord) {
            // V of OBJ points up the image.
            let [u, v] = self.surfaces.texcoords[texcoord];
            vertex.uv0 = [u, 1.0 - v];
        }
        if let Some(color) = self.surfaces.colors.get(at) {
            let [r, g, b] = color.map(linear);
            vertex.color = [r, g, b, 1.0];
        }
        vertex
    }
}

/// Linear light of an sRGB value; beyond 1 as it is.
fn linear(value: f32) -> f32 {
    match value {
        ..=0.04045 => value / 12.92,
        ..1.0 => ((value + 0.055) / 1.055).powf(2.4),
        _ => value,
    }
}
