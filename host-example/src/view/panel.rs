//! The controls on the device: what egui wants painted.

use egui::epaint::{ClippedPrimitive, textures::TexturesDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

/// egui's renderer with what it is to paint.
pub struct Panel {
    renderer: Renderer,
    shapes: Vec<ClippedPrimitive>,
    textures: TexturesDelta,
    pixels_per_point: f32,
}

impl Panel {
    /// Compiles its pass for surfaces of `format`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let options = RendererOptions { msaa_samples: 1, dithering: false, ..RendererOptions::default() };
        let renderer = Renderer::new(device, format, options);
        Self { renderer, shapes: Vec::new(), textures: TexturesDelta::default(), pixels_per_point: 1.0 }
    }

    /// Takes over what is painted from now on.
    pub fn set(&mut self, shapes: Vec<ClippedPrimitive>, textures: TexturesDelta, pixels_per_point: f32) {
        self.shapes = shapes;
        self.textures.append(textures);
        self.pixels_per_point = pixels_per_point;
    }

    /// Uploads textures that are new.
    pub fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) {
        for (id, deltas) in self.textures.set.drain() {
            for delta in &deltas {
                self.renderer.update_texture(device, queue, id, delta);
            }
        }
    }

    /// Uploads shapes for a window of a size in pixels.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        size: (u32, u32),
    ) {
        // Commands of callbacks come back, and there are none.
        let _ = self.renderer.update_buffers(device, queue, encoder, &self.shapes, &self.screen(size));
    }

    /// Paints.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'static>, size: (u32, u32)) {
        self.renderer.render(pass, &self.shapes, &self.screen(size));
    }

    /// Frees textures that nobody needs any more.
    pub fn free(&mut self) {
        for id in self.textures.free.drain() {
            self.renderer.free_texture(&id);
        }
    }

    fn screen(&self, (width, height): (u32, u32)) -> ScreenDescriptor {
        ScreenDescriptor { size_in_pixels: [width, height], pixels_per_point: self.pixels_per_point }
    }
}

impl Drop for Panel {
    fn drop(&mut self) {
        // egui holds it a mistake to drop what was not applied; here the device is gone.
        self.textures.clear();
    }
}
