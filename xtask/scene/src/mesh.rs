//! Triangle meshes and the shapes that everything in the scene is built of.
//!
//! Lengths are metres, y is up, faces wind counter-clockwise seen from outside. Texture coordinates
//! are metres too (u to the right, v down); a material scales them with `KHR_texture_transform`, so
//! that every surface has the texel density of its material whatever its size.

use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};
use std::f32::consts::{PI, TAU};

/// An indexed triangle list. `colors` may end before the vertices do; the rest is white. `joints` and
/// `weights` are empty or have one entry per vertex, and so has each entry of `morphs`.
#[derive(Clone, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub colors: Vec<Vec4>,
    pub joints: Vec<[u8; 4]>,
    pub weights: Vec<[f32; 4]>,
    pub morphs: Vec<Morph>,
    pub indices: Vec<u32>,
}

/// Displacements of a morph target.
#[derive(Clone, Default)]
pub struct Morph {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
}

/// Faces of a box that exist.
#[derive(Clone, Copy, PartialEq)]
pub enum Faces {
    All,
    /// All but the bottom, which stands on something.
    Standing,
    /// The four sides.
    Sides,
}

/// The texture coordinate, in metres, of a point on a plane: u runs horizontally, v downhill.
pub fn metric_uv(point: Vec3, normal: Vec3) -> Vec2 {
    let across = if normal.y.abs() > 0.999 { Vec3::X } else { Vec3::Y.cross(normal).normalize() };
    Vec2::new(point.dot(across), -point.dot(normal.cross(across)))
}

impl Mesh {
    /// Adds a vertex and returns its index.
    pub fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// Adds a flat convex polygon with texture coordinates in metres.
    pub fn face(&mut self, corners: &[Vec3]) -> &mut Self {
        let normal = polygon_normal(corners);
        let uvs: Vec<Vec2> = corners.iter().map(|&corner| metric_uv(corner, normal)).collect();
        self.textured_face(corners, &uvs)
    }

    /// Adds a flat convex polygon with the given texture coordinates.
    pub fn textured_face(&mut self, corners: &[Vec3], uvs: &[Vec2]) -> &mut Self {
        let normal = polygon_normal(corners);
        let first = self.positions.len() as u32;
        for (&corner, &uv) in corners.iter().zip(uvs) {
            self.vertex(corner, normal, uv);
        }
        for index in 2..corners.len() as u32 {
            self.indices.extend([first, first + index - 1, first + index]);
        }
        self
    }

    /// Adds a quadrilateral that shows the whole texture once; the first corner is the lower left.
    pub fn picture(&mut self, corners: [Vec3; 4]) -> &mut Self {
        self.textured_face(&corners, &[Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO])
    }

    /// Adds an axis-aligned box between two corners.
    pub fn cuboid(&mut self, low: Vec3, high: Vec3, faces: Faces) -> &mut Self {
        let corner = |x: bool, y: bool, z: bool| {
            Vec3::new(
                if x { high.x } else { low.x },
                if y { high.y } else { low.y },
                if z { high.z } else { low.z },
            )
        };
        let (o, i) = (false, true);
        self.face(&[corner(o, o, i), corner(i, o, i), corner(i, i, i), corner(o, i, i)]);
        self.face(&[corner(i, o, o), corner(o, o, o), corner(o, i, o), corner(i, i, o)]);
        self.face(&[corner(i, o, i), corner(i, o, o), corner(i, i, o), corner(i, i, i)]);
        self.face(&[corner(o, o, o), corner(o, o, i), corner(o, i, i), corner(o, i, o)]);
        if faces != Faces::Sides {
            self.face(&[corner(o, i, i), corner(i, i, i), corner(i, i, o), corner(o, i, o)]);
        }
        if faces == Faces::All {
            self.face(&[corner(o, o, o), corner(i, o, o), corner(i, o, i), corner(o, o, i)]);
        }
        self
    }

    /// Adds a box that stands on `y`, given by its centre in plan, its size and its lowest y.
    pub fn block(&mut self, x: f32, y: f32, z: f32, size: Vec3) -> &mut Self {
        let half = Vec3::new(size.x / 2.0, 0.0, size.z / 2.0);
        let base = Vec3::new(x, y, z);
        self.cuboid(base - half, base + half + Vec3::Y * size.y, Faces::All)
    }

    /// Adds a square beam of the given width and height from one point to another.
    pub fn beam(&mut self, from: Vec3, to: Vec3, width: f32, height: f32) -> &mut Self {
        let along = (to - from).normalize();
        let reference = if along.y.abs() > 0.95 { Vec3::Z } else { Vec3::Y };
        let side = along.cross(reference).normalize();
        let up = side.cross(along);
        let mut beam = Self::default();
        let half = Vec3::new(width / 2.0, height / 2.0, 0.0);
        beam.cuboid(-half, half + Vec3::Z * from.distance(to), Faces::All);
        self.append(
            &beam,
            Mat4::from_cols((-side).extend(0.0), up.extend(0.0), along.extend(0.0), from.extend(1.0)),
        )
    }

    /// Adds a smooth parametric patch `shape(u, v)`, u to the right and v upwards, sampled on
    /// `columns` x `rows` quadrilaterals. Texture coordinates span `uv_size` and begin at zero.
    pub fn patch(
        &mut self,
        columns: u32,
        rows: u32,
        uv_size: Vec2,
        shape: impl Fn(f32, f32) -> Vec3,
    ) -> &mut Self {
        let first = self.positions.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let (u, v) = (column as f32 / columns as f32, row as f32 / rows as f32);
                let uv = Vec2::new(u, 1.0 - v) * uv_size;
                self.vertex(shape(u, v), patch_normal(&shape, u, v), uv);
            }
        }
        let stride = columns + 1;
        for row in 0..rows {
            for column in 0..columns {
                let corner = first + row * stride + column;
                self.indices.extend([corner, corner + 1, corner + stride + 1]);
                self.indices.extend([corner, corner + stride + 1, corner + stride]);
            }
        }
        self
    }

    /// Adds the surface of revolution of a profile of (radius, height) points, listed upwards on the
    /// outside. Profile corners sharper than 35 degrees become creases.
    pub fn lathe(&mut self, profile: &[Vec2], segments: u32) -> &mut Self {
        let reference = profile.iter().fold(0.0, |widest: f32, point| widest.max(point.x));
        let slopes: Vec<Vec2> = profile
            .windows(2)
            .map(|pair| {
                let step = pair[1] - pair[0];
                Vec2::new(step.y, -step.x).normalize_or_zero()
            })
            .collect();
        let mut travelled = 0.0;
        for (index, pair) in profile.windows(2).enumerate() {
            let smooth = |neighbour: Option<&Vec2>| match neighbour {
                Some(other) if other.dot(slopes[index]) > 0.82 => (*other + slopes[index]).normalize(),
                _ => slopes[index],
            };
            let below = smooth(index.checked_sub(1).and_then(|previous| slopes.get(previous)));
            let above = smooth(slopes.get(index + 1));
            let length = pair[0].distance(pair[1]);
            let first = self.positions.len() as u32;
            for (point, slope, v) in [(pair[0], below, travelled), (pair[1], above, travelled + length)] {
                for segment in 0..=segments {
                    let turn = segment as f32 / segments as f32;
                    let (sin, cos) = (turn * TAU).sin_cos();
                    let position = Vec3::new(point.x * sin, point.y, point.x * cos);
                    let normal = Vec3::new(slope.x * sin, slope.y, slope.x * cos).normalize();
                    self.vertex(position, normal, Vec2::new(turn * TAU * reference, -v));
                }
            }
            for segment in 0..segments {
                let (low, high) = (first + segment, first + segments + 1 + segment);
                if pair[0].x > 1e-5 {
                    self.indices.extend([low, low + 1, high + 1]);
                }
                if pair[1].x > 1e-5 {
                    self.indices.extend([low, high + 1, high]);
                }
            }
            travelled += length;
        }
        self
    }

    /// Adds an ellipsoid about a centre.
    pub fn ellipsoid(&mut self, centre: Vec3, radii: Vec3, segments: u32) -> &mut Self {
        let profile: Vec<Vec2> = (0..=segments / 2)
            .map(|step| {
                let angle = PI * (step as f32 / (segments / 2) as f32 - 0.5);
                // The poles are exact, so that their collapsed triangles are left out.
                Vec2::new(if step == 0 || step == segments / 2 { 0.0 } else { angle.cos() }, angle.sin())
            })
            .collect();
        let mut ball = Self::default();
        ball.lathe(&profile, segments);
        let scale = (radii.x + radii.y + radii.z) / 3.0;
        ball.uvs.iter_mut().for_each(|uv| *uv *= scale);
        self.append(&ball, Mat4::from_translation(centre) * Mat4::from_scale(radii))
    }

    /// Adds a round tube along a path, with a radius at each of its points.
    pub fn tube(&mut self, path: &[Vec3], radii: &[f32], segments: u32) -> &mut Self {
        let first = self.positions.len() as u32;
        let mut side = Vec3::X;
        let mut travelled = 0.0;
        for (index, (&point, &radius)) in path.iter().zip(radii).enumerate() {
            let before = path[index.saturating_sub(1)];
            let after = path[(index + 1).min(path.len() - 1)];
            let along = (after - before).normalize_or(Vec3::Y);
            // Carrying the frame along the path keeps it from twisting.
            side = (side - along * side.dot(along)).try_normalize().unwrap_or(along.any_orthonormal_vector());
            let up = along.cross(side);
            travelled += point.distance(before);
            for segment in 0..=segments {
                let turn = segment as f32 / segments as f32;
                let (sin, cos) = (turn * TAU).sin_cos();
                let normal = side * cos + up * sin;
                self.vertex(point + normal * radius, normal, Vec2::new(turn * TAU * radius, -travelled));
            }
        }
        for ring in 0..path.len().saturating_sub(1) as u32 {
            for segment in 0..segments {
                let low = first + ring * (segments + 1) + segment;
                let high = low + segments + 1;
                self.indices.extend([low, low + 1, high + 1, low, high + 1, high]);
            }
        }
        self
    }

    /// Adds a moulding that runs around a rectangle with mitred corners: `half` is half the
    /// rectangle's size in plan, the profile lists (outset, height) upwards on the outside.
    pub fn moulding(&mut self, half: Vec2, profile: &[Vec2]) -> &mut Self {
        for pair in profile.windows(2) {
            let ring = |point: Vec2| {
                let (x, z) = (half.x + point.x, half.y + point.x);
                [(-x, z), (x, z), (x, -z), (-x, -z)].map(|(x, z)| Vec3::new(x, point.y, z))
            };
            let (low, high) = (ring(pair[0]), ring(pair[1]));
            for side in 0..4 {
                let next = (side + 1) % 4;
                self.face(&[low[side], low[next], high[next], high[side]]);
            }
        }
        self
    }

    /// Adds a convex polygon in the xy plane, drawn counter-clockwise, extruded from z = 0 to
    /// `depth`, with both caps.
    pub fn prism(&mut self, outline: &[Vec2], depth: f32) -> &mut Self {
        let front: Vec<Vec3> = outline.iter().map(|point| point.extend(depth)).collect();
        let back: Vec<Vec3> = outline.iter().rev().map(|point| point.extend(0.0)).collect();
        self.face(&front).face(&back);
        for (index, &a) in outline.iter().enumerate() {
            let b = outline[(index + 1) % outline.len()];
            self.face(&[b.extend(depth), a.extend(depth), a.extend(0.0), b.extend(0.0)]);
        }
        self
    }

    /// Adds a copy of another mesh under a transform.
    pub fn append(&mut self, other: &Self, transform: Mat4) -> &mut Self {
        let first = self.positions.len() as u32;
        let linear = Mat3::from_mat4(transform);
        let for_normals = linear.inverse().transpose();
        // Vertices without a colour stay so until they are painted or another colour follows.
        if !other.colors.is_empty() {
            self.colors.resize(self.positions.len(), Vec4::ONE);
            self.colors.extend(&other.colors);
        }
        self.positions.extend(other.positions.iter().map(|&point| transform.transform_point3(point)));
        self.normals.extend(other.normals.iter().map(|&normal| (for_normals * normal).normalize()));
        self.uvs.extend(&other.uvs);
        let mirrored = linear.determinant() < 0.0;
        self.indices.extend(other.indices.chunks_exact(3).flat_map(|triangle| {
            let [a, b, c] = [triangle[0] + first, triangle[1] + first, triangle[2] + first];
            if mirrored { [a, c, b] } else { [a, b, c] }
        }));
        self
    }

    /// Gives every vertex that has none yet a colour (linear, with alpha).
    pub fn paint(&mut self, color: impl Fn(Vec3, Vec3) -> Vec3) -> &mut Self {
        for index in self.colors.len()..self.positions.len() {
            self.colors.push(color(self.positions[index], self.normals[index]).extend(1.0));
        }
        self
    }

    /// Stretches the texture coordinates over [0, 1]², so that the texture shows once.
    pub fn fit_uvs(&mut self) -> &mut Self {
        let low = self.uvs.iter().copied().fold(Vec2::MAX, Vec2::min);
        let high = self.uvs.iter().copied().fold(Vec2::MIN, Vec2::max);
        let size = (high - low).max(Vec2::splat(1e-6));
        self.uvs.iter_mut().for_each(|uv| *uv = (*uv - low) / size);
        self
    }
}

/// The unit normal of a polygon (Newell's method, which also bears collinear corners).
fn polygon_normal(corners: &[Vec3]) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for (index, &corner) in corners.iter().enumerate() {
        sum += corner.cross(corners[(index + 1) % corners.len()]);
    }
    sum.normalize_or(Vec3::Y)
}

/// The unit normal of a parametric patch; where it degenerates (a pole) that of a point close by.
fn patch_normal(shape: &impl Fn(f32, f32) -> Vec3, u: f32, v: f32) -> Vec3 {
    const STEP: f32 = 2e-3;
    for inset in [0.0, 0.01, 0.05] {
        let (u, v) = (u.clamp(inset, 1.0 - inset), v.clamp(inset, 1.0 - inset));
        let along_u = shape((u + STEP).min(1.0), v) - shape((u - STEP).max(0.0), v);
        let along_v = shape(u, (v + STEP).min(1.0)) - shape(u, (v - STEP).max(0.0));
        let normal = along_u.cross(along_v);
        if normal.length() > 1e-3 * along_u.length().max(along_v.length()).powi(2) {
            return normal.normalize();
        }
    }
    Vec3::Y
}
