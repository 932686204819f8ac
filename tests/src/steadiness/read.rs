//! Frames from the EXR files that `isophote render --tone-mapped` writes.

use super::shot::Frame;
use exr::prelude::read_first_flat_layer_from_file;
use isophote_engine::Image;
use std::path::Path;

/// Reads a frame.
///
/// # Errors
/// The problem with the file, with its path.
pub fn frame(path: &Path) -> Result<Frame, String> {
    let fault = |what: String| format!("{}: {what}", path.display());
    let file = read_first_flat_layer_from_file(path).map_err(|e| fault(e.to_string()))?;
    let size = (file.layer_data.size.width() as u32, file.layer_data.size.height() as u32);
    let channel = |name: &str| -> Result<Vec<f32>, String> {
        let mut all = file.layer_data.channel_data.list.iter();
        let found = all.find(|c| c.name == *name).ok_or_else(|| fault(format!("has no channel {name}")))?;
        Ok(found.sample_data.values_as_f32().collect())
    };
    let channels = |names: &[&str]| names.iter().map(|name| channel(name)).collect::<Result<Vec<_>, _>>();
    let joined = |planes: &[Vec<f32>]| interleaved(size, planes).map_err(fault);

    let mut color = channels(&["R", "G", "B"])?;
    color.iter_mut().flatten().for_each(|v| *v = encoded(*v));
    // The sky has no coverage in the file, but it is in the picture.
    color.push(vec![1.0; color[0].len()]);
    let moved = |names: &[&str]| -> Result<Image, String> {
        let mut motion = channels(names)?;
        // Files count rows from below, as compositors do.
        motion[1].iter_mut().for_each(|v| *v = -*v);
        joined(&motion)
    };
    let object_id = channels(&["id"])?;
    let validity: Vec<f32> = object_id[0].iter().map(|id| f32::from(u8::from(*id != 0.0))).collect();
    let with_validity = |names: &[&str]| -> Result<Image, String> {
        let mut planes = channels(names)?;
        planes.push(validity.clone());
        joined(&planes)
    };
    Ok(Frame {
        color: joined(&color)?,
        motion: moved(&["backward.u", "backward.v"])?,
        motion_forward: moved(&["forward.u", "forward.v"])?,
        depth: joined(&channels(&["Z"])?)?,
        object_id: joined(&object_id)?,
        normal: with_validity(&["N.X", "N.Y", "N.Z"])?,
        rest: with_validity(&["Pref.X", "Pref.Y", "Pref.Z"])?,
    })
}

fn interleaved((width, height): (u32, u32), planes: &[Vec<f32>]) -> Result<Image, String> {
    let pixels = planes.first().map_or(0, Vec::len);
    let values = (0..pixels).flat_map(|i| planes.iter().filter_map(move |plane| plane.get(i).copied()));
    Image::from_vec(width, height, planes.len() as u32, values.collect()).map_err(|e| e.to_string())
}

/// Linear display light to sRGB.
fn encoded(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
