//! Samples of pixels, by which it is counted how much of each of them things cover.

/// Samples of a pixel, a power of 2.
pub const SAMPLES: u32 = 16;

/// Way from the middle of a pixel to one of its samples, as parts of a pixel, x to the right and y down. They are places by
/// Hammersley: no two of them are in one row or column.
pub fn shift(sample: u32) -> [f32; 2] {
    let place = [sample, sample.reverse_bits() >> (32 - SAMPLES.ilog2())];
    place.map(|step| (step as f32 + 0.5) / SAMPLES as f32 - 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_lie_in_rows_and_columns_of_their_own() {
        for axis in [0, 1] {
            let mut places: Vec<f32> = (0..SAMPLES).map(|sample| shift(sample)[axis]).collect();
            places.sort_by(f32::total_cmp);
            let even: Vec<f32> =
                (0..SAMPLES).map(|step| (step as f32 + 0.5) / SAMPLES as f32 - 0.5).collect();
            assert_eq!(places, even);
        }
    }
}
