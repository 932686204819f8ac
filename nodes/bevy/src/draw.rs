//! The system that stylizes the camera at hand, in Bevy's render schedule.

use crate::component::Wanted;
use crate::error::Error;
use crate::guides::{self, Prepasses, View};
use crate::runner::{Picture, Runner};
use crate::{present, shaders};
use bevy::camera::CompositingSpace;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::prelude::*;
use bevy::log::{error, error_once};
use bevy::render::render_resource::TextureView;
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::view::{ExtractedView, ResolvedCompositingSpace, ViewTarget};
use isophote::ColourSpace;
use isophote::engine::gpu::{Device, wgpu};
use isophote::guides::Guides;
use std::sync::Arc;

/// All that is kept on the device for stylized cameras.
#[derive(Resource, Default)]
pub(crate) struct Drawings {
    device: Option<Arc<Device>>,
    guides: Vec<guides::Pass>,
    presents: Vec<present::Pass>,
    cameras: EntityHashMap<Drawing>,
}

/// State of one camera.
struct Drawing {
    /// None where its look could not be drawn; it is tried again when something else is wanted.
    runner: Option<Runner>,
    /// The look and the picture that it was tried for last.
    tried: (Wanted, Picture),
    /// The [`View`] of the frame, and its viewport alone.
    uniforms: [wgpu::Buffer; 2],
}

type Camera<'w, 's> = ViewQuery<
    'w,
    's,
    (
        &'static ViewTarget,
        &'static ExtractedView,
        Option<&'static ViewPrepassTextures>,
        Option<&'static ResolvedCompositingSpace>,
        &'static Wanted,
    ),
>;

/// Stylizes the picture of the camera at hand. Where that fails the picture stays, and the error is logged once.
pub(crate) fn stylize(
    camera: Camera,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    mut drawings: ResMut<Drawings>,
    mut context: RenderContext,
) {
    let entity = camera.entity();
    let (target, view, prepass, space, wanted) = camera.into_inner();
    let Some(space) = space_of(space) else { return };
    let [left, top, width, height] = view.viewport.to_array();
    let picture = Picture { size: [width, height], space, guides: known(prepass) };
    let raw = device.wgpu_device();
    let Drawings { device: shared, guides, presents, cameras } = &mut *drawings;
    let shared = shared.get_or_insert_with(|| Device::wrap(raw.clone(), (**queue).clone()));
    let Some(drawing) = followed(cameras, entity, shared, wanted, picture) else { return };

    let viewport = [left, top, width, height].map(|n| n as i32);
    let view_from_world = view.world_from_view.to_matrix().inverse();
    let block = View {
        view_from_world: view_from_world.to_cols_array_2d(),
        view_from_clip: view.clip_from_view.inverse().to_cols_array_2d(),
        viewport,
    };
    let [of_view, of_viewport] = &drawing.uniforms;
    queue.write_buffer(of_view, 0, bytemuck::bytes_of(&block));
    queue.write_buffer(of_viewport, 0, bytemuck::bytes_of(&viewport));

    let prepasses = prepasses(target, prepass);
    let at =
        found(guides, |pass| pass.fits(&prepasses), || guides::Pass::new(raw, prepasses.is_multisampled()));
    let encoder = context.command_encoder();
    let Some(runner) = &mut drawing.runner else { return };
    guides[at].encode(raw, encoder, of_view, prepasses, &runner.targets(), picture.size);
    match runner.encode(encoder) {
        Ok(stylized) => {
            let (write, format) = (target.post_process_write(), target.main_texture_format());
            let at = found(presents, |pass| pass.fits(format), || present::Pass::new(raw, format));
            presents[at].encode(raw, encoder, of_viewport, [write.source, &stylized], write.destination);
        }
        Err(e) => {
            failed(&e);
            drawing.runner = None;
        }
    }
}

/// The space of a camera's colours; none for one that no look reads.
fn space_of(space: Option<&ResolvedCompositingSpace>) -> Option<ColourSpace> {
    match space.and_then(|space| space.0) {
        None | Some(CompositingSpace::Linear) => Some(ColourSpace::Linear),
        Some(CompositingSpace::Srgb) => Some(ColourSpace::Srgb),
        Some(CompositingSpace::Oklab) => {
            error_once!(
                "a camera that blends in Oklab is not stylized: choose CompositingSpace::Srgb or Linear"
            );
            None
        }
    }
}

/// Guides that a camera's prepasses give.
fn known(prepass: Option<&ViewPrepassTextures>) -> Guides {
    let has = |view: fn(&ViewPrepassTextures) -> Option<&TextureView>| prepass.and_then(view).is_some();
    let depth = has(ViewPrepassTextures::depth_only_view);
    Guides {
        depth,
        // Depth says where there is a surface.
        normal: depth && has(ViewPrepassTextures::normal_view),
        motion: has(ViewPrepassTextures::motion_vectors_view),
        ..Guides::NONE
    }
}

/// The pictures of a camera.
fn prepasses<'v>(target: &'v ViewTarget, prepass: Option<&'v ViewPrepassTextures>) -> Prepasses<'v> {
    Prepasses {
        color: target.main_texture_view(),
        depth: prepass.and_then(|p| p.depth_only_view()).map(|view| &**view),
        normal: prepass.and_then(|p| p.normal_view()).map(|view| &**view),
        motion: prepass.and_then(|p| p.motion_vectors_view()).map(|view| &**view),
    }
}

/// Forgets what is kept for cameras that are stylized no longer.
pub(crate) fn forget(mut drawings: ResMut<Drawings>, cameras: Query<(), With<Wanted>>) {
    drawings.cameras.retain(|entity, _| cameras.contains(*entity));
}

/// State of a camera, brought to what is wanted now; none where that cannot be drawn.
fn followed<'d>(
    cameras: &'d mut EntityHashMap<Drawing>,
    entity: Entity,
    device: &Arc<Device>,
    wanted: &Wanted,
    picture: Picture,
) -> Option<&'d mut Drawing> {
    let drawing = cameras.entry(entity).or_insert_with(|| {
        let raw = device.raw();
        let uniforms = [size_of::<View>(), size_of::<[i32; 4]>()]
            .map(|size| shaders::uniforms(raw, "isophote view", size));
        let runner = kept(Runner::new(device, wanted, picture));
        Drawing { runner, tried: (wanted.clone(), picture), uniforms }
    });
    let (before, earlier) = &drawing.tried;
    let is_other = !Arc::ptr_eq(&before.style, &wanted.style)
        || *earlier != picture
        || before.max_motion != wanted.max_motion
        || before.precision != wanted.precision;
    match &mut drawing.runner {
        Some(runner) => {
            if let Err(e) = runner.update(wanted, picture) {
                failed(&e);
                drawing.runner = None;
            }
        }
        None if is_other => drawing.runner = kept(Runner::new(device, wanted, picture)),
        None => {}
    }
    drawing.tried = (wanted.clone(), picture);
    drawing.runner.is_some().then_some(drawing)
}

fn kept(runner: Result<Runner, Error>) -> Option<Runner> {
    runner.inspect_err(failed).ok()
}

fn failed(e: &Error) {
    error!("a camera is not stylized: {e}");
}

/// The index of the pass that fits, which is made where there is none.
fn found<T>(passes: &mut Vec<T>, fits: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> usize {
    passes.iter().position(fits).unwrap_or_else(|| {
        passes.push(make());
        passes.len() - 1
    })
}
