//! Values of control maps that the vertices of a scene bring, on the GPU: what artists painted on things, for styles.

use crate::layouts::{Layouts, bind_buffer};
use crate::upload;
use isophote_files::error::Result;
use isophote_scene::model::NEUTRAL;
use isophote_scene::{Draw, Mesh, Primitive, Scene};

/// Group 3 of the pass of control maps for every primitive.
#[derive(Debug)]
pub struct ControlValues {
    /// By meshes and primitives; nothing where these have no values.
    groups: Vec<Vec<Option<wgpu::BindGroup>>>,
    /// One neutral value, which stands for those of all vertices of a primitive that has none.
    neutral: wgpu::BindGroup,
}

impl ControlValues {
    /// Uploads all values of a scene.
    ///
    /// # Errors
    /// As [`upload::buffer`].
    pub fn new(device: &wgpu::Device, layouts: &Layouts, scene: &Scene) -> Result<Self> {
        let group = |mesh: &str, values: &[[f32; 4]]| {
            let data = ("control values", bytemuck::cast_slice(values));
            let buffer = upload::buffer(device, mesh, data, wgpu::BufferUsages::STORAGE)?;
            Ok(device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("control"),
                layout: &layouts.control,
                entries: &[bind_buffer(0, &buffer)],
            }))
        };
        let of_primitive = |mesh: &str, primitive: &Primitive| {
            let values = Some(primitive.control.as_slice()).filter(|values| !values.is_empty());
            values.map(|values| group(mesh, values)).transpose()
        };
        let of_mesh = |mesh: &Mesh| {
            mesh.primitives.iter().map(|primitive| of_primitive(&mesh.name, primitive)).collect()
        };
        let groups = scene.meshes.iter().map(of_mesh).collect::<Result<_>>()?;
        Ok(Self { groups, neutral: group("", &[NEUTRAL])? })
    }

    /// The group that a draw reads.
    pub fn group(&self, draw: &Draw) -> &wgpu::BindGroup {
        self.groups[draw.mesh][draw.primitive].as_ref().unwrap_or(&self.neutral)
    }
}
