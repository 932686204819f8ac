//! Comparison of a card with the CPU: each node on both, in all precisions, on a picture that the program makes.

use serde::Serialize;

use crate::bench::Subject;
use isophote_files::error::{AtPlace, Result};
use isophote_finishing::stylize::precision::Precision;
use isophote_finishing::stylize::style::Style;
use isophote_loader::device::Device;
use isophote_loader::{Control, Input, Library};
use isophote_pictures::pixels::{Pixels, Precision as Samples};

/// A value that differs by more than this, of itself where it is larger than 1, is another one to the eye.
const STEP: f32 = 3.5 / 255.0;
/// Shares of values that may differ by more, in the precisions: a line may move by a pixel where a comparison turns on the last
/// bit, and bits are fewer in half precision.
const SHARES: [(Precision, f64); 3] =
    [(Precision::Exact, 0.004), (Precision::Half, 0.03), (Precision::Fast, 0.03)];

/// A node on the card against the CPU.
#[derive(Debug, Serialize)]
pub struct Twin {
    /// The node.
    pub node: String,
    /// The precision on the card.
    pub precision: &'static str,
    /// The largest difference.
    pub largest: f32,
    /// Ratio of signal to noise in decibels, of a signal from 0 to 1; none of equal pictures.
    pub decibels: Option<f64>,
    /// Share of values that are others to the eye.
    pub share: f64,
    /// The share that may be.
    pub allowed: f64,
    /// True where no more are, and all are numbers.
    pub agrees: bool,
}

/// Compares a node in all precisions; none where it needs more than a picture.
///
/// # Errors
/// [`isophote_files::error::Error::Failure`] when the device fails.
pub fn compare(library: &Library, device: &Device, subject: &Subject, picture: &Pixels) -> Result<Vec<Twin>> {
    let refused = |e: isophote_loader::Error| e.at(&subject.node, "leave it out with --node");
    let node = library.find_node(&subject.node).map_err(refused)?;
    if node.inputs.iter().any(|port| !port.optional && port.id != "color") {
        return Ok(Vec::new());
    }
    let result = |device: Option<&Device>, precision: Precision| {
        let mut style = Style::any(library, &subject.node, &subject.settings)?;
        precision.apply(&style)?;
        let (width, height) = (picture.width(), picture.height());
        let request = library.request((width, height)).map_err(refused)?;
        let mut target = Pixels::zeroed(width, height, 4, Samples::F32);
        let inputs = [Input { name: "color", pixels: picture }];
        style
            .graph
            .process(device, &request, &inputs, &mut target, &mut Control::default())
            .map_err(refused)?;
        Ok::<_, isophote_files::error::Error>(target.to_f32())
    };
    let expected = result(None, Precision::Exact)?;
    SHARES
        .into_iter()
        .map(|(precision, allowed)| {
            let found = result(Some(device), precision)?;
            Ok(twin(subject.label.clone(), precision, (&expected, &found), allowed))
        })
        .collect()
}

fn twin(node: String, precision: Precision, (expected, found): (&[f32], &[f32]), allowed: f64) -> Twin {
    let (mut largest, mut squares, mut others) = (0.0_f32, 0.0_f64, 0_usize);
    for (a, b) in expected.iter().zip(found) {
        let difference = (a - b).abs();
        // What is no number is no small difference.
        others += usize::from(difference.is_nan() || difference > STEP * a.abs().max(1.0));
        largest = largest.max(if difference.is_nan() { f32::INFINITY } else { difference });
        squares += f64::from(difference) * f64::from(difference);
    }
    let count = expected.len().max(1) as f64;
    let share = others as f64 / count;
    let decibels = (squares > 0.0).then(|| -10.0 * (squares / count).log10());
    let agrees = share <= allowed && largest.is_finite() && expected.len() == found.len();
    Twin { node, precision: precision.name(), largest, decibels, share, allowed, agrees }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_found() {
        let expected = vec![0.5; 1000];
        let compared = |change: &dyn Fn(&mut Vec<f32>)| {
            let mut found = expected.clone();
            change(&mut found);
            twin("a".into(), Precision::Exact, (&expected, &found), 0.004)
        };
        let same = compared(&|_| {});
        assert!(same.agrees && same.decibels.is_none() && same.share == 0.0);
        assert!(compared(&|v| v[..4].fill(0.9)).agrees, "a line may move");
        assert!(!compared(&|v| v[..5].fill(0.9)).agrees);
        assert!(!compared(&|v| v[7] = f32::NAN).agrees);
        assert!(!compared(&|v| v.truncate(999)).agrees);
    }
}
