//! Uniform blocks of all passes of a plan, in one buffer.

use std::num::NonZeroU64;

use crate::kernels::Kernels;
use isophote_files::error::Result;
use isophote_loader::uniforms::{Block, Bytes};

/// The buffer.
#[derive(Debug)]
pub struct Uniforms {
    buffer: wgpu::Buffer,
    /// Contents of the buffer, once they are [uploaded](Uniforms::upload).
    pub bytes: Bytes,
}

impl Uniforms {
    /// A buffer for blocks that were placed.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when the device refuses or has no memory.
    pub fn new(kernels: &Kernels, bytes: Bytes) -> Result<Self> {
        let buffer = kernels.make(|| {
            Ok(kernels.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("uniforms of a plan"),
                size: bytes.as_slice().len() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }))
        })?;
        Ok(Self { buffer, bytes })
    }

    /// Uploads all blocks.
    pub fn upload(&self, kernels: &Kernels) {
        kernels.upload(&self.buffer, self.bytes.as_slice());
    }

    /// A block as a bind group names it.
    pub fn binding(&self, block: Block) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: block.offset as u64,
            size: NonZeroU64::new(block.size as u64),
        })
    }
}
