//! The light of prints, seen from afar.

use isophote_engine::Image;

/// The sRGB value of linear light.
pub fn encoded(v: f64) -> f64 {
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Linear light of an sRGB value.
pub fn light(v: f32) -> f64 {
    let v = f64::from(v);
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// The light of one channel, row by row.
pub fn channel(image: &Image, channel: usize) -> Vec<f64> {
    image.data().chunks_exact(4).map(|pixel| light(pixel[channel])).collect()
}

/// The mean of square `values` under weights of each axis.
pub fn mean(values: &[f64], side: usize, columns: &[f64], rows: &[f64]) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for (y, row) in rows.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
        for (x, column) in columns.iter().enumerate() {
            sum += row * column * values[y * side + x];
            all += row * column;
        }
    }
    sum / all
}

/// A raised cosine, under which cells at the borders of a picture count little.
pub fn window(side: usize) -> Vec<f64> {
    (0..side).map(|x| 1.0 - (std::f64::consts::TAU * (x as f64 + 0.5) / side as f64).cos()).collect()
}

/// The light of means of `side` x `side` values, Gaussian windows a cell wide that pass what varies slower than a third
/// of the screen, against what `wanted` says at their middle: the farthest difference.
pub fn farthest(values: &[f64], side: usize, cell: f64, wanted: impl Fn(f64) -> f64) -> f64 {
    let weights = |at: f64| -> Vec<f64> {
        let weight = |x: usize| (-0.5 * ((x as f64 + 0.5 - at) / cell).powi(2)).exp();
        (0..side).map(weight).map(|w| if w > 1e-5 { w } else { 0.0 }).collect()
    };
    let margin = 5.0 * cell;
    let places = || (0..9).map(|i| margin + (side as f64 - 2.0 * margin) * f64::from(i) / 8.0);
    let mut most: f64 = 0.0;
    for (x, y) in places().flat_map(|y| places().map(move |x| (x, y))) {
        let found = mean(values, side, &weights(x), &weights(y));
        most = most.max((found - wanted(x)).abs());
    }
    most
}
