//! The window as the device draws on it.

use std::sync::Arc;

use winit::dpi::PhysicalSize;
use winit::window::Window;

use isophote_files::error::{Error, Result};
use isophote_render::gpu::Gpu;

/// Advice where windows cannot be drawn on.
const FIX: &str =
    "install a Vulkan driver with X11 or Wayland support (on Debian: apt install mesa-vulkan-drivers)";

/// The surface of a window.
pub struct Screen {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
}

impl Screen {
    /// The surface, drawn on by `gpu`, which must be of an adapter that can.
    ///
    /// # Errors
    /// [`Error::Failure`] when it cannot.
    pub fn new(gpu: &Gpu, surface: wgpu::Surface<'static>, window: &Window) -> Result<Self> {
        let (width, height) = drawable(window.inner_size());
        let config = surface.get_default_config(&gpu.adapter, width, height);
        let mut config =
            config.ok_or_else(|| Error::failure("the adapter cannot draw on the window", FIX))?;
        // Controls are blended as designers expect it, which is on encoded values.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        let plain = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
        config.format = plain.into_iter().find(|format| formats.contains(format)).unwrap_or(config.format);
        config.present_mode = wgpu::PresentMode::AutoVsync;
        surface.configure(&gpu.device, &config);
        Ok(Self { surface, config })
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        (self.config.width, self.config.height)
    }

    /// Format of its pixels.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Takes over the size of the window. Waits for the device.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device refuses.
    pub fn resize(&mut self, gpu: &Gpu, window: &Window) -> Result<()> {
        let size = drawable(window.inner_size());
        if size == self.size() {
            return Ok(());
        }
        (self.config.width, self.config.height) = size;
        self.configure(gpu);
        gpu.check()
    }

    /// Takes over what has changed of the window beside its size. Waits for the device.
    pub fn configure(&self, gpu: &Gpu) {
        self.surface.configure(&gpu.device, &self.config);
    }

    /// The texture to draw on, and whether the surface must be configured anew afterwards; nothing where there is none at
    /// the moment.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device is lost or reports an error.
    pub fn next_frame(
        &mut self,
        gpu: &Gpu,
        window: &Arc<Window>,
    ) -> Result<Option<(wgpu::SurfaceTexture, bool)>> {
        use wgpu::CurrentSurfaceTexture as Current;
        match self.surface.get_current_texture() {
            Current::Success(frame) => return Ok(Some((frame, false))),
            Current::Suboptimal(frame) => return Ok(Some((frame, true))),
            Current::Timeout | Current::Occluded => return Ok(None),
            Current::Lost => self.surface = surface(&gpu.instance, window)?,
            Current::Outdated | Current::Validation => gpu.poll()?,
        }
        self.configure(gpu);
        Ok(None)
    }
}

/// Surface of a window to draw on.
///
/// # Errors
/// [`Error::Failure`] when the system has nothing of the kind.
pub fn surface(instance: &wgpu::Instance, window: &Arc<Window>) -> Result<wgpu::Surface<'static>> {
    instance.create_surface(Arc::clone(window)).map_err(|e| {
        Error::failure(format!("the window cannot be drawn on: {}", reason(&e.to_string())), FIX)
    })
}

/// A minimised window has no pixels; targets have at least one.
fn drawable(size: PhysicalSize<u32>) -> (u32, u32) {
    (size.width.max(1), size.height.max(1))
}

/// Message of wgpu without its list of drivers where that is empty.
fn reason(said: &str) -> &str {
    said.trim_end_matches(": {}")
}
