//! Man-made patterns: the mosaic, cloths, and the painted vase.

use super::names::Texture;
use super::picture::{Picture, blend};
use crate::noise::{fractal, hash, smoothstep, unit};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// One unit of a running key pattern, six cells wide and five high.
const KEY: [&[u8; 6]; 5] = [b"#####.", b"#...#.", b"#.###.", b"#.....", b"######"];

/// True where the key pattern is dark at a point; `point.x` counts units, `point.y` goes from 0 (top)
/// to 1.
fn key(point: Vec2) -> bool {
    let column = (point.x.rem_euclid(1.0) * 6.0) as usize;
    let row = (point.y.clamp(0.0, 0.999) * 5.0) as usize;
    KEY[row][column.min(5)] == b'#'
}

/// A carpet of black and white tesserae: a border of key pattern around a disc of
/// triangles that shrink towards the centre.
pub fn mosaic() -> Vec<(Texture, Picture)> {
    let picture = Picture::paint(1024, 1024, |uv| {
        // Tesserae are whole: the pattern is taken at the centre of each.
        const COUNT: f32 = 144.0;
        let tessera = (uv * COUNT).floor();
        let inside = uv * COUNT - tessera;
        let joint = inside.min(1.0 - inside).min_element();
        let dark = carpet((tessera + 0.5) / COUNT);
        let chip = unit(hash(tessera.as_ivec2(), 81)) - 0.5;
        let stone = if dark {
            Vec3::splat(0.10) + Vec3::new(0.07, 0.06, 0.055) * chip
        } else {
            Vec3::new(0.93, 0.90, 0.83) + Vec3::new(0.10, 0.11, 0.13) * chip
        };
        blend(Vec3::new(0.48, 0.44, 0.38), stone, smoothstep(0.02, 0.12, joint))
    });
    vec![(Texture::Mosaic, picture)]
}

/// True where the carpet is black at a texture coordinate.
fn carpet(uv: Vec2) -> bool {
    let edge = uv.min(1.0 - uv).min_element();
    let along = if uv.x.min(1.0 - uv.x) < uv.y.min(1.0 - uv.y) { uv.y } else { uv.x };
    if edge < 0.05 {
        return edge < 0.025;
    }
    if edge < 0.16 {
        return key(Vec2::new(along * 10.0, (edge - 0.05) / 0.11));
    }
    if edge < 0.20 {
        return edge > 0.18;
    }
    let centre = (uv - 0.5) * 2.0 / 0.58;
    let radius = centre.length();
    let angle = centre.y.atan2(centre.x) / TAU;
    if radius > 1.0 {
        // In the corners, quarters of a smaller disc.
        let corner = centre.abs() - 1.0;
        return radius > 1.08 && corner.length() < 0.30;
    }
    if radius > 0.93 {
        return true;
    }
    if radius < 0.2 {
        return radius > 0.16 || (angle * 6.0).rem_euclid(1.0) < 0.5;
    }
    // Rings of triangles; their height follows the radius, so that they keep their shape.
    let rings = (radius / 0.2).ln() / (0.93_f32 / 0.2).ln() * 5.0;
    let turn = (angle + 0.5) * 18.0 + rings.floor() * 0.5;
    1.0 - rings.fract() > (turn.fract() * 2.0 - 1.0).abs()
}

/// Striped cloth, the pennant and the vase.
pub fn fabrics() -> Vec<(Texture, Picture)> {
    let weave = |uv: Vec2, threads: f32| {
        let angle = uv * threads * TAU;
        0.94 + 0.06 * angle.x.sin() * angle.y.sin()
    };
    let stripes = Picture::paint(512, 512, |uv| {
        let stripe = (uv.x * 9.0).fract();
        let fade = 0.88 + 0.2 * fractal(uv, 4, 4, 91);
        let color = if stripe < 0.5 { Vec3::new(0.70, 0.10, 0.09) } else { Vec3::new(0.95, 0.90, 0.78) };
        let seam = smoothstep(0.0, 0.02, (stripe - 0.25).abs().min((stripe - 0.75).abs()) - 0.2);
        let color =
            if seam > 0.0 && stripe >= 0.5 { blend(color, Vec3::new(0.85, 0.72, 0.45), seam) } else { color };
        color * fade * weave(uv, 96.0)
    });
    let pennant = Picture::paint(512, 256, |uv| {
        let border = uv.min(1.0 - uv) * Vec2::new(2.0, 1.0);
        let edge = border.min_element();
        let gold = Vec3::new(0.93, 0.72, 0.28);
        let blue = Vec3::new(0.10, 0.20, 0.46);
        let centre = (uv - Vec2::new(0.42, 0.5)) * Vec2::new(2.0, 1.0);
        let ray = ((centre.y.atan2(centre.x) / TAU * 12.0).rem_euclid(1.0) * 2.0 - 1.0).abs();
        let radius = centre.length();
        let sun = radius < 0.14 || (radius > 0.17 && radius < 0.17 + 0.15 * (1.0 - ray));
        let band = edge > 0.05 && edge < 0.10;
        (if sun || band { gold } else { blue }) * weave(uv, 64.0)
    });
    vec![(Texture::Stripes, stripes), (Texture::Pennant, pennant), (Texture::Vase, vase())]
}

/// Bands of a painted vase, from the mouth (top) to the foot: black glaze on red clay.
fn vase() -> Picture {
    let clay = Vec3::new(0.80, 0.41, 0.22);
    let glaze = Vec3::new(0.075, 0.06, 0.06);
    Picture::paint(1024, 512, |uv| {
        let band = |low: f32, high: f32| (uv.y >= low && uv.y < high).then(|| (uv.y - low) / (high - low));
        let dark = if let Some(t) = band(0.12, 0.22) {
            // Tongues.
            let x = (uv.x * 32.0).fract() * 2.0 - 1.0;
            x.abs() < 0.62 && t < 0.75 + 0.25 * (1.0 - x * x / 0.4).max(0.0).sqrt()
        } else if let Some(t) = band(0.25, 0.33) {
            key(Vec2::new(uv.x * 18.0, t))
        } else if let Some(t) = band(0.36, 0.60) {
            waves(uv.x, t)
        } else if let Some(t) = band(0.63, 0.70) {
            ((uv.x * 24.0).fract() * 2.0 - 1.0).abs() < t
        } else if let Some(t) = band(0.78, 0.92) {
            // Rays that rise from the foot.
            ((uv.x * 20.0).fract() * 2.0 - 1.0).abs() < t
        } else {
            true
        };
        let mottled = 0.92 + 0.16 * fractal(uv, 8, 4, 97);
        (if dark { glaze } else { clay }) * mottled
    })
}

/// Running spirals (a wave band).
fn waves(x: f32, t: f32) -> bool {
    let cell = Vec2::new((x * 12.0).fract() * 2.0 - 1.0, (t * 2.0 - 1.0) * 1.1);
    let radius = cell.length();
    if radius > 0.92 {
        return cell.y > 0.0;
    }
    let angle = cell.y.atan2(cell.x);
    ((radius * 2.2 - angle / TAU).rem_euclid(1.0) - 0.5).abs() < 0.25
}
