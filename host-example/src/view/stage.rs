//! Everything of the viewer that lives on the graphics device: surface, renderer, style, presentation.
//!
//! When the device is lost, the stage is thrown away and made anew; scene, camera and style are kept
//! outside.

use std::sync::Arc;

use winit::dpi::PhysicalSize;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::present::Present;
use super::viewer::Viewer;
use crate::error::{Error, Result};
use crate::loader::Library;
use crate::loader::catalogue::Kind;
use crate::render::Renderer;
use crate::render::gpu::Gpu;
use crate::render::look::Look;
use crate::scene::Scene;
use crate::scene::camera::View;
use crate::scene::pose::Pose;
use crate::stylize::Stylizer;
use crate::stylize::kernels::Kernels;
use crate::stylize::style::Style;

/// Surface, renderer and style of one device. Fields are dropped in order: what uses the device before it.
pub struct Stage {
    stylizer: Option<Stylizer>,
    kernels: Arc<Kernels>,
    renderer: Renderer,
    present: Present,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// It is on its way to the screen.
    Shown,
    /// There was no surface to draw on; try again later.
    Skipped,
}

impl Stage {
    /// Opens a device for `window` and uploads the scene.
    ///
    /// # Errors
    /// [`Error::Failure`] when there is no adapter for the window or the device refuses.
    pub fn new(window: &Arc<Window>, display: OwnedDisplayHandle, viewer: &Viewer) -> Result<Self> {
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(display));
        let instance = wgpu::Instance::new(descriptor);
        let surface = surface(&instance, window)?;
        let gpu = Gpu::with_instance(instance, Some(&surface))?;
        let size = drawable(window.inner_size());
        let mut config = surface.get_default_config(&gpu.adapter, size.0, size.1).ok_or_else(|| {
            Error::failure(
                "the adapter cannot draw on the window",
                "install a Vulkan driver with X11 or Wayland support",
            )
        })?;
        // The pictures are linear light: a surface that encodes by itself saves the shader the work.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        config.format = formats.iter().copied().find(wgpu::TextureFormat::is_srgb).unwrap_or(config.format);
        config.present_mode = wgpu::PresentMode::AutoVsync;
        surface.configure(&gpu.device, &config);
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &viewer.scene, size)?;
        renderer.set_background(&viewer.background, false)?;
        if viewer.ground {
            renderer.add_ground();
        }
        let present = Present::new(&gpu.device, config.format);
        let kernels = Kernels::new(gpu.device.clone(), gpu.queue.clone());
        gpu.check()?;
        let mut stage = Self { stylizer: None, kernels, renderer, present, surface, config, gpu };
        stage.show();
        Ok(stage)
    }

    /// Shows frames in `style` from now on, or as they were rendered.
    ///
    /// # Errors
    /// As [`Stylizer::new`]; the style before stays.
    pub fn set_style(&mut self, library: &Library, style: Option<Style>) -> Result<()> {
        let size = (self.config.width, self.config.height);
        let mut stylizer = style.map(|s| Stylizer::new(&self.kernels, library, s, size)).transpose()?;
        if let Some(stylizer) = &mut stylizer {
            if stylizer.wants_rest_positions()? {
                self.renderer.add_rest_positions();
            }
            stylizer.bind(self.renderer.targets())?;
        }
        self.stylizer = stylizer;
        self.show();
        self.gpu.check()
    }

    /// Takes over the size of the window.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device refuses.
    pub fn resize(&mut self, size: PhysicalSize<u32>) -> Result<()> {
        let size = drawable(size);
        if size == (self.config.width, self.config.height) {
            return Ok(());
        }
        (self.config.width, self.config.height) = size;
        self.surface.configure(&self.gpu.device, &self.config);
        self.renderer.resize(size)?;
        if let Some(stylizer) = &mut self.stylizer {
            stylizer.resize(size)?;
            stylizer.bind(self.renderer.targets())?;
        }
        self.show();
        self.gpu.check()
    }

    /// Draws one frame: scene, style and presentation in one submission.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device is lost or reports an error.
    pub fn draw(
        &mut self,
        window: &Arc<Window>,
        scene: &Scene,
        pose: &Pose,
        view: &View,
        look: &Look,
    ) -> Result<Drawn> {
        use wgpu::CurrentSurfaceTexture as Current;
        let (frame, renew) = match self.surface.get_current_texture() {
            Current::Success(frame) => (frame, false),
            Current::Suboptimal(frame) => (frame, true),
            Current::Timeout | Current::Occluded => return Ok(Drawn::Skipped),
            Current::Lost => {
                self.surface = surface(&self.gpu.instance, window)?;
                self.surface.configure(&self.gpu.device, &self.config);
                return Ok(Drawn::Skipped);
            }
            Current::Outdated | Current::Validation => {
                self.gpu.check()?;
                self.surface.configure(&self.gpu.device, &self.config);
                return Ok(Drawn::Skipped);
            }
        };
        self.update_style()?;
        let target = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.renderer.encode(&mut encoder, scene, pose, view, look);
        if let Some(stylizer) = &mut self.stylizer {
            stylizer.encode(&mut encoder)?;
        }
        self.present.encode(&mut encoder, &target);
        self.gpu.queue.submit([encoder.finish()]);
        window.pre_present_notify();
        self.gpu.queue.present(frame);
        // The time of a frame is only known once it is done; a viewer that runs ahead of its device
        // would also answer the mouse late.
        self.gpu.wait()?;
        if renew {
            self.surface.configure(&self.gpu.device, &self.config);
        }
        Ok(Drawn::Shown)
    }

    /// Whether the device is gone, and with it the stage.
    pub fn is_lost(&self) -> bool {
        self.gpu.is_lost()
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> String {
        self.gpu.adapter.get_info().name
    }

    /// Lets the style look at as many frames before as there are by now.
    fn update_style(&mut self) -> Result<()> {
        if let Some(stylizer) = &mut self.stylizer
            && stylizer.update()?
        {
            stylizer.bind(self.renderer.targets())?;
            self.show();
        }
        Ok(())
    }

    fn show(&mut self) {
        let (picture, kind) = match &self.stylizer {
            Some(stylizer) => (stylizer.output(), stylizer.kind()),
            None => (&self.renderer.targets().color.view, Kind::Color),
        };
        self.present.bind(&self.gpu.device, &self.gpu.queue, picture, kind);
    }
}

fn surface(instance: &wgpu::Instance, window: &Arc<Window>) -> Result<wgpu::Surface<'static>> {
    instance.create_surface(Arc::clone(window)).map_err(|e| {
        Error::failure(
            format!("the window cannot be drawn on: {e}"),
            "install a Vulkan driver with X11 or Wayland support",
        )
    })
}

/// A minimised window has no pixels; targets have at least one.
fn drawable(size: PhysicalSize<u32>) -> (u32, u32) {
    (size.width.max(1), size.height.max(1))
}
