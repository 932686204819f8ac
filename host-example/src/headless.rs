//! Frames to PNG files, without a window.

use std::fs;
use std::path::Path;

use isophote_files::error::{Error, Result};
use isophote_files::files::Existing;
use isophote_pictures::floats;
use isophote_render::gpu::Gpu;
use isophote_render::readback::Readback;
use isophote_scene::Scene;
use isophote_scene::pose::Pose;

use crate::camera::Camera;
use crate::painter::Painter;

/// Writes `count` frames of a size into a folder as `frame.0001.png` and so on. Of several, the camera turns once around
/// the scene.
///
/// # Errors
/// [`Error::Input`] for scenes, styles and folders that cannot be used, [`Error::Failure`] when the device fails.
pub fn write(folder: &Path, count: u32, size: (u32, u32), scene: Scene, style: &str) -> Result<()> {
    let unwritable =
        |e| Error::file(folder, format!("cannot be made: {e}"), "name a folder that can be written to");
    fs::create_dir_all(folder).map_err(unwritable)?;
    let gpu = Gpu::open()?;
    let is_turning = count > 1;
    let camera = if is_turning { Camera::turntable(&scene, size) } else { Camera::of(&scene, size) };
    let first = camera.view(&scene, &Pose::at_rest(&scene));
    let mut painter = Painter::new(&gpu, scene, style, size, &first)?;
    let mut readback = Readback::default();
    for index in 0..count {
        let view = if is_turning { camera.turned(index as f32 / count as f32) } else { first };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        painter.encode(&mut encoder, i64::from(index) + 1, &view)?;
        gpu.queue.submit([encoder.finish()]);
        let picture = readback.read(&gpu, painter.picture().texture())?;
        let file = folder.join(format!("frame.{:04}.png", index + 1));
        floats::save(&file, Existing::Replace, &picture)?;
        println!("{}", file.display());
    }
    Ok(())
}
