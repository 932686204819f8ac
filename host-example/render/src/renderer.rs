//! The renderer: a scene on a wgpu device that the caller owns, frame by frame, with everything that is known
//! about each pixel beside its colour.
//!
//! A frame is a few passes over the scene and the picture: the shadow maps, the multisampled colours, the
//! geometry buffer with one sample per pixel, and the tone mapping. They are recorded into the caller's
//! command encoder; nothing is allocated once every pipeline that the scene needs has been used.

use glam::{Mat4, Vec3};

use crate::animated::{fill_joints, fill_weights, joint_offsets, weight_offsets};
use crate::background::{Backdrop, Background};
use crate::control::ControlValues;
use crate::frame_buffers::Buffers;
use crate::ground::Ground;
use crate::layouts::Layouts;
use crate::lighting::Lighting;
use crate::pipelines::{Pass, Pipelines, Variant};
use crate::shadow::{Cascades, ShadowMaps};
use crate::targets::{CONTROL_FORMAT, Layers, REST_FORMAT, Target, Targets};
use crate::textures::TextureStore;
use crate::tone_map::ToneMap;
use crate::uniforms::{FrameBlock, InstanceBlock, LightBlock};
use crate::upload::GpuPrimitive;
use crate::visible::Visible;
use crate::{ground, layouts, lighting, rest, uniforms, upload};
use isophote_files::error::Result;
use isophote_pictures::meaning::ImageState;
use isophote_scene::camera::View;
use isophote_scene::pose::Pose;
use isophote_scene::{AlphaMode, Scene};

/// A scene on the GPU with the targets it is rendered into.
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layouts: Layouts,
    pipelines: Pipelines,
    backdrop: Backdrop,
    /// Draws the shadow on the ground, where there is to be one.
    ground: Option<Ground>,
    /// True where this frame has one.
    shows_ground: bool,
    targets: Targets,
    primitives: Vec<Vec<GpuPrimitive>>,
    materials: Vec<wgpu::BindGroup>,
    buffers: Buffers,
    shadow_maps: ShadowMaps,
    cascades: Option<Cascades>,
    tone_map: ToneMap,
    joints: Vec<Option<u32>>,
    weights: Vec<u32>,
    /// For every draw, from its mesh to the scene at rest.
    rest: Vec<Mat4>,
    /// Values of the control map, where it is rendered.
    control: Option<ControlValues>,
    joint_count: usize,
    weight_count: usize,
    history: History,
    scratch: Scratch,
    visible: Visible,
}

/// The frame before this one; empty before the first.
#[derive(Default)]
struct History {
    view_projection: Option<Mat4>,
    models: Vec<Mat4>,
}

/// Memory that is reused from frame to frame. Joints and weights hold the current frame's values and then the
/// previous one's.
#[derive(Default)]
struct Scratch {
    instances: Vec<InstanceBlock>,
    joints: Vec<Mat4>,
    weights: Vec<f32>,
    lights: Vec<LightBlock>,
    mirrored: Vec<bool>,
}

impl Renderer {
    /// Uploads a scene and allocates targets of `size` pixels. Errors that the device reports later than this
    /// are found by [`crate::gpu::Gpu::check`].
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] when the size or a part of the scene is beyond the limits of the device.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene, size: (u32, u32)) -> Result<Self> {
        let targets = Targets::new(device, size.0, size.1)?;
        let layouts = Layouts::new(device);
        let mut textures = TextureStore::new(device, queue);
        let mut primitives = Vec::with_capacity(scene.meshes.len());
        for mesh in &scene.meshes {
            let uploaded: Result<Vec<_>> =
                mesh.primitives.iter().map(|p| upload::primitive(device, &layouts, &mesh.name, p)).collect();
            primitives.push(uploaded?);
        }
        let mut materials = Vec::with_capacity(scene.materials.len());
        for material in &scene.materials {
            materials.push(upload::material(device, queue, &layouts, &mut textures, scene, material)?);
        }
        let (joints, joint_count) = joint_offsets(scene);
        let (weights, weight_count) = weight_offsets(scene);
        let light_count = lighting::visible_lights(scene).count();
        let buffers =
            Buffers::new(device, &layouts, scene.draws.len(), joint_count, weight_count, light_count);
        let shadow_maps = ShadowMaps::new(device, &layouts);
        let tone_map = ToneMap::new(device, &targets);
        Ok(Self {
            pipelines: Pipelines::new(device, &layouts),
            layouts,
            backdrop: Backdrop::sky(),
            ground: None,
            shows_ground: false,
            device: device.clone(),
            queue: queue.clone(),
            targets,
            primitives,
            materials,
            buffers,
            shadow_maps,
            cascades: None,
            tone_map,
            joints,
            weights,
            rest: rest::matrices(scene),
            control: None,
            joint_count,
            weight_count,
            history: History::default(),
            scratch: Scratch::default(),
            visible: Visible::default(),
        })
    }

    /// Targets that the last frame was rendered into.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// Replaces the targets by ones of another size; motion begins anew.
    ///
    /// # Errors
    /// As [`Renderer::new`]; the old targets then stay.
    pub fn resize(&mut self, size: (u32, u32)) -> Result<()> {
        if size != (self.targets.width, self.targets.height) {
            let new = Targets::new(&self.device, size.0, size.1)?;
            let old = std::mem::replace(&mut self.targets, new);
            if old.rest.is_some() {
                self.add_rest_positions();
            }
            if let Some(layers) = old.layers {
                let is_displayed = layers.displayed.is_some();
                self.add_layers(if is_displayed {
                    ImageState::DisplayReferred
                } else {
                    ImageState::SceneReferred
                });
            }
            self.add_control_target();
            if let Some(ground) = &mut self.ground {
                ground.resize(&self.device, size);
            }
            self.tone_map.bind(&self.device, &self.targets);
            self.forget_motion();
        }
        Ok(())
    }

    /// Renders rest positions too from now on, in a pass of their own.
    pub fn add_rest_positions(&mut self) {
        if self.targets.rest.is_some() {
            return;
        }
        let size = (self.targets.width, self.targets.height);
        self.targets.rest = Some(Target::new(&self.device, "rest position", REST_FORMAT, 1, size));
    }

    /// Renders the control map too from now on, in a pass of its own, where `scene`, which must be the one given to
    /// [`Renderer::new`], has one.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] when its values are beyond the limits of the device.
    pub fn add_control(&mut self, scene: &Scene) -> Result<()> {
        if self.control.is_none() && scene.has_control() {
            self.control = Some(ControlValues::new(&self.device, &self.layouts, scene)?);
            self.add_control_target();
        }
        Ok(())
    }

    fn add_control_target(&mut self) {
        let size = (self.targets.width, self.targets.height);
        let make = || Target::new(&self.device, "control", CONTROL_FORMAT, 1, size);
        self.targets.control = self.control.as_ref().map(|_| make());
    }

    /// Renders colours of surfaces and their light too from now on, in a pass of their own, and makes of them those that go with
    /// the colour in this state.
    pub fn add_layers(&mut self, state: ImageState) {
        let size = (self.targets.width, self.targets.height);
        let layers = self.targets.layers.get_or_insert_with(|| Layers::new(&self.device, size));
        if state == ImageState::DisplayReferred {
            layers.add_displayed(&self.device);
            self.tone_map.bind(&self.device, &self.targets);
        }
    }

    /// Takes another background from now on. `scene_referred` says that colours are wanted before tone mapping.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for pictures beyond the limits of the device.
    pub fn set_background(&mut self, background: &Background, scene_referred: bool) -> Result<()> {
        let (device, queue) = (&self.device, &self.queue);
        self.backdrop = Backdrop::new(device, queue, &self.layouts, background, scene_referred)?;
        Ok(())
    }

    /// Lets the scene cast its shadow on an invisible ground at its lowest point from now on.
    pub fn add_ground(&mut self) {
        let size = (self.targets.width, self.targets.height);
        self.ground.get_or_insert_with(|| Ground::new(&self.device, &self.layouts, size));
    }

    /// Makes the next frame the first of a sequence: its motion vectors are 0.
    pub fn forget_motion(&mut self) {
        self.history = History::default();
    }

    /// Makes a frame that is not rendered the one before the next, which its motion starts from.
    pub fn pass_over(&mut self, scene: &Scene, pose: &Pose, view: &View, lighting: &Lighting) {
        let frame = self.write_buffers(scene, pose, view, lighting);
        self.history.view_projection = Some(frame.view_projection);
    }

    /// Records one frame of `scene`, which must be the one given to [`Renderer::new`], in `pose`. Buffers are
    /// written through the queue, so the encoder must be submitted before the next call.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        pose: &Pose,
        view: &View,
        lighting: &Lighting,
    ) {
        let frame = self.write_buffers(scene, pose, view, lighting);
        let Targets { rest, control, layers, .. } = &self.targets;
        let passes = [
            (Pass::Shadow, true),
            (Pass::Depth, true),
            (Pass::Surface, true),
            (Pass::Geometry, true),
            (Pass::Rest, rest.is_some()),
            (Pass::Control, control.is_some()),
            (Pass::Layers, layers.is_some()),
        ];
        for draw in 0..scene.draws.len() {
            for (pass, _) in passes.into_iter().filter(|(_, is_wanted)| *is_wanted) {
                self.pipelines.prepare(&self.device, self.variant(scene, draw, pass));
            }
        }
        let eye = frame.eye.truncate();
        self.visible.update(scene, &self.primitives, pose, eye, frame.view_projection);
        self.shadow_passes(encoder, scene);
        if let Some(ground) = self.shown_ground() {
            ground.shadow_pass(encoder, &self.buffers.bind_group, &self.shadow_maps.group);
        }
        self.surface_pass(encoder, scene);
        if let Some(layers) = &self.targets.layers {
            self.layers_pass(encoder, scene, layers);
        }
        self.geometry_passes(encoder, scene);
        if let Some(rest) = &self.targets.rest {
            self.geometry_pass(encoder, scene, Pass::Rest, &[rest]);
        }
        if let Some(control) = &self.targets.control {
            self.geometry_pass(encoder, scene, Pass::Control, &[control]);
        }
        self.tone_map.encode(encoder, &self.targets);
        self.history.view_projection = Some(frame.view_projection);
    }

    /// Records the geometry of the frame that was encoded last once more, now that another one was [passed
    /// over](Self::pass_over): its motion vectors lead there. Its encoder must have been submitted.
    pub fn encode_motion(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        pose: &Pose,
        view: &View,
        lighting: &Lighting,
    ) {
        self.pass_over(scene, pose, view, lighting);
        self.geometry_passes(encoder, scene);
    }

    /// Records the geometry of the frame that was encoded last once more, moved by a part of a pixel, x to the right and y
    /// down: another sample of each pixel. Its encoder must have been submitted.
    pub fn encode_shifted(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        (scene, pose, view, lighting): (&Scene, &Pose, &View, &Lighting),
        [x, y]: [f32; 2],
    ) {
        let mut frame = self.write_buffers(scene, pose, view, lighting);
        // A pixel is so much of the picture, which is 2 wide and high where shaders see it, y up.
        let shift = Vec3::new(2.0 * x * frame.size.z, -2.0 * y * frame.size.w, 0.0);
        frame.view_projection = Mat4::from_translation(shift) * frame.view_projection;
        self.queue.write_buffer(&self.buffers.frame, 0, bytemuck::bytes_of(&frame));
        self.geometry_passes(encoder, scene);
    }

    fn write_buffers(&mut self, scene: &Scene, pose: &Pose, view: &View, lighting: &Lighting) -> FrameBlock {
        let scratch = &mut self.scratch;
        let first = self.history.models.len() != scene.draws.len();
        fill_joints(scene, pose, &self.joints, self.joint_count, &mut scratch.joints, first);
        fill_weights(pose, &self.weights, self.weight_count, &mut scratch.weights, first);
        scratch.instances.clear();
        scratch.mirrored.clear();
        self.history.models.resize(scene.draws.len(), Mat4::IDENTITY);
        for (index, draw) in scene.draws.iter().enumerate() {
            let primitive = scene.primitive(draw);
            let joints = self.joints[draw.node].filter(|_| !primitive.influences.is_empty());
            let model = pose.world[draw.node];
            let previous = std::mem::replace(&mut self.history.models[index], model);
            let skeleton = joints.map(|j| scratch.joints[j as usize]);
            scratch.mirrored.push(skeleton.unwrap_or(model).determinant() < 0.0);
            scratch.instances.push(InstanceBlock {
                model,
                previous_model: if first { model } else { previous },
                rest: self.rest[index],
                joints: joints.unwrap_or(0),
                previous_joints: joints.unwrap_or(0) + self.joint_count as u32,
                weights: self.weights[draw.node],
                previous_weights: self.weights[draw.node] + self.weight_count as u32,
                morph_targets: primitive.morph_targets.len() as u32,
                vertex_count: primitive.vertices.len() as u32,
                influence_sets: if joints.is_some() { primitive.influence_sets as u32 } else { 0 },
                object_id: index as u32 + 1,
            });
        }
        uniforms::lights(scene, pose, lighting, &mut scratch.lights);
        let size = (self.targets.width, self.targets.height);
        let cascades = Cascades::new(scene, lighting, view, size.0 as f32 / size.1 as f32);
        self.cascades = lighting.sun_color.map(|_| cascades);
        let ground = self.ground.as_ref().and_then(|_| ground::plane(scene, lighting, view));
        self.shows_ground = ground.is_some();
        let mut frame =
            FrameBlock::new(view, lighting, &cascades, ground, size, self.history.view_projection);
        frame.settings.y = scratch.lights.len() as f32;
        let write = |buffer: &wgpu::Buffer, bytes: &[u8]| {
            if !bytes.is_empty() {
                self.queue.write_buffer(buffer, 0, bytes);
            }
        };
        write(&self.buffers.frame, bytemuck::bytes_of(&frame));
        write(&self.buffers.instances, bytemuck::cast_slice(&scratch.instances));
        write(&self.buffers.joints, bytemuck::cast_slice(&scratch.joints));
        write(&self.buffers.weights, bytemuck::cast_slice(&scratch.weights));
        write(&self.buffers.lights, bytemuck::cast_slice(&scratch.lights));
        self.tone_map.set(&self.queue, lighting.exposure, self.backdrop.behind);
        frame
    }

    fn variant(&self, scene: &Scene, draw: usize, pass: Pass) -> Variant {
        let material = &scene.materials[scene.primitive(&scene.draws[draw]).material];
        Variant::new(pass, material, self.scratch.mirrored[draw])
    }

    fn draw(&self, pass: &mut wgpu::RenderPass, scene: &Scene, index: usize, kind: Pass) {
        let Some(pipeline) = self.pipelines.get(self.variant(scene, index, kind)) else { return };
        let draw = &scene.draws[index];
        let primitive = &self.primitives[draw.mesh][draw.primitive];
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, &primitive.bind_group, &[]);
        pass.set_bind_group(2, &self.materials[scene.primitive(draw).material], &[]);
        if let (Some(control), Pass::Control) = (&self.control, kind) {
            pass.set_bind_group(3, control.group(draw), &[]);
        }
        pass.set_vertex_buffer(0, primitive.vertices.slice(..));
        pass.set_index_buffer(primitive.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..primitive.index_count, 0, index as u32..index as u32 + 1);
    }

    fn shadow_passes(&self, encoder: &mut wgpu::CommandEncoder, scene: &Scene) {
        let Some(cascades) = &self.cascades else { return };
        for cascade in 0..cascades.count {
            let depth = layouts::depth(&self.shadow_maps.layers[cascade], 1.0, wgpu::StoreOp::Store);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow"),
                depth_stencil_attachment: Some(depth),
                ..Default::default()
            });
            pass.set_bind_group(0, &self.buffers.bind_group, &[]);
            pass.set_bind_group(3, &self.shadow_maps.layer_groups[cascade], &[]);
            for (index, sphere) in self.visible.spheres.iter().enumerate() {
                // What is shown as it is, such as a painted sky, stands in no light.
                let unlit = scene.materials[scene.primitive(&scene.draws[index]).material].unlit;
                if !unlit && sphere.is_none_or(|(middle, radius)| cascades.reaches(cascade, middle, radius)) {
                    self.draw(&mut pass, scene, index, Pass::Shadow);
                }
            }
        }
    }

    /// Begins a pass over the scene from the camera, whose depth nothing reads afterwards.
    fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &str,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: &Target,
    ) -> wgpu::RenderPass<'e> {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: colors,
            depth_stencil_attachment: Some(layouts::depth(&depth.view, 0.0, wgpu::StoreOp::Discard)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.buffers.bind_group, &[]);
        pass.set_bind_group(3, &self.shadow_maps.group, &[]);
        pass
    }

    fn surface_pass(&self, encoder: &mut wgpu::CommandEncoder, scene: &Scene) {
        let targets = &self.targets;
        let mut color = layouts::cleared(&targets.multisampled.view, self.backdrop.clear);
        color.resolve_target = Some(&targets.radiance.view);
        color.ops.store = wgpu::StoreOp::Discard;
        let mut pass = self.begin(encoder, "surface", &[Some(color)], &targets.multisampled_depth);
        for &(_, index) in &self.visible.solid {
            let material = &scene.materials[scene.primitive(&scene.draws[index]).material];
            if material.alpha_mode == AlphaMode::Opaque {
                self.draw(&mut pass, scene, index, Pass::Depth);
            }
        }
        for &(_, index) in &self.visible.solid {
            self.draw(&mut pass, scene, index, Pass::Surface);
        }
        self.backdrop.draw(&mut pass, &self.pipelines.background);
        if let Some(ground) = self.shown_ground() {
            ground.draw(&mut pass, Pass::Surface);
        }
        for &(_, index) in &self.visible.blended {
            self.draw(&mut pass, scene, index, Pass::Surface);
        }
    }

    /// Colours of surfaces and their light, by samples as [`Renderer::surface_pass`] has them.
    fn layers_pass(&self, encoder: &mut wgpu::CommandEncoder, scene: &Scene, layers: &Layers) {
        let depth = &self.targets.multisampled_depth;
        let mut pass = self.begin(encoder, "layers", &layers.attachments(), depth);
        for &(_, index) in self.visible.solid.iter().chain(&self.visible.blended) {
            self.draw(&mut pass, scene, index, Pass::Layers);
        }
    }

    /// All that is known of each pixel but its colour, its rest position and its control values.
    fn geometry_passes(&self, encoder: &mut wgpu::CommandEncoder, scene: &Scene) {
        let targets = &self.targets;
        let geometry = [&targets.normal, &targets.depth, &targets.object_id, &targets.motion];
        self.geometry_pass(encoder, scene, Pass::Geometry, &geometry);
    }

    /// One sample a pixel of what is nearest, into `targets`.
    fn geometry_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        kind: Pass,
        targets: &[&Target],
    ) {
        let attachments: Vec<_> =
            targets.iter().map(|t| Some(layouts::cleared(&t.view, kind.nothing()))).collect();
        let mut pass = self.begin(encoder, "geometry", &attachments, &self.targets.geometry_depth);
        for &(_, index) in self.visible.solid.iter().chain(&self.visible.blended) {
            self.draw(&mut pass, scene, index, kind);
        }
        if let Some(ground) = self.shown_ground() {
            ground.draw(&mut pass, kind);
        }
    }

    /// The ground, where this frame has one.
    fn shown_ground(&self) -> Option<&Ground> {
        self.ground.as_ref().filter(|_| self.shows_ground)
    }
}
