//! Key-frame animation: sampling of channels with the three interpolations of glTF 2.0 (appendix C).

use glam::{Quat, Vec3, Vec4};

/// How values between two key frames are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Keeps the earlier value.
    Step,
    /// Straight line; shortest arc for rotations.
    Linear,
    /// Cubic Hermite spline; each key holds in-tangent, value and out-tangent.
    CubicSpline,
}

/// What a channel drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// Translation of a node: 3 numbers.
    Translation,
    /// Rotation of a node: a quaternion, 4 numbers.
    Rotation,
    /// Scale of a node: 3 numbers.
    Scale,
    /// Morph weights of a node: as many numbers as its mesh has targets.
    Weights,
}

/// One animated property of one node.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The node.
    pub node: usize,
    /// The property.
    pub property: Property,
    /// How values are interpolated.
    pub interpolation: Interpolation,
    /// Strictly increasing times in seconds; at least one.
    pub times: Vec<f32>,
    /// `times.len() * width` numbers, three times as many for cubic splines.
    pub values: Vec<f32>,
    /// Numbers per value.
    pub width: usize,
}

impl Channel {
    /// Checks what [`Channel::sample`] relies on.
    ///
    /// # Errors
    /// One clause saying what is wrong.
    pub fn validate(&self) -> Result<(), String> {
        if self.times.is_empty() || self.width == 0 {
            return Err("has no key frames".into());
        }
        if !self.times.iter().all(|t| t.is_finite()) || self.times.windows(2).any(|w| w[0] >= w[1]) {
            return Err("has key-frame times that do not increase".into());
        }
        let per_key = self.width * if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if self.values.len() != self.times.len() * per_key {
            return Err(format!(
                "has {} numbers for {} key frames where {} are needed",
                self.values.len(),
                self.times.len(),
                self.times.len() * per_key
            ));
        }
        Ok(())
    }

    /// The value at `time`, clamped to the first and last key, into `out` (`width` numbers).
    pub fn sample(&self, time: f32, out: &mut [f32]) {
        let last = self.times.len() - 1;
        let next = self.times.partition_point(|&t| t <= time);
        if next == 0 || next > last {
            let key = if next == 0 { 0 } else { last };
            out.copy_from_slice(self.value(key));
            return;
        }
        let (k, span) = (next - 1, self.times[next] - self.times[next - 1]);
        let t = (time - self.times[k]) / span;
        match self.interpolation {
            Interpolation::Step => out.copy_from_slice(self.value(k)),
            Interpolation::Linear if self.property == Property::Rotation => {
                let arc = quaternion(self.value(k)).slerp(quaternion(self.value(next)), t);
                out.copy_from_slice(&arc.to_array());
            }
            Interpolation::Linear => {
                for ((o, a), b) in out.iter_mut().zip(self.value(k)).zip(self.value(next)) {
                    *o = a + (b - a) * t;
                }
            }
            Interpolation::CubicSpline => {
                let (t2, t3) = (t * t, t * t * t);
                let basis = [
                    2.0 * t3 - 3.0 * t2 + 1.0,
                    (t3 - 2.0 * t2 + t) * span,
                    3.0 * t2 - 2.0 * t3,
                    (t3 - t2) * span,
                ];
                let (start, out_tangent) = (self.value(k), self.part(k, 2));
                let (end, in_tangent) = (self.value(next), self.part(next, 0));
                for (i, o) in out.iter_mut().enumerate() {
                    *o = basis[0] * start[i]
                        + basis[1] * out_tangent[i]
                        + basis[2] * end[i]
                        + basis[3] * in_tangent[i];
                }
            }
        }
        if self.property == Property::Rotation {
            let unit = quaternion(out);
            out.copy_from_slice(&unit.to_array());
        }
    }

    fn value(&self, key: usize) -> &[f32] {
        self.part(key, usize::from(self.interpolation == Interpolation::CubicSpline))
    }

    fn part(&self, key: usize, part: usize) -> &[f32] {
        let parts = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let start = (key * parts + part) * self.width;
        &self.values[start..start + self.width]
    }
}

/// A unit quaternion from four numbers; identity where they have no direction.
pub fn quaternion(values: &[f32]) -> Quat {
    let raw = match values {
        [x, y, z, w] => Vec4::new(*x, *y, *z, *w),
        _ => Vec4::W,
    };
    Quat::from_vec4(raw.normalize_or(Vec4::W))
}

/// A vector from three numbers.
pub fn vector(values: &[f32]) -> Vec3 {
    match values {
        [x, y, z] => Vec3::new(*x, *y, *z),
        _ => Vec3::ZERO,
    }
}

/// Channels that play together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// Name from the file, or empty.
    pub name: String,
    /// The channels, each validated.
    pub channels: Vec<Channel>,
}

impl Animation {
    /// Time of the last key frame in seconds.
    pub fn duration(&self) -> f32 {
        self.channels.iter().filter_map(|c| c.times.last().copied()).fold(0.0, f32::max)
    }

    /// Brings any time into [0, duration): the animation plays in a loop.
    pub fn looped(&self, time: f32) -> f32 {
        let duration = self.duration();
        if duration > 0.0 { time.rem_euclid(duration) } else { 0.0 }
    }
}
