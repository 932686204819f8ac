//! Frames to PNG files, without a window.

use std::f32::consts::TAU;
use std::fs;
use std::path::Path;

use isophote_files::error::{Error, Result};
use isophote_files::files::Existing;
use isophote_pictures::floats;
use isophote_render::gpu::Gpu;
use isophote_render::readback::Readback;
use isophote_scene::Scene;
use isophote_scene::camera::{Framing, Orbit, Viewpoint};

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
    let aspect = size.0 as f32 / size.1 as f32;
    let mut camera = Viewpoint::of(&scene, aspect);
    if count > 1 {
        camera = Viewpoint { node: None, orbit: Orbit::turntable(&scene, aspect, Framing::default()) };
    }
    let mut painter = Painter::new(&gpu, scene, style, size, camera)?;
    let mut readback = Readback::default();
    for index in 0..count {
        painter.camera.orbit = camera.orbit.turned(index as f32 / count as f32 * TAU);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        painter.encode(&mut encoder, i64::from(index) + 1)?;
        gpu.queue.submit([encoder.finish()]);
        let picture = readback.read(&gpu, painter.picture().texture())?;
        let file = folder.join(format!("frame.{:04}.png", index + 1));
        floats::save(&file, Existing::Replace, &picture)?;
        println!("{}", file.display());
    }
    Ok(())
}
