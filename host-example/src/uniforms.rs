//! Uniform blocks of all passes of a plan, in one buffer.

use std::num::NonZeroU64;

use crate::kernels::{Kernels, block_size};
use isophote_files::error::Result;

/// Place of a pass's block in the buffer.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    at: u64,
    bound: u64,
}

/// Places of blocks one after the other, as the device wants them aligned.
#[derive(Debug)]
pub struct Layout {
    alignment: u64,
    end: u64,
}

impl Layout {
    /// No block yet.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { alignment: device.limits().min_uniform_buffer_offset_alignment.into(), end: 0 }
    }

    /// The place of the next block.
    pub fn place(&mut self, block: &[u8]) -> Block {
        let block = Block { at: self.end, bound: block_size(block) };
        self.end += block.bound.next_multiple_of(self.alignment);
        block
    }
}

/// The buffer.
#[derive(Debug)]
pub struct Uniforms {
    buffer: wgpu::Buffer,
    /// Its contents.
    bytes: Vec<u8>,
}

impl Uniforms {
    /// A buffer of zeros for all blocks that were placed.
    ///
    /// # Errors
    /// [`Error::Failure`](isophote_files::error::Error::Failure) when the device refuses or has no memory.
    pub fn new(kernels: &Kernels, layout: &Layout) -> Result<Self> {
        let buffer = kernels.make(|| {
            Ok(kernels.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("uniforms of a plan"),
                size: layout.end,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }))
        })?;
        Ok(Self { buffer, bytes: vec![0; layout.end as usize] })
    }

    /// Changes the bytes of a block, which [`Uniforms::upload`] uploads; says whether they are others now.
    pub fn put(&mut self, block: Block, new: &[u8]) -> bool {
        let old = &mut self.bytes[block.at as usize..][..new.len()];
        let is_changed = old != new;
        old.copy_from_slice(new);
        is_changed
    }

    /// Uploads all blocks.
    pub fn upload(&self, kernels: &Kernels) {
        kernels.upload(&self.buffer, &self.bytes);
    }

    /// A block as a bind group names it.
    pub fn binding(&self, block: Block) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: block.at,
            size: NonZeroU64::new(block.bound),
        })
    }
}
