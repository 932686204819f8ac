//! Generated pictures, guides and fields: the awkward ones that kernels are compared on.

use crate::random::Random;
use isophote::spec::ImageKind;
use isophote_cryptomatte::id;
use isophote_engine::Image;

/// A kind of picture that may go wrong in a way of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Independent uniform values, opaque.
    Noise,
    /// Flat patches with sharp straight and slanted edges, opaque.
    Steps,
    /// Scene-linear light from -2 to 10,000.
    Hdr,
    /// Steps with parts that are transparent, sharply and gradually; premultiplied.
    CutOut,
    /// Noise with some values that are not finite.
    Broken,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Noise, Self::Steps, Self::Hdr, Self::CutOut, Self::Broken];
}

/// An image of `width` x `height` from a function of the pixel's position.
///
/// # Panics
/// For a size that no image can have.
pub fn from_fn<const N: usize>(
    width: u32,
    height: u32,
    mut value: impl FnMut(i32, i32) -> [f32; N],
) -> Image {
    let mut data = Vec::with_capacity((width * height) as usize * N);
    for y in 0..height as i32 {
        for x in 0..width as i32 {
            data.extend_from_slice(&value(x, y));
        }
    }
    match Image::from_vec(width, height, N as u32, data) {
        Ok(image) => image,
        Err(e) => panic!("{e}"),
    }
}

/// A colour picture, premultiplied.
pub fn color(kind: Kind, width: u32, height: u32) -> Image {
    let mut random = Random::new(u64::from(width) << 20 | u64::from(height) << 4 | kind as u64);
    match kind {
        Kind::Noise => from_fn(width, height, |_, _| {
            let mut v = || random.unit() as f32;
            [v(), v(), v(), 1.0]
        }),
        Kind::Steps => from_fn(width, height, |x, y| {
            let [r, g, b] = steps(x, y);
            [r, g, b, 1.0]
        }),
        Kind::Hdr => from_fn(width, height, |x, y| {
            let [r, g, b] = steps(x, y);
            let light = match random.below(12) {
                0 => random.range(-2.0, 0.0),
                1 => random.range(100.0, 10_000.0),
                _ => random.range(0.0, 4.0),
            };
            [r * light, g * light, b * light + 0.01, 1.0]
        }),
        Kind::CutOut => from_fn(width, height, |x, y| {
            let alpha = match (x / 9 + y / 6) % 3 {
                0 => 0.0,
                1 => 1.0,
                _ => (x % 9) as f32 / 8.0,
            };
            let [r, g, b] = steps(x + 3, y);
            [r * alpha, g * alpha, b * alpha, alpha]
        }),
        Kind::Broken => broken(from_fn(width, height, |_, _| {
            let mut v = || random.unit() as f32;
            [v(), v(), v(), 1.0]
        })),
    }
}

/// Replaces some values by NaN, infinities and the farthest numbers; a single pixel loses its first value.
pub fn broken(mut image: Image) -> Image {
    const BAD: [f32; 6] =
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -f32::NAN, f32::MAX, -f32::MIN_POSITIVE / 8.0];
    for (i, v) in image.data_mut().iter_mut().enumerate().step_by(59) {
        *v = BAD[(i / 59) % BAD.len()];
    }
    image
}

/// Values that arithmetic runs over on, which hosts hand over all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hard {
    /// The largest number everywhere.
    Largest,
    /// The largest number and its negative in turn, in patches.
    Opposite,
    /// Numbers whose squares are 0.
    Tiny,
    /// Infinity everywhere.
    Infinite,
    /// Nothing that is a number.
    NotANumber,
    /// All of these and large ones between what the image holds.
    Mixed,
}

impl Hard {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Largest, Self::Opposite, Self::Tiny, Self::Infinite, Self::NotANumber, Self::Mixed];

    /// The image with such values.
    pub fn of(self, mut image: Image) -> Image {
        const MIXED: [f32; 9] =
            [f32::MAX, f32::MIN, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-38, -1e-42, 3e19, -2e9];
        let (channels, width) = (image.channels() as usize, image.width() as usize);
        let mut random = Random::new(17);
        for (i, v) in image.data_mut().iter_mut().enumerate() {
            let (x, y) = (i / channels % width, i / channels / width);
            *v = match self {
                Self::Largest => f32::MAX,
                Self::Opposite if (x / 3 + y / 5 + i % channels).is_multiple_of(2) => f32::MAX,
                Self::Opposite => f32::MIN,
                Self::Tiny => 1e-38 * (1 + (x + y) % 5) as f32,
                Self::Infinite => f32::INFINITY,
                Self::NotANumber => f32::NAN,
                Self::Mixed => MIXED.get(random.below(3 * MIXED.len())).copied().unwrap_or(*v),
            };
        }
        image
    }
}

/// The image with normal noise on its colours, of this standard deviation.
pub fn noisy(mut image: Image, sigma: f32, seed: u64) -> Image {
    let mut random = Random::new(seed);
    for pixel in image.data_mut().chunks_exact_mut(4) {
        pixel[..3].iter_mut().for_each(|v| *v += sigma * random.normal() as f32);
    }
    image
}

/// The image moved by whole pixels to the right and down; its edges are drawn out.
pub fn moved(image: &Image, by: [i32; 2]) -> Image {
    let mut moved = image.clone();
    let (w, h) = (image.width() as i32, image.height() as i32);
    for y in 0..h {
        for x in 0..w {
            let from = image.pixel((x - by[0]).clamp(0, w - 1), (y - by[1]).clamp(0, h - 1));
            let at = ((y * w + x) as usize) * from.len();
            moved.data_mut()[at..at + from.len()].copy_from_slice(from);
        }
    }
    moved
}

fn steps(x: i32, y: i32) -> [f32; 3] {
    let slanted = 2 * x - 3 * y > 7;
    let disc = (x - 31) * (x - 31) + (y - 19) * (y - 19) < 150;
    let stripe = (x / 5) % 4 == 1;
    let base = if slanted { [0.85, 0.62, 0.2] } else { [0.1, 0.25, 0.55] };
    let base = if stripe { [base[0], 0.5 * base[1], 0.9] } else { base };
    if disc { [0.95, 0.95, 0.9] } else { base }
}

/// An image of some other kind: valid tensors, scalars 0..=1, unit normals, depths, object numbers;
/// guides with a part that is empty.
pub fn field(kind: ImageKind, width: u32, height: u32) -> Image {
    let mut random = Random::new(u64::from(width) << 20 | u64::from(height) << 4 | kind as u64 | 1 << 40);
    let empty = |x: i32, y: i32| (x + 2 * y) % 23 > 18;
    match kind {
        ImageKind::Color => color(Kind::Noise, width, height),
        ImageKind::Scalar => {
            from_fn(width, height, |x, _| [if x % 11 == 0 { (x % 2) as f32 } else { random.unit() as f32 }])
        }
        ImageKind::Tensor => from_fn(width, height, |x, y| tensor(&mut random, x, y)),
        ImageKind::Normal => from_fn(width, height, |x, y| {
            if empty(x, y) {
                return [0.0; 4];
            }
            let v: [f32; 3] = if x > 20 { [0.6, 0.0, 0.8] } else { [random.range(-0.5, 0.5), 0.3, 0.9] };
            let length = v.iter().map(|c| c * c).sum::<f32>().sqrt();
            [v[0] / length, v[1] / length, v[2] / length, 1.0]
        }),
        ImageKind::Depth => from_fn(width, height, |x, y| {
            if empty(x, y) { [0.0] } else { [2.0 + 0.01 * x as f32 + if y > 20 { 7.0 } else { 0.0 }] }
        }),
        ImageKind::Flow => from_fn(width, height, |x, y| {
            let strength = if empty(x, y) { 0.0 } else { random.unit() as f32 };
            [random.unit() as f32, random.unit() as f32, 0.0, strength]
        }),
        // Some places that nobody has touched.
        ImageKind::Control => from_fn(width, height, |x, y| {
            let mut v = || if empty(x, y) { 0.5 } else { random.unit() as f32 };
            [v(), v(), v(), v()]
        }),
        // Crossed lines in four tones, and paper that nobody drew on.
        ImageKind::Hatching => from_fn(width, height, |x, y| {
            let mut tone = |every: i32| {
                if empty(x, y) || (x + 2 * y) % every > 1 { 1.0 } else { 0.3 * random.unit() as f32 }
            };
            [tone(11), tone(7), tone(5), tone(3)]
        }),
        ImageKind::ObjectId => {
            from_fn(width, height, |x, y| [if empty(x, y) { 0.0 } else { (1 + x / 13 + 7 * (y / 9)) as f32 }])
        }
        ImageKind::Cryptomatte => from_fn(width, height, |x, y| match empty(x, y) {
            true => [0.0; 4],
            false => two_things(&mut random, x, y),
        }),
        // Things that move each their way, and some that nobody knows.
        ImageKind::Motion => from_fn(width, height, |x, y| match empty(x, y) {
            true => [f32::NAN, f32::INFINITY],
            false => motion(&mut random, x, y),
        }),
        ImageKind::Position => from_fn(width, height, |x, y| {
            if empty(x, y) {
                return [0.0; 4];
            }
            let wall = if x > 20 { 1.0 } else { 0.0 };
            // Leaves and grass: points that are hardly those of one surface.
            let leaf = if y % 16 > 9 { random.range(0.0, 0.06) } else { 0.0 };
            [0.02 * x as f32 - 3.0 * wall, 0.015 * y as f32 + leaf, 0.3 * wall + 0.002 * (x + y) as f32, 1.0]
        }),
    }
}

/// About how far pictures move from frame to frame in `sweep::input`, or farther.
fn motion(random: &mut Random, x: i32, y: i32) -> [f32; 2] {
    let jitter: [f32; 2] = [random.range(-0.5, 0.5), random.range(-0.5, 0.5)];
    let base = if x / 13 % 2 == 0 { [-1.9, -1.05] } else { [-3.5, 2.0 + 0.02 * y as f32] };
    [base[0] + jitter[0], base[1] + jitter[1]]
}

/// Two things of a pixel: ids of their names, and their shares, of which some are no numbers.
fn two_things(random: &mut Random, x: i32, y: i32) -> [f32; 4] {
    let thing = |x: i32| f32::from_bits(id_of_thing((x / 13 + 7 * (y / 9)) as u32));
    match x % 13 {
        0 => [thing(x), 0.5 + 0.5 * random.unit() as f32, thing(x + 13), f32::NAN],
        12 => [thing(x), 0.7, thing(x + 13), 0.3],
        _ => [thing(x), 1.0, 0.0, 0.0],
    }
}

/// Id of the name that a thing has by its number, as bits of a float.
pub fn id_of_thing(number: u32) -> u32 {
    id(&format!("set/thing {number}"))
}

/// A positive semidefinite tensor: zero, of one direction, isotropic or in between.
fn tensor(random: &mut Random, x: i32, y: i32) -> [f32; 4] {
    // A smooth turn with some jitter, so that stream lines have somewhere to go.
    let angle = 0.05 * x as f32 + 0.08 * y as f32 + random.range(-0.2, 0.2);
    let (sin, cos) = angle.sin_cos();
    let major = 10f32.powf(random.range(-4.0, 0.0));
    let minor = match random.below(6) {
        0 => return [0.0, 0.0, 0.0, 1.0],
        1 => major,
        2 => 0.0,
        _ => major * random.range(0.0, 0.9),
    };
    let (e, g) = (major * cos * cos + minor * sin * sin, major * sin * sin + minor * cos * cos);
    [e, (major - minor) * sin * cos, g, 1.0]
}

/// A smooth picture with edges, curves, a gradient and some texture, as photographs have: sRGB, opaque.
pub fn scenery(width: u32, height: u32) -> Image {
    let mut random = Random::new(11);
    let grain: Vec<f32> = (0..width * height).map(|_| random.normal() as f32 * 0.012).collect();
    let scale = height as f32 / 192.0;
    from_fn(width, height, |x, y| {
        let (u, v) = ((x as f32 + 0.5) / scale, (y as f32 + 0.5) / scale);
        // Edges are as sharp as a lens makes them: one pixel of the 192 lines wide.
        let cover = |distance: f32| (0.5 + distance).clamp(0.0, 1.0);
        let mix = |a: [f32; 3], b: [f32; 3], t: f32| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t);
        let sky = mix([0.45, 0.65, 0.92], [0.85, 0.9, 0.95], v / 110.0);
        let hill = 110.0 + 14.0 * (u * 0.035).sin() - v;
        let ground = mix([0.35, 0.52, 0.2], [0.5, 0.42, 0.25], (u * 0.02).sin() * 0.5 + 0.5);
        let mut c = mix(sky, ground, cover(-hill));
        let disc = 34.0 - ((u - 80.0).powi(2) + (v - 112.0).powi(2)).sqrt();
        let shade = 0.55 + 0.4 * ((u - 70.0) * 0.02 - (v - 100.0) * 0.015).clamp(-1.0, 1.0);
        c = mix(c, [0.9 * shade, 0.35 * shade, 0.25 * shade], cover(disc));
        let wall = (u - 150.0).min(235.0 - u).min(v - 60.0).min(165.0 - v);
        c = mix(c, [0.82, 0.76, 0.66], cover(wall));
        let (bu, bv) = ((u - 150.0) % 17.0, (v - 60.0) % 21.0);
        let window = (bu - 5.0).min(12.0 - bu).min(bv - 6.0).min(16.0 - bv).min(wall);
        c = mix(c, [0.16, 0.19, 0.26], cover(window));
        let g = grain[(y as u32 * width + x as u32) as usize];
        [c[0] + g, c[1] + g, c[2] + g, 1.0]
    })
}

/// The test card of the golden images, 192 x 128 for comfort: a zone plate, ramps, patches of colour,
/// strokes like writing, noise and a part that fades to nothing; sRGB, premultiplied.
pub fn test_card(width: u32, height: u32) -> Image {
    let mut random = Random::new(3);
    from_fn(width, height, |x, y| {
        let (u, v) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        let (column, row) = ((u * 3.0) as i32, (v * 2.0) as i32);
        let (s, t) = (u * 3.0 - column as f32, v * 2.0 - row as f32);
        let noise = random.unit() as f32 - 0.5;
        let grey = |l: f32| [l, l, l, 1.0];
        match (column, row) {
            (0, 0) => {
                let r2 = (s - 0.5).powi(2) + (t - 0.5).powi(2);
                grey(0.5 + 0.45 * (64.0 * r2).cos())
            }
            (1, 0) if t < 0.34 => grey(s),
            (1, 0) if t < 0.67 => [s, 0.5, 1.0 - s, 1.0],
            (1, 0) => grey(0.3 + 0.4 * s + 0.25 * noise),
            (2, 0) => {
                let patch = (s * 4.0) as usize + 4 * (t * 3.0) as usize;
                let c = |i: usize| ((patch * (5 + 2 * i) + 3 * i) % 11) as f32 / 10.0;
                [c(0), c(1), c(2), 1.0]
            }
            (0, _) => {
                // Strokes of a pen, thick and thin, over paper.
                let wave = (s * 22.0).sin() * 0.05 + (s * 61.0).sin() * 0.03;
                let line = ((t * 6.0).fract() - 0.5 + wave * 6.0).abs();
                let pen = if (s * 9.0).fract() < 0.82 { (line * 7.0 - 0.5).clamp(0.0, 1.0) } else { 1.0 };
                [0.1 + 0.85 * pen, 0.1 + 0.82 * pen, 0.15 + 0.7 * pen, 1.0]
            }
            (1, _) => {
                // A shaded ball before a chequered wall.
                let (dx, dy) = (s - 0.5, t - 0.5);
                let r2 = (dx * dx + dy * dy) / 0.16;
                let wall = if ((s * 8.0) as i32 + (t * 8.0) as i32) % 2 == 0 { 0.42 } else { 0.55 };
                if r2 < 1.0 {
                    let light = (0.3 * dx / 0.4 - 0.5 * dy / 0.4 + 0.8 * (1.0 - r2).sqrt()).max(0.05);
                    [0.9 * light, 0.45 * light + 0.05, 0.2 * light + 0.1, 1.0]
                } else {
                    [wall, wall, wall * 1.1, 1.0]
                }
            }
            _ => {
                let alpha = (1.2 - 1.4 * t).clamp(0.0, 1.0) * if (s * 5.0) as i32 == 2 { 0.0 } else { 1.0 };
                let leaf = ((s * 40.0).sin() * (t * 36.0).cos() + noise).clamp(-1.0, 1.0);
                let c = [0.25 + 0.15 * leaf, 0.5 + 0.25 * leaf, 0.15 + 0.1 * leaf];
                [c[0] * alpha, c[1] * alpha, c[2] * alpha, alpha]
            }
        }
    })
}
