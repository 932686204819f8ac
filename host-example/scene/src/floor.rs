//! Tells a scene that brings a floor of its own from a model that stands on nothing.

use glam::{Vec2, Vec3};

use super::model::Scene;
use super::pose::Pose;

/// Places along each side of the scene, seen from above, at which a floor is looked for.
const PLACES: usize = 24;

/// Share of those places that a floor has at least.
const SHARE: f32 = 0.6;

/// Highest floor, as a share of the scene's height: what is higher is a pedestal.
const HIGHEST: f32 = 0.03;

/// Ratio of width to height that landscapes have at least. They are floors at any height.
const WIDE: f32 = 2.5;

/// Steepest slope of a floor: the least height of its unit normal.
const STEEPEST: f32 = 0.3;

/// True where there is no floor: along its sides, seen from above, the scene has nothing low that faces up.
/// Scenes with lights or backdrops of their own are whole, and taken as they are.
pub fn lacks_floor(scene: &Scene) -> bool {
    if scene.nodes.iter().any(|node| node.visible && (node.backdrop || node.light.is_some())) {
        return false;
    }
    let mut places = Places::new(scene);
    let pose = Pose::at_rest(scene);
    let mut positions = Vec::new();
    for draw in &scene.draws {
        positions.clear();
        let is_mirrored = pose.world[draw.node].determinant() < 0.0;
        pose.positions(scene, draw, |position| positions.push(position));
        for corners in scene.primitive(draw).indices.as_chunks::<3>().0 {
            let [a, b, c] = corners.map(|index| positions[index as usize]);
            places.cover(if is_mirrored { [a, c, b] } else { [a, b, c] });
        }
    }
    (places.covered.iter().filter(|is| **is).count() as f32) < SHARE * places.covered.len() as f32
}

/// Places just within the sides of the scene.
struct Places {
    points: Vec<Vec2>,
    covered: Vec<bool>,
    highest: f32,
}

impl Places {
    fn new(scene: &Scene) -> Self {
        let (low, high) = (scene.bounds.min, scene.bounds.max);
        let inner = |share: f32| 0.02 + 0.96 * share;
        let along = (0..PLACES).map(|i| inner((i as f32 + 0.5) / PLACES as f32));
        let shares = along.flat_map(|at| {
            [(at, inner(0.0)), (at, inner(1.0)), (inner(0.0), at), (inner(1.0), at)].map(Vec2::from)
        });
        let (corner, size) = (Vec2::new(low.x, low.z), Vec2::new(high.x - low.x, high.z - low.z));
        let points: Vec<Vec2> = shares.map(|share| corner + share * size).collect();
        let height = high.y - low.y;
        let is_landscape = size.min_element() >= WIDE * height;
        let highest = if is_landscape { high.y } else { low.y + HIGHEST * height };
        // Flat scenes are landscapes, too.
        let highest = highest + 1e-6 * scene.bounds.radius();
        Self { covered: vec![false; points.len()], points, highest }
    }

    /// Marks the places at which a triangle is a floor.
    fn cover(&mut self, corners: [Vec3; 3]) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let low = a.min(b).min(c);
        if low.y > self.highest || normal.y < STEEPEST * normal.length() || normal.y == 0.0 {
            return;
        }
        let high = a.max(b).max(c);
        let flat = |p: Vec3| Vec2::new(p.x, p.z);
        let edges = [(flat(a), flat(b)), (flat(b), flat(c)), (flat(c), flat(a))];
        for (point, covered) in self.points.iter().zip(&mut self.covered) {
            let is_near = point.x >= low.x && point.x <= high.x && point.y >= low.z && point.y <= high.z;
            if *covered || !is_near {
                continue;
            }
            let sides = edges.map(|(from, to)| (to - from).perp_dot(*point - from));
            let is_inside = sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0);
            let along = normal.x * (point.x - a.x) + normal.z * (point.y - a.z);
            *covered = is_inside && a.y - along / normal.y <= self.highest;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::build::Builder;

    fn lacks(obj: &str) -> bool {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, obj).unwrap();
        lacks_floor(&Scene::load(&path, None).unwrap())
    }

    const CUBE: &str = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n\
                        f 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";

    #[test]
    fn models_lack_a_floor_and_scenes_have_one() {
        assert!(lacks(&format!("{CUBE}f 1 2 3 4\n")), "a cube");
        assert!(lacks(&format!("{CUBE}v 0 9 0\nf 5 9 8\n")), "a box with something on it");
        let floor = "v -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\n";
        assert!(!lacks(&format!("{CUBE}{floor}f 9 12 11 10\n")), "a cube on a floor");
        assert!(!lacks(&format!("{floor}f 1 4 3 2\n")), "a floor alone");
        assert!(lacks(&format!("{CUBE}{}f 9 12 11 10\n", floor.replace(" 0 ", " 8 "))), "a roof");
        assert!(lacks("v -1 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"), "a wall");
        let hills = "v -9 0 -9\nv 9 1 -9\nv 9 0 9\nv -9 2 9\nv 0 5 0\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n";
        assert!(!lacks(hills), "hills");
    }

    #[test]
    fn backdrops_make_a_scene_whole() {
        let mut builder = Builder::triangle();
        assert!(lacks_floor(&builder.load().unwrap()));
        builder.json["nodes"][0]["extras"] = serde_json::json!({ "backdrop": true });
        assert!(!lacks_floor(&builder.load().unwrap()));
    }
}
