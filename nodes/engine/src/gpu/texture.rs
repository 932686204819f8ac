//! Textures for what programs compute, and those kept for later ones.

use super::device::{Device, count};
use super::pipeline::texture_format;
use crate::error::Result;
use crate::program::Format;
use std::sync::{Mutex, MutexGuard, PoisonError};

pub(super) fn texture_bytes(texture: &wgpu::Texture) -> u64 {
    let texel = texture.format().block_copy_size(None).unwrap_or(16);
    u64::from(texture.width()) * u64::from(texture.height()) * u64::from(texel)
}

/// A texture that can be read, written and copied, with its view.
pub(super) fn create_texture(device: &Device, size: [u32; 2], format: Format) -> Result<wgpu::TextureView> {
    let what = format!("a texture of {}x{} texels ({})", size[0], size[1], format.wgsl());
    let view = device.guarded(&what, |raw| {
        let texture = raw.create_texture(&wgpu::TextureDescriptor {
            label: Some("isophote"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: texture_format(format),
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    })?;
    count(&device.counters.textures);
    Ok(view)
}

/// Scratch textures of dropped programs, for the next ones.
#[derive(Debug, Default)]
pub(super) struct Pool(Mutex<Vec<wgpu::TextureView>>);

impl Pool {
    /// Bytes kept at most; the oldest textures go first.
    const KEPT: u64 = 512 << 20;

    /// A texture of at least `size` that wastes at most half of itself, or a new one of `size`.
    pub fn take(&self, device: &Device, size: [u32; 2], format: Format) -> Result<wgpu::TextureView> {
        let wanted = u64::from(size[0]) * u64::from(size[1]);
        let area = |t: &wgpu::Texture| u64::from(t.width()) * u64::from(t.height());
        let mut kept = self.lock();
        let best = kept
            .iter()
            .enumerate()
            .filter(|(_, view)| {
                let t = view.texture();
                t.format() == texture_format(format)
                    && t.width() >= size[0]
                    && t.height() >= size[1]
                    && area(t) <= 2 * wanted
            })
            .min_by_key(|(_, view)| area(view.texture()))
            .map(|(index, _)| index);
        if let Some(index) = best {
            return Ok(kept.remove(index));
        }
        drop(kept);
        create_texture(device, size, format)
    }

    pub fn put(&self, view: wgpu::TextureView) {
        let mut kept = self.lock();
        kept.push(view);
        let mut bytes: u64 = kept.iter().map(|v| texture_bytes(v.texture())).sum();
        let mut surplus = 0;
        while bytes > Self::KEPT && surplus < kept.len() {
            bytes -= texture_bytes(kept[surplus].texture());
            surplus += 1;
        }
        kept.drain(..surplus);
    }

    pub fn is_empty(&self) -> bool {
        self.lock().is_empty()
    }

    pub fn clear(&self) {
        self.lock().clear();
    }

    fn lock(&self) -> MutexGuard<'_, Vec<wgpu::TextureView>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
