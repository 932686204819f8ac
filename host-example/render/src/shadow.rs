//! Shadows of the sun: up to three maps of growing parts of the view (cascades), so that a street keeps sharp
//! shadows in a city and an object on its own needs a single map.

use glam::camera::rh::{proj::directx as clip, view as camera};
use glam::{Mat4, Vec2, Vec3};

use crate::buffers;
use crate::layouts::{Layouts, bind_buffer, bind_sampler, bind_view};
use crate::lighting::Lighting;
use crate::targets::DEPTH_FORMAT;
use isophote_scene::Scene;
use isophote_scene::camera::View;
use isophote_scene::model::Projection;

/// Most maps.
pub const CASCADES: usize = 3;

/// Texels along a side of each map.
const RESOLUTION: u32 = 2048;

/// Share of a cascade's depth over which it fades into the next.
const FADE: f32 = 0.1;

/// Places of the maps of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cascades {
    /// World to the clip space of each map.
    pub matrices: [Mat4; CASCADES],
    /// Size of a texel of each map in the world.
    pub texels: [f32; CASCADES],
    /// Depth in the view at which each map ends; the last one in use holds the whole scene.
    pub ends: [f32; CASCADES],
    /// Number of maps in use.
    pub count: usize,
}

impl Cascades {
    /// Maps for a view of the scene in pictures of this aspect.
    pub fn new(scene: &Scene, lighting: &Lighting, view: &View, aspect: f32) -> Self {
        let center = scene.bounds.center();
        let up = if lighting.sun_direction.y.abs() > 0.99 { Vec3::X } else { Vec3::Y };
        let to_light = camera::look_at_mat4(center + lighting.sun_direction, center, up);
        let whole = light_box(scene, to_light);
        let mut cascades = Self {
            matrices: [Mat4::IDENTITY; CASCADES],
            texels: [1.0; CASCADES],
            ends: [f32::MAX; CASCADES],
            count: 0,
        };
        for part in parts_of_view(scene, view, aspect).into_iter().flatten() {
            let middle = to_light.transform_point3(part.center).truncate();
            let texel = 2.0 * part.radius / RESOLUTION as f32;
            // Moving in whole texels keeps the edges of shadows from crawling with the camera.
            let middle = (middle / texel).floor() * texel;
            let (low, high) = (middle - part.radius, middle + part.radius);
            let smaller = (whole.1 - whole.0).truncate().max_element() > 2.2 * part.radius;
            if !smaller || cascades.count + 1 == CASCADES {
                break;
            }
            cascades.push(to_light, low.extend(whole.0.z), high.extend(whole.1.z), part.end);
        }
        cascades.push(to_light, whole.0, whole.1, f32::MAX);
        cascades
    }

    fn push(&mut self, to_light: Mat4, low: Vec3, high: Vec3, end: f32) {
        let projection = clip::orthographic(low.x, high.x, low.y, high.y, -high.z, -low.z);
        self.matrices[self.count] = projection * to_light;
        self.texels[self.count] = (high - low).truncate().max_element() / RESOLUTION as f32;
        self.ends[self.count] = end;
        self.count += 1;
    }

    /// True where a sphere can cast a shadow into a map.
    pub fn reaches(&self, cascade: usize, center: Vec3, radius: f32) -> bool {
        let matrix = self.matrices[cascade];
        let place = matrix.transform_point3(center).truncate().abs();
        let scale = Vec2::new(matrix.row(0).truncate().length(), matrix.row(1).truncate().length());
        place.cmple(scale * radius + 1.0).all()
    }
}

/// Box around the scene as the sun sees it, with room for the filter at its edges and for flat scenes.
fn light_box(scene: &Scene, to_light: Mat4) -> (Vec3, Vec3) {
    let (min, max) = (scene.bounds.min, scene.bounds.max);
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for corner in 0..8 {
        let pick = |bit: u32, a: f32, b: f32| if corner >> bit & 1 == 0 { a } else { b };
        let point = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
        let seen = to_light.transform_point3(point);
        (low, high) = (low.min(seen), high.max(seen));
    }
    let margin = scene.bounds.radius() * 0.02;
    (low - margin, high + margin)
}

/// Sphere around the view between two depths.
struct Part {
    center: Vec3,
    radius: f32,
    end: f32,
}

/// The nearer parts of the view, at depths that grow geometrically. Depths depend on the camera in coarse steps
/// only, so that the spheres keep their size while it moves.
fn parts_of_view(scene: &Scene, view: &View, aspect: f32) -> [Option<Part>; CASCADES] {
    let Projection::Perspective { vertical_fov, .. } = view.projection else {
        return [const { None }; CASCADES];
    };
    let to_world = view.world_to_view.inverse();
    let (eye, forward) = (to_world.w_axis.truncate(), -to_world.z_axis.truncate());
    let (center, extent) = (scene.bounds.center(), scene.bounds.radius());
    let far = coarse(eye.distance(center) + extent);
    let near = coarse((eye.distance(center) - extent).max(far * 0.008));
    let tan_y = (vertical_fov * 0.5).tan();
    // Squared slope of the edges of the view.
    let k = tan_y * tan_y * (1.0 + aspect * aspect);
    std::array::from_fn(|i| {
        let depth = |i: usize| near * (far / near).powf(i as f32 / CASCADES as f32);
        let (start, end) = (if i == 0 { 0.0 } else { depth(i) * (1.0 - FADE) }, depth(i + 1));
        let (sum, length) = (start + end, end - start);
        let (along, radius) = if k * sum >= length {
            (end, end * k.sqrt())
        } else {
            let squared = length * length + 2.0 * (start * start + end * end) * k + sum * sum * k * k;
            (0.5 * sum * (1.0 + k), 0.5 * squared.sqrt())
        };
        Some(Part { center: eye + forward * along, radius, end })
    })
}

/// The next power of the square root of 2 below.
fn coarse(value: f32) -> f32 {
    ((value.max(1e-6).log2() * 2.0).floor() * 0.5).exp2()
}

/// The maps on the GPU.
pub struct ShadowMaps {
    /// One view for each map, to draw into.
    pub layers: Vec<wgpu::TextureView>,
    /// Group 3 of the shadow pass, which says which map is drawn.
    pub layer_groups: Vec<wgpu::BindGroup>,
    /// Group 3 of the other passes: all maps with their sampler.
    pub group: wgpu::BindGroup,
}

impl ShadowMaps {
    /// Allocates the maps.
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow maps"),
            size: wgpu::Extent3d {
                width: RESOLUTION,
                height: RESOLUTION,
                depth_or_array_layers: CASCADES as u32,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow maps"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let all = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let layers = (0..CASCADES as u32)
            .map(|layer| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let layer_groups = (0..CASCADES as u32)
            .map(|layer| {
                let bytes = [layer, 0, 0, 0];
                let usage = wgpu::BufferUsages::UNIFORM;
                let uniform = buffers::filled_buffer(device, "cascade", bytemuck::bytes_of(&bytes), usage);
                device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("cascade"),
                    layout: &layouts.cascade,
                    entries: &[bind_buffer(0, &uniform)],
                })
            })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("shadow maps"),
            layout: &layouts.shadow,
            entries: &[bind_view(0, &all), bind_sampler(1, &sampler)],
        });
        Self { layers, layer_groups, group }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_scene::camera::{Framing, Orbit};

    fn scene(scale: f32) -> Scene {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, format!("v 0 0 0\nv {scale} 0 0\nv 0 {scale} 0\nf 1 2 3\n")).unwrap();
        Scene::load(&path, None).unwrap()
    }

    #[test]
    fn an_object_has_one_map_and_a_landscape_three() {
        let object = scene(1.0);
        let orbit = Orbit::framing(&object, 1.5, Framing::default());
        assert_eq!(Cascades::new(&object, &Lighting::default(), &orbit.view(), 1.5).count, 1);
        let landscape = scene(1000.0);
        let inside = Orbit { target: landscape.bounds.center(), distance: 5.0, ..orbit };
        let cascades = Cascades::new(&landscape, &Lighting::default(), &inside.view(), 1.5);
        assert_eq!(cascades.count, 3);
        assert!(cascades.texels[0] < 0.1 * cascades.texels[2], "{:?}", cascades.texels);
        // What lies before the camera is in the first map, and everything in the last.
        let eye = inside.view().eye();
        let ahead = eye - inside.direction() * cascades.ends[0] * 0.5;
        assert!(cascades.matrices[0].transform_point3(ahead).abs().max_element() <= 1.0);
        for point in [landscape.bounds.min, landscape.bounds.max] {
            assert!(cascades.matrices[2].transform_point3(point).abs().max_element() <= 1.0);
            assert!(cascades.reaches(2, point, 1.0));
        }
        assert!(!cascades.reaches(0, landscape.bounds.max, 1.0));
    }
}
