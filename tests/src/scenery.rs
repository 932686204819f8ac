//! Pictures of something: forms as a renderer knows them, and a landscape at any size.

use crate::pictures::from_fn;
use isophote_engine::Image;
use std::sync::OnceLock;

/// A picture with all that renderers know of it: balls and a roof over a floor, textured and plain.
pub fn forms() -> &'static [(&'static str, Image)] {
    static SCENE: OnceLock<Vec<(&str, Image)>> = OnceLock::new();
    SCENE.get_or_init(|| {
        const SIZE: [u32; 2] = [240, 180];
        let at = |x: i32, y: i32| {
            let (u, v) = (x as f32 / 180.0, y as f32 / 180.0);
            // A roof of three sides.
            let (dx, dy) = ((u - 0.85) / 0.2, (v - 0.3) / 0.2);
            if dx.abs() < 1.0 && dy.abs() < 1.0 {
                let n = match (dy < -0.4, dx < 0.1) {
                    (true, _) => [0.0, 0.9, 0.44],
                    (_, true) => [-0.6, 0.0, 0.8],
                    _ => [0.7, 0.0, 0.71],
                };
                let light = 0.35 + 0.25 * (n[2] - n[0] + n[1]);
                return ([0.75, 0.7, 0.6].map(|c| c * light), n, 3.5 + dx.abs(), 5.0);
            }
            for (number, [cx, cy, r]) in [[0.45, 0.55, 0.3], [1.0, 0.65, 0.22]].into_iter().enumerate() {
                let (dx, dy) = ((u - cx) / r, (v - cy) / r);
                let zz = 1.0 - dx * dx - dy * dy;
                if zz > 0.0 {
                    let n = [dx, -dy, zz.sqrt()];
                    let half = 0.5 + 0.5 * (n[2] * 0.6 - n[0] * 0.5 + n[1] * 0.6);
                    let light = 0.15 + 0.85 * half * half;
                    let checks = ((dx * 5.0).floor() as i32 + (dy * 5.0).floor() as i32).rem_euclid(2) as f32;
                    let own = if number == 0 { [0.8, 0.3, 0.2] } else { [0.25 + 0.3 * checks, 0.5, 0.75] };
                    return (own.map(|c| c * light), n, 4.0 - n[2] * r, number as f32 + 1.0);
                }
            }
            if v > 0.7 {
                let far = 3.0 / (v - 0.45);
                ([0.35, 0.4 + 0.2 * v, 0.25], [0.0, 0.9, 0.44], far, 9.0)
            } else {
                ([0.55 + 0.3 * v, 0.7, 0.9 - 0.1 * u], [0.0; 3], 0.0, 0.0)
            }
        };
        let [width, height] = SIZE;
        let color = |x, y| {
            let [r, g, b] = at(x, y).0;
            [r, g, b, 1.0]
        };
        let normal = |x, y| {
            let (_, [a, b, c], _, id) = at(x, y);
            [a, b, c, f32::from(id > 0.0)]
        };
        vec![
            ("color", from_fn(width, height, color)),
            ("normal", from_fn(width, height, normal)),
            ("depth", from_fn(width, height, |x, y| [at(x, y).2])),
            ("object_id", from_fn(width, height, |x, y| [at(x, y).3])),
        ]
    })
}

/// A picture that is the same at every size: soft and sharp forms.
pub fn landscape(height: u32) -> Image {
    let h = height as f32;
    let at = |u: f32, v: f32| {
        let hill = 0.55 + 0.12 * (u * 4.0).sin();
        let disc = (u - 0.9).hypot(v - 0.3) < 0.16;
        let tower = (0.35..0.47).contains(&u) && v > 0.25;
        match (disc, tower, v > hill) {
            (true, ..) => [0.95, 0.75, 0.25],
            (_, true, _) => [0.45, 0.2 + 0.3 * v, 0.25],
            (_, _, true) => [0.2 + 0.2 * (v - hill), 0.42, 0.2],
            _ => [0.45 + 0.4 * v, 0.6 + 0.3 * v, 0.9],
        }
    };
    from_fn(height * 4 / 3, height, |x, y| {
        let mut sum = [0.0; 3];
        for i in 0..16 {
            let (dx, dy) = ((i % 4) as f32 * 0.25 + 0.125, (i / 4) as f32 * 0.25 + 0.125);
            let color = at((x as f32 + dx) / h, (y as f32 + dy) / h);
            sum = [0, 1, 2].map(|c| sum[c] + color[c] / 16.0);
        }
        [sum[0], sum[1], sum[2], 1.0]
    })
}
