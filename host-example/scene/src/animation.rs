//! Key-frame animation: sampling of channels with the three interpolations of glTF 2.0 (appendix C).

use glam::{Quat, Vec3, Vec4};

/// The way in which values between two key frames are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Keeps the earlier value.
    Step,
    /// Straight line; shortest arc for rotations.
    Linear,
    /// Cubic Hermite spline; each key holds in-tangent, value and out-tangent.
    CubicSpline,
}

/// Property that a channel drives.
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
    /// Interpolation of the values.
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
        } else {
            self.interpolate(next, time, out);
        }
        if self.property == Property::Rotation {
            let unit = quaternion(out);
            out.copy_from_slice(&unit.to_array());
        }
    }

    /// The value at a time between two keys, the later of which is `next`.
    fn interpolate(&self, next: usize, time: f32, out: &mut [f32]) {
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
                let [first, leaving, second, arriving] = hermite(t);
                let basis = [first, leaving * span, second, arriving * span];
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

/// Weights of a cubic Hermite spline at a share of the way from one value to the next: of the first, of the slope there,
/// of the second, and of the slope there.
pub fn hermite(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [2.0 * t3 - 3.0 * t2 + 1.0, t3 - 2.0 * t2 + t, 3.0 * t2 - 2.0 * t3, t3 - t2]
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

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(property: Property, interpolation: Interpolation, times: &[f32], values: &[f32]) -> Channel {
        let width = if property == Property::Rotation { 4 } else { 3 };
        let channel = Channel {
            node: 0,
            property,
            interpolation,
            times: times.to_vec(),
            values: values.to_vec(),
            width,
        };
        channel.validate().unwrap();
        channel
    }

    fn at(channel: &Channel, time: f32) -> Vec<f32> {
        let mut out = vec![0.0; channel.width];
        channel.sample(time, &mut out);
        out
    }

    #[test]
    fn steps_and_lines() {
        let values = [0.0, 0.0, 0.0, 2.0, 4.0, 8.0];
        let step = channel(Property::Scale, Interpolation::Step, &[1.0, 3.0], &values);
        let line = channel(Property::Scale, Interpolation::Linear, &[1.0, 3.0], &values);
        for (time, stepped, lined) in [
            (0.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (2.0, 0.0, 4.0),
            (2.999, 0.0, 7.996),
            (3.0, 8.0, 8.0),
            (9.0, 8.0, 8.0),
        ] {
            assert_eq!(at(&step, time)[2], stepped);
            assert!((at(&line, time)[2] - lined).abs() < 1e-5);
        }
    }

    #[test]
    fn splines_meet_their_keys_with_their_slopes() {
        // A cubic is reproduced exactly: x(t) = t^3 over [0, 2], with slopes 0 and 12 per second.
        let key =
            |slope_in: f32, value: f32, slope_out: f32| [[slope_in; 3], [value; 3], [slope_out; 3]].concat();
        let values = [key(99.0, 0.0, 0.0), key(12.0, 8.0, 99.0)].concat();
        let spline = channel(Property::Translation, Interpolation::CubicSpline, &[0.0, 2.0], &values);
        for time in [0.0f32, 0.3, 1.0, 1.7, 2.0] {
            assert!((at(&spline, time)[0] - time.powi(3)).abs() < 1e-5);
        }
        assert_eq!(at(&spline, 5.0), [8.0; 3], "the value, not a tangent, is kept after the end");
    }

    #[test]
    fn rotations_take_the_shorter_arc_at_constant_speed() {
        let start = Quat::IDENTITY;
        let end = -Quat::from_rotation_y(2.0);
        let values = [start.to_array(), end.to_array()].concat();
        let turn = channel(Property::Rotation, Interpolation::Linear, &[0.0, 1.0], &values);
        for t in [0.25, 0.5, 0.75] {
            let angle = quaternion(&at(&turn, t)).angle_between(start);
            assert!((angle - 2.0 * t).abs() < 1e-3, "{angle} at {t}");
        }
        let zero = channel(Property::Rotation, Interpolation::Linear, &[0.0], &[0.0; 4]);
        assert_eq!(at(&zero, 0.0), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn time_loops() {
        let line = channel(Property::Scale, Interpolation::Linear, &[0.0, 4.0], &[0.0; 6]);
        let animation = Animation { name: String::new(), channels: vec![line] };
        assert_eq!(animation.duration(), 4.0);
        assert_eq!((animation.looped(5.0), animation.looped(-1.0)), (1.0, 3.0));
        assert_eq!(Animation::default().looped(3.0), 0.0);
    }
}
