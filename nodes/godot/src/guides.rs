//! The guides of a look, from the pictures that Godot has of a viewport.

use crate::device::{Bound, Device};
use crate::error::Error;
use godot::builtin::{Projection, Rid};
use godot::classes::rendering_device::DataFormat;

/// The images that are written: the names that plans have for them, and their formats.
pub(crate) const IMAGES: [(&str, DataFormat); 4] = [
    ("color", DataFormat::R16G16B16A16_SFLOAT),
    ("normal", DataFormat::R16G16B16A16_SFLOAT),
    ("depth", DataFormat::R32_SFLOAT),
    ("motion", DataFormat::R32G32_SFLOAT),
];

/// Side of a workgroup, as in the shaders.
const SIDE: u32 = 8;

/// The uniform block.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct View {
    view_from_clip: [[f32; 4]; 4],
    size: [i32; 2],
    has_normals: u32,
    has_velocities: u32,
    is_transparent: [u32; 4],
}

/// The viewport's pictures as Godot has them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pictures {
    pub(crate) color: Rid,
    pub(crate) depth: Rid,
    pub(crate) normal: Option<Rid>,
    pub(crate) velocity: Option<Rid>,
    /// From camera to clip space as Godot draws: y downwards, depth reversed.
    pub(crate) projection: Projection,
    pub(crate) size: [u32; 2],
    /// Alpha is coverage.
    pub(crate) is_transparent: bool,
}

/// Records the guides of a frame, into `targets`, which are those of [`IMAGES`].
///
/// # Errors
/// [`Error::Device`] where the device refuses.
pub(crate) fn write(device: &mut Device, pictures: &Pictures, targets: &[Rid]) -> Result<(), Error> {
    let columns = pictures.projection.inverse().cols;
    let view = View {
        view_from_clip: columns.map(|column| [column.x, column.y, column.z, column.w]),
        size: pictures.size.map(|n| n as i32),
        has_normals: pictures.normal.is_some().into(),
        has_velocities: pictures.velocity.is_some().into(),
        is_transparent: [pictures.is_transparent.into(), 0, 0, 0],
    };
    let uniforms = device.uniforms(bytemuck::bytes_of(&view))?;
    let read = [
        pictures.color,
        pictures.depth,
        // Colours stand for what is not there and not read.
        pictures.normal.unwrap_or(pictures.color),
        pictures.velocity.unwrap_or(pictures.color),
    ];
    let textures = read.map(Bound::Read).into_iter().chain(targets.iter().copied().map(Bound::Written));
    let bound: Vec<(u32, Bound)> =
        std::iter::once((0, Bound::Uniforms(uniforms))).chain((2..).zip(textures)).collect();
    let recorded = record(device, "guides", include_str!("guides.wgsl"), &bound, pictures.size);
    // Its set goes with it; Godot waits until the frame is done.
    device.free([uniforms]);
    recorded.map(|_| ())
}

/// Records the stylized picture, into the viewport's colours.
///
/// # Errors
/// [`Error::Device`] where the device refuses.
pub(crate) fn present(device: &mut Device, stylized: Rid, pictures: &Pictures) -> Result<(), Error> {
    let bound = [(2, Bound::Read(stylized)), (3, Bound::Written(pictures.color))];
    let set = record(device, "present", include_str!("present.wgsl"), &bound, pictures.size)?;
    device.free([set]);
    Ok(())
}

/// Records a pass of one thread for each pixel, and returns what it is given.
fn record(
    device: &mut Device,
    name: &str,
    source: &str,
    bound: &[(u32, Bound)],
    [width, height]: [u32; 2],
) -> Result<Rid, Error> {
    let shader = device.shader(name, source)?;
    let set = device.set(shader, bound)?;
    device.dispatch(shader, set, [width.div_ceil(SIDE), height.div_ceil(SIDE), 1]);
    Ok(set)
}
