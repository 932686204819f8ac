//! What was computed and the source, blended: alpha, masks and amounts.

use super::host::Outcome;
use isophote::engine::{Image, Rect};
use isophote::kernels::shared::host_colour::scalar::beyond_coverage;
use isophote_abi::openfx::*;

/// Gives a premultiplied pixel the coverage of another, of which it takes the colour where it has none of its own. Its
/// light beyond coverage stays.
fn recover(pixel: &mut [f32], source: &[f32]) {
    let (now, kept) = (pixel[3], source[3]);
    // Filters leave most pixels covered but for a rounding. No such colour is beyond coverage.
    if (now - 1.0).abs() < 1e-3 && pixel[..3].iter().all(|v| v.abs() < 1e9) {
        let share = kept / now;
        for v in &mut pixel[..3] {
            // Zeros keep the signs that they have with light.
            let light = 0.0_f32.copysign(*v);
            *v = (*v - light) * share + light;
        }
    } else {
        recover_light(pixel, source);
    }
}

/// The same for any coverage and light.
fn recover_light(pixel: &mut [f32], source: &[f32]) {
    let ([r, g, b, now], kept) = ([pixel[0], pixel[1], pixel[2], pixel[3]], source[3]);
    let light = beyond_coverage([r, g, b, now]);
    let under = beyond_coverage([source[0], source[1], source[2], kept]);
    for c in 0..3 {
        let covered = if now > 0.0 { (pixel[c] - light[c]) * (kept / now) } else { source[c] - under[c] };
        pixel[c] = covered + light[c];
    }
}

/// The pixels of a row of `image` that lie in `band`.
fn of_band(image: &Image, band: Rect, y: i32) -> &[f32] {
    let first = (band.x0 - image.window().x0) as usize * 4;
    &image.row(y)[first..first + band.width() as usize * 4]
}

/// Gives a row of pixels the alpha of the source.
fn take_alpha(row: &mut [f32], source: &[f32], premultiplied: bool) {
    for (pixel, source) in row.chunks_exact_mut(4).zip(source.chunks_exact(4)) {
        if premultiplied && pixel[3] != source[3] {
            recover(pixel, source);
        }
        pixel[3] = source[3];
    }
}

/// Blends the source into a row of pixels where the mask, which is 1 where there is none, times the mix is less than 1.
fn blend(row: &mut [f32], source: &[f32], amounts: Option<&[f32]>, mix: f32) {
    for (at, (pixel, source)) in row.chunks_exact_mut(4).zip(source.chunks_exact(4)).enumerate() {
        let amount = amounts.map_or(1.0, |amounts| amounts[at]) * mix;
        for (v, s) in pixel.iter_mut().zip(source) {
            // Exact at both ends.
            *v = *v * amount + *s * (1.0 - amount);
        }
    }
}

/// The last that is done to the rows of a band's result.
#[derive(Default)]
pub struct Finish {
    /// The band, which the source holds at least.
    pub band: Rect,
    /// The source; where there is none, rows stay as they are.
    pub source: Option<Image>,
    /// Whether colours are multiplied by alpha, where rows get the source's alpha.
    pub alpha: Option<bool>,
    /// How much of the result is shown, where not all of it is.
    pub mix: Option<f32>,
    /// The mask's amounts.
    pub amounts: Option<Vec<f32>>,
}

impl Finish {
    /// Changes row `y` of the result.
    pub fn row(&self, y: i32, row: &mut [f32]) {
        let Some(source) = &self.source else { return };
        let source = of_band(source, self.band, y);
        if let Some(premultiplied) = self.alpha {
            take_alpha(row, source, premultiplied);
        }
        if let Some(mix) = self.mix {
            let (at, width) = ((y - self.band.y0) as usize, self.band.width() as usize);
            blend(row, source, self.amounts.as_ref().map(|all| &all[at * width..(at + 1) * width]), mix);
        }
    }
}

/// Lines as opaque grey.
///
/// # Errors
/// Memory.
pub fn spread(lines: &Image) -> Outcome<Image> {
    let mut image = Image::with_window(lines.window(), 4).map_err(|_| kOfxStatErrMemory)?;
    for (pixel, v) in image.data_mut().chunks_exact_mut(4).zip(lines.data()) {
        pixel.copy_from_slice(&[*v, *v, *v, 1.0]);
    }
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covered_pixels_are_recovered_as_all_are() {
        let values = [0.0, -0.0, 0.25, -0.5, 1.0, 3.0e4, -7.0e8, 2.0e12, f32::NAN];
        for now in [0.9, 0.9991, 0.999_999_9, 1.0, 1.000_000_1, 1.0009, 1.1] {
            for kept in [0.0, 0.3, 1.0] {
                for v in values {
                    let source = [0.1, 0.2, 0.3, kept];
                    let [mut quick, mut any] = [[v, 0.5, -v, now]; 2];
                    recover(&mut quick, &source);
                    recover_light(&mut any, &source);
                    assert_eq!(quick.map(f32::to_bits), any.map(f32::to_bits), "{v} {now} {kept}");
                }
            }
        }
    }
}
