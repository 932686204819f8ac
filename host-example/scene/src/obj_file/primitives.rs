//! Meshes of an OBJ file: runs of faces of one object and one material.

use std::collections::HashMap;

use glam::Vec3;

use super::polygons::triangulate;
use super::surfaces::{Corner, Face, Surfaces};
use crate::geometry;
use crate::model::{Primitive, Vertex};

/// Faces that meet at more than this keep a sharp edge between them when normals are averaged.
const CREASE: f32 = 60.0 * std::f32::consts::PI / 180.0;

/// The triangles of some faces; texture coordinates and normals are computed where the file has none.
pub fn primitive(surfaces: &Surfaces, faces: &[Face], material: usize) -> Primitive {
    let mut builder =
        Builder { surfaces, places: HashMap::new(), given: Vec::new(), out: Primitive::default() };
    let (mut points, mut triangles, mut smoothing) = (Vec::new(), Vec::new(), Vec::new());
    for face in faces {
        let corners = &surfaces.corners[face.corners.clone()];
        let indices: Vec<u32> = corners.iter().map(|corner| builder.index(*corner)).collect();
        points.clear();
        points.extend(
            corners.iter().map(|corner| Vec3::from(surfaces.positions[corner.position as usize - 1])),
        );
        triangles.clear();
        triangulate(&points, &mut triangles);
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|corner| indices[corner]);
            if a != b && b != c && c != a {
                builder.out.indices.extend([a, b, c]);
                smoothing.push(face.smoothing);
            }
        }
    }
    let Builder { out: mut primitive, given, .. } = builder;
    primitive.material = material;
    if given.contains(&false) {
        geometry::normals(&mut primitive, CREASE, &smoothing, &given);
    }
    if !surfaces.texcoords.is_empty() {
        geometry::tangents(&mut primitive, 0);
    }
    primitive
}

struct Builder<'a> {
    surfaces: &'a Surfaces,
    /// Vertex of each kind of corner.
    places: HashMap<Corner, u32>,
    /// True for vertices whose normal the file gives.
    given: Vec<bool>,
    out: Primitive,
}

impl Builder<'_> {
    /// The vertex of a corner.
    fn index(&mut self, corner: Corner) -> u32 {
        let next = self.out.vertices.len() as u32;
        let index = *self.places.entry(corner).or_insert(next);
        if index == next {
            self.out.vertices.push(self.vertex(corner));
            self.given.push(corner.normal > 0);
        }
        index
    }

    fn vertex(&self, corner: Corner) -> Vertex {
        let place = |place: u32| (place as usize).checked_sub(1);
        let at = corner.position as usize - 1;
        let mut vertex = Vertex { position: self.surfaces.positions[at], ..Vertex::default() };
        if let Some(normal) = place(corner.normal) {
            vertex.normal = Vec3::from(self.surfaces.normals[normal]).normalize_or(Vec3::Z).to_array();
        }
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
