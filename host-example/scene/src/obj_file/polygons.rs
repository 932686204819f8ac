//! Triangles of faces with any number of corners, concave ones included.

use earcut::Earcut;
use glam::{Vec2, Vec3};

/// Appends the triangles of a polygon, each as places among its corners. Convex ones become fans around their first
/// corner.
pub fn triangulate(corners: &[Vec3], triangles: &mut Vec<[usize; 3]>) {
    let fan = |triangles: &mut Vec<[usize; 3]>| {
        triangles.extend((2..corners.len()).map(|last| [0, last - 1, last]));
    };
    if corners.len() <= 3 {
        return fan(triangles);
    }
    let normal = area(corners).normalize_or_zero();
    let (right, up) = normal.try_normalize().unwrap_or(Vec3::Z).any_orthonormal_pair();
    let flat: Vec<Vec2> =
        corners.iter().map(|p| Vec2::new((p - corners[0]).dot(right), (p - corners[0]).dot(up))).collect();
    if normal == Vec3::ZERO || !normal.is_finite() || is_convex(&flat) {
        return fan(triangles);
    }
    let mut places: Vec<u32> = Vec::new();
    Earcut::new().earcut(flat.iter().map(Vec2::to_array), &[], &mut places);
    if places.is_empty() {
        return fan(triangles);
    }
    triangles.extend(places.as_chunks::<3>().0.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|place| place as usize);
        let turns_right = (flat[b] - flat[a]).perp_dot(flat[c] - flat[a]) < 0.0;
        if turns_right { [a, c, b] } else { [a, b, c] }
    }));
}

/// Twice the area as a vector along the normal, by Newell's sum.
fn area(corners: &[Vec3]) -> Vec3 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| (a - corners[0]).cross(b - corners[0])).sum()
}

/// True where no corner of a polygon, which is counter-clockwise, turns right.
fn is_convex(corners: &[Vec2]) -> bool {
    let count = corners.len();
    let size = corners.iter().fold(0.0f32, |size, corner| size.max(corner.abs().max_element()));
    (0..count).all(|i| {
        let [a, b, c] = [i, (i + 1) % count, (i + 2) % count].map(|i| corners[i]);
        (b - a).perp_dot(c - b) >= -1e-6 * size * size
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(corners: &[[f32; 3]]) -> Vec<[usize; 3]> {
        let corners: Vec<Vec3> = corners.iter().map(|p| Vec3::from(*p)).collect();
        let mut triangles = Vec::new();
        triangulate(&corners, &mut triangles);
        triangles
    }

    #[test]
    fn convex_polygons_become_fans() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, -1.0], [0.0, 0.0, -1.0]];
        assert_eq!(triangles(&square), [[0, 1, 2], [0, 2, 3]]);
        // A corner on a side is no reason to cut otherwise.
        let five = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        assert_eq!(triangles(&five), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(triangles(&[[0.0; 3]; 5]).len(), 3, "degenerate ones stay as they are");
    }

    #[test]
    fn concave_polygons_are_covered_once_from_every_side() {
        let shape =
            [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [3.0, 2.0], [3.0, 3.0], [0.0, 3.0]];
        for start in 0..shape.len() {
            for place in [
                |[x, y]: [f32; 2]| Vec3::new(x, y, 5.0),
                |[x, y]: [f32; 2]| Vec3::new(-y, 0.0, x),
                |[x, y]: [f32; 2]| Vec3::new(y, x, y),
            ] {
                let mut turned = shape;
                turned.rotate_left(start);
                let corners = turned.map(place);
                let mut triangles = Vec::new();
                triangulate(&corners, &mut triangles);
                let whole = area(&corners);
                let parts = triangles.iter().map(|t| area(&t.map(|i| corners[i])));
                let sizes: f32 = parts.clone().map(Vec3::length).sum();
                assert!((sizes - whole.length()).abs() < 1e-4, "{sizes} is not {whole}");
                assert!(
                    parts.clone().all(|part| part.dot(whole) > 0.0),
                    "all triangles face as the polygon does"
                );
            }
        }
    }
}
