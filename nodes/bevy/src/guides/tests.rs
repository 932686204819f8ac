//! Numbers of guides from prepasses whose numbers are known.

use super::{IMAGES, Pass, Prepasses, View};
use crate::images::{Images, Needed};
use crate::shaders;
use isophote::engine::gpu::{Device, Options, wgpu};
use std::sync::Arc;
use wgpu::{TextureFormat, TextureUsages};

/// The target, and a viewport in it.
const TARGET: [u32; 2] = [8, 8];
const VIEWPORT: [u32; 4] = [2, 3, 4, 2];

/// Bytes between rows of a copy, as wgpu asks for.
const STRIDE: u32 = 256;

fn device() -> Arc<Device> {
    Device::open(&Options::default()).expect("a graphics device")
}

/// A texture of the target's size that is one value everywhere, as a pass clears it.
fn cleared(device: &Device, format: TextureFormat, samples: u32, value: [f64; 4]) -> wgpu::TextureView {
    let [width, height] = TARGET;
    let texture = device.raw().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let [r, g, b, a] = value;
    let color = wgpu::RenderPassColorAttachment {
        view: &view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
            store: wgpu::StoreOp::Store,
        },
    };
    let depth = wgpu::RenderPassDepthStencilAttachment {
        view: &view,
        depth_ops: Some(wgpu::Operations {
            load: wgpu::LoadOp::Clear(r as f32),
            store: wgpu::StoreOp::Store,
        }),
        stencil_ops: None,
    };
    let (colors, is_depth) = ([Some(color)], format.is_depth_stencil_format());
    let mut encoder = device.raw().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: if is_depth { &[] } else { &colors },
        depth_stencil_attachment: is_depth.then_some(depth),
        ..wgpu::RenderPassDescriptor::default()
    }));
    device.queue().submit([encoder.finish()]);
    view
}

/// Eight bytes of the first texel of a texture, through a copy.
fn first(device: &Device, view: &wgpu::TextureView) -> [u8; 8] {
    let buffer = device.raw().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(STRIDE),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.raw().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(STRIDE), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        view.texture().as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
    );
    device.queue().submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("a buffer can be read"));
    device.raw().poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    let bytes = buffer.get_mapped_range(..).expect("it was mapped");
    let mut read = [0; 8];
    read.copy_from_slice(&bytes[..8]);
    read
}

/// The guides of a pixel.
struct Found {
    depth: f32,
    motion: [f32; 2],
    /// Bits of 16-bit floats.
    normal: [u16; 4],
}

/// The guides of one pixel, whose depth is this, in a camera that looks along -x.
fn guides(device: &Arc<Device>, samples: u32, depth: f64) -> Found {
    let size = [VIEWPORT[2], VIEWPORT[3]];
    let needed = IMAGES.map(|(name, format)| Needed { name: name.into(), depth: 0, size, format });
    let mut images = Images::default();
    images.hold(device, &needed).expect("there is room");
    let target = |name: &str| images.now(name).expect("it is kept");
    let targets = IMAGES.map(|(name, _)| target(name));
    let raw = device.raw();
    let color = cleared(device, TextureFormat::Rgba8UnormSrgb, 1, [0.2, 0.4, 0.6, 1.0]);
    let depth = cleared(device, TextureFormat::Depth32Float, samples, [depth, 0.0, 0.0, 0.0]);
    let normal = cleared(device, TextureFormat::Rgb10a2Unorm, samples, [1.0, 0.5, 0.5, 1.0]);
    // A quarter of the width to the right, and an eighth of the height down.
    let motion = cleared(device, TextureFormat::Rg16Float, samples, [0.25, 0.125, 0.0, 0.0]);
    let prepasses =
        Prepasses { color: &color, depth: Some(&depth), normal: Some(&normal), motion: Some(&motion) };
    let pass = Pass::new(raw, samples > 1);
    assert!(pass.fits(&prepasses));
    let view = View {
        // Columns: the camera looks along -x, with y up.
        view_from_world: [
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
        // A right angle of view, the near plane at 0.1, depth reversed and without an end.
        view_from_clip: [
            [2.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 10.0],
            [0.0, 0.0, -1.0, 0.0],
        ],
        viewport: VIEWPORT.map(|n| n as i32),
    };
    let uniforms = shaders::uniforms(raw, "view", size_of::<View>());
    device.queue().write_buffer(&uniforms, 0, bytemuck::bytes_of(&view));
    let mut encoder = raw.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    pass.encode(raw, &mut encoder, &uniforms, prepasses, &targets, size);
    device.queue().submit([encoder.finish()]);
    device.check().expect("nothing was refused");
    let read = |name: &str| first(device, target(name));
    let [depth, _]: [f32; 2] = bytemuck::cast(read("depth"));
    Found { depth, motion: bytemuck::cast(read("motion")), normal: bytemuck::cast(read("normal")) }
}

#[test]
fn distances_and_motion_are_those_of_the_camera() {
    let device = device();
    for samples in [1, 4] {
        // Of a near plane at 0.1, reversed: 0.02 is at 5.
        let found = guides(&device, samples, 0.02);
        assert!((found.depth - 5.0).abs() < 1e-4, "{}", found.depth);
        // Back to where it was, in pixels of the viewport.
        assert_eq!(found.motion, [-0.25 * VIEWPORT[2] as f32, -0.125 * VIEWPORT[3] as f32]);
        // The surface faces the camera, as precisely as 10 bits tell.
        let [x, y, z, _] = found.normal;
        assert!(x & 0x7fff < 0x1c00 && y & 0x7fff < 0x1c00, "{x:x} {y:x}");
        assert!((0x3bf0..=0x3c00).contains(&z), "{z:x}");
        let nothing = guides(&device, samples, 0.0);
        assert_eq!((nothing.depth, nothing.normal[..3].to_vec()), (0.0, vec![0; 3]));
    }
}
