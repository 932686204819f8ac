//! Images of the frame at hand and of those before it, by their names.

use crate::error::Error;
use isophote::engine::gpu::{Device, wgpu};

/// Usages of all images: kernels write and read them, and tools copy them.
const USAGES: wgpu::TextureUsages = wgpu::TextureUsages::STORAGE_BINDING
    .union(wgpu::TextureUsages::TEXTURE_BINDING)
    .union(wgpu::TextureUsages::COPY_SRC);

/// Image that is needed.
#[derive(Clone, Debug)]
pub(crate) struct Needed {
    pub(crate) name: String,
    /// Frames before the one at hand that it is read of.
    pub(crate) depth: usize,
    /// Width and height.
    pub(crate) size: [u32; 2],
    pub(crate) format: wgpu::TextureFormat,
}

/// Image of a name in the frame at hand, and in as many before it as are read.
#[derive(Debug)]
struct Ring {
    name: String,
    /// The frame at hand first, then the frame before it, and so on.
    views: Vec<wgpu::TextureView>,
}

/// All images of the frame at hand that later frames read, or that the camera's pictures are written to.
#[derive(Debug, Default)]
pub(crate) struct Images {
    rings: Vec<Ring>,
}

impl Images {
    /// The image of a name in the frame at hand, where it is kept.
    pub(crate) fn now(&self, name: &str) -> Option<&wgpu::TextureView> {
        self.before(name, 0)
    }

    /// The image of a name in a frame before.
    pub(crate) fn before(&self, name: &str, frames: usize) -> Option<&wgpu::TextureView> {
        self.rings.iter().find(|ring| ring.name == name)?.views.get(frames)
    }

    /// Makes room for these images and forgets all others.
    ///
    /// # Errors
    /// [`Error::Device`] where memory does not suffice.
    pub(crate) fn hold(&mut self, device: &Device, needed: &[Needed]) -> Result<(), Error> {
        self.rings.retain(|ring| needed.iter().any(|image| ring.is_for(image)));
        for image in needed {
            if !self.rings.iter().any(|ring| ring.is_for(image)) {
                let views = (0..=image.depth).map(|_| image.create(device.raw())).collect();
                self.rings.push(Ring { name: image.name.clone(), views });
            }
        }
        Ok(device.check()?)
    }

    /// The next frame begins: the frame at hand is the one before it.
    pub(crate) fn advance(&mut self) {
        self.rings.iter_mut().for_each(|ring| ring.views.rotate_right(1));
    }
}

impl Ring {
    fn is_for(&self, image: &Needed) -> bool {
        let texture = self.views[0].texture();
        self.name == image.name
            && self.views.len() == image.depth + 1
            && texture.format() == image.format
            && [texture.width(), texture.height()] == image.size
    }
}

impl Needed {
    fn create(&self, device: &wgpu::Device) -> wgpu::TextureView {
        let [width, height] = self.size;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(&self.name),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: USAGES,
            view_formats: &[],
        });
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }
}
