//! Textures of a plan: those that passes write, and places for those of the host.

use crate::history::Rings;
use crate::kernels::{Kernels, texture_format};
use isophote_files::error::Result;
use isophote_loader::history::{self, Past};
use isophote_loader::plan::{Format, Role, Texture};

/// Uses of textures that passes write.
pub const WRITTEN: wgpu::TextureUsages = wgpu::TextureUsages::TEXTURE_BINDING
    .union(wgpu::TextureUsages::STORAGE_BINDING)
    .union(wgpu::TextureUsages::COPY_SRC);
/// Uses of copies of the host's textures.
pub const COPIED: wgpu::TextureUsages =
    wgpu::TextureUsages::TEXTURE_BINDING.union(wgpu::TextureUsages::COPY_DST);

/// A texture of the plan, by its index there.
#[derive(Debug)]
pub struct Slot {
    /// Name of an input or output.
    pub name: String,
    /// Who makes it, and what for.
    pub role: Role,
    format: Format,
    /// Columns and rows; at least so many.
    pub size: [u32; 2],
    /// The runner's own, or what the host has bound, none for inputs until then; one for all frames, or as many as take
    /// turns.
    pub views: Vec<wgpu::TextureView>,
}

impl Slot {
    fn is_like(&self, texture: &Texture<'_>) -> bool {
        (self.role, self.format, self.size) == (texture.role, texture.format, texture.size)
    }

    /// Tells whether the runner made it for this plan alone.
    fn is_own(&self) -> bool {
        self.role != Role::Input && !history::is_stage(&self.name)
    }
}

/// The textures that a plan wants, `old` ones where they fit and new ones elsewhere. `rings` holds those of stages for
/// later frames.
///
/// # Errors
/// [`Error::Failure`](isophote_files::error::Error::Failure) when the device refuses or has no memory.
pub fn slots(
    kernels: &Kernels,
    wanted: &[Texture<'_>],
    past: &Past,
    mut old: Vec<Slot>,
    rings: &mut Rings,
) -> Result<Vec<Slot>> {
    old.retain(|slot| slot.is_own() && wanted.iter().any(|t| slot.is_like(t)));
    let is_written = |name: &str| wanted.iter().any(|t| t.name == name && t.role == Role::Output);
    rings.retain(|name| is_written(name) || past.inputs().any(|input| input == name));
    let mut slots = Vec::with_capacity(wanted.len());
    for texture in wanted {
        let Texture { name, role, format, size } = *texture;
        let make = || create(kernels, texture_format(format), size, WRITTEN);
        let found = old.iter().position(|slot| slot.is_like(texture));
        let views = match (role, found) {
            (Role::Input, _) => Vec::new(),
            (Role::Output, _) if history::is_stage(name) => {
                rings.hold(name, texture_format(format), size, None, make)?;
                rings.views(name, 0).unwrap_or_default()
            }
            (_, Some(at)) => old.swap_remove(at).views,
            (_, None) => vec![make()?],
        };
        slots.push(Slot { name: name.to_owned(), role, format, size, views });
    }
    Ok(slots)
}

/// A texture without contents.
///
/// # Errors
/// As [`slots`].
pub fn create(
    kernels: &Kernels,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    usage: wgpu::TextureUsages,
) -> Result<wgpu::TextureView> {
    kernels.make(|| {
        let texture = kernels.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("texture of a plan"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
    })
}
