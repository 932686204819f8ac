//! Pictures as they are drawn.

use crate::stage::{Picture, SIZE, Stage};
use bevy::core_pipeline::prepass::{DepthPrepass, MotionVectorPrepass, NormalPrepass};
use bevy::prelude::*;
use isophote_bevy::isophote::engine::cpu::{Control, CpuExecutor, Pool};
use isophote_bevy::isophote::engine::{Image, Rect};
use isophote_bevy::isophote::{Graph, Planned, Request};
use isophote_bevy::{Look, Precision, Stylize};
use std::path::Path;

/// A scene of a few things, a camera and its target.
fn scene() -> (Stage, Entity, Handle<bevy::image::Image>) {
    let mut stage = Stage::new(Path::new("."));
    let color = |r, g, b| StandardMaterial {
        base_color: Color::srgb(r, g, b),
        perceptual_roughness: 0.8,
        ..default()
    };
    stage.put(Sphere::new(0.9).mesh().uv(64, 32), color(0.8, 0.3, 0.2), Transform::from_xyz(-1.0, 0.2, 0.0));
    stage.put(Cuboid::new(1.3, 1.3, 1.3).into(), color(0.2, 0.5, 0.8), Transform::from_xyz(1.0, 0.0, -0.4));
    stage.put(
        Plane3d::default().mesh().size(12.0, 12.0).build(),
        color(0.5, 0.6, 0.4),
        Transform::from_xyz(0.0, -0.7, 0.0),
    );
    let target = stage.target(SIZE);
    let camera = stage.camera(&target);
    (stage, camera, target)
}

/// A style whose lengths are pixels of the picture, which is small.
fn in_pixels(style: &str) -> Look {
    let json = format!(r#"{{"style": "{style}", "lengths": "pixels"}}"#);
    Look::from_json("a test", &json).expect("a preset")
}

/// The picture by the library's CPU executor, in sRGB as it was captured.
fn expected(plain: &Picture, style: &str) -> Picture {
    let [width, height] = plain.size;
    let values = plain.texels.iter().flatten().map(|v| f32::from(*v) / 255.0).collect();
    let image = Image::from_vec(width, height, 4, values).expect("the texels are a picture");
    let planned =
        Planned::new(&Graph::single(style).expect("a style"), Request::new(width, height)).expect("a plan");
    let all = Rect::of_size(width, height);
    let inputs = [("color", &image)];
    let (mut executor, threads) = (CpuExecutor::new(), Pool::new(0));
    let results =
        executor.run(planned.plan(), &inputs, all, &threads, Control::default()).expect("a picture");
    let data = results[0].data();
    let texel = |v: &[f32]| [v[0], v[1], v[2], v[3]].map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
    Picture { size: plain.size, texels: data.chunks_exact(4).map(texel).collect() }
}

#[test]
fn a_style_of_colours_is_the_librarys_own() {
    let (mut stage, camera, target) = scene();
    let plain = stage.picture(&target);
    for style in ["anisotropic_kuwahara", "bilateral"] {
        stage.stylize(camera, in_pixels(style));
        stage.app.world_mut().get_mut::<Stylize>(camera).expect("it is stylized").precision =
            Precision::Exact;
        let drawn = stage.picture(&target);
        let changed = drawn.differs(&plain, 4);
        assert!(changed > 0.002, "{style} changed {changed} of the picture");
        let share = drawn.differs(&expected(&plain, style), 3);
        assert!(share < 0.002, "{style}: {share} of the picture differs");
    }
}

#[test]
fn a_disabled_camera_is_as_it_was() {
    let (mut stage, camera, target) = scene();
    let plain = stage.picture(&target);
    stage.stylize(camera, Look::named("look:travel_poster").expect("a look"));
    let drawn = stage.picture(&target);
    assert!(drawn.differs(&plain, 16) > 0.2);
    stage.app.world_mut().get_mut::<Stylize>(camera).expect("it is stylized").enabled = false;
    let disabled = stage.picture(&target);
    // Borders may differ where a prepass decides which surface is seen.
    assert!(disabled.differs(&plain, 2) < 0.005, "{}", disabled.differs(&plain, 2));
    stage.app.world_mut().entity_mut(camera).remove::<Stylize>();
    assert_eq!(stage.picture(&target), disabled);
}

/// Share of dark texels.
fn dark(picture: &Picture) -> f32 {
    let is_dark = |texel: &&[u8; 4]| texel[..3].iter().all(|v| *v < 90);
    picture.texels.iter().filter(is_dark).count() as f32 / picture.texels.len() as f32
}

#[test]
fn lines_are_drawn_where_only_the_prepasses_see_them() {
    let mut stage = Stage::new(Path::new("."));
    // One colour without light before a ground of that colour: the picture shows nothing at all.
    let flat = || StandardMaterial { base_color: Color::srgb(0.7, 0.75, 0.8), unlit: true, ..default() };
    stage.put(
        Cuboid::new(1.4, 1.4, 1.4).into(),
        flat(),
        Transform::from_rotation(Quat::from_rotation_y(0.6)),
    );
    let target = stage.target(SIZE);
    let camera = stage.camera(&target);
    let plain = stage.picture(&target);
    assert!(plain.texels.iter().all(|texel| *texel == plain.texels[0]), "the cube is seen without lines");
    stage.stylize(camera, in_pixels("cartoon"));
    let drawn = dark(&stage.picture(&target));
    assert!((0.003..0.1).contains(&drawn), "{drawn} of the picture is dark");
    stage.app.world_mut().entity_mut(camera).remove::<(DepthPrepass, NormalPrepass, MotionVectorPrepass)>();
    assert_eq!(dark(&stage.picture(&target)), 0.0);
}

#[test]
fn pictures_stand_still_where_nothing_moves() {
    let (mut stage, camera, target) = scene();
    let mut look = Look::named("cartoon").expect("a style");
    look.set("steadiness", "1").expect("a parameter");
    stage.stylize(camera, look);
    let first = stage.picture(&target);
    let later = stage.picture(&target);
    assert!(first.differs(&later, 1) < 0.001);
    // A cut: what was before counts no longer.
    stage.app.world_mut().get_mut::<Transform>(camera).expect("it stands somewhere").translation.x = 2.0;
    stage.app.world_mut().get_mut::<Stylize>(camera).expect("it is stylized").shot = 1;
    let cut = stage.picture(&target);
    assert!(cut.differs(&later, 16) > 0.1);
}
