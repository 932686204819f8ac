//! Cameras of all kinds.

use crate::stage::{SIZE, Stage};
use bevy::camera::{Hdr, RenderTarget, Viewport};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use isophote_bevy::Look;
use std::path::Path;

fn stage() -> Stage {
    let mut stage = Stage::new(Path::new("."));
    let material = StandardMaterial { base_color: Color::srgb(0.8, 0.3, 0.2), ..default() };
    stage.put(Sphere::new(1.0).mesh().uv(64, 32), material, Transform::default());
    stage
}

#[test]
fn two_cameras_share_a_target_with_a_look_each() {
    let mut stage = stage();
    let target = stage.target(SIZE);
    let cameras = [stage.camera(&target), stage.camera(&target)];
    let half = UVec2::new(SIZE[0] / 2, SIZE[1]);
    for (index, camera) in cameras.into_iter().enumerate() {
        let mut camera = stage.app.world_mut().get_mut::<Camera>(camera).expect("a camera");
        camera.order = index as isize;
        camera.viewport = Some(Viewport {
            physical_position: UVec2::new(half.x * index as u32, 0),
            physical_size: half,
            ..default()
        });
        if index > 0 {
            camera.clear_color = ClearColorConfig::None;
        }
    }
    let halves = [[0, 0, half.x, half.y], [half.x, 0, half.x, half.y]];
    let plain = stage.picture(&target);
    stage.stylize(cameras[1], Look::named("look:fineliner").expect("a look"));
    let one = stage.picture(&target);
    assert_eq!(one.part(halves[0]), plain.part(halves[0]));
    assert!(one.part(halves[1]).differs(&plain.part(halves[1]), 16) > 0.2);
    stage.stylize(cameras[0], Look::named("look:travel_poster").expect("a look"));
    let both = stage.picture(&target);
    assert!(both.part(halves[0]).differs(&plain.part(halves[0]), 16) > 0.1);
    assert!(both.part(halves[0]).differs(&both.part(halves[1]), 16) > 0.2);
    assert!(both.part(halves[1]).differs(&one.part(halves[1]), 2) < 0.001);
}

#[test]
fn samples_and_high_range_are_stylized_alike() {
    let mut stage = stage();
    let target = stage.target(SIZE);
    let camera = stage.camera(&target);
    stage.stylize(camera, Look::named("cartoon").expect("a style"));
    let once = stage.picture(&target);
    stage.app.world_mut().entity_mut(camera).insert(Msaa::Sample4);
    let sampled = stage.picture(&target);
    // Borders differ by their coverage.
    assert!(sampled.differs(&once, 24) < 0.03);
    stage.app.world_mut().entity_mut(camera).insert((Msaa::Off, Hdr, Tonemapping::None));
    let high = stage.picture(&target);
    assert!(high.differs(&once, 24) < 0.03);
}

#[test]
fn cameras_follow_their_targets_sizes() {
    let mut stage = stage();
    let target = stage.target(SIZE);
    let camera = stage.camera(&target);
    stage.stylize(camera, Look::named("cartoon").expect("a style"));
    let first = stage.picture(&target);
    for size in [[200, 320], [64, 48], [1, 1], SIZE] {
        let other = stage.target(size);
        let target = RenderTarget::Image(other.clone().into());
        stage.app.world_mut().entity_mut(camera).insert(target);
        assert_eq!(stage.picture(&other).size, size);
        if size == SIZE {
            assert!(stage.picture(&other).differs(&first, 2) < 0.001);
        }
    }
}

#[test]
fn cameras_that_are_hidden_or_gone_do_no_harm() {
    let mut stage = stage();
    let target = stage.target(SIZE);
    let camera = stage.camera(&target);
    stage.stylize(camera, Look::named("cartoon").expect("a style"));
    stage.app.world_mut().get_mut::<Camera>(camera).expect("a camera").is_active = false;
    stage.run(4);
    stage.app.world_mut().despawn(camera);
    stage.run(4);
}
