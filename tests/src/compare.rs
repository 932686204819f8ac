//! Difference of two images.

use isophote_engine::{Image, Tolerance};

/// The outcome of comparing what the two twins of a kernel gave.
#[derive(Clone, Debug, Default)]
pub struct Difference {
    /// Values compared.
    pub values: usize,
    /// Values beyond the tolerance's bound.
    pub outliers: usize,
    /// Greatest |gpu - cpu|.
    pub worst: f32,
    /// Greatest |gpu - cpu| as a share of what the tolerance allows there.
    pub ratio: f32,
    /// Place of that: pixel, channel, both values.
    pub place: String,
    /// Values that are not finite in either.
    pub broken: usize,
}

impl Difference {
    /// Compares `gpu` with `cpu`.
    pub fn between(cpu: &Image, gpu: &Image, tolerance: &Tolerance) -> Self {
        let mut out = Self::default();
        assert_eq!((cpu.window(), cpu.channels()), (gpu.window(), gpu.channels()), "shapes differ");
        let channels = cpu.channels() as usize;
        for (i, (c, g)) in cpu.data().iter().zip(gpu.data()).enumerate() {
            out.values += 1;
            let pixel = i / channels * channels..(i / channels + 1) * channels;
            let both = cpu.data()[pixel.clone()].iter().chain(&gpu.data()[pixel]);
            let size = both.fold(0.0f32, |m, v| m.max(v.abs()));
            let place = || {
                let (pixel, width) = (i / channels, cpu.width() as usize);
                format!("({}, {})[{}] cpu {c:?} gpu {g:?}", pixel % width, pixel / width, i % channels)
            };
            if !c.is_finite() || !g.is_finite() {
                if out.broken == 0 {
                    out.place = place();
                }
                out.broken += 1;
                continue;
            }
            let difference = (g - c).abs();
            out.worst = out.worst.max(difference);
            let bound = tolerance.absolute + tolerance.relative * size;
            if difference > bound {
                out.outliers += 1;
            }
            let ratio = if difference == 0.0 { 0.0 } else { difference / bound };
            if ratio > out.ratio {
                out.ratio = ratio;
                if out.broken == 0 {
                    out.place = place();
                }
            }
        }
        out
    }

    /// True when this one comparison keeps the tolerance. A share of outliers allows at least one
    /// value, or small images could never have any.
    pub fn is_within(&self, tolerance: &Tolerance) -> bool {
        let allowed = (f64::from(tolerance.outliers) * self.values as f64).ceil() as usize;
        self.broken == 0 && self.outliers <= allowed
    }
}

/// Greatest and mean absolute difference of two images of one shape.
pub fn distance(a: &Image, b: &Image) -> (f32, f64) {
    assert_eq!((a.width(), a.height(), a.channels()), (b.width(), b.height(), b.channels()));
    let differences = a.data().iter().zip(b.data()).map(|(a, b)| (a - b).abs());
    let worst = differences.clone().fold(0.0, f32::max);
    (worst, differences.map(f64::from).sum::<f64>() / a.data().len() as f64)
}

/// Peak signal-to-noise ratio in decibels for values whose peak is 1; infinite for equal images.
pub fn psnr(a: &Image, b: &Image) -> f64 {
    assert_eq!((a.width(), a.height(), a.channels()), (b.width(), b.height(), b.channels()));
    let sum: f64 = a.data().iter().zip(b.data()).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    -10.0 * (sum / a.data().len() as f64).log10()
}
