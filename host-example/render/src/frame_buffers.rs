//! The buffers of the scene's passes.

use glam::Mat4;

use crate::layouts::{Layouts, bind_buffer};
use crate::uniforms::{FrameBlock, InstanceBlock, LightBlock};

/// Buffers that are filled anew for each frame, and the group that binds them.
pub struct Buffers {
    /// The frame.
    pub frame: wgpu::Buffer,
    /// Draws.
    pub instances: wgpu::Buffer,
    /// Joints of this frame, then of the one before.
    pub joints: wgpu::Buffer,
    /// Weights of morph targets, likewise.
    pub weights: wgpu::Buffer,
    /// The lights of the file.
    pub lights: wgpu::Buffer,
    /// All of them, which is group 0.
    pub bind_group: wgpu::BindGroup,
}

impl Buffers {
    /// Makes them, for as many of each.
    pub fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        draws: usize,
        joints: usize,
        weights: usize,
        lights: usize,
    ) -> Self {
        let make = |label, size: usize, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let frame = make("frame", size_of::<FrameBlock>(), wgpu::BufferUsages::UNIFORM);
        let instances = make("instances", draws.max(1) * size_of::<InstanceBlock>(), storage);
        let joints = make("joints", 2 * joints.max(1) * size_of::<Mat4>(), storage);
        let weights = make("weights", 2 * weights.max(1) * size_of::<f32>(), storage);
        let lights = make("lights", lights.max(1) * size_of::<LightBlock>(), storage);
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &layouts.frame,
            entries: &[
                bind_buffer(0, &frame),
                bind_buffer(1, &instances),
                bind_buffer(2, &joints),
                bind_buffer(3, &weights),
                bind_buffer(4, &lights),
            ],
        });
        Self { frame, instances, joints, weights, lights, bind_group }
    }
}
