//! Motion vectors of renderers as the library's, by the conventions that all faces share.

use crate::array::{Pixels, Use};
use crate::exception::invalid;
use isophote_loader::Sample;
use isophote_motion::{Convention, Way};
use pyo3::prelude::*;

/// Writes the vectors of a way into an array of two channels, from those of two passes, one of which may be missing.
///
/// # Errors
/// `InvalidValueError` for a convention that does not exist, passes that lack its channels, and arrays of another size or type.
#[pyfunction]
#[pyo3(signature = (backward, forward, target, convention, is_forward))]
pub fn motion(
    backward: Option<&Bound<'_, PyAny>>,
    forward: Option<&Bound<'_, PyAny>>,
    target: &Bound<'_, PyAny>,
    convention: &str,
    is_forward: bool,
) -> PyResult<()> {
    let pass = |array: Option<&Bound<'_, PyAny>>, what| {
        array.map(|array| Pixels::of(array, what, Use::Read)).transpose()
    };
    let passes =
        [pass(backward, "the pass to the frame before")?, pass(forward, "the pass to the frame after")?];
    let target = Pixels::of(target, "the target of vectors", Use::Write)?;
    let convention: Convention = convention
        .parse()
        .map_err(|fix| invalid(format!("'{convention}' is no convention of motion vectors; {fix}")))?;
    let way = if is_forward { Way::Forward } else { Way::Backward };
    let channels = passes.each_ref().map(|pass| pass.as_ref().map_or(0, |pass| pass.channels as usize));
    let found = convention.among(way, channels).and_then(|(from, places, rule)| {
        let [backward, forward] = &passes;
        let pass = if from == Way::Forward { forward } else { backward };
        pass.as_ref().map(|pass| (pass, places, rule))
    });
    let Some((pass, places, rule)) = found else {
        return Err(invalid("the passes of motion vectors have too few channels".into()));
    };
    let shape = |pixels: &Pixels| (pixels.width, pixels.height, pixels.sample);
    if shape(pass) != shape(&target) || target.sample != Sample::F32 || target.channels != 2 {
        return Err(invalid("motion vectors are arrays of float32 of one size".into()));
    }
    let size = [target.width as f32, target.height as f32];
    let mut row = vec![0.0; target.width as usize * 2];
    for y in 0..target.height {
        // SAFETY: the lines of both arrays hold so many pixels of floats, as their descriptions say; nothing is aligned.
        unsafe {
            let (from, to) = (pass.line(y), target.line(y));
            for (x, vector) in row.chunks_exact_mut(2).enumerate() {
                for (value, place) in vector.iter_mut().zip(places) {
                    *value = from.add(x * pass.channels as usize + place).read_unaligned();
                }
            }
            rule.apply(&mut row, size);
            for (at, value) in row.iter().enumerate() {
                to.add(at).write_unaligned(*value);
            }
        }
    }
    Ok(())
}
