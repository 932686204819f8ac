//! Surroundings as a picture: the light of all directions, equirectangular. What is above is at its upper edge, and
//! its middle is where -Z is: behind a model that is seen from its front.

use std::f32::consts::{PI, TAU};
use std::path::Path;

use glam::Vec3;
use half::f16;

use isophote_files::error::{Error, Result};
use isophote_pictures::convert::Conversion;
use isophote_pictures::exr::Selection;
use isophote_pictures::meaning::Meaning;
use isophote_pictures::read;

/// Most pixels across; larger pictures are reduced.
const MOST_ACROSS: usize = 8192;

/// Pixels across of the copy that light is summed over.
const FEW_ACROSS: usize = 256;

/// Mean light that pictures are brought to where they have less or more: files count in units of any magnitude.
const LEAST_MEAN: f32 = 0.1;
const MOST_MEAN: f32 = 0.45;

/// Brightest light that counts, in multiples of the mean: what is brighter is a lamp or the sun, which the sun of the
/// scene stands for.
const BRIGHTEST: f32 = 4.0;

/// Least one-sidedness of light whose direction is that of a sun, and least height of that.
const ONE_SIDED: f32 = 0.25;
const LOWEST_SUN: f32 = 0.1;

const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Light from all directions in linear Rec.709.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Four numbers a pixel, the last 1; rows from the top.
    pub pixels: Vec<f16>,
    /// Light that falls on a diffuse surface, divided by pi: factors of 1, y, z, x, xy, yz, 3zz-1, zx and xx-yy of its
    /// normal (Ramamoorthi and Hanrahan, "An efficient representation for irradiance environment maps", 2001).
    pub irradiance: [Vec3; 9],
    /// Mean light from above.
    pub zenith: Vec3,
    /// Mean light from around.
    pub horizon: Vec3,
    /// Mean light from below.
    pub ground: Vec3,
    /// Unit vector to where the light comes from, if it comes from one side above.
    pub sun: Option<Vec3>,
}

impl Environment {
    /// Reads a picture that the host can read, such as Radiance HDR or EXR.
    ///
    /// # Errors
    /// [`Error::Input`] for pictures that cannot be read or do not show all directions.
    pub fn read(path: &Path) -> Result<Self> {
        let source = read::read(path, &Selection::default())?;
        let without = || Error::file(path, "holds no picture", "name a picture of all directions");
        let picture = source.pictures.into_iter().next().ok_or_else(without)?;
        let (width, height) = (picture.pixels.width() as usize, picture.pixels.height() as usize);
        let channels = picture.pixels.channels() as usize;
        if width != 2 * height {
            return Err(Error::file(
                path,
                format!("is {width}x{height} pixels and so no equirectangular picture of all directions"),
                "name one that is twice as wide as high",
            ));
        }
        let changed = Conversion::between(&picture.meaning, &Meaning::light());
        let pixels = changed.map_or_else(|| picture.pixels.clone(), |change| change.apply(&picture.pixels).0);
        let light = |pixel: &[f32]| {
            let rgb = match *pixel {
                [r, g, b, ..] => [r, g, b],
                [v, ..] => [v; 3],
                [] => [0.0; 3],
            };
            // What is no number is no light; what is infinite is the most that the numbers hold.
            Vec3::from(rgb.map(|v| if v > 0.0 { v.min(f16::MAX.to_f32()) } else { 0.0 }))
        };
        let colors = pixels.to_f32().chunks_exact(channels.max(1)).map(light).collect();
        Ok(Self::new(reduced(Map { width, colors }, MOST_ACROSS)))
    }

    fn new(map: Map) -> Self {
        let mut few = reduced(map.clone(), FEW_ACROSS);
        let mut sums = Sums::of(&few);
        let sun = sums.sun;
        // The second time the mean is one without lamps.
        for _ in 0..2 {
            few.limit(BRIGHTEST * sums.mean.dot(LUMINANCE));
            sums = Sums::of(&few);
        }
        let mean = sums.mean.dot(LUMINANCE);
        // A black picture stays black.
        let scale = if mean > 0.0 { mean.clamp(LEAST_MEAN, MOST_MEAN) / mean } else { 1.0 };
        let pixel = |color: &Vec3| {
            let [r, g, b] = (*color * scale).min(Vec3::splat(f16::MAX.to_f32())).to_array();
            [r, g, b, 1.0].map(f16::from_f32)
        };
        Self {
            width: map.width as u32,
            height: (map.width / 2) as u32,
            pixels: map.colors.iter().flat_map(pixel).collect(),
            irradiance: sums.irradiance.map(|v| v * scale),
            zenith: sums.zenith * scale,
            horizon: sums.horizon * scale,
            ground: sums.ground * scale,
            sun,
        }
    }
}

/// Colours of all directions, twice as many across as down.
#[derive(Clone, Debug)]
struct Map {
    width: usize,
    colors: Vec<Vec3>,
}

impl Map {
    /// Makes light that is brighter than this as bright as this.
    fn limit(&mut self, most: f32) {
        for color in &mut self.colors {
            *color *= (most / color.dot(LUMINANCE).max(1e-12)).min(1.0);
        }
    }
}

/// Halves a map until it has at most so many pixels across.
fn reduced(mut map: Map, most: usize) -> Map {
    while map.width > most {
        let (width, height) = (map.width / 4 * 2, map.width / 4);
        let mut colors = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let at = |dx: usize, dy: usize| map.colors[(2 * y + dy) * map.width + 2 * x + dx];
                colors.push((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) * 0.25);
            }
        }
        map = Map { width, colors };
    }
    map
}

/// Sums over all directions.
struct Sums {
    mean: Vec3,
    irradiance: [Vec3; 9],
    zenith: Vec3,
    horizon: Vec3,
    ground: Vec3,
    sun: Option<Vec3>,
}

impl Sums {
    fn of(map: &Map) -> Self {
        let height = map.width / 2;
        let mut moments = [Vec3::ZERO; 9];
        let mut parts = [(Vec3::ZERO, 1e-9); 3];
        for y in 0..height {
            let (sin, cos) = (PI * (y as f32 + 0.5) / height as f32).sin_cos();
            let solid = TAU / map.width as f32 * (PI / height as f32) * sin;
            for x in 0..map.width {
                let around = TAU * ((x as f32 + 0.5) / map.width as f32 - 0.5);
                let n = Vec3::new(around.sin() * sin, cos, -around.cos() * sin);
                let light = map.colors[y * map.width + x] * solid;
                for (moment, value) in moments.iter_mut().zip(polynomials(n)) {
                    *moment += light * value;
                }
                let part = if n.y > 0.6 {
                    0
                } else if n.y > -0.4 {
                    1
                } else {
                    2
                };
                parts[part].0 += light;
                parts[part].1 += solid;
            }
        }
        // Squared norms of the harmonics, and how much of each a cosine lets pass.
        let first = 1.0 / (4.0 * PI);
        let factors = [
            first,
            2.0 * first,
            2.0 * first,
            2.0 * first,
            15.0 / 4.0 * first,
            15.0 / 4.0 * first,
            5.0 / 16.0 * first,
            15.0 / 4.0 * first,
            15.0 / 16.0 * first,
        ];
        let towards =
            Vec3::new(moments[3].dot(LUMINANCE), moments[1].dot(LUMINANCE), moments[2].dot(LUMINANCE));
        let all = moments[0].dot(LUMINANCE);
        let sun = (towards.length() > ONE_SIDED * all).then(|| towards.normalize());
        let [zenith, horizon, ground] = parts.map(|(light, solid)| light / solid);
        Self {
            mean: moments[0] * first,
            irradiance: std::array::from_fn(|i| moments[i] * factors[i]),
            zenith,
            horizon,
            ground,
            sun: sun.filter(|sun| sun.y > LOWEST_SUN),
        }
    }
}

/// The harmonics up to the second order without their norms.
fn polynomials(n: Vec3) -> [f32; 9] {
    let Vec3 { x, y, z } = n;
    [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, z * x, x * x - y * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(color: impl Fn(Vec3) -> Vec3) -> Map {
        let width = 128;
        let colors = (0..width * width / 2).map(|at| {
            let (x, y) = ((at % width) as f32 + 0.5, (at / width) as f32 + 0.5);
            let (sin, cos) = (PI * y / 64.0).sin_cos();
            let around = TAU * (x / 128.0 - 0.5);
            color(Vec3::new(around.sin() * sin, cos, -around.cos() * sin))
        });
        Map { width, colors: colors.collect() }
    }

    fn light(environment: &Environment, normal: Vec3) -> Vec3 {
        let terms = environment.irradiance.iter().zip(polynomials(normal));
        terms.map(|(factor, value)| *factor * value).sum()
    }

    #[test]
    fn even_light_is_the_same_from_all_sides() {
        let even = Environment::new(map(|_| Vec3::new(0.5, 0.4, 0.3)));
        for normal in [Vec3::X, Vec3::Y, -Vec3::Z, Vec3::ONE.normalize()] {
            assert!(light(&even, normal).abs_diff_eq(Vec3::new(0.5, 0.4, 0.3), 2e-3));
        }
        assert!(even.sun.is_none() && even.zenith.abs_diff_eq(even.ground, 1e-4));
        // An irradiance that is a polynomial of the second order is exact: of x * x it is (1 + x * x) / 4.
        let waist = Environment::new(map(|n| Vec3::splat(n.x * n.x)));
        for (normal, expected) in [(Vec3::X, 0.5), (Vec3::Y, 0.25), (Vec3::Z, 0.25)] {
            assert!((light(&waist, normal).x - expected).abs() < 3e-3, "{}", light(&waist, normal));
        }
    }

    #[test]
    fn light_of_one_side_has_a_direction_and_any_magnitude() {
        let towards = Vec3::new(1.0, 1.0, -0.5).normalize();
        for scale in [1e-3, 1.0, 1e4] {
            let lamp = Environment::new(map(|n| Vec3::splat(scale * n.dot(towards).max(0.0).powi(8))));
            assert!(lamp.sun.unwrap().dot(towards) > 0.99);
            assert!((LEAST_MEAN - 1e-3..=MOST_MEAN + 1e-3).contains(&lamp.irradiance[0].x));
            assert!(light(&lamp, towards).x > 3.0 * light(&lamp, -towards).x.max(0.0));
        }
    }

    #[test]
    fn maps_are_halved_until_they_fit() {
        let small = reduced(map(|n| Vec3::splat(n.y)), 40);
        assert_eq!((small.width, small.colors.len()), (32, 32 * 16));
        assert!(small.colors[0].x > 0.95 && small.colors[32 * 16 - 1].x < -0.95);
        let odd = reduced(Map { width: 6, colors: vec![Vec3::ONE; 18] }, 4);
        assert_eq!((odd.width, odd.colors.len()), (2, 2));
    }
}
