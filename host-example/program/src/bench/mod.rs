//! Measuring what each node and each of its passes takes, on the CPU and on the GPU.

pub mod card;
pub mod compare;
pub mod cpu;
mod entry;
pub mod gpu;
pub mod peak;
mod peers;
pub mod report;
mod resident;
pub mod sequence;
mod throughput;
mod timer;
mod transfers;

use isophote_finishing::stylize::style::Setting;
use isophote_pictures::pixels::{Pixels, Samples};

/// Subject of a measurement: a node, with other values than the defaults where they are given.
#[derive(Debug)]
pub struct Subject {
    /// As it was written.
    pub label: String,
    /// Id of the node.
    pub node: String,
    /// Parameters that are not at their defaults.
    pub settings: Vec<Setting>,
}

/// A picture that has what pictures have: slow changes, edges in all directions, fine detail.
pub fn picture((width, height): (u32, u32)) -> Pixels {
    let mut samples = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
            let cell = [(x % 160) as f32 - 80.0, (y % 160) as f32 - 80.0];
            let disc = if cell[0] * cell[0] + cell[1] * cell[1] < 50.0 * 50.0 { 0.35 } else { 0.0 };
            let hash = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77)).wrapping_mul(0xc2b2_ae3d);
            let noise = (hash >> 24) as f32 / 255.0 * 0.04;
            let waves = 0.05 * (x as f32 * 0.3 + y as f32 * 0.1).sin();
            samples.extend([
                0.1 + 0.5 * u + disc + noise,
                0.2 + 0.4 * v + noise + waves,
                0.6 - disc + noise,
                1.0,
            ]);
        }
    }
    // Four samples were made for each pixel.
    let black = || Pixels::zeroed(width, height, 4, isophote_pictures::pixels::Precision::F32);
    Pixels::new(width, height, 4, Samples::F32(samples)).unwrap_or_else(black)
}

/// Motion that is the same everywhere, to places between pixels.
fn motion((width, height): (u32, u32)) -> Pixels {
    let samples = [-1.3, 0.7].repeat(width as usize * height as usize);
    // Two samples were made for each pixel.
    let rest = || Pixels::zeroed(width, height, 2, isophote_pictures::pixels::Precision::F32);
    Pixels::new(width, height, 2, Samples::F32(samples)).unwrap_or_else(rest)
}

/// The middle one of some numbers, the mean of the middle two; 0 of none.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let count = numbers.len();
    match (numbers.get(count.saturating_sub(1) / 2), numbers.get(count / 2)) {
        (Some(a), Some(b)) => (a + b) / 2.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(vec![]), 0.0);
        assert_eq!(median(vec![3.0]), 3.0);
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![9.0, 1.0, 2.0, 4.0]), 3.0);
    }
}
