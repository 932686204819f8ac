//! Textures of a host's own: made, filled and read back.

use isophote_engine::Image;
use isophote_engine::gpu::wgpu;

pub fn texture(device: &wgpu::Device, width: u32, height: u32, format: wgpu::TextureFormat) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST
            | match format {
                wgpu::TextureFormat::Rgba32Float => wgpu::TextureUsages::STORAGE_BINDING,
                _ => wgpu::TextureUsages::empty(),
            },
        view_formats: &[],
    })
}

pub fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

pub fn upload(queue: &wgpu::Queue, texture: &wgpu::Texture, image: &Image) {
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(image.data()),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(image.stride() as u32 * 4),
            rows_per_image: None,
        },
        texture.size(),
    );
}

/// Pixels of a texture whose rows are a multiple of 256 bytes.
pub fn download(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture, channels: u32) -> Image {
    let row = texture.width() * channels * 4;
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row * texture.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        texture.size(),
    );
    queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let data = bytemuck::cast_slice(&buffer.get_mapped_range(..).unwrap()).to_vec();
    Image::from_vec(texture.width(), texture.height(), channels, data).unwrap()
}
