//! The controls on the device: what egui wants painted.

use std::collections::HashMap;
use std::sync::Arc;

use egui::TextureId;
use egui::epaint::textures::TexturesDelta;
use egui::epaint::{ClippedPrimitive, ImageData, ImageDelta};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

/// Content of egui's textures. egui tells what changes of them alone, so that a device that takes another's place
/// needs this.
#[derive(Default)]
pub struct Textures(HashMap<TextureId, ImageDelta>);

impl Textures {
    /// Takes over what changes.
    pub fn follow(&mut self, changes: &TexturesDelta) {
        for (id, deltas) in &changes.set {
            for delta in deltas {
                match (delta.pos, self.0.get_mut(id)) {
                    (Some(at), Some(known)) => patch(known, delta, at),
                    _ => {
                        self.0.insert(*id, delta.clone());
                    }
                }
            }
        }
        self.0.retain(|id, _| !changes.free.contains(id));
    }

    /// All of them, for a device that has none.
    pub fn whole(&self) -> TexturesDelta {
        let mut all = TexturesDelta::default();
        self.0.iter().for_each(|(id, texture)| all.push(*id, texture.clone()));
        all
    }
}

/// Puts a part of a texture in its place.
fn patch(known: &mut ImageDelta, delta: &ImageDelta, [left, top]: [usize; 2]) {
    let (ImageData::Color(image), ImageData::Color(part)) = (&mut known.image, &delta.image);
    let image = Arc::make_mut(image);
    let [width, _] = image.size;
    for (row, line) in part.pixels.chunks_exact(part.size[0].max(1)).enumerate() {
        let from = (top + row) * width + left;
        if let Some(old) = image.pixels.get_mut(from..from + line.len()) {
            old.copy_from_slice(line);
        }
    }
}

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

    /// Gives a device that has none the textures that were made before.
    pub fn restore(&mut self, textures: &Textures) {
        self.textures.append(textures.whole());
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

#[cfg(test)]
mod tests {
    use egui::{Color32, ColorImage, TextureOptions};

    use super::*;

    #[test]
    fn a_texture_is_known_whole_after_parts_of_it_have_changed() {
        let (plain, other) = (Color32::BLACK, Color32::WHITE);
        let image = |size: [usize; 2], color| ColorImage::new(size, vec![color; size[0] * size[1]]);
        let id = TextureId::Managed(7);
        let mut textures = Textures::default();
        let mut changes = TexturesDelta::default();
        changes.push(id, ImageDelta::full(image([4, 3], plain), TextureOptions::LINEAR));
        changes.push(id, ImageDelta::partial([1, 2], image([2, 1], other), TextureOptions::LINEAR));
        textures.follow(&changes);
        changes.clear();
        let mut whole = textures.whole();
        let ImageData::Color(known) = &whole.set[&id][0].image;
        let seen: Vec<usize> = (0..12).filter(|at| known.pixels[*at] == other).collect();
        assert_eq!(seen, [9, 10]);
        whole.clear();
        changes.free(id);
        textures.follow(&changes);
        changes.clear();
        assert!(textures.whole().is_empty());
    }
}
